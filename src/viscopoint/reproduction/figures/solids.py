"""Draws a rod as it stands in a scene: elements by their lit outer faces, material points as lit balls."""

from collections.abc import Callable
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import Colormap, ListedColormap, Normalize
from numpy.typing import NDArray

from viscopoint.case.tables import Rod
from viscopoint.figures.faces import ON_CUT, far_first, lines
from viscopoint.kernels.arrays import Array
from viscopoint.methods.fem.mesh import outer_faces
from viscopoint.reproduction.figures.balls import picture
from viscopoint.reproduction.figures.scene import View, brightness
from viscopoint.results.reader import Snapshot
from viscopoint.results.run import Run

LINE = 0.01  # width of the edges of elements, in points to a pixel per mm
BALL = 0.62  # radius of a material point's ball in spacings: balls of a stretched foot still hide what is behind
DEEP = 2.0  # how far below the surface points are still drawn, in spacings
FINE = 2.0  # pixels of the balls' picture to one of the figure's PNG, along each axis

Part = Callable[[Array], NDArray[np.bool_]]  # which of the places [p, 3] [mm] at the start are shown


class Paint(NamedTuple):
    """What the colours mean."""

    label: str  # with the unit
    values: Callable[[Snapshot], Array]
    colours: Colormap
    norm: Normalize

    def rgb(self, values: Array) -> Array:
        """Return red, green and blue of values, ``[n, 3]``."""
        return self.colours(self.norm(values))[:, :3]


def colours(name: str, first: float = 0.0, last: float = 1.0) -> Colormap:
    """Return a part of a colour map, such as one without its darkest end, on which light would not show."""
    return ListedColormap(matplotlib.colormaps[name](np.linspace(first, last, 256)))


def whole(start: Array) -> NDArray[np.bool_]:
    """Show all of the rod."""
    return np.ones(len(start), bool)


def half_section(start: Array) -> NDArray[np.bool_]:
    """Leave out the quarter in front at the right: the outside shows at the left, the inside at the right."""
    across, away, _ = start.T
    rim = ON_CUT * np.ptp(across)  # elements of an odd mesh whose centre is on the cut stay
    return ~((across > rim) & (away < -rim))


def draw_rod(axis: Any, view: View, run: Run, snapshot: Snapshot, paint: Paint, part: Part = whole) -> None:
    """Draw what is left of a rod at a snapshot."""
    draw = _draw_elements if len(run.body.cells) else _draw_points
    draw(axis, view, run, snapshot, paint, part)


def _draw_elements(axis: Any, view: View, run: Run, snapshot: Snapshot, paint: Paint, part: Part) -> None:
    cells = run.body.cells
    shown = part(run.body.position[cells].mean(axis=1)) & (snapshot["deleted"] == 0)
    faces = outer_faces(cells[shown])
    corners = view.seen(snapshot["position"])[faces]
    order = far_first(corners)
    faces, corners = faces[order], corners[order]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal *= -np.sign(normal[:, 2:]) / np.linalg.norm(normal, axis=1, keepdims=True)  # towards the camera
    colour = paint.rgb(paint.values(snapshot)[faces].mean(axis=1)) * brightness(normal)[:, None]
    axis.add_collection(
        PolyCollection(
            list(corners[:, :, :2]), facecolors=np.clip(colour, 0.0, 1.0), cmap=paint.colours, norm=paint.norm,
            snap=False, **(lines(run) | {"linewidths": LINE * view.pixels}),
        )
    )  # fmt: skip


def _draw_points(axis: Any, view: View, run: Run, snapshot: Snapshot, paint: Paint, part: Part) -> None:
    spacing = float(np.cbrt(run.body.volume[0]))
    lost = snapshot["lost"] > 0
    hidden = lost if lost.any() else _buried(run.body.position, run.case.rod, part, DEEP * spacing)
    shown = np.flatnonzero(part(run.body.position) & ~hidden)
    seen = view.seen(snapshot["position"][shown])
    left, right, low, high = view.extent
    fine = FINE * view.pixels
    shape = round((high - low) * fine), round((right - left) * fine)
    colour = paint.rgb(paint.values(snapshot)[shown])
    balls = picture(seen, colour, BALL * spacing, np.array([left, low]), shape, fine)
    axis.imshow(
        balls, extent=view.extent, origin="lower", cmap=paint.colours, norm=paint.norm, zorder=1.0,
        interpolation="hanning", interpolation_stage="rgba",
    )  # fmt: skip


def _buried(start: Array, rod: Rod, part: Part, deep: float) -> NDArray[np.bool_]:
    """Return which points have material of the part all around them, by their places at the start."""

    def material(place: Array) -> NDArray[np.bool_]:
        x, y, z = place.T
        return part(place) & (np.hypot(x, y) <= rod.radius) & (z >= 0.0) & (z <= rod.length)

    steps = deep * np.vstack([np.eye(3), -np.eye(3)])
    return np.logical_and.reduce([material(start + step) for step in steps])
