import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from material_point import ELASTIC, PAPER, PLASTIC, POLYMER, State, at_rest, moved, square, strained, symmetric
from scipy.optimize import brentq

from viscopoint.kernels.tensors import Sym, contract, von_mises
from viscopoint.materials import step_factors, stored_energy
from viscopoint.materials.plastic import Plastic

K, G, Y, H = ELASTIC.bulk, ELASTIC.shear, PLASTIC.yield_stress, PLASTIC.hardening
E = 9 * K * G / (3 * K + G)
# in MPa: the lateral strain of up to 0.05 is solved to 9e-16 (brentq's) of itself in up to 50 steps of 1e3 MPa a unit
ROUNDING = 1e-11


def stretched(law: Any, state: State, axial: float) -> State:
    """Advance by an axial logarithmic strain under uniaxial stress, by solving for the lateral one."""
    factors = step_factors(law, 1.0)

    def trial(lateral: float) -> State:
        ratio = math.exp(axial + 2 * lateral)  # so that p = -K tr(strain) exactly, as in the closed form
        return strained(law, factors, state, Sym(axial, lateral, lateral, 0.0, 0.0, 0.0), ratio=ratio)

    lateral: Any = brentq(lambda x: trial(x).stress.yy, -abs(axial), abs(axial), xtol=1e-18)
    return trial(lateral)


def elastic_part(law: Any, state: State) -> float:
    return stored_energy(law, state.jacobian, state.stress, state.history)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("steps", [1, 3, 50])
def test_uniaxial_stress_hardens_along_the_bilinear_curve(steps: int, direction: int) -> None:
    # flow keeps its direction, so that the return is exact in steps of any size, also across the yield point;
    # in logarithmic strain the law has no geometric nonlinearity left, and only rounding is
    state, total = at_rest(PLASTIC), 0.1
    for k in range(1, steps + 1):
        state = stretched(PLASTIC, state, direction * total / steps)
        strain = total * k / steps
        stress = min(E * strain, Y + E * H / (E + H) * (strain - Y / E))
        assert state.stress.xx == pytest.approx(direction * stress, abs=ROUNDING)
        assert state.history[-1] == pytest.approx(max(0.0, strain - stress / E), abs=ROUNDING / E)
    assert max(abs(state.stress.yy), abs(state.stress.zz)) < ROUNDING


def test_unloading_is_elastic_until_the_hardened_yield_stress_is_met_in_reverse() -> None:
    state = at_rest(PLASTIC)
    for _ in range(10):
        state = stretched(PLASTIC, state, 0.01)
    top, plastic, lost = state.stress.xx, state.history[-1], state.dissipated
    assert top == pytest.approx(Y + H * plastic, abs=ROUNDING)
    for k in range(1, 21):  # isotropic hardening: elastic over twice the yield stress
        state = stretched(PLASTIC, state, -0.0999 * top / E)
        assert state.stress.xx == pytest.approx((1 - 0.0999 * k) * top, abs=ROUNDING)
    assert state.history[-1] == plastic
    assert state.dissipated == lost
    state = stretched(PLASTIC, state, -0.002 * top / E - 0.01)
    assert state.stress.xx == pytest.approx(-top - E * H / (E + H) * 0.01, abs=ROUNDING)


@settings(deadline=None)
@given(
    strains=arrays(float, st.tuples(st.integers(1, 6), st.just(6)), elements=st.floats(-0.4, 0.4)),
    hardening=st.sampled_from([0.0, 20.0, 1e4]),
    dt=st.sampled_from([1e-6, 0.01, 10.0]),
    law=st.sampled_from([PLASTIC, POLYMER]),
)
def test_stress_never_leaves_the_yield_surface(strains: np.ndarray, hardening: float, dt: float, law: Any) -> None:
    law = law._replace(hardening=hardening)
    factors, state = step_factors(law, dt), at_rest(law)
    for strain in strains:
        before, state = state, strained(law, factors, state, Sym(*map(float, strain)))
        limit = law.yield_stress + law.hardening * state.history[-1]
        # the trial stress, some 2 G |strain| < 400 MPa, and the hardened limit < 1e4 MPa round
        assert von_mises(state.stress) <= limit + 1e-12 + 1e-14 * limit
        assert state.dissipated >= before.dissipated
        assert state.history[-1] >= before.history[-1]
        if state.history[-1] > before.history[-1]:  # flow only on the surface
            assert von_mises(state.stress) == pytest.approx(limit, rel=1e-14, abs=1e-12)


@pytest.mark.parametrize("law", [PLASTIC, POLYMER], ids=["elastic", "viscoelastic"])
def test_flow_is_isochoric_along_the_stress_and_the_base_law_takes_the_rest(law: Any) -> None:
    # the defining equations of the return, solved for the flow: S = S_base(strain - (3/2) growth S/|S|)
    base, path = (ELASTIC, ()) if law is PLASTIC else (PAPER, (0.0,) * 6)
    state, factors = at_rest(law), step_factors(law, 0.01)
    plain = at_rest(base)._replace(history=path)
    for row in np.random.default_rng(3).uniform(-0.1, 0.1, (8, 6)):
        strain, before = Sym(*map(float, row)), state.history[-1]
        state = strained(law, factors, state, strain)
        growth = state.history[-1] - before
        shape = square(state.stress) - np.trace(square(state.stress)) / 3 * np.eye(3)
        flow = symmetric(1.5 * growth * shape / von_mises(state.stress))
        plain = strained(base, factors, plain, strain - flow)
        np.testing.assert_allclose(square(state.stress), square(plain.stress), rtol=0, atol=1e-12)
        np.testing.assert_allclose(state.history[:-1], plain.history, rtol=0, atol=1e-12)
    assert state.history[-1] > 0.1


SHAPE = Sym(0.5, 0.3, -0.8, 0.4, -0.2, 0.7)  # traceless, so that J = 1
EQUIVALENT = math.sqrt(2 / 3 * contract(SHAPE, SHAPE))
TO_YIELD = Y / (3 * G * EQUIVALENT)  # the amount of SHAPE that just does not yield


def test_perfectly_plastic_work_is_what_the_law_reports_as_dissipated() -> None:
    law = PLASTIC._replace(hardening=0.0)
    state, work = at_rest(law), 0.0
    for amount in [TO_YIELD, *[0.005] * 10]:  # stress is linear within each of these steps
        before, state = state, strained(law, 1.0, state, amount * SHAPE)
        work += amount * contract(0.5 * (before.stress + state.stress), SHAPE)
        assert state.dissipated == pytest.approx(Y * state.history[-1], rel=1e-12)
        assert elastic_part(law, state) + state.dissipated == pytest.approx(work, rel=1e-12)
    assert state.history[-1] == pytest.approx(0.05 * EQUIVALENT, rel=1e-12)


@pytest.mark.parametrize("steps", [1, 10, 100])
def test_hardening_work_is_dissipated_to_the_order_of_the_step(steps: int) -> None:
    state = strained(PLASTIC, 1.0, at_rest(PLASTIC), TO_YIELD * SHAPE)
    for _ in range(steps):
        state = strained(PLASTIC, 1.0, state, (0.1 / steps) * SHAPE)
    plastic = state.history[-1]
    assert plastic == pytest.approx(3 * G * 0.1 * EQUIVALENT / (3 * G + H), rel=1e-12)
    work = Y * plastic + H * plastic**2 / 2  # the integral of the yield stress
    # the law takes the stress at the end of a step, which is H dp above that at its start, for all of its flow dp
    assert -1e-13 <= state.dissipated - work <= H * plastic**2 / steps / 2 * (1 + 1e-9)


def test_flowing_maxwell_fluid_loses_all_the_work_of_steady_shear() -> None:
    # on the yield surface nothing is stored any more: the arm's relaxation and the flow share Y gamma/sqrt(3)
    law = Plastic(PAPER._replace(shear_long=0.0), Y, 0.0)
    before = state = at_rest(law)
    factors = step_factors(law, 0.004)
    for _ in range(5):
        before, state = state, strained(law, factors, state, Sym(0.0, 0.0, 0.0, 0.1, 0.0, 0.0))
    assert before.stress.xy == pytest.approx(Y / math.sqrt(3), rel=1e-14)
    assert state.dissipated - before.dissipated == pytest.approx(Y / math.sqrt(3) * 0.2, rel=1e-12)
    assert 0 < state.history[-1] - before.history[-1] < 0.2 / math.sqrt(3)


MOTIONS = 0.05 * np.random.default_rng(8).uniform(-1, 1, (15, 3, 3))


@pytest.mark.parametrize(
    ("law", "base"),
    [(Plastic(ELASTIC, 1e9, H), ELASTIC), (Plastic(PAPER, 1e9, H), PAPER)],
    ids=["elastic", "viscoelastic"],
)
def test_huge_yield_stress_leaves_the_base_law(law: Any, base: Any) -> None:
    strong, plain, factors = at_rest(law), at_rest(base), step_factors(base, 0.01)
    for motion in MOTIONS:
        strong, plain = moved(law, step_factors(law, 0.01), strong, motion), moved(base, factors, plain, motion)
        assert strong == plain._replace(history=(*plain.history, 0.0))  # the same arithmetic
        assert elastic_part(law, strong) == elastic_part(base, plain)


def test_viscoelastic_plastic_solid_that_does_not_relax_is_elastic_plastic() -> None:
    slow = POLYMER._replace(base=PAPER._replace(decay=0.0))
    one, other = at_rest(slow), at_rest(PLASTIC)
    for motion in MOTIONS:
        one, other = moved(slow, step_factors(slow, 0.01), one, motion), moved(PLASTIC, 0.01, other, motion)
        np.testing.assert_allclose(square(one.stress), square(other.stress), rtol=0, atol=1e-12)
        assert one.history[-1] == pytest.approx(other.history[-1], rel=1e-12)
        assert one.dissipated == pytest.approx(other.dissipated, rel=1e-12)
