"""``method.geometry = "axisymmetric"`` of the material point methods as a case chooses it."""

import pytest

import viscopoint as vp
from viscopoint.errors import CaseError
from viscopoint.model.build import build
from viscopoint.model.simulation import Simulation

ROUND = {"method.geometry": "axisymmetric"}


def test_paper_s_case_changes_by_one_key():
    model = build(vp.Case.load("paper", ROUND))
    assert model.body.position.shape == (670, 3)  # 10 x 67
    assert model.method.totals().mass == pytest.approx(1e-3 * 3.141592653589793 * 3.8**2 * 67 * 0.38, rel=1e-12)
    assert model.method.stable_step() == pytest.approx(build(vp.Case.load("paper")).method.stable_step(), rel=1e-12)


@pytest.mark.parametrize(("changes", "method", "length"), [
    ({}, "tlmpm", 25.4),
    ({"method.spacing": "0.3 mm", "method.cell": "0.9 mm"}, "tlmpm", 25.4),  # cells that divide the radius: 0.95 mm
    ({"method.fill": "rings"}, "mpm", 25.4),
    ({"method.spacing": "3 mm", "method.cell": "3.5 mm", "method.fill": "rings"}, "mpm", 25.4),  # one ring
    ({}, "mpm", 67 * 0.38),
])  # fmt: skip
def test_an_undeformed_rod_measures_what_the_case_says(changes: dict[str, str], method: str, length: float):
    simulation = Simulation(build(vp.Case.load("paper", changes, method=method).with_(ROUND)))
    start = simulation.balances[0].start
    row = simulation.balances[0].row(0.0, 0, 0.0)
    assert (row.length, row.impact_face_radius, row.greatest_radius) == pytest.approx((length, 3.8, 3.8), rel=1e-12)
    assert start.mass == pytest.approx(1e-3 * 3.141592653589793 * 3.8**2 * length, rel=1e-12)
    assert start.kinetic == pytest.approx(0.5 * start.mass * 150.0**2, rel=1e-12)
    assert tuple(start.momentum) == pytest.approx((0.0, 0.0, -150.0 * start.mass), rel=1e-12)


@pytest.mark.parametrize(("changes", "method", "told"), [
    ({"method.fill": "rings"}, "tlmpm", '"rings" fills a circle; with method.geometry = "axisymmetric" boxes fit'),
    ({"method.geometry": "round"}, "mpm", "is not known; allowed: 3d, axisymmetric"),
])  # fmt: skip
def test_faults_are_told_with_key_value_and_what_is_allowed(changes: dict[str, str], method: str, told: str):
    with pytest.raises(CaseError) as caught:
        vp.Case.load("paper", ROUND | changes, method=method)
    assert told in str(caught.value)
