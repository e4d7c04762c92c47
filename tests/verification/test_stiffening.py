"""A material that stiffens under compression: the step follows the stiffness that it has, not the one it began with.

With u = ln J the pressure is p = -K (u + s u³), whose tangent modulus K (1 + 3 s u²) is ten times K at u = -0.3 for
s = 33. The energy per reference volume is ∫ -p dJ = K [e^u (u - 1 + s (u³ - 3u² + 6u - 6)) + 1 + 6s].
"""

import math
from typing import Any, NamedTuple

import bricks
import columns
import lagrangian
import numpy as np
import pytest

from solids import sheared, solid
from viscopoint.interactions.planes import symmetry_plane
from viscopoint.kernels.logarithm import log
from viscopoint.kernels.tensors import Sym, contract, deviator, spherical
from viscopoint.materials import History, HistoryField, Increment, Response, p_wave_modulus, shear_energy
from viscopoint.methods.fem.elements.one_point import OnePoint
from viscopoint.methods.fem.hourglass import StiffnessControl
from viscopoint.model.viscosity import BulkViscosity

BULK, SHEAR, S, DENSITY, SPEED = 100.0, 10.0, 33.0, 1e-3, 170.0
FACTORS = {"fem": 0.9, "tlmpm": 0.9, "mpm": 0.6}  # of the critical step


class Stiffening(NamedTuple):
    """``tells``: 1 if the material says how stiff it is now, 0 if it says what it was at the start."""

    density: float
    bulk: float
    shear: float
    s: float
    tells: float

    @property
    def p_wave_modulus(self) -> float:
        return p_wave_modulus(self.bulk, self.shear)

    @property
    def history_fields(self) -> tuple[HistoryField, ...]:
        return ()


def update(material: Stiffening, factors: float, increment: Increment, stress: Sym, history: History) -> Response:
    u = log(increment.jacobian)
    stress = sheared(material, increment, stress) + spherical(material.bulk * (u + material.s * u * u * u))
    tangent = material.bulk * (1.0 + 3.0 * material.tells * material.s * u * u)
    return Response(stress, history, 0.0, p_wave_modulus(tangent, material.shear))


def energy(material: Stiffening, jacobian: float, stress: Sym, history: History) -> float:
    u, s = log(jacobian), material.s
    volume = jacobian * (u - 1.0 + s * (u * u * u - 3.0 * u * u + 6.0 * u - 6.0)) + 1.0 + 6.0 * s
    return material.bulk * volume + jacobian * shear_energy(material, stress, history)


solid(Stiffening, update, stored=energy)


def squeezed(method: str, tells: float) -> Any:
    """Return a column of 40 cells between rollers all around, of which one half flies against the other."""
    material, cells = Stiffening(DENSITY, BULK, SHEAR, S, tells), 40

    def speed(z: np.ndarray) -> np.ndarray:
        return SPEED * np.sin(2.0 * np.pi * z / columns.LENGTH)

    ends = (symmetry_plane(2, 0.0), symmetry_plane(2, columns.LENGTH))
    if method == "fem":
        made: Any = bricks.column(cells, bricks.SELECTIVE, material, ends, velocity=bricks.upward(speed))
    elif method == "tlmpm":
        made = lagrangian.column(cells, material, ends, lagrangian.upward(speed))
    else:
        made = columns.column(cells, material, ends, speed, shape="quadratic")
    made.viscosity, made.time_step_factor = BulkViscosity(0.06, 1.5), FACTORS[method]
    return made


@pytest.mark.parametrize("method", ["fem", "tlmpm"])
def test_energy_stays_where_the_step_follows_the_present_stiffness(method: str) -> None:
    worst = {}
    for tells in (1.0, 0.0):
        body, time, stiffest = squeezed(method, tells), 0.0, 1.0
        start, end = body.totals().energy, 0.25 * columns.LENGTH / math.sqrt(p_wave_modulus(BULK, SHEAR) / DENSITY)
        worst[tells] = 0.0
        with np.errstate(all="ignore"):
            while time < end and 0.0 < body.stable_step() < np.inf:
                dt = min(body.stable_step(), end - time)
                body.advance(dt)
                time += dt
                stiffest = max(stiffest, 1.0 + 3.0 * S * math.log(lowest(body)) ** 2)
                worst[tells] = max(worst[tells], abs(1.0 - body.totals().energy / start))
        if tells:
            assert stiffest > 10.0
            assert time == end
    assert worst[1.0] < 1e-3
    assert not worst[0.0] < 1e-2  # by the old constant the step is too long


def test_step_of_material_points_follows_the_present_stiffness() -> None:
    """Of points, whose balance is not that fine: FLIP's lags by per cents while they are squeezed."""
    steps = {}
    for tells in (1.0, 0.0):
        body = squeezed("mpm", tells)
        for _ in range(60):
            body.advance(0.2 * body.stable_step())
        jacobian = body.points.shared.jacobian
        u = np.log(jacobian)
        modulus = BULK * (1.0 + 3.0 * tells * S * u**2) + 4.0 * SHEAR / 3.0
        fastest = np.sqrt(modulus * jacobian / DENSITY) + np.linalg.norm(body.points.velocity, axis=1)
        steps[tells] = body.stable_step()
        assert steps[tells] < FACTORS["mpm"] * body.grid.cell / fastest.max() * (1.0 + 1e-12)  # damping shortens it
        assert steps[tells] > 0.5 * FACTORS["mpm"] * body.grid.cell / fastest.max()
    assert steps[1.0] < 0.8 * steps[0.0]


def lowest(body: Any) -> float:
    """Return the least J."""
    shared = body.points.shared if hasattr(body, "points") else body.elements.shared
    return max(float(shared.jacobian.min()), 1e-3)


class Stirred(NamedTuple):
    """A solid whose p-wave modulus grows with the shear that it has seen, which its stress does not tell."""

    density: float
    bulk: float
    shear: float

    history_fields = (HistoryField("seen"),)

    @property
    def p_wave_modulus(self) -> float:
        return p_wave_modulus(self.bulk, self.shear)


def stir(material: Stirred, factors: float, increment: Increment, stress: Sym, history: History) -> Response:
    shape = deviator(increment.strain)
    seen = history[0] + contract(shape, shape)
    modulus = p_wave_modulus(material.bulk, material.shear) * (1.0 + 1e3 * seen)
    return Response(stress + spherical(0.0), (seen,), 0.0, modulus)


def no_energy(material: Stirred, jacobian: float, stress: Sym, history: History) -> float:
    return 0.0


def no_shear_energy(material: Stirred, stress: Sym, history: History) -> float:
    return 0.0


solid(Stirred, stir, no_energy, no_shear_energy)


def test_step_of_a_selective_element_is_that_of_its_stiffest_point_wherever_it_is() -> None:
    steps, size, dt = [], 1e-3, 1e-3
    for corner, sign in ((0, 1.0), (6, -1.0)):  # opposite ones, moved in opposite ways
        body = bricks.brick((1.0, 1.0, 1.0), (1, 1, 1))
        method = bricks.fem(body, bricks.SELECTIVE, Stirred(DENSITY, BULK, SHEAR))
        velocity = np.zeros((8, 3))
        velocity[body.cells[0][corner]] = sign * size / dt * np.array([100.0, 50.0, 20.0])
        bricks.answer(method, velocity, dt)
        steps.append(float(method.critical.min()))
        seen = method.elements.material.history
        stiffest = p_wave_modulus(BULK, SHEAR) * (1.0 + 1e3 * float(seen.max()))
        assert seen.max() > 10.0 * seen.min()
        soft = bricks.fem(body, bricks.SELECTIVE, columns.Elastic(DENSITY, stiffest - 4.0 / 3.0 * SHEAR, SHEAR))
        bricks.answer(soft, velocity, dt)  # as stiff from the start
        np.testing.assert_allclose(method.critical, soft.critical, rtol=1e-12)
    np.testing.assert_allclose(steps[0], steps[1], rtol=1e-12)


def test_mean_stress_of_a_selective_element_counts_points_by_their_reference_volumes() -> None:
    """Pressures that differ from point to point push as one would in an element of one point, however uneven it is."""
    body, rng = bricks.brick((2.0, 2.0, 2.0), (2, 2, 2), shake=0.2), np.random.default_rng(3)
    law, motion = Stirred(DENSITY, BULK, SHEAR), 0.1 * rng.normal(size=body.position.shape)
    full, one = (bricks.fem(body, element, law) for element in (bricks.SELECTIVE, OnePoint(StiffnessControl(0.0))))
    pressure, volume = rng.uniform(1.0, 2.0, (8, 8)), full.elements.volume.reshape(8, 8)
    mean = (volume * pressure).sum(axis=1) / volume.sum(axis=1)
    full.elements.material.stress[:, :3] = -pressure.reshape(-1, 1)
    one.elements.material.stress[:, :3] = -mean[:, None]
    found, expected = (bricks.answer(method, motion, 1.0) for method in (full, one))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * mean.max())  # on areas of 1 mm^2
