"""Isotropic elastic solid: hypoelastic shear with the Jaumann rate, p = -K ln J."""

from typing import Literal, NamedTuple

from viscopoint import materials
from viscopoint.case.tables import MaterialInput
from viscopoint.case.units import Density, Modulus, PositiveModulus
from viscopoint.kernels.jit import implements
from viscopoint.kernels.logarithm import log
from viscopoint.kernels.tensors import Sym, contract, deviator, rotated, spherical
from viscopoint.materials import History, Increment, Response, p_wave_modulus


class Elastic(NamedTuple):
    """Parameters; no history."""

    density: float  # rho, g/mm^3
    bulk: float  # K, MPa
    shear: float  # G, MPa

    history_fields = ()

    @property
    def p_wave_modulus(self) -> float:
        return p_wave_modulus(self.bulk, self.shear)


class ElasticModuli(MaterialInput):
    """The keys of an elastic solid."""

    density: Density
    bulk: PositiveModulus
    shear: Modulus

    def elastic(self) -> Elastic:
        return Elastic(self.density, self.bulk, self.shear)


class ElasticInput(ElasticModuli):
    """``law = "elastic"``."""

    law: Literal["elastic"]

    def build(self) -> Elastic:
        return self.elastic()


@implements(materials.step_factors, Elastic)
def none(material: Elastic, dt: float) -> float:
    return 0.0


@implements(materials.update_stress, Elastic)
def update(material: Elastic, factors: float, increment: Increment, stress: Sym, history: History) -> Response:
    shape = rotated(deviator(stress), increment.rotation) + 2.0 * material.shear * deviator(increment.strain)
    stress = shape + spherical(material.bulk * log(increment.jacobian))
    return Response(stress, history, 0.0, p_wave_modulus(material.bulk, material.shear))


implements(materials.stored_energy, Elastic)(materials.volume_and_shear_energy)


@implements(materials.shear_energy, Elastic)
def spring_energy(material: Elastic, stress: Sym, history: History) -> float:
    shape = deviator(stress)
    return 0.25 / material.shear * contract(shape, shape) if material.shear > 0.0 else 0.0
