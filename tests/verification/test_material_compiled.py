from typing import Any

import numba
import numpy as np
import pytest
from material_point import LAWS, matrix, square

from viscopoint.kernels.jit import OPTIONS
from viscopoint.kernels.tensors import Sym
from viscopoint.materials import step_factors, stored_energy, update_stress
from viscopoint.model.kinematics import increments

MOTIONS = [matrix(a) for a in 0.05 * np.random.default_rng(5).uniform(-1, 1, (30, 3, 3))]


def visit(law: Any, factors: Any, motions: Any, history: tuple[float, ...]) -> Any:
    stress, jacobian, lost = Sym(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 1.0, 0.0
    for motion in motions:
        strain, turn, ratio = increments(motion)
        jacobian *= ratio
        stress, history, loss = update_stress(law, factors, strain, turn, jacobian, stress, history)
        lost += jacobian * loss
    parts = (stress.xx, stress.yy, stress.zz, stress.xy, stress.yz, stress.zx)
    return parts, history, (jacobian, lost, stored_energy(law, jacobian, stress, history))


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_compiled_material_point_follows_the_interpreted_one_to_rounding(law: Any) -> None:
    blank = (0.0,) * sum(count for _, count in law.history_fields)
    arguments = (law, step_factors(law, 0.01), tuple(MOTIONS), blank)
    compiled = numba.njit(**OPTIONS)(visit)(*arguments)
    for found, expected in zip(compiled, visit(*arguments), strict=True):
        # fused multiply-add rounds once where Python rounds twice; K ln J makes 550 MPa of a rounding of J
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=30 * 1e-15 * law.bulk)
    assert np.abs(square(compiled[0])).max() > 1.0
