"""Standard linear solid with elastic volume (Kim 2018, eqs. 5-10; LS-DYNA MAT_006).

    G(t) = G_long + (G_short - G_long) exp(-decay t),    p = -K ln J

A spring G_long beside a Maxwell arm G_short - G_long whose deviatoric stress is the history. Both turn with the
material (Jaumann rate) and the arm is integrated exactly for a constant strain rate over the step (eq. 9).

The law is hypoelastic: no potential gives it where shear and volume change together. The stored energy J S:S / 4G
differs from the work done by ``hypoelastic_work``, which the energy balance counts.
"""

import math
from typing import Literal, NamedTuple

from viscopoint import materials
from viscopoint.case.rules import rule
from viscopoint.case.tables import MaterialInput
from viscopoint.case.units import Decay, Density, Modulus, PositiveModulus
from viscopoint.kernels.jit import implements, inline
from viscopoint.kernels.logarithm import log
from viscopoint.kernels.tensors import Sym, components, contract, deviator, read, rotated, spherical
from viscopoint.materials import History, HistoryField, Increment, Response, p_wave_modulus


class LinearViscoelastic(NamedTuple):
    """Parameters; the history is the Maxwell arm's deviatoric stress S_v [MPa]."""

    density: float  # rho, g/mm^3
    bulk: float  # K, MPa
    shear_long: float  # G_inf, MPa
    shear_maxwell: float  # G_0 - G_inf, MPa
    decay: float  # beta, 1/ms

    history_fields = (HistoryField("maxwell_stress", "MPa", 6),)

    @property
    def p_wave_modulus(self) -> float:
        return p_wave_modulus(self.bulk, self.shear_long + self.shear_maxwell)


class ViscoelasticModuli(MaterialInput):
    """The keys of a standard linear solid."""

    density: Density
    bulk: PositiveModulus
    shear_short: Modulus
    shear_long: Modulus
    decay: Decay

    def viscoelastic(self) -> LinearViscoelastic:
        maxwell = self.shear_short - self.shear_long
        return LinearViscoelastic(self.density, self.bulk, self.shear_long, maxwell, self.decay)


@rule("material.shear_long", "material.shear_short")
def relaxes(long: float, short: float) -> str | None:
    return f"{long:g} MPa must not exceed material.shear_short, {short:g} MPa" if long > short else None


class LinearViscoelasticInput(ViscoelasticModuli):
    """``law = "linear-viscoelastic"``."""

    law: Literal["linear-viscoelastic"]

    def build(self) -> LinearViscoelastic:
        return self.viscoelastic()


class MaxwellStep(NamedTuple):
    """The arm over one step of x = beta dt; every factor is 1, 1, x/2G.. times a smooth function of x."""

    relaxed: float  # exp(-x)
    mean_relaxation: float  # (1 - exp(-x)) / x
    loss_start: float  # dissipated per S_n : S_n
    loss_cross: float  # dissipated per S_n : strain
    loss_strain: float  # dissipated per strain : strain


@implements(materials.step_factors, LinearViscoelastic)
def maxwell_step(material: LinearViscoelastic, dt: float) -> MaxwellStep:
    x, maxwell = material.decay * dt, material.shear_maxwell
    mean = mean_decay(x)
    start = 0.5 * x * mean_decay(2.0 * x) / maxwell if maxwell > 0.0 else 0.0
    return MaxwellStep(math.exp(-x), mean, start, x * mean * mean, 2.0 * maxwell * x * mean_square_gain(x))


@implements(materials.update_stress, LinearViscoelastic)
def update(
    material: LinearViscoelastic, factors: MaxwellStep, increment: Increment, stress: Sym, history: History
) -> Response:
    shape = deviator(increment.strain)
    arm = rotated(read(history), increment.rotation)
    spring = rotated(deviator(stress) - read(history), increment.rotation)
    dissipated = (
        factors.loss_start * contract(arm, arm)
        + factors.loss_cross * contract(arm, shape)
        + factors.loss_strain * contract(shape, shape)
    )
    arm = factors.relaxed * arm + 2.0 * material.shear_maxwell * factors.mean_relaxation * shape  # eq. 9
    spring = spring + 2.0 * material.shear_long * shape
    stress = spring + arm + spherical(material.bulk * log(increment.jacobian))  # eq. 6
    modulus = p_wave_modulus(material.bulk, material.shear_long + material.shear_maxwell)
    return Response(stress, components(arm), dissipated, modulus)


implements(materials.stored_energy, LinearViscoelastic)(materials.volume_and_shear_energy)


@implements(materials.shear_energy, LinearViscoelastic)
def springs_energy(material: LinearViscoelastic, stress: Sym, history: History) -> float:
    arm = read(history)
    spring = deviator(stress) - arm
    shear = 0.0
    if material.shear_long > 0.0:
        shear += 0.25 / material.shear_long * contract(spring, spring)  # the quotient is the same for all points
    if material.shear_maxwell > 0.0:
        shear += 0.25 / material.shear_maxwell * contract(arm, arm)
    return shear


@inline
def mean_decay(x: float) -> float:
    """Return the mean of exp(-s) over 0..x, (1 - exp(-x)) / x, to rounding for every x >= 0."""
    return -math.expm1(-x) / x if x > 0.0 else 1.0


@inline
def mean_square_gain(x: float) -> float:
    """Return the mean of (1 - exp(-s))² over 0..x, divided by x²: the arm's own share of the loss.

    In closed form [x - 2(1 - e^-x) + (1 - e^-2x)/2] / x³, which cancels for small x; there its power series.
    """
    if x > 0.5:
        return (x + 2.0 * math.expm1(-x) - 0.5 * math.expm1(-2.0 * x)) / (x * x * x)
    total = 0.0
    power = -1.0 / 6.0  # (-1)^k x^(k-3) / k!, from k = 3
    doubling = 4.0  # 2^(k-1)
    for k in range(3, 24):
        total += (2.0 - doubling) * power
        power *= -x / (k + 1)
        doubling *= 2.0
    return total
