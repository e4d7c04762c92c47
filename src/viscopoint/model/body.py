"""The body: where its material is at the start, and where its surface shows."""

from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Indices


class Surface(NamedTuple):
    """Which points show where the rod's surface is (see ``measurements``)."""

    ring: Indices  # [layer, c], points around the circumference of each layer, from the foot up; -1: none
    start: Array  # [c], how far from the axis such a point starts, mm
    radius: float  # of the rod at the start, mm
    rear_face: Indices  # [column, 2], points of the last two layers
    impact_face: Indices  # [column, 2], of the first two
    end_overhang: float  # of the distance of these two, by which the rod ends beyond its last points
    contact_height: float  # mm; what is no higher than this above the lowest point of the surface is on the wall


def layered_surface(
    index: Indices, rim: Any, start: Array, radius: float, *, end_overhang: float, contact_height: float
) -> Surface:
    """Return the surface of a rod whose equal layers are the rows of ``index``, and ``rim`` the columns that show."""
    rear, impact = np.column_stack([index[-1], index[-2]]), np.column_stack([index[0], index[1]])
    return Surface(index[:, rim], start, radius, rear, impact, end_overhang, contact_height)


EXACT = 1e-3  # of the radius: ``Surface.contact_height`` of surfaces that nodes or points stand on


def half_height(body: "Body") -> float:
    """Return how far the lowest material reaches below the lowest points [mm]."""
    lowest, next_lowest = body.surface.impact_face.T
    height = body.position[:, 2]
    return body.surface.end_overhang * float((height[next_lowest] - height[lowest]).mean())


class Body(NamedTuple):
    """Points, material points or the nodes of a mesh, and what each stands for.

    An axisymmetric body stands in the half plane y = 0, x >= 0: x is the distance from the axis, and a point's volume,
    and with it its mass, momentum and energy, are those of a whole ring around it.
    """

    position: Array  # [p, 3], mm
    volume: Array  # [p], mm^3
    surface: Surface
    # [e, 8], corners of the hexahedra in VTK's order, or [e, 4], of the quadrilaterals of a section; none for MPM
    cells: Indices = np.empty((0, 8), np.int64)


def reordered(body: Body, order: Indices) -> Body:
    """Return a body of points whose row n is row ``order[n]`` of this one."""
    place = np.empty(len(order) + 1, np.int64)
    place[order] = np.arange(len(order))
    place[-1] = -1  # none stays none
    surface = body.surface
    faces = {"rear_face": place[surface.rear_face], "impact_face": place[surface.impact_face]}
    moved = surface._replace(ring=place[surface.ring], **faces)
    return Body(body.position[order], body.volume[order], moved)


def in_half_plane(body: Body) -> bool:
    """Return whether a body is the half section of an axisymmetric one."""
    return not body.position[:, 1].any()


def spacing(body: Body) -> float:
    """Return how far apart the body's points are at the start, the usual one of them [mm]."""
    if not in_half_plane(body):
        return float(np.cbrt(np.median(body.volume)))
    inside = (body.position[:, 0] > 0.0) & (body.volume > 0.0)
    area = body.volume[inside] / (2.0 * np.pi * body.position[inside, 0])
    return float(np.sqrt(np.median(area)))
