"""What shows of a body in the 3-D view: the outer faces of finite elements, cubes around material points."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from viscopoint.figures.revolve import AROUND, edges_off_axis, surface_points, swept, turns
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.methods.fem.mesh import outer_faces
from viscopoint.model.body import Body, in_half_plane, spacing
from viscopoint.model.method import Field
from viscopoint.results.reader import Snapshot


class Skin(NamedTuple):
    """Which points of a body show, and how."""

    points: Indices  # [n], their numbers in the body; several times where an axisymmetric body is turned
    angle: Array  # [n], by which each is turned around the z axis
    faces: tuple[Indices, ...]  # sets of quadrilaterals [f, 4], counted in ``points`` from outside; none: cubes
    faces_at: tuple[int, ...]  # [snapshot], which of the sets shows
    edge: float  # of a cube, mm; 0: none


def skin_of_elements(body: Body, snapshots: Sequence[Snapshot]) -> Skin:
    """Return the outer faces of the elements that live; where some are deleted, others come to light."""
    sets, faces_at = _outermost(body, snapshots, outer_faces)
    points = np.unique(np.concatenate([faces.ravel() for faces in sets]))
    counted = tuple(np.searchsorted(points, faces) for faces in sets)
    return Skin(points, np.zeros(len(points)), counted, faces_at, 0.0)


def skin_of_rings(body: Body, snapshots: Sequence[Snapshot], coarser: int = 1) -> Skin:
    """Return what the elements of a half section show as they turn around the axis, in ``coarser`` turns."""
    sets, faces_at = _outermost(body, snapshots, lambda cells: edges_off_axis(body, cells))
    nodes = np.unique(np.concatenate([edges.ravel() for edges in sets]))
    around = AROUND // coarser
    points, angle = turns(nodes, around)
    faces = tuple(swept(np.searchsorted(nodes, edges), len(nodes), around) for edges in sets)
    return Skin(points, angle, faces, faces_at, 0.0)


def _outermost(
    body: Body, snapshots: Sequence[Snapshot], outer: Callable[[Indices], Indices]
) -> tuple[list[Indices], tuple[int, ...]]:
    """Return what is outermost of the elements that live, each set once, and which of the sets a snapshot has."""
    found: dict[bytes, tuple[int, Indices]] = {}
    faces_at = []
    for snapshot in snapshots:
        alive = snapshot["deleted"] == 0
        if alive.tobytes() not in found:
            found[alive.tobytes()] = len(found), outer(body.cells[alive])
        faces_at.append(found[alive.tobytes()][0])
    return [outermost for _, outermost in found.values()], tuple(faces_at)


def skin_of_points(body: Body, coarser: int = 1) -> Skin:
    """Return the points of the rod's surface; of those in each block of ``coarser``³ spacings only the first."""
    if in_half_plane(body):
        turning = surface_points(body, coarser)
        return Skin(turning.points, turning.angle, (), (), coarser * spacing(body))
    surface = body.surface
    every = np.concatenate([surface.ring.ravel(), surface.rear_face[:, 0], surface.impact_face[:, 0]])
    points = np.unique(every[every >= 0])
    edge = coarser * spacing(body)
    if coarser > 1:
        block = np.floor(body.position[points] / edge + 1e-6)
        points = points[np.sort(np.unique(block, axis=0, return_index=True)[1])]
    return Skin(points, np.zeros(len(points)), (), (), edge)


def at_points(field: Field, snapshot: Snapshot, body: Body) -> Array:
    """Return a field at the body's points; one on elements as the mean of those that live around each node."""
    if field.on == "points":
        return field.values
    alive = snapshot["deleted"] == 0
    corners, count = body.cells[alive], len(body.position)
    sums = np.bincount(corners.ravel(), np.repeat(field.values[alive], corners.shape[1]), minlength=count)
    around = np.bincount(corners.ravel(), minlength=count)
    return np.divide(sums, around, out=np.full(count, np.nan), where=around > 0)
