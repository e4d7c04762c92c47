"""Planes act on the nodes of the grid where they stand, and beyond it.

A plane that is normal to an axis stands on the closest plane of nodes, and splines know it (``shapes.splines``).
Any other, or one that moves, acts on the nodes behind it: its place is then known to a cell.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from viscopoint.interactions import rows as of_rows
from viscopoint.interactions.planes import Interaction, Plane, Triple
from viscopoint.interactions.rows import REACTIONS, Rows, add_row, add_slot, empty_rows, load_slot, solve, with_room
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import generic, implements, serial_kernel
from viscopoint.kernels.vectors import Vec, dot, read_vector, write_vector
from viscopoint.methods.mpm.contacts import Contact, closed
from viscopoint.methods.mpm.contacts.nodes import Nodes
from viscopoint.methods.mpm.geometry import ON_AXIS
from viscopoint.methods.mpm.grid import Grid, HalfPlane
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.shapes import NOWHERE, Planes

ALIGNED = 1e-12  # 1 - |n_a|, up to which a plane is normal to axis a
CLOSE = 1e-6  # cells; nodes no farther in front of a plane stand on it


class PlanesOnGrid:
    """The planes that act on a body through the nodes of its grid."""

    def __init__(self, interactions: Sequence[Interaction], grid: Grid, middle: Array, contact: type[Contact]) -> None:
        """Take the planes, each with the body's ``middle`` in front; ``contact`` says where walls act."""
        self.interactions = tuple(interactions)
        self.reactions = np.zeros((len(self.interactions), REACTIONS))
        self.elapsed = np.zeros(1)  # since the start, ms
        self._planes = [_on_grid(each.plane, grid, middle) for each in self.interactions]
        self._contact, self._strain_rows = contact, empty_rows(0)
        self._slot_of = np.full(0, -1)

    def wall_planes(self, grid: Grid) -> tuple[Planes, Planes, Planes]:
        """Return the planes of nodes between which the body is, along each axis."""
        planes = [[NOWHERE, NOWHERE] for _ in range(3)]
        for plane in self._planes:
            axis = _axis(plane)
            if axis is not None and plane.speed == 0.0:
                planes[axis][int(plane.normal[axis] < 0.0)] = _node(plane, axis, grid)
        (x0, x1), (y0, y1), (z0, z1) = planes
        return (x0, x1), (y0, y1), (z0, z1)

    def add_rows(self, rows: Rows, body: int, first: int, grid: Grid, points: Points, shape: Any, half: float) -> Rows:
        """Add the rows of all planes; ``half`` is half the height of a point's material at the start [mm]."""
        if len(self._slot_of) != len(grid.momentum):
            self._slot_of = np.full(len(grid.momentum), -1)
        for number, start in enumerate(self._planes):
            gone = start.speed * float(self.elapsed[0])
            plane = start._replace(point=_triple(np.array(start.point) + gone * np.array(start.normal)))
            contact = Nodes() if plane.two_sided else self._contact.at(plane, points, grid, shape, half)
            low, high = _window(plane, grid)
            rows = with_room(rows, int(np.prod(high - low)))
            several = len(self._planes) > 1
            add_contact_rows(contact, plane, grid, low, high, self._slot_of, rows, body, first + number, several)
        return rows

    def correct_velocity(self, grid: Grid, rows: Rows, body: int) -> None:
        """Let the nodes have the velocity that the rows leave."""
        if rows.size[1]:
            correct_velocity(grid, rows, body, self._slot_of)

    def constrain_velocity(self, grid: Grid, points: Points, shape: Any, half: float) -> None:
        """Apply the constraints to velocities that only strain is taken from, so that no reaction counts."""
        self._strain_rows.size[:] = 0
        rows = self._strain_rows = self.add_rows(self._strain_rows, 0, 0, grid, points, shape, half)
        if rows.size[0]:
            solve(rows, 0, rows.size[0], np.zeros_like(self.reactions))
            self.correct_velocity(grid, rows, 0)


def _triple(vector: Array) -> Triple:
    x, y, z = vector.tolist()
    return x, y, z


def _axis(plane: Plane) -> int | None:
    """Return the axis to which a plane is normal, if to any."""
    along = np.abs(np.array(plane.normal))
    axis = int(along.argmax())
    return axis if 1.0 - along[axis] < ALIGNED else None


def _node(plane: Plane, axis: int, grid: Grid) -> int:
    """Return the plane of nodes closest to a plane, counted from the lattice's first."""
    return round((plane.point[axis] - (grid.x0, grid.y0, grid.z0)[axis]) * grid.per_cell)


def _on_grid(plane: Plane, grid: Grid, middle: Array) -> Plane:
    """Return a plane of which the body is in front, on a plane of nodes if it is normal to an axis and stands still."""
    point, normal = np.array(plane.point), np.array(plane.normal)
    if plane.two_sided and (middle - point) @ normal < 0.0:
        plane, normal = plane._replace(normal=_triple(-normal), speed=-plane.speed), -normal
    axis = _axis(plane)
    if axis is None or plane.speed != 0.0:
        return plane
    point[axis] = (grid.x0, grid.y0, grid.z0)[axis] + _node(plane, axis, grid) * grid.cell
    return plane._replace(point=_triple(point))


def _window(plane: Plane, grid: Grid) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first nodes of the window, and those after the last, that a plane may act on along each axis."""
    low, high = np.zeros(3, np.int64), np.array([grid.nx, grid.ny, grid.nz], np.int64)
    axis = _axis(plane)
    if axis is not None:
        place = (plane.point[axis] - (grid.x0, grid.y0, grid.z0)[axis]) * grid.per_cell
        first = (grid.i0, grid.j0, grid.k0)[axis]
        if plane.normal[axis] > 0.0:
            high[axis] = min(max(int(np.floor(place + CLOSE)) - first + 1, 0), high[axis])
        else:
            low[axis] = min(max(int(np.ceil(place - CLOSE)) - first, 0), high[axis])
    return low, high


@generic
def inverse_mass(grid: Any, i: int, inverse: float) -> Vec:
    """Return the inverse mass along each axis of a node, the i-th along x of the window; 0: it cannot move along it."""
    raise NotImplementedError


@implements(inverse_mass, Grid)
def in_space(grid: Grid, i: int, inverse: float) -> Vec:
    return Vec(inverse, inverse, inverse)


@implements(inverse_mass, HalfPlane)
def in_half_plane(grid: HalfPlane, i: int, inverse: float) -> Vec:
    x = (grid.x0 * grid.per_cell) + (grid.i0 + i)
    return Vec(0.0 if abs(x) < ON_AXIS else inverse, 0.0, inverse)


@serial_kernel
def add_contact_rows(
    contact: Any, plane: Plane, grid: Grid, low: NDArray[np.int64], high: NDArray[np.int64], slot_of: Indices,
    rows: Rows, body: int, owner: int, several: bool,
) -> None:  # fmt: skip
    """Add a row for each node on a plane or behind it, of ``low`` to ``high`` of the window, that the plane acts on."""
    normal, point = read_vector(plane.normal), read_vector(plane.point)
    x0 = Vec(grid.x0 + grid.i0 * grid.cell, grid.y0 + grid.j0 * grid.cell, grid.z0 + grid.k0 * grid.cell) - point
    for k in range(low[2], high[2]):
        for j in range(low[1], high[1]):
            for i in range(low[0], high[0]):
                n: Any = np.int64((np.uint64(k) * grid.ny + np.uint64(j)) * grid.nx + np.uint64(i))
                m = grid.momentum[n, 3]
                height = dot(x0 + grid.cell * Vec(float(i), float(j), float(k)), normal)
                if not (m > 0.0 and height <= CLOSE * grid.cell and closed(contact, n)):
                    continue
                velocity = read_vector(grid.velocity[n])
                if not (several or plane.two_sided or dot(velocity, normal) < plane.speed):
                    continue
                s: Any = slot_of[n]
                if s < 0:
                    s = slot_of[n] = add_slot(rows, body, n)
                    before = (1.0 / m) * read_vector(grid.momentum[n])
                    load_slot(rows, s, before, velocity, inverse_mass(grid, i, 1.0 / m))
                add_row(rows, s, owner, normal, point, plane.speed, plane.friction, plane.two_sided, -1.0)


@serial_kernel
def correct_velocity(grid: Grid, rows: Rows, body: int, slot_of: Indices) -> None:
    """Let the nodes have the velocity that their slots have; what that adds is part of Δv."""
    for s in range(rows.size[1]):
        if rows.node[s, 0] == body:
            n, motion = rows.node[s, 1], rows.motion[s]
            velocity = read_vector(motion, of_rows.VELOCITY)
            write_vector(grid.velocity[n], velocity)
            write_vector(grid.dv[n], read_vector(grid.dv[n]) + (velocity - read_vector(motion, of_rows.TRIAL)))
            slot_of[n] = -1


@serial_kernel
def deactivate_rows(rows: Rows, body: int) -> None:
    """Let rows that are solved once more not act on a body's nodes: its step is done."""
    for s in range(rows.size[1]):
        if rows.node[s, 0] == body:
            write_vector(rows.motion[s], Vec(0.0, 0.0, 0.0), of_rows.INVERSE)
