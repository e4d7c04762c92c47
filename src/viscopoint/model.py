"""From a case to something that can be advanced in time."""

from typing import NamedTuple

from viscopoint import memory
from viscopoint.body import Body
from viscopoint.case import Case
from viscopoint.errors import InputError
from viscopoint.laws import Law
from viscopoint.method import Method


class Model(NamedTuple):
    """A body of a material on its way to the wall, and the method that moves it."""

    case: Case
    body: Body
    law: Law
    method: Method


def build(case: Case) -> Model:
    """Return the model of a case at its start; raise ``InputError`` if a run of it would not fit into memory."""
    need = case.method.need(case.rod)
    memory.check(need, memory.free())
    law = case.material.build()
    try:
        method = case.method.build(case.rod, case.impact, law)
    except MemoryError:  # somebody else took it, or a limit that nobody could see was met
        raise InputError(f"{need.key}: {need.what}: there was no memory left; {need.advice}") from None
    return Model(case, method.body, law, method)
