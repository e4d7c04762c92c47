"""From a case to bodies that can be advanced in time."""

from typing import NamedTuple

from viscopoint.case.case import Case
from viscopoint.errors import InputError
from viscopoint.kernels.jit import check_ready
from viscopoint.materials import Material
from viscopoint.model import memory
from viscopoint.model.body import Body
from viscopoint.model.method import Method


class Model(NamedTuple):
    """Bodies on their way, each with the method that moves it and what acts on it; a case describes one, the rod."""

    case: Case  # with all that it leaves to be derived spelt out
    bodies: tuple[Method, ...]

    @property
    def method(self) -> Method:
        """What moves the first body."""
        return self.bodies[0]

    @property
    def body(self) -> Body:
        """Where the first body is at the start."""
        return self.method.body

    @property
    def material(self) -> Material:
        """What the first body is of."""
        return self.method.material

    @property
    def size(self) -> int:
        """Number of elements, or of points where there are none, of all bodies."""
        return sum(len(method.body.cells) or len(method.body.position) for method in self.bodies)

    @property
    def mass(self) -> float:
        """The mass of the first body [g]."""
        return self.material.density * float(self.body.volume.sum())

    @property
    def mass_error(self) -> float:
        """How much heavier the first body is than the rod of the case, as a share of the rod's mass."""
        return self.mass / (self.material.density * self.case.rod.volume) - 1.0


def build(case: Case) -> Model:
    """Return the model of a case at its start.

    Where no kernel can run, ``jit.check_ready`` says why.

    Raises:
        InputError: a run of it would not fit into memory, or its points or elements have not the rod's mass.
    """
    check_ready()
    need = case.method.need(case.rod)
    memory.check(need, memory.free())
    material, case = case.material.build(), case.resolved()
    try:
        method = case.method.build(case.rod, case.impact, material)
    except MemoryError:  # somebody else took it, or a limit that nobody could see was met
        raise InputError(f"{need.key}: {need.what}: there was no memory left; {need.advice}") from None
    model = Model(case, (method,))
    most = case.guards.mass_error
    if abs(model.mass_error) > most:
        raise InputError(
            f"{need.key}: {mass_in_words(model)} (guards.mass_error allows {100 * most:g} %); take {case.method.finer}"
        )
    return model


def mass_in_words(model: Model) -> str:
    """Say what the mass of the body that is computed is, and how far it is off."""
    rod = model.material.density * model.case.rod.volume
    return f"the computed mass, {model.mass:.4g} g, is {100 * model.mass_error:+.2g} % off that of the rod, {rod:.4g} g"
