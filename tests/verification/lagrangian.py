"""Bodies of total Lagrangian points: blocks and columns on rollers, and a short rod.

Along a row of cells whose points see one gradient per cell, nodes are masses and cells springs, as in ``bricks``: steps
of Courant number C give w = c k (1 - DISPERSION (kh)^2 + ...) with DISPERSION = (1 - C^2) / 24. Bulk viscosity is off.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from columns import COURANT, LENGTH, Array, block, viscoelastic

from viscopoint.interactions.planes import Interaction, rigid_wall, symmetry_plane
from viscopoint.kernels.arrays import Real
from viscopoint.methods.mpm.fills import FILLS
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.tlmpm.filling import with_tracers
from viscopoint.methods.tlmpm.lattice import Lattice
from viscopoint.methods.tlmpm.method import Discretisation, TotalLagrangianMethod
from viscopoint.methods.tlmpm.volumes import VOLUMES
from viscopoint.model.body import Body
from viscopoint.model.viscosity import BulkViscosity

DISPERSION = (1 - COURANT**2) / 24
ELASTIC = viscoelastic(0.0)  # an arm that never relaxes: the same kernels serve all tests
Boundaries = tuple[Interaction, ...]
ON_WALL: Boundaries = (rigid_wall(0.0, 0.0),)
Motion = Callable[[Array], Array]
each_volume = pytest.mark.parametrize("volume", sorted(VOLUMES))


def lagrangian(
    body: Body,
    cell: tuple[float, float, float],
    law: Any = ELASTIC,
    boundaries: Boundaries = (),
    motion: Motion = np.zeros_like,
    *,
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    shape: str = "trilinear",
    volume: str = "cell-mean",
    safety: float = 0.9,
    viscosity: tuple[float, float] = (0.0, 0.0),
    lattice: type[Lattice] = Lattice,
    real: Real = np.float64,
) -> TotalLagrangianMethod:
    """Return a method on a body; ``motion`` is the velocity at a place [mm/ms]."""
    choices = Discretisation(
        cell, SHAPES[shape].fitted(0.5), VOLUMES[volume], safety, BulkViscosity(*viscosity), origin, lattice, real
    )
    method = TotalLagrangianMethod(body, law, boundaries, choices, (0.0, 0.0, 0.0))
    method.nodes.velocity[:] = motion(method.reference)
    return method


def brick(
    cells: tuple[int, int, int], law: Any = ELASTIC, boundaries: Boundaries = (), motion: Motion = np.zeros_like,
    *, cell: float = 1.0, lift: float = 0.0, **choices: Any,
) -> TotalLagrangianMethod:  # fmt: skip
    """Return a block of cubic cells from (0, 0, ``lift``) up."""
    body = block(cell, *cells)
    body = body._replace(position=body.position + [0.0, 0.0, lift])
    return lagrangian(body, (cell, cell, cell), law, boundaries, motion, origin=(0.0, 0.0, lift), **choices)


def column(
    cells: int, law: Any = ELASTIC, ends: Boundaries = ON_WALL, motion: Motion = np.zeros_like,
    volume: str = "cell-mean",
) -> TotalLagrangianMethod:  # fmt: skip
    """Return a row of cells along z between rollers, its foot on z = 0."""
    cell = LENGTH / cells
    rollers = [symmetry_plane(axis, place) for axis in (0, 1) for place in (0.0, cell)]
    method = brick((1, 1, cells), law, (*ends, *rollers), motion, cell=cell, volume=volume)
    method.time_step_factor = COURANT * cell / method.sound / float(method.critical[0])
    return method


def rod(
    law: Any = None, motion: Motion = np.zeros_like, walls: Boundaries = (), *, fill: str = "trimmed",
    spacing: float = 0.5, viscosity: tuple[float, float] = (0.06, 1.5), **choices: Any,
) -> TotalLagrangianMethod:  # fmt: skip
    """Return a rod of 2 mm radius and 6 mm length on z = 0."""
    body = with_tracers(FILLS[fill](2.0, 6.0, spacing), 6.0, spacing)
    cell = (2 * spacing, 2 * spacing, spacing)
    return lagrangian(body, cell, law or viscoelastic(65.0), walls, motion, viscosity=viscosity, **choices)


def flying(*velocity: float) -> Motion:
    """Return the same velocity everywhere."""
    return lambda position: np.broadcast_to(velocity, position.shape)


def upward(speed: Callable[[Array], Array]) -> Motion:
    """Return the velocity field of a speed along z that depends on z."""
    return lambda position: np.outer(speed(position[:, 2]), [0.0, 0.0, 1.0])


def levels(method: TotalLagrangianMethod, values: Array) -> Array:
    """Average values of nodes over each plane, from the foot up."""
    _, plane = np.unique(np.round(method.reference[:, 2], 9), return_inverse=True)
    return np.bincount(plane, values) / np.bincount(plane)


def survives(method: TotalLagrangianMethod, share: float) -> bool:
    """Return whether a body that trembles rings on at a share of the critical step, and does not blow up."""
    dt, start = share * method.stable_length / method.sound, method.totals().kinetic
    for _ in range(600):
        method.advance(dt)
    return bool(method.totals().kinetic < 4.0 * start)


def moved(method: TotalLagrangianMethod, velocity: Array, dt: float) -> Array:
    """Move the nodes for a step at a velocity, whatever the forces; return the forces that the points then exert."""
    method.nodes.velocity[:] = velocity
    method.nodes.position[:] += dt * velocity
    method.strain(dt)
    return method.nodes.force.copy()
