"""Isotropic elastic solid: hypoelastic shear with the Jaumann rate, p = -K ln J."""

from typing import Literal, NamedTuple

from viscopoint.case.tables import Material
from viscopoint.case.units import Density, Modulus, PositiveModulus
from viscopoint.kernels.jit import implements
from viscopoint.kernels.logarithm import log
from viscopoint.kernels.tensors import Matrix, Sym, contract, deviator, rotated, spherical
from viscopoint.materials import History, shear_energy, step_factors, stored_energy, update_stress, volumetric_energy


class Elastic(NamedTuple):
    """Parameters; no history."""

    density: float  # rho, g/mm^3
    bulk: float  # K, MPa
    shear: float  # G, MPa

    @property
    def instantaneous_modulus(self) -> float:
        return self.bulk + 4 * self.shear / 3

    @property
    def history_fields(self) -> tuple[tuple[str, int], ...]:
        return ()


class ElasticModuli(Material):
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


@implements(step_factors, Elastic)
def nothing(law: Elastic, dt: float) -> float:
    return dt


@implements(update_stress, Elastic)
def update(
    law: Elastic, factors: float, strain: Sym, turn: Matrix, jacobian: float, stress: Sym, history: History
) -> tuple[Sym, History, float]:
    shape = rotated(deviator(stress), turn) + 2.0 * law.shear * deviator(strain)
    return shape + spherical(law.bulk * log(jacobian)), history, 0.0


@implements(stored_energy, Elastic)
def energy(law: Elastic, jacobian: float, stress: Sym, history: History) -> float:
    return volumetric_energy(law.bulk, jacobian, log(jacobian)) + jacobian * shear_energy(law, stress, history)


@implements(shear_energy, Elastic)
def spring_energy(law: Elastic, stress: Sym, history: History) -> float:
    shape = deviator(stress)
    return 0.25 / law.shear * contract(shape, shape) if law.shear > 0.0 else 0.0
