"""A lattice of boxes that the circumference cuts: the cylinder's volume, by points as even as a lattice's.

Boxes inside are cubes of edge d. Those on the circumference keep the part within, and their points stand at its
centroid, so that Σ V_p f(x_p) over the points is exact for all linear f. For x² it lacks what the parts have about
their own centroids, d²/12 of a whole box and less of a part:

    (area of the whole boxes) d² / 12  <  π R⁴ / 4 - Σ A_p x_p²  <  π R² d² / 12.

A cut box has as little volume as the circle leaves it, and stands nearer than d to its neighbour inside. Boxes of GIMP
are as wide for it as for all: they overlap beside the surface, with little weight, and nowhere else. In height all
boxes are whole, so that where they end (``gated``) is right for all.
"""

from itertools import pairwise

import numpy as np

from viscopoint.kernels.arrays import Array
from viscopoint.methods.mpm.fills import FILLS, Layer, stacked
from viscopoint.model.body import Body


@FILLS.register("trimmed")
def rod_trimmed(radius: float, length: float, spacing: float) -> Body:
    """Fill the rod with boxes side by side, cut where the rod ends: a lattice of exactly its volume.

    In height the boxes are as close to ``spacing`` as an even number of layers allows: two make a cell.
    """
    half = int(np.ceil(radius / spacing - 1e-9))
    edges: Array = np.linspace(-half, half, 2 * half + 1) * spacing
    area, x, y = _cut_squares(edges, radius)
    kept = area > 1e-9 * spacing**2
    area, x, y = area[kept], x[kept], y[kept]
    layers = 2 * max(round(length / (2 * spacing)), 1)
    height = length / layers
    start = np.hypot(x, y)
    rim = start > radius - spacing
    return stacked(Layer(x, y, area * height, rim, start[rim], contact_height=0.5 * spacing), layers, height, radius)


def _cut_squares(edges: Array, radius: float) -> tuple[Array, Array, Array]:
    """Return area and centroid of each square of a square lattice, as far as it is within the circle.

    By symmetry over the diagonal the centroid's y is the x of the square mirrored there.
    """
    low, high = edges[:-1], edges[1:]
    points, weights = np.polynomial.legendre.leggauss(32)
    area = np.zeros((len(low), len(low)))
    moment = np.zeros_like(area)
    for i, (x0, x1) in enumerate(zip(low, high, strict=True)):
        # in y the part is what lies between the edges and the circle: smooth between where the circle meets an edge,
        # and of the angle x = radius sin(a) up to the circle's end
        kinks = np.sqrt(np.maximum(radius**2 - edges**2, 0.0))
        breaks = np.unique(np.clip(np.concatenate([[x0, x1], kinks, -kinks]), max(x0, -radius), min(x1, radius)))
        for a, b in pairwise(np.arcsin(breaks / radius)):
            angle = 0.5 * (a + b) + 0.5 * (b - a) * points
            x, half_chord = radius * np.sin(angle), radius * np.cos(angle)
            inside = np.clip(high[:, None], -half_chord, half_chord) - np.clip(low[:, None], -half_chord, half_chord)
            share = 0.5 * (b - a) * weights * half_chord
            area[i] += inside @ share
            moment[i] += inside @ (share * x)
    x = np.divide(moment, area, out=np.zeros_like(area), where=area > 0.0)
    return area.ravel(), x.ravel(), x.T.ravel()
