import cmath
import math
from typing import Any

import numpy as np
import pytest
from material_point import ELASTIC, PAPER, State, at_rest, deviatoric, moved, orders, square, strained

from viscopoint.kernels.tensors import Sym, contract
from viscopoint.materials import step_factors, stored_energy
from viscopoint.materials.linear_viscoelastic import LinearViscoelastic

G_LONG, G_ARM, BETA = PAPER.shear_long, PAPER.shear_maxwell, PAPER.decay
G_SHORT = G_LONG + G_ARM
SHAPE = Sym(0.004, -0.003, -0.001, 0.002, -0.005, 0.003)  # traceless
STILL = Sym(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
ROUNDING = 1e-13  # of some tens of steps, each of a few roundings of 1.1e-16


def sheared(law: LinearViscoelastic, state: State, dt: float, gamma: float) -> State:
    return strained(law, step_factors(law, dt), state, Sym(0.0, 0.0, 0.0, gamma / 2, 0.0, 0.0))


@pytest.mark.parametrize("ramp_steps", [1, 7])
@pytest.mark.parametrize("ramp", [1e-3, 0.02, 0.5])
def test_held_strain_relaxes_exactly_as_the_hereditary_integral_says(ramp: float, ramp_steps: int) -> None:
    # eq. 7 for a strain ramped at constant rate until ``ramp``, then held: eq. 9 is exact for it in steps of any size
    state, factors = at_rest(PAPER), step_factors(PAPER, ramp / ramp_steps)
    for _ in range(ramp_steps):
        state = strained(PAPER, factors, state, (1 / ramp_steps) * SHAPE)
    held = 0.0
    for dt in (0.001, 0.03, 0.002, 0.01):
        state = strained(PAPER, step_factors(PAPER, dt), state, STILL)
        held += dt
        arm = G_ARM * (math.exp(-BETA * held) - math.exp(-BETA * (held + ramp))) / (BETA * ramp)
        np.testing.assert_allclose(square(state.stress), 2 * (G_LONG + arm) * square(SHAPE), rtol=ROUNDING, atol=0)


def test_sudden_strain_relaxes_with_the_relaxation_modulus() -> None:
    sudden = 1e-9 / BETA  # the step lasts long enough to relax by half of 1e-9
    state = strained(PAPER, step_factors(PAPER, sudden), at_rest(PAPER), SHAPE)
    for k in range(20):
        modulus = G_LONG + G_ARM * math.exp(-BETA * 0.005 * k)
        np.testing.assert_allclose(square(state.stress), 2 * modulus * square(SHAPE), rtol=1e-9)
        state = strained(PAPER, step_factors(PAPER, 0.005), state, STILL)


def test_stress_follows_the_hereditary_integral_of_a_changing_rate_to_second_order() -> None:
    # gamma = t^2 from rest: the integral of eq. 7 is 2 G_arm (t/beta - (1 - exp(-beta t))/beta^2)
    end = 0.05
    exact = G_LONG * end**2 + 2 * G_ARM * (end / BETA - (1 - math.exp(-BETA * end)) / BETA**2)
    errors = []
    for count in (20, 40, 80):
        state, t = at_rest(PAPER), np.linspace(0, end, count + 1)
        for step in np.diff(t**2):
            state = sheared(PAPER, state, end / count, float(step))
        errors.append(abs(state.stress.xy - exact))
    np.testing.assert_allclose(orders(errors), 2, atol=0.05)
    # strain is interpolated linearly within each step, and so is wrong by at most gamma'' dt^2/8
    assert errors[-1] < G_ARM * 2 * (end / 80) ** 2 / 8


def test_creep_follows_the_compliance_to_second_order() -> None:
    load, end, errors = 1.7, 0.4, []  # the retardation time G_0/(beta G_inf) is 0.43 ms
    for count in (40, 80, 160):
        state, gamma, t = at_rest(PAPER), 0.0, 0.0
        error = 0.0
        for dt in (1e-12 / BETA, *[end / count] * count):
            idle = sheared(PAPER, state, dt, 0.0).stress.xy
            slope = sheared(PAPER, state, dt, 1.0).stress.xy - idle  # the law is linear in a step's shear
            step = (load - idle) / slope
            state = sheared(PAPER, state, dt, step)
            gamma, t = gamma + step, t + dt
            compliance = 1 / G_LONG - (1 / G_LONG - 1 / G_SHORT) * math.exp(-t * BETA * G_LONG / G_SHORT)
            error = max(error, abs(gamma / load / compliance - 1))
        errors.append(error)
    np.testing.assert_allclose(orders(errors), 2, atol=0.05)
    # at constant stress eq. 9 multiplies the arm's by 1 - r (1 - exp(-x))/(r + (1 - r) (1 - exp(-x))/x) in each step,
    # r = G_inf/G_0, whose logarithm is -r x (1 - r (1 - r) x^2/12 + ...) in place of -r x
    r, x = G_LONG / G_SHORT, BETA * end / 160
    assert errors[-1] < r * (1 - r) * x**2 / 12


def cycle(law: LinearViscoelastic, omega: float, per_cycle: int, amplitude: float) -> tuple[complex, float]:
    """Shear sinusoidally; return the modulus and the loss of the last cycle, once the start has decayed."""
    dt = 2 * math.pi / omega / per_cycle
    cycles = 1 + math.ceil(40 * omega / (2 * math.pi * law.decay))  # exp(-40) is below rounding
    phase = omega * dt * np.arange(cycles * per_cycle + 1)
    state, stresses, losses = at_rest(law), [], [0.0]
    for step in np.diff(amplitude * np.sin(phase)):
        state = sheared(law, state, dt, float(step))
        stresses.append(state.stress.xy)
        losses.append(state.dissipated)
    # stress = Im(modulus * amplitude * exp(i phase)), so that its first Fourier coefficient gives the modulus
    last = np.array(stresses[-per_cycle:]) * np.exp(-1j * phase[-per_cycle:])
    return complex(2j * last.mean() / amplitude), losses[-1] - losses[-1 - per_cycle]


@pytest.mark.parametrize("omega", [4.0, 65.0, 900.0])
@pytest.mark.parametrize("per_cycle", [5, 24])
def test_sampled_harmonic_strain_meets_the_discrete_complex_modulus(omega: float, per_cycle: int) -> None:
    modulus, _ = cycle(PAPER, omega, per_cycle, 0.01)
    x, turn = BETA * 2 * math.pi / omega / per_cycle, cmath.exp(-2j * math.pi / per_cycle)
    arm = G_ARM * (1 - math.exp(-x)) / x * (1 - turn) / (1 - math.exp(-x) * turn)  # z-transform of eq. 9
    assert abs(modulus / (G_LONG + arm) - 1) < 1e-12


@pytest.mark.parametrize("omega", [20.0, 65.0, 200.0])
def test_loss_per_cycle_is_that_of_the_loss_modulus_to_second_order(omega: float) -> None:
    loss_modulus = G_ARM * omega * BETA / (omega**2 + BETA**2)
    counts = (20, 40, 80)
    errors = [1 - cycle(PAPER, omega, n, 0.01)[1] / (math.pi * 0.01**2 * loss_modulus) for n in counts]
    np.testing.assert_allclose(orders(errors), 2, atol=0.05)
    # strain interpolated linearly n times a cycle has the amplitude sinc^2(pi/n), and loss goes with its square
    assert errors[-1] == pytest.approx(1 - np.sinc(1 / 80) ** 4, rel=0.01)


MOTIONS = 0.02 * np.random.default_rng(6).uniform(-1, 1, (20, 3, 3))  # shear, rotation and volume together


def same_path(one: Any, other: Any, dt: float, motions: np.ndarray = MOTIONS) -> list[tuple[State, State]]:
    states = (at_rest(one), at_rest(other))
    visited = []
    for motion in motions:
        states = (
            moved(one, step_factors(one, dt), states[0], motion),
            moved(other, step_factors(other, dt), states[1], motion),
        )
        visited.append(states)
    return visited


@pytest.mark.parametrize(
    ("law", "shear"),
    [
        (PAPER._replace(decay=1e-14), G_SHORT),  # so slow that nothing relaxes within rounding
        (PAPER._replace(decay=0.0), G_SHORT),
        (PAPER._replace(shear_maxwell=0.0), G_LONG),
    ],
    ids=["slow", "never", "no arm"],
)
def test_solid_that_does_not_relax_is_elastic(law: LinearViscoelastic, shear: float) -> None:
    elastic = ELASTIC._replace(shear=shear)
    for solid, reference in same_path(law, elastic, 1e-3):
        np.testing.assert_allclose(square(solid.stress), square(reference.stress), atol=1e-12)  # of some 30 MPa
        stored = stored_energy(law, solid.jacobian, solid.stress, solid.history)
        assert stored == pytest.approx(stored_energy(elastic, solid.jacobian, reference.stress, ()), abs=1e-12)
        assert 0.0 <= solid.dissipated < 1e-15


def test_fast_arm_is_a_newtonian_dashpot_beside_the_long_term_spring() -> None:
    dt = 1.0
    fast = PAPER._replace(decay=1e3)
    viscosity = fast.shear_maxwell / fast.decay
    stretches = MOTIONS + np.swapaxes(MOTIONS, 1, 2)  # symmetric, so that nothing turns
    before, volume = 0.0, 1.0
    for stretch, (solid, spring) in zip(
        stretches, same_path(fast, ELASTIC._replace(shear=G_LONG), dt, stretches), strict=True
    ):
        rate = deviatoric(stretch @ np.linalg.inv(np.eye(3) + stretch / 2)) / dt
        np.testing.assert_allclose(square(solid.stress), square(spring.stress) + 2 * viscosity * rate, atol=1e-12)
        # the dashpot loses 2 eta d:d, but for the time of about 1/beta that the arm takes to follow a new rate
        loss = 0.5 * (volume + solid.jacobian) * 2 * viscosity * np.sum(rate**2) * dt
        assert solid.dissipated - before == pytest.approx(loss, rel=6 / (fast.decay * dt))
        before, volume = solid.dissipated, solid.jacobian


def test_maxwell_fluid_forgets_its_shear_and_loses_its_energy() -> None:
    fluid = PAPER._replace(shear_long=0.0)
    state = strained(fluid, step_factors(fluid, 1e-12 / BETA), at_rest(fluid), SHAPE)
    work = G_ARM * contract(SHAPE, SHAPE)  # of a sudden strain, which only the spring of the arm takes
    assert stored_energy(fluid, 1.0, state.stress, state.history) == pytest.approx(work, rel=4e-12, abs=1e-16)
    for k in range(1, 21):
        state = strained(fluid, step_factors(fluid, 0.03), state, STILL)
        left = math.exp(-BETA * 0.03 * k)
        np.testing.assert_allclose(square(state.stress), 2 * G_ARM * left * square(SHAPE), rtol=2e-12, atol=1e-15)
        assert stored_energy(fluid, 1.0, state.stress, state.history) == pytest.approx(
            left**2 * work, rel=4e-12, abs=1e-16
        )
        assert state.dissipated == pytest.approx((1 - left**2) * work, rel=4e-12, abs=1e-16)
