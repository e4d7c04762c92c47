"""Figure 2: finite elements follow the circumference, material points stand on a lattice in stair-steps.

Beside each rod its foot face and a part of the rim close up: at the size of the rod the difference is a line's width.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from viscopoint.reproduction.figures import DPI, register
from viscopoint.reproduction.figures.page import LEFT, PAD, TOP, empty_scene, letter, panel, rulers
from viscopoint.reproduction.figures.scene import View, upright
from viscopoint.reproduction.figures.solids import Paint, draw_rod
from viscopoint.results.run import Run

WIDTH, SCALE, SIDE, GAP, EDGE = 7.0, 0.116, 1.30, 0.10, 0.04  # of the page, a mm of the rods, a face, between; inches
FACE, RIM = (-1.08, 1.08), (0.42, 1.08)  # what is seen of the foot, from the axis, in radii of the rod
PLAIN = Paint("", lambda snapshot: np.zeros(len(snapshot["position"])), ListedColormap(["#c3d4e3"]), Normalize(0, 1))
RED = "#c1121f"
LINE: Any = {"fill": False, "edgecolor": RED, "zorder": 3.0}


@register(
    "FEM mesh and MPM points at the start",
    "The rod at t = 0 as finite elements (a) and as material points (b); beside each the foot, seen from below, and "
    "its rim close up; in red the circle of the rod's radius. The mesh follows the circumference, the lattice goes "
    "around it in steps.",
    needs=("fem-650", "mpm-650"),
)
def fig2(runs: Mapping[str, Run]) -> Figure:
    shown = [("(a) FEM", "elements", runs["fem-650"]), ("(b) MPM", "points", runs["mpm-650"])]
    case = shown[0][2].case
    view = upright(case.rod, case.impact.gap, SCALE)
    width, height = view.size()
    figure = Figure(figsize=(WIDTH, EDGE + height + TOP))
    second = WIDTH - EDGE - width - GAP - SIDE
    for left, (name, parts, run) in zip((LEFT, second), shown, strict=True):
        axis = panel(figure, left, EDGE, width, height)
        empty_scene(axis, view, case)
        draw_rod(axis, view, run, run.snapshot(0), PLAIN)
        count = len(run.body.cells) or len(run.body.position)
        axis.set_title(f"{count:,} {parts}", pad=PAD)
        letter(axis, name)
        if left == LEFT:
            rulers(axis, view, case.rod.length)
        _draw_faces(figure, left + width + GAP, EDGE + height, run)
    return figure


def _draw_faces(figure: Figure, left: float, top: float, run: Run) -> None:
    """Draw the foot face, and its rim close up below."""
    radius = run.case.rod.radius
    space = 0.5 * (top - 2.0 * SIDE - TOP)
    titles = "foot from below", "its rim close up"
    for row, ((first, last), title) in enumerate(zip((FACE, RIM), titles, strict=True)):
        axis = panel(figure, left, top - space * (0.3 + row) - SIDE * (row + 1) - TOP * row, SIDE, SIDE)
        low, high = radius * first, radius * last
        below = View(-0.5 * np.pi, 0.0, (low, high, low, high), DPI * SIDE / (high - low))  # up in the picture is -y
        below.frame(axis)
        draw_rod(axis, below, run, run.snapshot(0), PLAIN)
        axis.add_patch(Circle((0.0, 0.0), radius, linewidth=0.9, **LINE))
        axis.set_title(title, pad=PAD)
        if first < 0.0:
            corner, side = radius * RIM[0], radius * (RIM[1] - RIM[0])
            axis.add_patch(Rectangle((corner, corner), side, side, fill=False, linewidth=0.6, edgecolor="0.1"))
        else:
            axis.spines[:].set_visible(True)
            axis.text(0.95, 0.93, f"R = {radius:g} mm", transform=axis.transAxes, color=RED, ha="right", va="top")
