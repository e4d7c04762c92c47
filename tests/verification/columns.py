"""A slender column on rollers: three-dimensional code, one-dimensional physics. And a short rod.

Bulk viscosity is off: it would smear the fronts and damp the waves that are compared with exact solutions without it.
With two points per cell and axis and strains near zero the scheme is linear, and what it does to waves is known. Nodes
see points through N and points see nodes through N again: a wave's acceleration is filtered by
F = 1 - 3/8 (1 - cos kh). So leapfrog steps of Courant number C give

    sin^2(w dt / 2) = C^2 sin^2(kh / 2) F(kh)    =>    w = c k (1 - DISPERSION (kh)^2 + ...).
"""

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

from viscopoint.interactions.planes import Interaction, rigid_wall, symmetry_plane
from viscopoint.kernels.arrays import PRECISIONS, Real
from viscopoint.materials.elastic import Elastic
from viscopoint.materials.linear_viscoelastic import LinearViscoelastic
from viscopoint.methods.mpm.contacts import CONTACTS
from viscopoint.methods.mpm.fills.lattice import rod_lattice
from viscopoint.methods.mpm.geometry import Box
from viscopoint.methods.mpm.grid import Grid, zero
from viscopoint.methods.mpm.mapping import scatter_momentum_and_force
from viscopoint.methods.mpm.method import Discretisation, MaterialPointMethod
from viscopoint.methods.mpm.schemes import SCHEMES
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.mpm.transfers import Transfer
from viscopoint.methods.mpm.transfers.flip import Flip
from viscopoint.methods.mpm.volumes import VOLUMES
from viscopoint.model.body import Body, Surface
from viscopoint.model.method import Method
from viscopoint.model.viscosity import BulkViscosity

Array = NDArray[np.float64]
DENSITY, BULK, SHEAR_SHORT, SHEAR_LONG, LENGTH = 1e-3, 550.0, 140.0, 5.0, 25.4  # g/mm^3, MPa, mm
MODULI = (DENSITY, BULK, SHEAR_SHORT, SHEAR_LONG)  # as ``laplace`` takes them
ACROSS = 2  # cells along x and y
CELL, HEIGHT, BOX = 1.0, 6.0, Box((-6.0, -6.0, 0.0), (6.0, 6.0, 20.0))  # mm, of the rod
COURANT = 0.5
DISPERSION = 1 / 24 + 3 / 32 - COURANT**2 / 24


@pytest.fixture
def one_thread() -> None:
    """Few points: threads would only wait for each other. They change no bit (test_conservation)."""
    numba.set_num_threads(1)


def viscoelastic(decay: float) -> LinearViscoelastic:
    return LinearViscoelastic(DENSITY, BULK, SHEAR_LONG, SHEAR_SHORT - SHEAR_LONG, decay)


ELASTIC = Elastic(DENSITY, BULK, SHEAR_SHORT)
each_precision = pytest.mark.parametrize("real", PRECISIONS.values(), ids=PRECISIONS.keys())


def block(cell: float, x: int, y: int, z: int, per_cell: int = 2) -> Body:
    """Fill x * y * z cells from the origin with a uniform lattice of points."""
    step = cell / per_cell
    places: list[Array] = [np.linspace(0.5, n * per_cell - 0.5, n * per_cell) * step for n in (z, y, x)]
    mesh = np.meshgrid(*places, indexing="ij")
    position: Array = np.column_stack([axis.ravel() for axis in mesh[::-1]])
    index = np.arange(len(position)).reshape(z * per_cell, -1)
    ends = [np.column_stack([index[a], index[b]]) for a, b in ((-1, -2), (0, 1))]
    surface = Surface(index, np.ones(index.shape[1]), 1.0, ends[0], ends[1], 0.5, 0.0)
    return Body(position, np.full(len(position), step**3), surface)


def column(
    cells: int,
    law: Any = ELASTIC,
    ends: tuple[Interaction, ...] = (rigid_wall(0.0, 0.0),),
    velocity: Callable[[Array], Array] = np.zeros_like,
    scheme: str = "musl",
    pic: float = 0.0,
    transfer: Transfer | None = None,
    safety: float = COURANT,
    viscosity: tuple[float, float] = (0.0, 0.0),
    shape: str = "trilinear",
    volume: str = "local",
    contact: str = "nodes",
) -> MaterialPointMethod:
    """Return a column with its foot on the plane z = 0, where ``velocity(z)`` is along z [mm/ms]."""
    cell = LENGTH / cells
    body = block(cell, ACROSS, ACROSS, cells)
    side = ACROSS * cell
    rollers = [symmetry_plane(axis, place) for axis in (0, 1) for place in (0.0, side)]
    choices = Discretisation(
        cell=cell,
        box=Box((0.0, 0.0, -4 * cell), (side, side, 2 * LENGTH)),
        shape=SHAPES[shape].fitted(0.5),
        scheme=SCHEMES[scheme],
        transfer=Flip(pic) if transfer is None else transfer,
        time_step_factor=safety,
        viscosity=BulkViscosity(*viscosity),
        volume=VOLUMES[volume],
        contact=CONTACTS[contact],
    )
    start = np.zeros((len(body.position), 3))
    start[:, 2] = velocity(body.position[:, 2])
    return MaterialPointMethod(body, law, (*ends, *rollers), choices, start)


def rod(
    law: Any = None,
    velocity: Any = (0.0, 0.0, -100.0),
    walls: tuple[Interaction, ...] = (),
    *,
    lift: float = 0.0,
    cell: float = CELL,
    box: Box = BOX,
    scheme: str = "musl",
    pic: float = 0.0,
    transfer: Transfer | None = None,
    safety: float = 0.4,
    viscosity: tuple[float, float] = (0.06, 1.5),
    body: Body | None = None,
    shape: str = "trilinear",
    volume: str = "local",
    contact: str = "nodes",
    real: Real = np.float64,
) -> MaterialPointMethod:
    """Return a viscoelastic rod of 2 mm radius, or another law or body, ``lift`` above the plane z = 0."""
    body = body or rod_lattice(2.0, HEIGHT, cell / 2)
    body = body._replace(position=body.position + [0.0, 0.0, lift])
    fitted, damping = SHAPES[shape].fitted(0.5), BulkViscosity(*viscosity)
    exchange = Flip(pic) if transfer is None else transfer  # some transfers are empty tuples, and so false
    rest = SCHEMES[scheme], exchange, safety, damping, VOLUMES[volume], CONTACTS[contact]
    choices = Discretisation(cell, box, fitted, *rest, real=real)
    return MaterialPointMethod(body, law or viscoelastic(65.0), walls, choices, velocity)


def fresh_grid(method: MaterialPointMethod) -> Grid:
    """Return the grid without mass, momentum and force."""
    zero(method.grid.momentum)
    zero(method.grid.force)
    return method.grid


def scattered(method: MaterialPointMethod) -> Grid:
    """Return the grid with the points' mass, momentum and force, which is its ``force``."""
    grid = fresh_grid(method)
    averaged = method.volume.of_pressure(method.points, grid)
    scatter_momentum_and_force(method.points, grid, method.shape, averaged, method.transfer)
    return grid


def area(method: MaterialPointMethod) -> float:
    """Return the column's cross-section [mm^2]."""
    return (ACROSS * method.grid.cell) ** 2


def advance(method: Method, time: float) -> float:
    """Advance by ``time`` in equal steps no longer than the stable one; return their length."""
    steps = int(np.ceil(time / method.stable_step() * (1 - 1e-9)))
    for _ in range(steps):
        method.advance(time / steps)
    return time / steps


def order(errors: list[float]) -> float:
    """Return the mean order over errors of meshes refined by two each time."""
    return float(np.log2(errors[0] / errors[-1])) / (len(errors) - 1)


def layers(values: Array) -> Array:
    """Average values of points over each layer, from the foot up."""
    return values.reshape(-1, (2 * ACROSS) ** 2).mean(axis=1)
