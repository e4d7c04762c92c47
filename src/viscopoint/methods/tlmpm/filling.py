"""Tracers: points of no volume on the surface of a rod of points, that show where it is."""

import numpy as np

from viscopoint.kernels.arrays import Array
from viscopoint.methods.mpm.fills.meridian import boxes
from viscopoint.model.body import EXACT, Body, Surface


def with_tracers(body: Body, length: float, spacing: float) -> Body:
    """Add tracers on the surface: around the planes between layers, on the impact face and the rear face.

    The rod is then measured where its surface is, as finite elements are; with one layer to a cell where nodes are.
    """
    radius = body.surface.radius
    around = 4 * max(round(2 * np.pi * radius / (4 * spacing)), 3)
    angle = 2 * np.pi * np.arange(around) / around
    return _add_tracers(body, length, radius * np.column_stack([np.cos(angle), np.sin(angle)]))


def rod_meridian(radius: float, length: float, spacing: float, per_cell: int) -> Body:
    """Fill the half plane of the rod with boxes, ``per_cell`` to a cell that divides the radius; add tracers."""
    rings = per_cell * max(round(radius / (per_cell * spacing)), 1)
    layers = _even(length, spacing)
    body = boxes(radius, rings, radius / rings, layers, length / layers)
    return _add_tracers(body, length, np.array([[radius, 0.0]]))


def _even(length: float, spacing: float) -> int:
    """Return the even number of layers that comes closest."""
    return 2 * max(round(length / (2 * spacing)), 1)


def _add_tracers(body: Body, length: float, circle: Array) -> Body:
    """Add tracers at x and y of the ``circle`` between layers and at the ends, and over both end faces."""
    count, around = len(body.position), len(circle)
    layers = len(body.surface.ring)
    heights = length * np.arange(layers + 1) / layers
    layer = np.arange(len(heights) * around).reshape(len(heights), around)
    on = np.column_stack([np.tile(circle, (len(heights), 1)), np.repeat(heights, around)])
    ends = np.unique(np.round(body.position[body.surface.impact_face[:, 0], :2], 12), axis=0)
    flat = [np.column_stack([ends, np.full(len(ends), z)]) for z in (0.0, length)]
    first = count + len(on) + np.arange(len(ends))
    impact, rear = (np.concatenate([count + layer[0], first]), np.concatenate([count + layer[-1], first + len(ends)]))
    surface = Surface(
        ring=count + layer,
        start=np.full(around, body.surface.radius),
        radius=body.surface.radius,
        rear_face=np.column_stack([rear, rear]),
        impact_face=np.column_stack([impact, impact]),
        end_overhang=0.0,
        contact_height=EXACT * body.surface.radius,
    )
    position = np.concatenate([body.position, on, *flat])
    return Body(position, np.concatenate([body.volume, np.zeros(len(position) - count)]), surface)
