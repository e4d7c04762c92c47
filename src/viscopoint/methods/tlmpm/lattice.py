"""The background grid of the undeformed body: bricks whose nodes are where they are for good.

A plane of nodes is the body's foot. Points are sorted once by cell, and so into slabs.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.errors import InputError
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import implements, inline, serial_kernel
from viscopoint.kernels.workspace import BLOCK
from viscopoint.methods.mpm.geometry import GEOMETRIES
from viscopoint.methods.mpm.stencil import in_half_plane, in_space, stencil_around
from viscopoint.methods.tlmpm.points import Points

MARGIN = 3  # nodes beyond the outermost points: what shape functions reach, and what only extends the body


class Lattice(NamedTuple):
    """Nodes of a block of cells around the undeformed body, and the order in which kernels visit the points."""

    x0: float  # of a node, mm
    y0: float
    z0: float
    per_x: float  # 1/h along each axis, 1/mm
    per_y: float
    per_z: float
    i0: float  # index of that node along each axis
    j0: float
    k0: float
    nx: np.uint64  # nodes along x
    ny: np.uint64
    velocity: Array  # [n, 4], of the nodes, mm/ms, the fourth column unused
    force: Array  # [n, 4], of the points, N, the fourth column unused
    order: NDArray[np.uint64]  # [p], points sorted by cell
    cells: Indices  # [cells + 1], where each cell that has points begins in ``order``
    start: Indices  # [slabs + 1], where each slab begins in ``cells``

    geometry = GEOMETRIES["3d"]


class HalfLattice(Lattice):
    """The same around an axisymmetric body, where every node is a ring and x = 0 the axis."""

    geometry = GEOMETRIES["axisymmetric"]


LATTICES: dict[str, type[Lattice]] = {"3d": Lattice, "axisymmetric": HalfLattice}
implements(stencil_around, Lattice)(in_space)
implements(stencil_around, HalfLattice)(in_half_plane)


def lattice_around(
    reference: Array,
    cell: tuple[float, float, float],
    origin: tuple[float, float, float],
    kind: type[Lattice] = Lattice,
    overhang: int = 0,
) -> Lattice:
    """Return the grid of bricks ``cell`` [mm] with a node at ``origin`` that holds all points.

    Points act on nodes up to ``overhang`` cells before and behind their own cell.

    Raises:
        InputError: more points than a block share a cell.
    """
    margin, per_cell = MARGIN * np.array(kind.geometry.extends), 1.0 / np.array(cell)
    place = (reference - origin) * per_cell
    first = margin - np.floor(place.min(axis=0))
    nx, ny, nz = (np.floor(place.max(axis=0)) + first + 1 + margin).astype(int)
    row = (place + first).astype(np.int64) @ [1, nx, nx * ny]
    order = np.argsort(row, kind="stable")
    rows, points = np.unique(row, return_counts=True)
    if points.max() > BLOCK:
        raise InputError(f"method.cell: {points.max()} points share a cell, at most {BLOCK} may; take a smaller one")
    slab = rows // (nx * ny * (1 + 2 * overhang))
    scalars: list[float] = [float(value) for value in (*origin, *per_cell, *first)]
    return kind(
        *scalars,
        nx=np.uint64(nx),
        ny=np.uint64(ny),
        velocity=np.zeros((nx * ny * nz, 4)),
        force=np.zeros((nx * ny * nz, 4)),
        order=order.astype(np.uint64),
        cells=np.concatenate([[0], np.cumsum(points)]).astype(np.int64),
        start=np.concatenate([[0], np.cumsum(np.bincount(slab))]).astype(np.int64),
    )


def cell_by_cell(reference: Array, cell: tuple[float, float, float]) -> Indices:
    """Return the order of points by cell, along x, then y, then z: what kernels visit together stands together."""
    return np.lexsort(np.floor(reference / np.array(cell)).T)


@inline
def place(points: Points, p: int, lattice: Lattice) -> tuple[float, float, float]:
    """Return the coordinates of point p in cells from the grid's first node."""
    reference = points.reference
    return (
        (reference[p, 0] - lattice.x0) * lattice.per_x + lattice.i0,
        (reference[p, 1] - lattice.y0) * lattice.per_y + lattice.j0,
        (reference[p, 2] - lattice.z0) * lattice.per_z + lattice.k0,
    )


@inline
def stencil_at(points: Points, p: int, lattice: Lattice, shape: Any) -> Any:
    """Return the nodes on which point p acts."""
    radius = points.reference[p, 0] * lattice.per_x
    return stencil_around(lattice, np.uint64(0), (shape, shape, shape), place(points, p, lattice), radius)


@inline
def cells_in_block(lattice: Lattice, first: int, end: int) -> int:
    """Return the cell after the last that fits into a block together with the cells from ``first``."""
    last = first + 1
    while last < end and lattice.cells[last + 1] - lattice.cells[first] <= BLOCK:
        last += 1
    return last


@inline
def cell_row(points: Points, p: int, lattice: Lattice) -> np.uint64:
    """Return the row of the cell that holds point p: that of its first node."""
    x, y, z = place(points, p, lattice)
    return (np.uint64(z) * lattice.ny + np.uint64(y)) * lattice.nx + np.uint64(x)


@serial_kernel
def sum_volumes(points: Points, lattice: Lattice, shape: Any, weight: Array, filled: Array, active: Array) -> None:
    """Sum each node's Σ N V_p and each cell's Σ V_p [mm^3]; mark the nodes that any point knows."""
    for p in range(len(points.volume)):
        at = stencil_at(points, p, lattice, shape)
        filled[cell_row(points, p, lattice)] += points.volume[p]
        for c in range(len(at.wz)):
            for b in range(len(at.wy)):
                for a in range(len(at.wx)):
                    node = at.first + (np.uint64(c) * lattice.ny + np.uint64(b)) * lattice.nx + np.uint64(a)
                    weight[node] += at.wx[a] * at.wy[b] * at.wz[c] * points.volume[p]
                    active[node] = 1.0
