"""Solids of users: what those of the tests have in common, as one would write it beside the package."""

from collections.abc import Callable
from typing import Any

from viscopoint.kernels.jit import implements, inline
from viscopoint.kernels.tensors import Sym, contract, deviator, rotated
from viscopoint.materials import (
    History,
    Increment,
    shear_energy,
    step_factors,
    stored_energy,
    update_stress,
    volume_and_shear_energy,
)


@inline
def sheared(material: Any, increment: Increment, stress: Sym) -> Sym:
    """Return the deviator of the stress of an elastic solid at the end of the step."""
    return rotated(deviator(stress), increment.rotation) + 2.0 * material.shear * deviator(increment.strain)


def spring_energy(material: Any, stress: Sym, history: History) -> float:
    """Return what elastic shear stores."""
    shape = deviator(stress)
    return 0.25 / material.shear * contract(shape, shape)


def no_factors(material: Any, dt: float) -> float:
    """Return nothing of a step."""
    return 0.0


def solid(
    subject: type, stress: Callable[..., Any], stored: Callable[..., Any] = volume_and_shear_energy,
    shear: Callable[..., Any] = spring_energy,
) -> None:  # fmt: skip
    """Let a class be a material by its stress and, if they are not those of an elastic solid, its energies."""
    for operation, function in (
        (step_factors, no_factors), (update_stress, stress), (stored_energy, stored), (shear_energy, shear)
    ):  # fmt: skip
        implements(operation, subject)(function)
