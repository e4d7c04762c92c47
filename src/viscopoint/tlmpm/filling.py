"""The rod's points on the undeformed grid, and points of no volume on its surface that show where it is."""

from itertools import pairwise

import numpy as np

from viscopoint.arrays import Array
from viscopoint.body import Body, Surface
from viscopoint.mpm.fills import FILLS
from viscopoint.mpm.fills.meridian import boxes


def rod_trimmed(radius: float, length: float, spacing: float) -> Body:
    """Fill the rod with boxes side by side, cut where the rod ends: a lattice of exactly its volume.

    Inside, boxes are cubes of edge ``spacing`` (in height as close to it as an even number of layers allows). Those on
    the circumference keep the part within, and their points stand at its centroid: integrals over the rod are exact
    for all linear functions.
    """
    half = int(np.ceil(radius / spacing - 1e-9))
    edges: Array = np.linspace(-half, half, 2 * half + 1) * spacing
    area, x, y = _cut_squares(edges, radius)
    kept = area > 1e-9 * spacing**2
    area, x, y = area[kept], x[kept], y[kept]
    layers = _even(length, spacing)
    height = length / layers
    z = (np.arange(layers) + 0.5) * height
    position = np.stack([np.tile(x, layers), np.tile(y, layers), np.repeat(z, len(x))], axis=1, dtype=np.float64)
    return Body(position, np.tile(area * height, layers), _ends(len(x), layers, radius))


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
            x, reach = radius * np.sin(angle), radius * np.cos(angle)
            inside = np.clip(high[:, None], -reach, reach) - np.clip(low[:, None], -reach, reach)
            share = 0.5 * (b - a) * weights * reach
            area[i] += inside @ share
            moment[i] += inside @ (share * x)
    x = np.divide(moment, area, out=np.zeros_like(area), where=area > 0.0)
    return area.ravel(), x.ravel(), x.T.ravel()


def _ends(across: int, layers: int, radius: float) -> Surface:
    index = np.arange(across * layers).reshape(layers, across)
    ends = [np.column_stack([index[a], index[b]]) for a, b in ((-1, -2), (0, 1))]
    return Surface(index, np.full(across, radius), radius, ends[0], ends[1], 0.5)


FILLING = {**FILLS, "trimmed": rod_trimmed}


def watched(body: Body, length: float, spacing: float) -> Body:
    """Add points of no volume on the surface: around each layer and around the foot and the tail, and on the axis.

    The rod is then measured where its surface is, as finite elements are.
    """
    radius = body.surface.radius
    around = 4 * max(round(2 * np.pi * radius / (4 * spacing)), 3)
    angle = 2 * np.pi * np.arange(around) / around
    return _watched_at(body, length, radius * np.column_stack([np.cos(angle), np.sin(angle)]))


def rod_meridian(radius: float, length: float, spacing: float, per_cell: int) -> Body:
    """Fill the half plane of the rod with boxes, ``per_cell`` to a cell that divides the radius; watch its surface."""
    rings = per_cell * max(round(radius / (per_cell * spacing)), 1)
    layers = _even(length, spacing)
    body = boxes(radius, rings, radius / rings, layers, length / layers)
    return _watched_at(body, length, np.array([[radius, 0.0]]))


def _even(length: float, spacing: float) -> int:
    """Return the even number of layers that comes closest."""
    return 2 * max(round(length / (2 * spacing)), 1)


def _watched_at(body: Body, length: float, circle: Array) -> Body:
    """Add points of no volume at x and y of the ``circle`` in each layer and at the ends, and over foot and tail."""
    count, around = len(body.position), len(circle)
    heights = np.concatenate([[0.0], np.unique(body.position[:, 2]), [length]])
    layer = np.arange(len(heights) * around).reshape(len(heights), around)
    on = np.column_stack([np.tile(circle, (len(heights), 1)), np.repeat(heights, around)])
    ends = np.unique(np.round(body.position[body.surface.foot[:, 0], :2], 12), axis=0)
    flat = [np.column_stack([ends, np.full(len(ends), z)]) for z in (0.0, length)]
    foot = count + len(on) + np.arange(len(ends))
    tail = foot + len(ends)
    foot, tail = np.concatenate([count + layer[0], foot]), np.concatenate([count + layer[-1], tail])
    surface = Surface(
        ring=count + layer,
        start=np.full(around, body.surface.radius),
        radius=body.surface.radius,
        tail=np.column_stack([tail, tail]),
        foot=np.column_stack([foot, foot]),
        reach=0.0,
    )
    position = np.concatenate([body.position, on, *flat])
    return Body(position, np.concatenate([body.volume, np.zeros(len(position) - count)]), surface)
