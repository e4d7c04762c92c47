"""Single precision of what points and elements keep: how far from double it may lead."""

from typing import Any

import numpy as np
import pytest
from columns import one_thread  # noqa: F401
from numpy.testing import assert_allclose, assert_array_equal

from viscopoint.bench.work import MATERIALS
from viscopoint.case.case import Case
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.model.build import build

pytestmark = pytest.mark.usefixtures("one_thread")
SIZES: dict[str, dict[str, str]] = {
    "mpm": {"method.cell": "1 mm", "method.spacing": "0.72 mm"},
    "tlmpm": {"method.spacing": "0.7 mm"},
    "fem": {"method.size": "1.2 mm"},
}
KEPT_DOUBLE = {  # and integers
    "mpm": {"position", "velocity", "jacobian", "alive"},
    "tlmpm": {"reference", "position", "alive"},
    "fem": {"corner", "alive"},
}
each_method = pytest.mark.parametrize("name", sorted(SIZES))
EPS = float(np.finfo(np.float32).eps)
COUNT = 60  # steps; those of MPM take the rod 2 us into the impact, those of the others 10


def rod(name: str, precision: str, **changes: Any) -> Any:
    """Return a coarse rod of the paper before it hits the wall."""
    chosen = {"method.precision": precision, **SIZES[name], **changes}
    return build(Case.load("paper", chosen, method=name)).method


def state_of(method: Any) -> dict[str, Any]:
    """Return the arrays of points or elements."""
    own = method.points if hasattr(method, "points") else method.elements
    every = {**own._asdict(), **own.material._asdict(), **own.shared._asdict()}
    return {name: rows for name, rows in every.items() if name not in ("material", "shared")}


@each_method
def test_impact_in_single_precision_differs_from_double_by_roundings_of_strain_in_each_step(name: str) -> None:
    one, other = rod(name, "double"), rod(name, "single")
    time = 0.0
    for _ in range(COUNT):
        dt = one.stable_step()
        one.advance(dt)
        other.advance(dt)
        time += dt
    # each step rounds strains (F, J) by up to eps / 2, and stresses, which are smaller than modulus * strain, once more
    strain = COUNT * EPS
    stress = one.material.p_wave_modulus * strain
    velocity = stress / (one.material.density * one.sound)
    fields, found = one.snapshot(), other.snapshot()
    assert abs(fields["stress"].values).max() > 10.0  # MPa: the rod has hit the wall
    for field, bound in (("stress", stress), ("velocity", velocity), ("position", velocity * time)):
        assert_allclose(found[field].values, fields[field].values, rtol=0, atol=bound, err_msg=field)


@each_method
def test_a_state_in_single_precision_stays_so_through_steps_outputs_and_a_restart(name: str) -> None:
    method, resumed = rod(name, "single"), rod(name, "single")
    for _ in range(3):
        method.advance(method.stable_step())
    resumed.restore(method.state())
    for values in (state_of(method), state_of(resumed)):
        assert {key for key, rows in values.items() if rows.dtype != np.float32} == KEPT_DOUBLE[name]
    assert method.snapshot()["stress"].values.dtype == np.float32
    dt = method.stable_step()
    method.advance(dt)
    resumed.advance(dt)
    for key, rows in method.state().items():
        assert_array_equal(resumed.state()[key], rows, err_msg=key)


OTHERS: list[tuple[str, dict[str, Any]]] = [
    *(("mpm", {"method.shape": shape, "method.transfer": "apic"}) for shape in SHAPES if shape != "trilinear"),
    *(("mpm", {"method.shape": "gimp", "method.transfer": transfer}) for transfer in ("tpic", "apic")),
    *(("mpm", {"method.scheme": scheme}) for scheme in ("usl", "usf")),
    ("mpm", {"method.contact": "gated", "method.volume": "cell-mean"}),
    ("tlmpm", {"method.volume": "local", "method.shape": "gimp"}),
    ("fem", {"method.element": "selective"}),
    ("fem", {"method.hourglass.form": "viscous"}),
    *((name, {"method.geometry": "axisymmetric"}) for name in SIZES),
    ("fem", {"method.geometry": "axisymmetric", "method.element": "selective"}),
    *((name, {"material": {"law": law, **MATERIALS[law]}}) for name in SIZES for law in MATERIALS),
]


@pytest.mark.long
@pytest.mark.parametrize(("name", "changes"), OTHERS)
def test_every_choice_keeps_its_account_of_energy_in_single_precision(name: str, changes: dict[str, Any]) -> None:
    left = []
    for precision in ("double", "single"):
        method = rod(name, precision, **changes)
        start = method.totals().energy
        for _ in range(20):
            method.advance(method.stable_step())
        left.append(method.totals().energy / start)
    # each of the energies' parts is a sum that each step rounds, as is each stress that does the work
    assert_allclose(left[1], left[0], rtol=0, atol=20 * EPS)
