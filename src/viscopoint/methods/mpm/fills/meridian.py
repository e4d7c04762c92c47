"""The half plane x = r >= 0, y = 0 of a round rod: boxes side by side, each point a ring in the middle of its box.

In the middle, at r, the ring's volume is 2 pi r dr dz exactly, and volume over radius is the same for all: a uniform
stress pulls at no node inside as long as boxes do not lie across the planes of nodes. At the centroid, r + dr²/(12 r),
neither would hold.
"""

import numpy as np

from viscopoint.kernels.arrays import Array
from viscopoint.methods.mpm.fills import MERIDIANS, Layer, stacked
from viscopoint.model.body import Body


@MERIDIANS.register("lattice")
def half_lattice(radius: float, length: float, spacing: float) -> Body:
    """Fill the rod as the paper's lattice does along its axis, points at half spacings; boxes divide the radius."""
    rings, layers = max(round(radius / spacing), 1), int(length / spacing + 0.5 + 1e-9)
    return boxes(radius, rings, radius / rings, layers, spacing)


@MERIDIANS.register("rings")
@MERIDIANS.register("trimmed")
def half_rings(radius: float, length: float, spacing: float) -> Body:
    """Fill the rod with boxes that divide radius and length, as close to ``spacing`` as can be: exactly its volume."""
    rings, layers = max(round(radius / spacing), 1), max(round(length / spacing), 2)
    return boxes(radius, rings, radius / rings, layers, length / layers)


def boxes(radius: float, rings: int, thickness: float, layers: int, height: float) -> Body:
    """Return an upright rod of ``rings`` times ``layers`` boxes, its foot at z = 0; the case's radius is ``radius``."""
    r: Array = np.linspace(0.5, rings - 0.5, rings) * thickness
    outermost, volume = slice(None, -3, -1), 2.0 * np.pi * r * thickness * height
    layer = Layer(r, np.zeros(rings), volume, outermost, r[outermost], contact_height=0.5 * thickness)
    return stacked(layer, layers, height, radius)
