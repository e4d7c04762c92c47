"""From a case to something that can be advanced in time."""

from typing import NamedTuple

from viscopoint.body import Body
from viscopoint.case import Case
from viscopoint.laws import Law
from viscopoint.method import Method


class Model(NamedTuple):
    """A body of a material on its way to the wall, and the method that moves it."""

    case: Case
    body: Body
    law: Law
    method: Method


def build(case: Case) -> Model:
    """Return the model of a case at its start."""
    law = case.material.build()
    method = case.method.build(case.rod, case.impact, law)
    return Model(case, method.body, law, method)
