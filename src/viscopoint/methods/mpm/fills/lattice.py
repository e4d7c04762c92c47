"""A cubic lattice, cut where the rod ends: the paper's."""

import numpy as np

from viscopoint.methods.mpm.fills import FILLS
from viscopoint.model.body import Body, Surface


@FILLS.register("lattice")
def rod_lattice(radius: float, length: float, spacing: float) -> Body:
    """Fill an upright rod, its foot at z = 0, with the paper's lattice.

    Points stand at half spacings from the axis and from the foot, wherever that is inside the rod: 21,172 = 316 x 67
    for the paper's 3.8 mm, 25.4 mm and 0.38 mm. All lengths in mm; there must be room for two layers.
    """
    half = int(radius / spacing) + 1
    places = (np.arange(-half, half) + 0.5) * spacing
    y, x = (grid.ravel() for grid in np.meshgrid(places, places, indexing="ij"))
    inside = x**2 + y**2 <= radius**2 * (1 + 1e-12)
    x, y = x[inside], y[inside]
    layers = int(length / spacing + 0.5 + 1e-9)
    z = (np.arange(layers) + 0.5) * spacing
    position = np.stack([np.tile(x, layers), np.tile(y, layers), np.repeat(z, len(x))], axis=1, dtype=np.float64)
    index = np.arange(len(position)).reshape(layers, len(x))
    start = np.hypot(x, y)
    rim = start > radius - spacing
    surface = Surface(
        ring=index[:, rim],
        start=start[rim],
        radius=radius,
        tail=np.column_stack([index[-1], index[-2]]),
        foot=np.column_stack([index[0], index[1]]),
        reach=0.5,
        near=0.5 * spacing,
    )
    return Body(position, np.full(len(position), spacing**3), surface)
