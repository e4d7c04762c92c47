"""J2 plasticity with linear isotropic hardening, by radial return, on top of a law that is linear in shear.

The base law predicts the stress; where its von Mises value exceeds the yield stress, the excess strain is plastic and
the base law advances by the rest (Wilkins 1964; Simo & Hughes 1998, box 3.1). As the base law makes that step itself,
spring and Maxwell arm share the return as their moduli over the step do.
"""

from typing import Any, Literal, NamedTuple

from viscopoint.case.tables import Material
from viscopoint.case.units import Modulus, PositiveModulus
from viscopoint.kernels.jit import generic, implements
from viscopoint.kernels.tensors import Matrix, Sym, contract, deviator, von_mises
from viscopoint.materials import History, shear_energy, step_factors, stored_energy, update_stress
from viscopoint.materials.elastic import Elastic, ElasticModuli
from viscopoint.materials.linear_viscoelastic import LinearViscoelastic, MaxwellStep, ViscoelasticModuli


class ElasticPlastic(NamedTuple):
    """Elastic, then J2 plastic; the history is the equivalent plastic strain."""

    density: float  # rho, g/mm^3
    bulk: float  # K, MPa
    shear: float  # G, MPa
    yield_stress: float  # Y, MPa
    hardening: float  # H, MPa

    @property
    def instantaneous_modulus(self) -> float:
        return base_law(self).instantaneous_modulus

    @property
    def history_fields(self) -> tuple[tuple[str, int], ...]:
        return (*base_law(self).history_fields, PLASTIC_STRAIN)


class ViscoelasticPlastic(NamedTuple):
    """Linear viscoelastic, then J2 plastic; the history is the arm's and the equivalent plastic strain."""

    density: float  # rho, g/mm^3
    bulk: float  # K, MPa
    shear_long: float  # G_inf, MPa
    shear_arm: float  # G_0 - G_inf, MPa
    decay: float  # beta, 1/ms
    yield_stress: float  # Y, MPa
    hardening: float  # H, MPa

    @property
    def instantaneous_modulus(self) -> float:
        return base_law(self).instantaneous_modulus

    @property
    def history_fields(self) -> tuple[tuple[str, int], ...]:
        return (*base_law(self).history_fields, PLASTIC_STRAIN)


PLASTIC_STRAIN = ("plastic_strain", 1)


class Yielding(Material):
    """The keys a plastic law adds to its base law."""

    yield_stress: PositiveModulus
    hardening: Modulus = 0.0


class ElasticPlasticInput(ElasticModuli, Yielding):
    """``law = "elastic-plastic"``."""

    law: Literal["elastic-plastic"]

    def build(self) -> ElasticPlastic:
        return ElasticPlastic(*self.elastic(), self.yield_stress, self.hardening)


class ViscoelasticPlasticInput(ViscoelasticModuli, Yielding):
    """``law = "linear-viscoelastic-plastic"``."""

    law: Literal["linear-viscoelastic-plastic"]

    def build(self) -> ViscoelasticPlastic:
        return ViscoelasticPlastic(*self.viscoelastic(), self.yield_stress, self.hardening)


@generic
def base_law(law: Any) -> Any:
    """Return the law below the yield stress."""


@generic
def shear_over_step(base: Any, factors: Any) -> float:
    """Return G such that a step's deviatoric strain adds 2 G times itself to the stress of ``base`` [MPa]."""
    raise NotImplementedError


@implements(base_law, ElasticPlastic)
def elastic(law: ElasticPlastic) -> Elastic:
    return Elastic(law.density, law.bulk, law.shear)


@implements(base_law, ViscoelasticPlastic)
def viscoelastic(law: ViscoelasticPlastic) -> LinearViscoelastic:
    return LinearViscoelastic(law.density, law.bulk, law.shear_long, law.shear_arm, law.decay)


@implements(shear_over_step, Elastic)
def elastic_shear(base: Elastic, factors: Any) -> float:
    return base.shear


@implements(shear_over_step, LinearViscoelastic)
def viscoelastic_shear(base: LinearViscoelastic, factors: MaxwellStep) -> float:
    return base.shear_long + base.shear_arm * factors.gain


def base_factors(law: Any, dt: float) -> Any:
    return step_factors(base_law(law), dt)


def radial_return(
    law: Any, factors: Any, strain: Sym, turn: Matrix, jacobian: float, stress: Sym, history: History
) -> tuple[Sym, History, float]:
    base = base_law(law)
    plastic = history[-1]
    trial, inner, loss = update_stress(base, factors, strain, turn, jacobian, stress, history[:-1])
    size = von_mises(trial)
    excess = size - (law.yield_stress + law.hardening * plastic)
    if excess > 0.0:
        growth = excess / (3.0 * shear_over_step(base, factors) + law.hardening)
        flow = (1.5 * growth / size) * deviator(trial)  # plastic strain increment, along the trial stress
        trial, inner, loss = update_stress(base, factors, strain - flow, turn, jacobian, stress, history[:-1])
        loss += contract(trial, flow) - 0.5 * law.hardening * growth * growth  # the mean stress of the flow works
        plastic += growth
    return trial, (*inner, plastic), loss


def base_energy(law: Any, jacobian: float, stress: Sym, history: History) -> float:
    return stored_energy(base_law(law), jacobian, stress, history[:-1])


def base_shear_energy(law: Any, stress: Sym, history: History) -> float:
    return shear_energy(base_law(law), stress, history[:-1])


for _law in (ElasticPlastic, ViscoelasticPlastic):
    implements(step_factors, _law)(base_factors)
    implements(update_stress, _law)(radial_return)
    implements(stored_energy, _law)(base_energy)
    implements(shear_energy, _law)(base_shear_energy)
