"""The modulus of a sudden strain, K + 4/3 G of both springs together, in the law and in the steps that it bounds."""

from typing import Any

import bricks
import columns
import lagrangian
import numpy as np
import pytest
from columns import BULK, DENSITY, SHEAR_SHORT, one_thread, viscoelastic  # noqa: F401
from material_point import LAWS, at_rest, strained
from numpy.testing import assert_allclose

from viscopoint.kernels.tensors import Sym
from viscopoint.materials import step_factors

pytestmark = pytest.mark.usefixtures("one_thread")
SUDDEN = BULK + 4 / 3 * SHEAR_SHORT
CELL = 0.7  # mm


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_modulus_is_the_stress_of_a_sudden_confined_strain(law: Any) -> None:
    """Over no time nothing relaxes, and no strain so small yields; the error is that of ln J, half the strain."""
    strain = 1e-6
    state = strained(law, step_factors(law, 0.0), at_rest(law), Sym(strain, 0.0, 0.0, 0.0, 0.0, 0.0), ratio=1 + strain)
    assert_allclose(state.stress.xx / strain, law.p_wave_modulus, rtol=2 * strain)
    assert_allclose(law.p_wave_modulus, SUDDEN, rtol=1e-14)


def limits() -> dict[str, tuple[Any, float]]:
    """Return resting bodies of cubes by each method, and how far a wave may run in a step."""
    law, cube = viscoelastic(65.0), (CELL, CELL, CELL)
    solids = {name: bricks.fem(bricks.brick(cube, (1, 1, 1)), bricks.ELEMENTS[name], law) for name in bricks.ELEMENTS}
    bodies: dict[str, tuple[Any, float]] = {
        # 8 corners' eighths of an edge h: 1/l^2 = 3/h^2; eight points' shear, 2 (now / 8 Σ area²/det)^1/2, is shorter
        "fem-viscous": (solids["viscous"], CELL / np.sqrt(3)),
        "fem-stiffness": (solids["stiffness"], CELL / np.sqrt(3)),
        "fem-selective": (solids["selective"], CELL / np.sqrt(3)),
        "mpm": (columns.rod(law, (0.0, 0.0, 0.0), cell=CELL, viscosity=(0.0, 0.0)), CELL),
    }
    points = lagrangian.brick((2, 2, 2), law, cell=CELL)
    bodies["tlmpm"] = points, points.stable_length
    return bodies


@pytest.mark.parametrize("name", ["fem-viscous", "fem-stiffness", "fem-selective", "mpm", "tlmpm"])
def test_a_step_at_rest_is_what_a_sudden_wave_needs(name: str) -> None:
    method, length = limits()[name]
    method.time_step_factor = 1.0
    assert_allclose(method.stable_step(), length * np.sqrt(DENSITY / SUDDEN), rtol=1e-12)
