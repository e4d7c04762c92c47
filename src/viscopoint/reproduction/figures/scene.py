"""The scene that all figures share: camera, light and wall."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.patches import Ellipse, Polygon
from matplotlib.patheffects import Normal, Stroke

from viscopoint.case.tables import Rod
from viscopoint.figures.shapes import seen
from viscopoint.kernels.arrays import Array
from viscopoint.reproduction.figures import DPI

TILT, TURN = np.radians(18.0), np.radians(-22.0)  # the camera looks down by the one; the other turns the rod under it
LIGHT = np.array([-0.45, 0.55, -0.70])  # where it comes from: across, up, away; about 1 long
SHADE, BRIGHT = 0.64, 1.10  # of a colour turned away from the light, and towards it
WALL, THICK = 1.72, 0.8  # radius of the piece of wall that is shown, in radii of the rod, and its thickness in mm
RULER = 1.7  # room for a scale bar below, mm
HALO = [Stroke(linewidth=2.0, foreground="1.0", alpha=0.6), Normal()]  # so that a line shows on any colour
STEEL, EDGE = ("0.88", "0.72"), "0.45"


class View(NamedTuple):
    """A camera far away, and what it sees."""

    tilt: float  # looks down by this angle
    turn: float  # of the rod about its axis, counter-clockwise from above
    extent: tuple[float, float, float, float]  # left, right, low, high in mm
    pixels: float  # of the figure's PNG to a mm

    def seen(self, position: Array) -> Array:
        """Return where places are in the picture: across, up, away from the camera [mm]."""
        x, y, z = position.T
        cos, sin = np.cos(self.turn), np.sin(self.turn)
        return seen(np.column_stack([cos * x - sin * y, sin * x + cos * y, z]), self.tilt)

    def size(self) -> tuple[float, float]:
        """Return the picture's width and height in inches."""
        left, right, low, high = self.extent
        return (right - left) * self.pixels / DPI, (high - low) * self.pixels / DPI

    def frame(self, axis: Any) -> None:
        """Show all that is in sight, without lines around it."""
        left, right, low, high = self.extent
        axis.set(xlim=(left, right), ylim=(low, high), xticks=[], yticks=[])
        axis.spines[:].set_visible(False)


def upright(rod: Rod, gap: float, scale: float) -> View:
    """See a rod on its wall from obliquely above; ``scale`` is in inches per mm."""
    half = WALL * rod.radius
    low = -gap * np.cos(TILT) - half * np.sin(TILT) - THICK - RULER
    high = rod.length * np.cos(TILT) + rod.radius * np.sin(TILT)
    margin = 0.15
    return View(TILT, TURN, (-half - margin, half + margin, low - margin, high + margin), DPI * scale)


def draw_wall(axis: Any, view: View, rod: Rod, gap: float) -> None:
    """Draw a round piece of the wall."""
    half, up = WALL * rod.radius, -gap * np.cos(view.tilt)
    size = {"width": 2.0 * half, "height": 2.0 * half * np.sin(view.tilt)}
    line: Any = {"edgecolor": EDGE, "linewidth": 0.5}
    axis.add_patch(Ellipse((0.0, up - THICK), **size, facecolor=STEEL[1], zorder=0.1, **line))
    sides = [(-half, up), (half, up), (half, up - THICK), (-half, up - THICK)]
    axis.add_patch(Polygon(sides, facecolor=STEEL[1], linewidth=0.0, zorder=0.2))
    for side in (-half, half):
        axis.plot([side, side], [up, up - THICK], color=EDGE, linewidth=0.5, zorder=0.25)
    axis.add_patch(Ellipse((0.0, up), **size, facecolor=STEEL[0], zorder=0.3, **line))


def outline(axis: Any, view: View, rod: Rod) -> None:
    """Draw where the rod was at the start, as far as a glass rod would show it in front."""
    r, z = rod.radius, rod.length * np.cos(view.tilt)
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    ring = np.column_stack([r * np.cos(angle), r * np.sin(angle) * np.sin(view.tilt)])
    front = ring[np.abs(angle - 1.5 * np.pi) <= 0.5 * np.pi + 1e-9]
    dashed: Any = {"color": "0.1", "linewidth": 0.7, "linestyle": (0, (4, 2.5)), "zorder": 3.0, "path_effects": HALO}
    axis.plot(ring[:, 0], ring[:, 1] + z, **dashed)
    axis.plot(*np.vstack([[-r, z], front, [r, z]]).T, **dashed)


def brightness(normal: Array) -> Array:
    """Return what a colour is multiplied by on faces of outward unit normals ``[n, 3]`` in the picture."""
    return SHADE + (BRIGHT - SHADE) * np.maximum(normal @ LIGHT, 0.0)
