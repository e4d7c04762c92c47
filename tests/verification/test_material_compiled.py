from typing import Any

import numba
import numpy as np
import pytest
from material_point import LAWS, matrix, square

from viscopoint.kernels.jit import OPTIONS
from viscopoint.kernels.kinematics import at_mid_step, strain_and_rotation, volume_ratio
from viscopoint.kernels.tensors import IDENTITY, Sym
from viscopoint.materials import Increment, step_factors, stored_energy, update_stress
from viscopoint.materials.block import MaterialBlock

MOTIONS = [matrix(a) for a in 0.05 * np.random.default_rng(5).uniform(-1, 1, (30, 3, 3))]


def visit(law: Any, factors: Any, motions: Any, history: tuple[float, ...]) -> Any:
    stress, jacobian, lost = Sym(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 1.0, 0.0
    for motion in motions:
        strain, rotation = strain_and_rotation(at_mid_step(motion))
        jacobian *= volume_ratio(motion)
        now = update_stress(law, factors, Increment(0.01, strain, rotation, jacobian, IDENTITY), stress, history)
        stress, history = now.stress, now.history
        lost += jacobian * now.dissipated
    parts = (stress.xx, stress.yy, stress.zz, stress.xy, stress.yz, stress.zx)
    return parts, history, (jacobian, lost, stored_energy(law, jacobian, stress, history))


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_compiled_material_point_follows_the_interpreted_one_to_rounding(law: Any) -> None:
    history = tuple(MaterialBlock(law).initial_history())
    arguments = (law, step_factors(law, 0.01), tuple(MOTIONS), history)
    compiled = numba.njit(**OPTIONS)(visit)(*arguments)
    for found, expected in zip(compiled, visit(*arguments), strict=True):
        # fused multiply-add rounds once where Python rounds twice; K ln J makes 550 MPa of a rounding of J
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=30 * 1e-15 * 550.0)
    assert np.abs(square(compiled[0])).max() > 1.0
