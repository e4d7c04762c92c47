"""A vibration of known shape and large strain in a cube, by body forces (Wallstedt & Guilkey 2008; verification.md, 6).

    u_i = A sin(π X_i / L) sin(ω t)    so that    F = diag(λ_i),  λ_i = 1 + u_i',  σ = K ln J I + 2 G dev ln U

without rotation, which the rate form integrates exactly. P_ii = σ_ii J/λ_i depends on X_i through λ_i alone, where
∂P_ii/∂λ_i = (K + 4G/3) Π_{j≠i} λ_j / λ_i; so ρ b_i = ρ ü_i - (K + 4G/3) u_i'' Π_{j≠i} λ_j / λ_i. Rollers all around.
"""

import numpy as np
import pytest
from columns import BULK, DENSITY, SHEAR_SHORT, Array, one_thread, order  # noqa: F401
from lagrangian import ELASTIC, brick, each_volume
from numpy.testing import assert_allclose

from viscopoint.interactions.planes import symmetry_plane

pytestmark = pytest.mark.usefixtures("one_thread")
SIDE, AMPLITUDE = 4.0, 0.12  # mm; strains up to π A / L, 9 % along each axis
MODULUS = BULK + 4 * SHEAR_SHORT / 3
RATE = np.pi / SIDE * np.sqrt(MODULUS / DENSITY)
TIME = 0.4 * 2 * np.pi / RATE


def displacement(x: Array, t: float, amplitude: float = AMPLITUDE) -> Array:
    return amplitude * np.sin(np.pi * x / SIDE) * np.sin(RATE * t)


def body_force(x: Array, t: float, amplitude: float = AMPLITUDE) -> Array:
    """Return b [mm/ms²] at the undeformed places x."""
    u = displacement(x, t, amplitude)
    stretch = 1 + np.pi / SIDE * amplitude * np.cos(np.pi * x / SIDE) * np.sin(RATE * t)
    bent = -((np.pi / SIDE) ** 2) * u
    return -(RATE**2) * u - MODULUS / DENSITY * bent * stretch.prod(axis=1, keepdims=True) / stretch**2


def error(cells: int, volume: str) -> float:
    """Return the root mean square error of the nodes' positions, per amplitude."""
    walls = tuple(symmetry_plane(axis, place) for axis in range(3) for place in (0.0, SIDE))
    cell = SIDE / cells

    def motion(x: Array) -> Array:
        return AMPLITUDE * RATE * np.sin(np.pi * x / SIDE)

    method = brick((cells, cells, cells), ELASTIC, walls, motion, cell=cell, volume=volume, safety=0.5)
    count = int(np.ceil(TIME / method.stable_step() * 1.3))
    dt, mass = TIME / count, method.nodes.mass[:, None]
    strain, now = method.strain, [0.0]

    def driven(step: float) -> None:
        now[0] += step
        strain(step)
        method.nodes.force[:] += mass * body_force(method.reference, now[0])

    method.strain = driven  # pyright: ignore[reportAttributeAccessIssue]
    for _ in range(count):
        method.advance(dt)
    missed = method.nodes.position - method.reference - displacement(method.reference, TIME)
    return float(np.sqrt((missed**2).mean())) / AMPLITUDE


@each_volume
def test_manufactured_vibration_of_large_strain_converges_to_second_order(volume: str) -> None:
    errors = [error(cells, volume) for cells in (4, 8, 16)]
    assert errors[-1] < 0.01
    assert order(errors[1:]) > 1.9
    assert_allclose(order(errors), 2.0, atol=0.25)
