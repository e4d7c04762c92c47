"""Pages of panels drawn to one scale, each with a rod on the wall; heights, a scale bar and colour bars beside them."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from viscopoint.case.case import Case
from viscopoint.reproduction.figures.scene import RULER, View, draw_wall, upright
from viscopoint.reproduction.figures.solids import Paint

LEFT, RIGHT, TOP = 0.55, 0.80, 0.24  # margins of panels, inches
GAP, PAD = 0.10, 3.0  # between panels in inches, under titles in points
BAR = "colour bar"  # the label of its axis
BAR_WIDTH, BAR_SHARE = 0.11, 0.62  # width of a colour bar, and its height over that of its panels
ONE_ROW, TWO_ROWS = 0.136, 0.113  # inches per mm


class Page(NamedTuple):
    """A figure and its panels."""

    figure: Figure
    axes: Any  # [row, column]
    view: View

    def bar(self, paint: Paint, first: int, last: int, extend: Any = "neither") -> None:
        """Add a colour bar at the right of rows ``first`` to ``last``."""
        top, low = (self.axes[row, 0].get_position() for row in (first, last))
        across = self.figure.get_figwidth()
        height = BAR_SHARE * (top.y1 - low.y0)
        place = (1.0 - (RIGHT - 0.06) / across, 0.5 * (top.y1 + low.y0 - height), BAR_WIDTH / across, height)
        bar = self.figure.colorbar(
            ScalarMappable(paint.norm, paint.colours), cax=self.figure.add_axes(place, label=BAR),
            label=paint.label, extend=extend, ticks=MaxNLocator(8, steps=[1, 2, 2.5, 5, 10]),
        )  # fmt: skip
        bar.outline.set_linewidth(0.5)  # pyright: ignore[reportCallIssue, reportAttributeAccessIssue]


def lay_out(case: Case, titles: tuple[tuple[str, ...], ...], scale: float) -> Page:
    """Lay out rows of empty scenes, ``scale`` inches to a mm, with a title above each."""
    view = upright(case.rod, case.impact.gap, scale)
    width, height = view.size()
    rows, columns = len(titles), len(titles[0])
    total = rows * (height + TOP) + (rows - 1) * GAP + 0.02
    across = LEFT + columns * width + (columns - 1) * GAP + RIGHT
    figure = Figure(figsize=(across, total))
    axes = np.empty((rows, columns), object)
    for row, column in np.ndindex(rows, columns):
        bottom = total - (row + 1) * (height + TOP) - row * GAP
        axis = panel(figure, LEFT + column * (width + GAP), bottom, width, height)
        empty_scene(axis, view, case)
        axis.set_title(titles[row][column], pad=PAD)
        axes[row, column] = axis
    for axis in axes[:, 0]:
        rulers(axis, view, case.rod.length)
    return Page(figure, axes, view)


def letter(axis: Any, text: str) -> None:
    """Name a panel, or the row that it begins, at its upper left."""
    axis.annotate(text, (0.0, 1.0), (-34.0, PAD), "axes fraction", "offset points", weight="bold", va="baseline")


def panel(figure: Figure, left: float, low: float, width: float, height: float) -> Any:
    """Add an axis at a place in inches."""
    across, up = figure.get_size_inches()
    return figure.add_axes((left / across, low / up, width / across, height / up))


def empty_scene(axis: Any, view: View, case: Case) -> None:
    """Show the wall alone."""
    view.frame(axis)
    draw_wall(axis, view, case.rod, case.impact.gap)


def rulers(axis: Any, view: View, length: float) -> None:
    """Measure heights on the rod's axis at the left, and draw a scale bar below."""
    heights = np.arange(0.0, length + 1e-9, 5.0)
    axis.set_yticks(heights * np.cos(view.tilt), [f"{height:g}" for height in heights])
    axis.spines["left"].set_visible(True)
    axis.spines["left"].set_bounds(0.0, heights[-1] * np.cos(view.tilt))
    axis.set_ylabel("height on the axis (mm)")
    low = view.extent[2] + 0.25 * RULER
    axis.plot([-2.5, 2.5], [low, low], color="0.1", linewidth=1.5, solid_capstyle="butt")
    axis.text(2.8, low, "5 mm", ha="left", va="center", fontsize=8)
