"""Round bodies in their half plane: cylinders of axisymmetric points, and how an infinite one breathes.

Held in z (plane strain), a free cylinder of radius R swells and shrinks as u_r = J1(x r / R) cos(w t) with

    x J0(x) = (1 - 2 nu) / (1 - nu) J1(x),    w = x c / R,    (1 - 2 nu) / (1 - nu) = 2 G / M,    c² = M / rho.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from columns import BULK, COURANT, DENSITY, SHEAR_SHORT, viscoelastic
from lagrangian import lagrangian
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import j0, j1

from viscopoint.interactions.planes import Interaction
from viscopoint.methods.mpm.contacts import CONTACTS
from viscopoint.methods.mpm.fills.meridian import boxes
from viscopoint.methods.mpm.geometry import Box
from viscopoint.methods.mpm.grid import HalfPlane
from viscopoint.methods.mpm.method import Discretisation, MaterialPointMethod
from viscopoint.methods.mpm.schemes import SCHEMES
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.mpm.transfers import TRANSFERS
from viscopoint.methods.mpm.volumes import VOLUMES
from viscopoint.methods.tlmpm.lattice import HalfLattice
from viscopoint.methods.tlmpm.method import TotalLagrangianMethod
from viscopoint.model.body import Body
from viscopoint.model.viscosity import BulkViscosity

Array = NDArray[np.float64]
Boundaries = tuple[Interaction, ...]
Motion = Callable[[Array], Array]
RADIUS = 2.0  # mm
MODULUS = BULK + 4 * SHEAR_SHORT / 3
SOUND = float(np.sqrt(MODULUS / DENSITY))
ROOT: float = brentq(lambda x: x * j0(x) - 2 * SHEAR_SHORT / MODULUS * j1(x), 1.0, 3.0)  # pyright: ignore
ELASTIC = viscoelastic(0.0)  # an arm that never relaxes: the same kernels serve all tests


def cylinder(cells: int, layers: int, height: float = 0.0, radius: float = RADIUS) -> Body:
    """Return a cylinder on z = 0, ``cells`` from the axis to its surface with two points each across.

    ``layers`` of points are ``height`` high [mm], by default as they are wide.
    """
    width = radius / cells / 2
    return boxes(radius, 2 * cells, width, layers, height or width)


def lagrangian_rings(
    cells: int, layers: int, law: Any = ELASTIC, boundaries: Boundaries = (), motion: Motion = np.zeros_like,
    height: float = 0.0, cell_height: float = 0.0, **choices: Any,
) -> TotalLagrangianMethod:  # fmt: skip
    """Return a cylinder of total Lagrangian points, by default one layer of them to a cell."""
    body, cell = cylinder(cells, layers, height), RADIUS / cells
    edges = (cell, cell, cell_height or height or cell / 2)
    return lagrangian(body, edges, law, boundaries, motion, lattice=HalfLattice, **choices)


def rings(
    cells: int, layers: int, law: Any = ELASTIC, boundaries: Boundaries = (), motion: Motion = np.zeros_like,
    *, shape: str = "gimp", transfer: str = "flip", volume: str = "local", contact: str = "nodes",
    safety: float = COURANT, viscosity: tuple[float, float] = (0.0, 0.0), radius: float = RADIUS,
) -> MaterialPointMethod:  # fmt: skip
    """Return a cylinder of material points; ``motion`` is the velocity at a place [mm/ms]."""
    body, cell = cylinder(cells, layers, radius=radius), radius / cells
    top = 2.0 * layers * cell
    choices = Discretisation(
        cell=cell,
        box=Box((0.0, 0.0, -4 * cell), (4 * radius, cell, top)),
        shape=SHAPES[shape].fitted(0.5),
        scheme=SCHEMES["musl"],
        transfer=TRANSFERS[transfer].chosen(0.0),
        time_step_factor=safety,
        viscosity=BulkViscosity(*viscosity),
        volume=VOLUMES[volume],
        contact=CONTACTS[contact],
        grid=HalfPlane,
    )
    return MaterialPointMethod(body, law, boundaries, choices, motion(body.position))


def stretching(across: float, upward: float) -> Motion:
    """Return the velocity field (a r, 0, b z)."""
    return lambda position: position * [across, 0.0, upward]


def breathing(position: Array) -> Array:
    """Return the velocity of a cylinder's first mode, at a speed that strains it by no more than 1e-6."""
    speed = 1e-6 * SOUND * j1(ROOT * position[:, 0] / RADIUS)
    return np.outer(speed, [1.0, 0.0, 0.0])


def frequency(signal: Array, dt: float) -> float:
    """Return that of a cosine: s(t + dt) + s(t - dt) = 2 cos(w dt) s(t)."""
    middle, sides = signal[1:-1], signal[2:] + signal[:-2]
    return float(np.arccos(0.5 * (middle @ sides) / (middle @ middle))) / dt
