"""Two equal elastic discs that meet head-on (Sulsky, Chen & Schreyer 1994), in plane strain, without a contact law.

Sulsky's numbers, read in g, mm and ms: radius 0.2 mm, centres (0.2, 0.2) and (0.8, 0.8), velocities (0.1, 0.1) and
(-0.1, -0.1), density 1000 g/mm³, E = 1000 MPa, Poisson's ratio 0.3. Surfaces touch at ``TOUCH``. One layer of cells
between two planes of symmetry; the second disc is the first one's image in (1/2, 1/2), and so is the grid.
"""

from typing import Any, NamedTuple

import numpy as np
from columns import Array

from viscopoint.interactions.planes import symmetry_plane
from viscopoint.materials.elastic import Elastic
from viscopoint.methods.mpm.contacts.nodes import Nodes
from viscopoint.methods.mpm.fills import FILLS
from viscopoint.methods.mpm.geometry import Box
from viscopoint.methods.mpm.method import Discretisation, MaterialPointMethod
from viscopoint.methods.mpm.schemes import SCHEMES
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.mpm.transfers import Transfer
from viscopoint.methods.mpm.transfers.flip import Flip
from viscopoint.methods.mpm.volumes import VOLUMES
from viscopoint.model.body import Body
from viscopoint.model.viscosity import BulkViscosity

RADIUS, SPEED = 0.2, 0.1  # mm; mm/ms along each axis
YOUNG, POISSON, DENSITY = 1000.0, 0.3, 1000.0
LAW = Elastic(DENSITY, YOUNG / (3 * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON)))
CLOSING = 2 * np.sqrt(2) * SPEED
GAP = np.sqrt(2) * 0.6 - 2 * RADIUS
TOUCH = GAP / CLOSING  # 1.5858 ms
END = 3.6  # ms


def discs(
    cells: int = 20,
    shape: str = "trilinear",
    transfer: Transfer | None = None,
    volume: str = "local",
    fill: str = "lattice",
    safety: float = 0.2,
) -> MaterialPointMethod:
    """Return the discs on ``cells`` cells to the mm, two points to a cell along each axis."""
    cell = 1.0 / cells
    one = FILLS[fill](RADIUS, cell, cell / 2)
    first = one.position + [0.2, 0.2, 0.0]
    position = np.concatenate([first, [1.0, 1.0, 0.0] + first * [-1.0, -1.0, 1.0]])
    body = Body(position, np.tile(one.volume, 2), one.surface)
    exchange = Flip(0.0) if transfer is None else transfer
    choices = Discretisation(
        cell, Box((0.0, 0.0, 0.0), (1.0, 1.0, cell)), SHAPES[shape].fitted(0.5), SCHEMES["musl"], exchange, safety,
        BulkViscosity(0.0, 0.0), VOLUMES[volume], Nodes,
    )  # fmt: skip
    way = np.where(np.arange(len(position)) < len(first), SPEED, -SPEED)
    velocity: Array = np.outer(way, [1.0, 1.0, 0.0])
    return MaterialPointMethod(body, LAW, (symmetry_plane(2, 0.0), symmetry_plane(2, cell)), choices, velocity)


class Collision(NamedTuple):
    """Energies over their sum at the start, and when a point first moved at another velocity than at the start."""

    time: Array  # ms
    kinetic: Array
    stored: Array
    felt: float  # ms


def collide(method: MaterialPointMethod, end: float = END, felt: float = 1e-6) -> Collision:
    """Run to ``end``; a change of velocity counts from the share ``felt`` of the speed on."""
    start, began, rows, first = method.totals().kinetic, method.points.velocity.copy(), [(0.0, 1.0, 0.0)], np.inf
    now = 0.0
    while now < end * (1 - 1e-12):
        dt = min(method.stable_step(), end - now)
        method.advance(dt)
        now += dt
        sums = method.totals()
        rows.append((now, sums.kinetic / start, sums.stored / start))
        if not np.isfinite(first) and np.abs(method.points.velocity - began).max() > felt * SPEED:
            first = now
    time, kinetic, stored = np.array(rows).T
    return Collision(time, kinetic, stored, float(first))


def halves(values: Array) -> Any:
    """Return the rows of either disc."""
    return values.reshape(2, -1, *values.shape[1:])


def rebound(method: MaterialPointMethod) -> float:
    """Return the speed with which the first disc's centre flies back, over that with which it came."""
    velocity, mass = halves(method.points.velocity)[0], halves(method.points.mass)[0]
    return float(-(mass @ velocity)[:2].mean() / mass.sum() / SPEED)
