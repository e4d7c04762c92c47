from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import viscopoint as vp
from viscopoint.case.tables import Guards
from viscopoint.model.callbacks import Callback
from viscopoint.model.energy_balance import Row
from viscopoint.model.guards import GuardError, check_row, check_step
from viscopoint.model.method import FailureHints, Totals
from viscopoint.model.simulation import Simulation

METHOD: Any = SimpleNamespace(
    failure_hints=FailureHints._make(["because"] * 6 + ["points lost"]), limiting_element=lambda: "element 7 is thin"
)
START: Any = Totals.of_flat([100.0, *[0.0] * 14, 1.0])
REFERENCE: Any = SimpleNamespace(energy=START.kinetic, of="the initial kinetic energy")
ROW = Row._make([0] * len(Row._fields))._replace(time=0.0123, numerical=1.0)


def at_step(step: float) -> Any:
    return SimpleNamespace(**vars(METHOD), stable_step=lambda: step)


def test_a_sound_row_passes():
    check_row(ROW, START, REFERENCE, Guards(), METHOD)
    check_step(0.0, 1.0, Guards(), at_step(0.5))


@pytest.mark.parametrize("name", ["kinetic", "length", "wall_force"])
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_what_is_not_finite_is_named_with_time_and_cause(name: str, value: float):
    with pytest.raises(GuardError, match=rf"t = 12.3 us: {name} is not finite. Likely cause"):
        check_row(ROW._replace(**{name: value}), START, REFERENCE, Guards(), METHOD)


@pytest.mark.parametrize("missing", [5.1, -5.1])
def test_an_open_energy_balance_stops(missing: float):
    with pytest.raises(GuardError, match=r"5\.1 % of the initial kinetic energy \(guards.energy_error allows 5 %\)"):
        check_row(ROW._replace(numerical=missing), START, REFERENCE, Guards(), METHOD)
    check_row(ROW._replace(numerical=missing), START, REFERENCE, Guards(energy_error=0.06), METHOD)


def test_losses_excuse_lengths_up_to_the_limit():
    lossy = ROW._replace(numerical=0.0, lost=3, lost_mass=0.009, length=float("nan"))
    check_row(lossy, START, REFERENCE, Guards(), METHOD)
    with pytest.raises(GuardError, match=r"3 points lost, 1.1 % of the mass \(guards.lost_share allows 1 %\)"):
        check_row(lossy._replace(lost_mass=0.011), START, REFERENCE, Guards(), METHOD)
    with pytest.raises(GuardError, match=r"and 1\.1 % of the initial kinetic energy"):
        check_row(lossy._replace(eroded=1.1), START, REFERENCE, Guards(), METHOD)
    with pytest.raises(GuardError, match="velocity is not finite"):
        check_row(lossy._replace(velocity=float("nan")), START, REFERENCE, Guards(), METHOD)


def test_hourglassing_beyond_the_limit_stops():
    check_row(ROW._replace(hourglass_share=9.9), START, REFERENCE, Guards(), METHOD)
    with pytest.raises(GuardError, match=r"took 10.1 % of the internal energy \(guards.hourglass_share allows 10 %\)"):
        check_row(ROW._replace(hourglass_share=10.1), START, REFERENCE, Guards(), METHOD)


@pytest.mark.parametrize("step", [0.9e-3, 0.0, float("nan")])
def test_a_collapsed_step_stops(step: float):
    with pytest.raises(GuardError, match=r"t = 12.3 us: the stable step fell to .*; element 7 is thin. Likely cause"):
        check_step(0.0123, 1.0, Guards(), at_step(step))


def test_an_unstable_scheme_is_stopped_not_reported_as_a_result():
    # nodes of nearly no mass run away in USL (Zhang, Chen & Liu 2016, ch. 3): on the paper's lattice it cannot finish
    run = vp.run(vp.Case.load("paper-elastic", {"method.scheme": "usl"}), figures=False)
    assert run.status == "stopped"
    assert "Likely cause" in run.summary["reason"]
    assert len(run.summary["snapshots"]) >= 1
    assert run.history["kinetic"].iloc[0] > 0


def test_points_that_leave_the_box_are_counted():
    # the foot spreads beyond a box that is hardly wider than the rod
    changes = {"method.box.x": ["-4 mm", "4 mm"], "guards.energy_error": 1.0, "guards.lost_share": 1.0}
    with pytest.warns(vp.ResultWarning, match=r"\d+ points left the box, .* % of the mass"):
        run = vp.run(vp.Case.load("paper", changes), figures=False)
    lost = run.summary["snapshots"][-1]["lost"]
    assert lost > 0
    assert run.status == "complete with losses"
    snapshot = run.snapshot(-1)
    assert int(snapshot["lost"].sum()) == lost
    outside = abs(snapshot["position"][:, 0]) >= 4.0
    assert (outside == (snapshot["lost"] == 1)).all()


class Spoils(Callback):
    """Makes a body's velocities no numbers after its second step."""

    def __call__(self, simulation: Simulation) -> None:
        if simulation.step == 2:
            simulation.model.bodies[0].nodes.velocity[:] = np.nan  # pyright: ignore[reportAttributeAccessIssue]


def test_what_is_not_finite_stays_in_the_history_but_is_no_snapshot():
    changes = {"method.spacing": "1.2 mm", "time.end": "4 us", "time.snapshots": {"every": 1}}
    run = vp.run(vp.Case.load("paper", changes, method="tlmpm"), callbacks=[Spoils()])
    assert run.status == "stopped"
    assert "is not finite" in run.results.reason
    assert run.columns["step"].tolist() == [0, 1, 2, 3]
    assert [row.step for row in run.rows] == [0, 1, 2]
    assert run.times.tolist() == run.columns["time"][:3].tolist()
