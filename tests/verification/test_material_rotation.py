import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from material_point import (
    ELASTIC,
    LAWS,
    PAPER,
    PLASTIC,
    State,
    at_rest,
    deviatoric,
    increments,
    matrix,
    moved,
    orders,
    square,
)
from scipy.spatial.transform import Rotation

from viscopoint.kernels.tensors import trace
from viscopoint.materials import step_factors

ROUNDING = 2e-15 * PAPER.bulk  # MPa in a step or two: J rounds by 1.1e-16 several times, and p = -K ln J
AXES = {"x": (1.0, 0.0, 0.0), "oblique": (1.0, -2.0, 3.0)}


def rotation(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    return Rotation.from_rotvec(angle * np.array(axis) / np.linalg.norm(axis)).as_matrix()


# --- simple shear with the Jaumann rate ------------------------------------------------------------------------------

SPIN = 20.0  # shear rate, 1/ms


def jaumann_shear(t: float) -> np.ndarray:
    """Return tau and sigma_xx: eq. 10 is linear for a constant spin; integrated in closed form from rest."""
    g, beta, long, arm = SPIN, PAPER.decay, PAPER.shear_long, PAPER.shear_maxwell
    size, left, sine, cosine = beta**2 + g**2, math.exp(-beta * t), math.sin(g * t), math.cos(g * t)
    tau = long * sine + arm * g / size * (beta * (1 - left * cosine) + g * left * sine)
    normal = long * (1 - cosine) + arm * g / size * (g * (1 - left * cosine) - beta * left * sine)
    return np.array([tau, normal])


def sheared(end: float, count: int) -> np.ndarray:
    dt = end / count
    factors, state = step_factors(PAPER, dt), at_rest(PAPER)
    motion = np.zeros((3, 3))
    motion[0, 1] = SPIN * dt  # F = I + t L exactly, as L L = 0
    for _ in range(count):
        state = moved(PAPER, factors, state, motion)
    assert state.jacobian == 1.0
    assert state.stress.yy == pytest.approx(-state.stress.xx, rel=1e-12)
    return np.array([state.stress.xy, state.stress.xx])


@pytest.mark.parametrize("end", [0.05, 0.2])
def test_simple_shear_converges_to_the_jaumann_solution(end: float) -> None:
    if end == 0.05:
        np.testing.assert_allclose(jaumann_shear(end), [41.739288, 12.491485], atol=5e-7)  # from an ODE solver
    one, two, four = (sheared(end, count) for count in (200, 400, 800))
    # Aitken's limit of three runs removes the leading power of the step; what is left of a first-order error
    # is of the order of the square of the angle per step, and smaller still for a higher order
    limit = four - (four - two) ** 2 / (four - 2 * two + one)
    np.testing.assert_allclose(limit, jaumann_shear(end), atol=PAPER.shear_maxwell * (SPIN * end / 800) ** 2)


def test_simple_shear_follows_the_jaumann_solution_to_second_order() -> None:
    counts = (40, 80, 160)
    errors = [float(np.abs(sheared(0.05, count) - jaumann_shear(0.05)).max()) for count in counts]
    np.testing.assert_allclose(orders(errors), 2, atol=0.1)


# --- rigid rotation ---------------------------------------------------------------------------------------------------


def prestressed(law: Any, frame: np.ndarray) -> State:
    """Compress, shear and turn a little, with every axis of the motion seen from a turned frame."""
    state, factors = at_rest(law), step_factors(law, 0.003)
    for motion in ([[0.01, 0.04, 0], [0, -0.03, 0.02], [0.01, 0, -0.02]], [[-0.02, 0, 0.03], [0.05, 0, 0], [0, 0, 0]]):
        state = moved(law, factors, state, frame @ np.array(motion) @ frame.T)
    return state


def maxwell_arm(state: State) -> np.ndarray:
    return square(state.history[:6]) if len(state.history) >= 6 else np.zeros((3, 3))


@pytest.mark.parametrize("steps", [7, 1000])
@pytest.mark.parametrize("axis", AXES.values(), ids=AXES)
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_rigid_rotation_turns_stress_and_history_to_rounding(law: Any, axis: Any, steps: int) -> None:
    angle, duration = 4 * math.pi + 0.3, 0.01  # two turns and some more, so that the end is not the start
    start = state = prestressed(law, np.eye(3))
    arm = maxwell_arm(start)
    factors, step = step_factors(law, duration / steps), rotation(axis, angle / steps)
    for _ in range(steps):
        state = moved(law, factors, state, step - np.eye(3))
    turn = rotation(axis, angle)
    left = math.exp(-getattr(getattr(law, "base", law), "decay", 0.0) * duration)  # the arm relaxes meanwhile
    close = {"rtol": 0, "atol": steps * ROUNDING}
    np.testing.assert_allclose(maxwell_arm(state), left * turn @ arm @ turn.T, **close)
    expected = turn @ (square(start.stress) - (1 - left) * arm) @ turn.T
    np.testing.assert_allclose(square(state.stress), expected, **close)
    np.testing.assert_allclose(
        np.linalg.eigvalsh(square(state.stress)), np.linalg.eigvalsh(square(start.stress) - (1 - left) * arm), **close
    )
    assert state.jacobian == pytest.approx(start.jacobian, rel=steps * 1e-15)
    if law is PLASTIC:  # no further yield; its stress, at the yield surface, stays there to rounding
        assert start.history[-1] > 1e-3
        assert state.history[-1] == pytest.approx(start.history[-1], rel=1e-12)


@settings(deadline=None)
@given(axis=arrays(float, 3, elements=st.floats(-1, 1)), angle=st.floats(-2.8, 2.8))
def test_rigid_step_strains_nothing_and_turns_by_the_whole_angle(axis: np.ndarray, angle: float) -> None:
    if np.linalg.norm(axis) < 1e-3:
        axis = np.array([0.0, 0.0, 1.0])
    turn = rotation(tuple(axis), angle)
    strain, found, ratio = increments(matrix(turn - np.eye(3)))
    # (I + R)/2 is singular at half a turn: the rounding in its inverse grows with 1/cos^2(angle/2), 35 at 2.8 rad
    close = {"rtol": 0, "atol": 2e-15 / math.cos(angle / 2) ** 2}
    np.testing.assert_allclose(square(strain), 0, **close)
    np.testing.assert_allclose(square(found), turn, **close)
    assert ratio == pytest.approx(1.0, abs=2e-15)


# --- objectivity ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_motion_seen_from_a_turned_frame_gives_the_turned_stress(law: Any) -> None:
    frame = rotation((2.0, 1.0, -0.5), 2.1)
    here, there = prestressed(law, np.eye(3)), prestressed(law, frame)
    np.testing.assert_allclose(square(there.stress), frame @ square(here.stress) @ frame.T, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(maxwell_arm(there), frame @ maxwell_arm(here) @ frame.T, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(there.dissipated, here.dissipated, rtol=1e-12)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_stretch_after_a_finite_rotation_gives_the_turned_stress(law: Any) -> None:
    turn, factors = rotation((2.0, 1.0, -0.5), 2.1), step_factors(law, 0.003)
    stretch = np.diag([0.05, -0.02, -0.03]) + 0.01
    at_once = 1e-15  # ms, so that the arm does not relax while it turns
    here = moved(law, factors, prestressed(law, np.eye(3)), stretch)
    there = moved(law, step_factors(law, at_once), prestressed(law, np.eye(3)), turn - np.eye(3))
    there = moved(law, factors, there, turn @ stretch @ turn.T)
    np.testing.assert_allclose(square(there.stress), turn @ square(here.stress) @ turn.T, rtol=0, atol=2 * ROUNDING)


def test_stretch_while_spinning_gives_the_turned_stress_to_second_order() -> None:
    # F = R(t) U(t) with fixed principal axes of stretch: D = R U' U^-1 R^T and W = R' R^T, so S = 2 G R (ln U)' R^T
    strain, angle, errors = np.array([0.2, -0.15, -0.05]), 1.5, []
    for count in (20, 40, 80):
        state, before = at_rest(ELASTIC), np.eye(3)
        for t in np.linspace(0, 1, count + 1)[1:]:
            now = rotation(AXES["oblique"], angle * t) @ np.diag(np.exp(strain * t))
            state = moved(ELASTIC, 1.0, state, now @ np.linalg.inv(before) - np.eye(3))
            before = now
        turn = rotation(AXES["oblique"], angle)
        exact = turn @ (2 * ELASTIC.shear * np.diag(strain)) @ turn.T
        errors.append(float(np.abs(deviatoric(square(state.stress)) - exact).max()))
    np.testing.assert_allclose(orders(errors), 2, atol=0.1)


# --- volume -----------------------------------------------------------------------------------------------------------


@settings(deadline=None)
@given(arrays(float, st.tuples(st.integers(1, 8), st.just(3), st.just(3)), elements=st.floats(-0.2, 0.2)))
def test_volume_is_that_of_the_deformation_gradient_and_sets_the_pressure(motions: np.ndarray) -> None:
    state, deformation = at_rest(PAPER), np.eye(3)
    for motion in motions:
        state = moved(PAPER, step_factors(PAPER, 0.01), state, motion)
        deformation = (np.eye(3) + motion) @ deformation
    # the determinant loses its size relative to the product of the norms of the rows
    lost = 1e-15 * len(motions) * 3 * np.prod(np.linalg.norm(deformation, axis=1)) / np.linalg.det(deformation)
    assert state.jacobian == pytest.approx(np.linalg.det(deformation), rel=10 * lost)
    shear = np.abs(square(state.stress)).max()
    assert trace(state.stress) / 3 == pytest.approx(PAPER.bulk * math.log(state.jacobian), rel=1e-13, abs=1e-14 * shear)
