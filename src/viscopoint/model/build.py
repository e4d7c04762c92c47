"""From a case to something that can be advanced in time."""

from typing import NamedTuple

from viscopoint.case.case import Case
from viscopoint.errors import InputError
from viscopoint.kernels.jit import check_ready
from viscopoint.materials import Law
from viscopoint.model import memory
from viscopoint.model.body import Body
from viscopoint.model.method import Method


class Model(NamedTuple):
    """A body of a material on its way to the wall, and the method that moves it."""

    case: Case  # with all that it leaves to be derived spelt out
    body: Body
    law: Law
    method: Method

    @property
    def mass(self) -> float:
        """The mass of the body that is computed [g]."""
        return self.law.density * float(self.body.volume.sum())

    @property
    def mass_error(self) -> float:
        """How much heavier the body is than the rod of the case, as a share of the rod's mass."""
        return self.mass / (self.law.density * self.case.rod.volume) - 1.0


def build(case: Case) -> Model:
    """Return the model of a case at its start.

    Where no kernel can run, ``jit.check_ready`` says why.

    Raises:
        InputError: a run of it would not fit into memory, or its points or elements have not the rod's mass.
    """
    check_ready()
    need = case.method.need(case.rod)
    memory.check(need, memory.free())
    law, case = case.material.build(), case.resolved()
    try:
        method = case.method.build(case.rod, case.impact, law)
    except MemoryError:  # somebody else took it, or a limit that nobody could see was met
        raise InputError(f"{need.key}: {need.what}: there was no memory left; {need.advice}") from None
    model = Model(case, method.body, law, method)
    most = case.guards.mass_error
    if abs(model.mass_error) > most:
        raise InputError(
            f"{need.key}: {mass_in_words(model)} (guards.mass_error allows {100 * most:g} %); take {case.method.finer}"
        )
    return model


def mass_in_words(model: Model) -> str:
    """Say what the mass of the body that is computed is, and how far it is off."""
    rod = model.law.density * model.case.rod.volume
    return f"the computed mass, {model.mass:.4g} g, is {100 * model.mass_error:+.2g} % off that of the rod, {rod:.4g} g"
