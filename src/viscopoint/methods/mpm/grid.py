"""The background grid: nodes of cubic cells, allocated only around the body, and the points sorted into slabs.

Slabs (see ``slabs``) and cells are counted from the grid's fixed origin: where memory begins changes no result.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import PARTS, kernel, serial_kernel
from viscopoint.kernels.slabs import CHUNKS, chunk
from viscopoint.kernels.vectors import fetch, put, zeros4
from viscopoint.methods.mpm.geometry import GEOMETRIES, Box
from viscopoint.methods.mpm.points import Points
from viscopoint.model import memory

FIELDS = 3  # of a node beside the spare ones
PAGE, APART = 128, 43  # rows of nodes in a page of memory, and from one field to the next, less whole pages
NEGLIGIBLE = 64e6  # bytes for which nobody need ask


class Grid(NamedTuple):
    """Nodes of a window of the lattice, and the order in which kernels visit the points.

    A node is one row: x, y, z and a fourth column (mass, or unused) that makes it a whole vector register.
    """

    x0: float  # the lattice's first node, mm
    y0: float
    z0: float
    cell: float  # h, mm
    per_cell: float  # 1/h, 1/mm
    i0: int  # lattice index of the window's first node along x
    j0: int
    k0: int
    nx: np.uint64  # nodes of the window along x
    ny: np.uint64
    nz: np.uint64
    shift: np.uint64  # (k0 ny + j0) nx + i0: takes a row counted from the lattice's first node into the window
    momentum: Array  # [n, 4], (mv)_i and m_i
    velocity: Array  # [n, 4], v_i
    force: Array  # [n, 4], f_i, until the nodes are accelerated
    dv: Array  # [n, 4], f_i Δt / m_i, with what constraints add, in the memory of ``force``
    spare: Array  # [k, n, 4], for those choices that sum something else over nodes or cells
    layers: int  # of cells in a slab; their points act on twice as many layers of nodes at most
    order: NDArray[np.uint64]  # [p], points sorted by slab, those outside the box last
    start: Indices  # [slabs + 2], where each slab, then what is outside, begins; and the end
    critical: Array  # [slabs], least stable step of each, ms
    slab: NDArray[np.int32]  # [p], of each point
    share: Indices  # [CHUNKS, slabs + 1], points of each chunk in each slab, then where in ``order`` they go
    least: Array  # [CHUNKS, 3], least coordinates of each chunk's points, mm
    most: Array  # [CHUNKS, 3]

    geometry = GEOMETRIES["3d"]


class HalfPlane(Grid):
    """The same around an axisymmetric body, where every node is a ring; a plane of nodes is the axis."""

    geometry = GEOMETRIES["axisymmetric"]


GRIDS: dict[str, type[Grid]] = {"3d": Grid, "axisymmetric": HalfPlane}


def lattice(box: Box, cell: float, points: int, overhang: int, kind: type[Grid] = Grid, spares: int = 0) -> Grid:
    """Return a grid, as yet without nodes, with ``spares`` spare arrays of them.

    Points act on nodes up to ``overhang`` cells before and behind their own cell.
    """
    extends = kind.geometry.extends
    x0, y0, z0 = (low - overhang * there * cell for low, there in zip(box.low, extends, strict=True))
    layers = 1 + 2 * overhang
    slabs = -(-int(np.ceil((box.high[2] - z0) / cell - 1e-9)) // layers)
    nodes = np.zeros((0, 4))
    zero = np.uint64(0)
    return kind(
        x0, y0, z0, cell, 1.0 / cell, 0, 0, 0, zero, zero, zero, zero, nodes, nodes, nodes, nodes,
        spare=np.zeros((spares, 0, 4)), layers=layers,
        order=np.zeros(points, np.uint64), start=np.zeros(slabs + 2, np.int64), critical=np.full(slabs, np.inf),
        slab=np.zeros(points, np.int32), share=np.zeros((CHUNKS, slabs + 1), np.int64),
        least=np.zeros((CHUNKS, 3)), most=np.zeros((CHUNKS, 3)),
    )  # fmt: skip


def fitted_to_points(grid: Grid, points: Points, box: Box) -> Grid:
    """Sort the points into slabs; return the grid with a window that holds all nodes they act on."""
    find_slabs(points.position, grid, box.low, box.high)
    find_places(grid)
    sort_by_slab(grid)
    return _windowed(grid, grid.least.min(axis=0), grid.most.max(axis=0))


def _windowed(grid: Grid, least: Array, most: Array) -> Grid:
    """Return the grid, with a new window if points from ``least`` to ``most`` [mm] are not inside the present one."""
    if not np.all(least <= most):  # no point is left in the box
        return grid
    origin = np.array([grid.x0, grid.y0, grid.z0])
    low, high = (((place - origin) * grid.per_cell).astype(np.int64) for place in (least, most))
    # cells: the support of a point beyond its own cell, and room to move before the next new window
    margin = 2 * np.array(grid.geometry.extends)
    first = np.array([grid.i0, grid.j0, grid.k0])
    size = np.array([grid.nx, grid.ny, grid.nz], np.int64)
    if np.all(size > 0) and np.all((first == 0) | (low - 1 >= first)) and np.all(high + margin < first + size):
        return grid
    first = np.maximum(low - 2 * margin, 0)
    nx, ny, nz = (int(n) for n in high + 2 * margin + 1 - first)
    _check_memory(nx * ny * nz * (FIELDS + len(grid.spare)) * 4 * 8.0, least, most)
    count = nx * ny * nz
    # where fields begin at the same place of a page, the processor takes a node's row in one for that in another
    nodes = np.zeros((FIELDS + len(grid.spare), count + (APART - count) % PAGE, 4))[:, :count]
    i0, j0, k0 = (int(index) for index in first)
    shift = (k0 * ny + j0) * nx + i0
    return grid._replace(
        i0=i0, j0=j0, k0=k0,
        nx=np.uint64(nx), ny=np.uint64(ny), nz=np.uint64(nz), shift=np.uint64(shift),
        momentum=nodes[0], velocity=nodes[1], force=nodes[2], dv=nodes[2], spare=nodes[FIELDS:],
    )  # fmt: skip


def _check_memory(size: float, least: Array, most: Array) -> None:
    """Raise ``MemoryError`` if a grid [bytes] does not fit; the system would grant it, and end the process later."""
    if size > NEGLIGIBLE and size > (there := memory.free()):
        places = " to ".join("({:.3g}, {:.3g}, {:.3g}) mm".format(*place) for place in (least, most))
        raise MemoryError(
            f"the grid around points from {places} takes {size / 2**30:.3g} GiB; there are {there / 2**30:.3g}"
        )


@kernel(CHUNKS)
def find_slabs(part: int, position: Array, grid: Grid, low: tuple[float, ...], high: tuple[float, ...]) -> None:
    """Find each point's slab, how many points each chunk has in each slab, and between which coordinates they are."""
    slab, share, least, most = grid.slab, grid.share, grid.least, grid.most
    total, layers = len(position), grid.layers
    outside = share.shape[1] - 1
    x0 = y0 = z0 = np.inf
    x1 = y1 = z1 = -np.inf
    for s in range(outside + 1):
        share[part, s] = 0
    present, run = outside, 0  # neighbours in the list mostly share a slab: counted in a register
    for p in chunk(part, CHUNKS, total):
        x, y, z = position[p, 0], position[p, 1], position[p, 2]
        mine = outside
        inside = low[0] <= x < high[0] and low[1] <= y < high[1] and low[2] <= z < high[2]
        if inside:  # never true for a position that is not a number
            x0, x1 = min(x0, x), max(x1, x)
            y0, y1 = min(y0, y), max(y1, y)
            z0, z1 = min(z0, z), max(z1, z)
            layer = int((z - grid.z0) * grid.per_cell)
            mine = layer if layers == 1 else layer // layers
        slab[p] = mine
        if mine != present:
            share[part, present] += run
            present, run = mine, 0
        run += 1
    share[part, present] += run
    least[part, 0], least[part, 1], least[part, 2] = x0, y0, z0
    most[part, 0], most[part, 1], most[part, 2] = x1, y1, z1


@serial_kernel
def find_places(grid: Grid) -> None:
    """Find where each slab begins in the order, and where in it each chunk's points go."""
    start, share = grid.start, grid.share
    place = 0
    for slab in range(share.shape[1]):
        start[slab] = place
        for part in range(CHUNKS):
            points = share[part, slab]
            share[part, slab] = place
            place += points
    start[-1] = place


@kernel(CHUNKS)
def sort_by_slab(part: int, grid: Grid) -> None:
    """List the points by slab."""
    slab, place, order = grid.slab, grid.share, grid.order
    total = len(slab)
    first, last = part * total // CHUNKS, (part + 1) * total // CHUNKS
    if first == last:
        return
    present = slab[first]
    next_place = place[part, present]
    for p in range(first, last):
        if slab[p] != present:
            place[part, present] = next_place
            present = slab[p]
            next_place = place[part, present]
        order[next_place] = p
        next_place += 1


@kernel()
def zero(part: int, field: Array) -> None:
    """Set a field of the nodes to zero."""
    for n in chunk(part, PARTS, len(field)):
        put(field, n, zeros4())


def accelerate(grid: Grid, dt: float) -> None:
    """Solve the momentum equation: v_i = ((mv)_i + f_i Δt) / m_i, and Δv_i = f_i Δt / m_i."""
    grid.geometry.mirror(grid, grid.momentum, grid.force)
    divide_with_force(grid, dt)


def average(grid: Grid) -> None:
    """Find the nodes' velocity from their momentum, v_i = (mv)_i / m_i."""
    grid.geometry.mirror(grid, grid.momentum)
    divide(grid)


@kernel()
def divide_with_force(part: int, grid: Grid, dt: float) -> None:
    """Find the nodes' velocity from momentum and force; ``dv`` replaces the force."""
    momentum, velocity = grid.momentum, grid.velocity
    for n in chunk(part, PARTS, len(momentum)):
        m = momentum[n, 3]
        per_mass = 1.0 / m if m > 0.0 else 0.0
        dv = (per_mass * dt) * fetch(grid.force, n)
        put(grid.dv, n, dv)
        put(velocity, n, per_mass * fetch(momentum, n) + dv)


@kernel()
def divide(part: int, grid: Grid) -> None:
    """Divide the nodes' momentum by their mass."""
    momentum, velocity = grid.momentum, grid.velocity
    for n in chunk(part, PARTS, len(momentum)):
        m = momentum[n, 3]
        put(velocity, n, (1.0 / m if m > 0.0 else 0.0) * fetch(momentum, n))
