"""Points of no volume on the surface of a rod of points, that show where it is."""

import numpy as np

from viscopoint.kernels.arrays import Array
from viscopoint.methods.mpm.fills.meridian import boxes
from viscopoint.model.body import EXACT, Body, Surface


def watched(body: Body, length: float, spacing: float) -> Body:
    """Add points of no volume on the surface: around the planes between layers, on the impact face and the rear face.

    The rod is then measured where its surface is, as finite elements are; with one layer to a cell where nodes are.
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
    """Add points of no volume at x and y of the ``circle`` between layers and at the ends, and over foot and tail."""
    count, around = len(body.position), len(circle)
    layers = len(body.surface.ring)
    heights = length * np.arange(layers + 1) / layers
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
        near=EXACT * body.surface.radius,
    )
    position = np.concatenate([body.position, on, *flat])
    return Body(position, np.concatenate([body.volume, np.zeros(len(position) - count)]), surface)
