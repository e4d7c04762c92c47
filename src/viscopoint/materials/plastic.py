"""J2 plasticity with linear isotropic hardening, by radial return, on top of a material that is linear in shear.

The base material predicts the stress; where its von Mises value exceeds the yield stress, the excess strain is plastic
and the base material advances by the rest (Wilkins 1964; Simo & Hughes 1998, box 3.1). As the base material makes that
step itself, spring and Maxwell arm share the return as their moduli over the step do.
"""

from typing import Any, Literal, NamedTuple

from viscopoint import materials
from viscopoint.case.tables import MaterialInput
from viscopoint.case.units import Modulus, PositiveModulus
from viscopoint.kernels.jit import generic, implements
from viscopoint.kernels.tensors import Sym, contract, deviator, von_mises
from viscopoint.materials import History, HistoryField, Increment, Response
from viscopoint.materials.elastic import Elastic, ElasticModuli
from viscopoint.materials.linear_viscoelastic import LinearViscoelastic, MaxwellStep, ViscoelasticModuli


class Plastic(NamedTuple):
    """A base material that yields; the history is the base's and the equivalent plastic strain."""

    base: Any  # ``Elastic`` or ``LinearViscoelastic``
    yield_stress: float  # Y, MPa
    hardening: float  # H, MPa

    @property
    def density(self) -> float:
        return self.base.density

    @property
    def p_wave_modulus(self) -> float:
        return self.base.p_wave_modulus

    @property
    def history_fields(self) -> tuple[HistoryField, ...]:
        return (*self.base.history_fields, HistoryField("plastic_strain"))


class Yielding(MaterialInput):
    """The keys a plastic material adds to its base's."""

    yield_stress: PositiveModulus
    hardening: Modulus = 0.0


class ElasticPlasticInput(ElasticModuli, Yielding):
    """``law = "elastic-plastic"``."""

    law: Literal["elastic-plastic"]

    def build(self) -> Plastic:
        return Plastic(self.elastic(), self.yield_stress, self.hardening)


class ViscoelasticPlasticInput(ViscoelasticModuli, Yielding):
    """``law = "linear-viscoelastic-plastic"``."""

    law: Literal["linear-viscoelastic-plastic"]

    def build(self) -> Plastic:
        return Plastic(self.viscoelastic(), self.yield_stress, self.hardening)


@generic
def shear_over_step(base: Any, factors: Any) -> float:
    """Return G such that a step's deviatoric strain adds 2 G times itself to the stress of ``base`` [MPa]."""
    raise NotImplementedError


@implements(shear_over_step, Elastic)
def elastic_shear(base: Elastic, factors: Any) -> float:
    return base.shear


@implements(shear_over_step, LinearViscoelastic)
def viscoelastic_shear(base: LinearViscoelastic, factors: MaxwellStep) -> float:
    return base.shear_long + base.shear_maxwell * factors.mean_relaxation


@implements(materials.step_factors, Plastic)
def base_factors(material: Plastic, dt: float) -> Any:
    return materials.step_factors(material.base, dt)


@implements(materials.update_stress, Plastic)
def radial_return(material: Plastic, factors: Any, increment: Increment, stress: Sym, history: History) -> Response:
    base, plastic = material.base, history[-1]
    trial = materials.update_stress(base, factors, increment, stress, history[:-1])
    size = von_mises(trial.stress)
    excess = size - (material.yield_stress + material.hardening * plastic)
    loss = trial.dissipated
    if excess > 0.0:
        growth = excess / (3.0 * shear_over_step(base, factors) + material.hardening)
        flow = (1.5 * growth / size) * deviator(trial.stress)  # plastic strain increment, along the trial stress
        i = increment
        rest = Increment(i.dt, i.strain - flow, i.rotation, i.jacobian, i.deformation)
        trial = materials.update_stress(base, factors, rest, stress, history[:-1])
        # the mean stress of the flow works
        loss = trial.dissipated + (contract(trial.stress, flow) - 0.5 * material.hardening * growth * growth)
        plastic += growth
    return Response(trial.stress, (*trial.history, plastic), loss, trial.p_wave_modulus)


@implements(materials.stored_energy, Plastic)
def base_energy(material: Plastic, jacobian: float, stress: Sym, history: History) -> float:
    return materials.stored_energy(material.base, jacobian, stress, history[:-1])


@implements(materials.shear_energy, Plastic)
def base_shear_energy(material: Plastic, stress: Sym, history: History) -> float:
    return materials.shear_energy(material.base, stress, history[:-1])
