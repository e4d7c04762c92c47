"""A result without some of its points or elements is none, or says so."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import viscopoint as vp
from viscopoint.command_line.terminal import print_summary
from viscopoint.methods.mpm.fills.lattice import rod_lattice
from viscopoint.model.measurements import Measurements, measure

REBOUND = {
    "method.geometry": "axisymmetric", "method.spacing": "0.76 mm", "method.cell": "1.52 mm",
    "method.shape": "gimp", "method.contact": "gated", "method.fill": "trimmed",
    "impact.speed": "50 m/s", "time.snapshots": [], "guards.energy_error": 1.0,
}  # fmt: skip
NARROW = {"method.box": {"x": ["-5 mm", "5 mm"], "y": ["-5 mm", "5 mm"], "z": ["-0.01 mm", "27 mm"]}}


def rebound(**changes: object) -> vp.Case:
    tables = vp.Case.load("paper-elastic").to_tables()
    tables["method"].pop("box")
    return vp.Case.from_tables(tables).with_(REBOUND | changes)


def test_a_rod_that_rebounds_stays_in_the_box_that_a_case_does_not_give():
    run = vp.run(rebound(**{"time.end": "1 ms"}), figures=False)
    end = run.rows[-1]
    assert (run.status, end.lost) == ("complete", 0)
    # it flew farther than the two lengths that the box once had, and is as long as it was but for its vibration,
    # at most speed over that of the bar wave, 8 %
    assert end.lowest_point > 25.4
    assert end.length == pytest.approx(25.4, rel=0.08)


def test_a_rod_that_leaves_its_box_stops_the_run():
    run = vp.run(rebound(**NARROW, **{"time.end": "1 ms"}), figures=False)
    assert run.status == "stopped"
    assert "points left the box" in run.results.reason
    assert "guards.lost_share allows 1 %" in run.results.reason
    assert "method.box" in run.results.reason


def test_a_run_that_may_lose_points_says_so_and_gives_no_length(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    case = rebound(**NARROW, **{"time.end": "1 ms", "guards.lost_share": 1.0})
    with pytest.warns(vp.ResultWarning, match="points left the box"):
        run = vp.run(case, tmp_path / "run")
    assert run.status == "complete with losses"
    end = run.rows[-1]
    assert end.lost > 0
    mass = run.case.material.density * run.body.volume[run.snapshot(-1)["lost"] > 0].sum()
    assert end.lost_mass == pytest.approx(mass, rel=1e-12)
    assert all(math.isnan(getattr(end, name)) for name in ("length", "highest_point", "widest_point"))
    assert np.isnan(run.columns["length"][run.columns["lost"] > 0]).all()
    assert np.isfinite(run.columns["length"][run.columns["lost"] == 0]).all()
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["snapshots"][-1]["length"] is None
    assert "points left the box" in summary["reason"]
    assert len(list((tmp_path / "run" / "figures").iterdir())) == 4
    print_summary(run)
    shown = capsys.readouterr().out
    last = next(line for line in shown.splitlines() if line.split()[:1] == ["1000"])
    assert last.split()[1] == "-"  # length
    assert "complete with losses" in shown
    assert "WARNING: " in shown


@pytest.mark.parametrize(
    ("lost", "unknown"),
    [
        ("ring", {"contact_radius", "impact_face_radius", "greatest_radius"}),
        ("tail", {"length"}),
        ("foot", {"length", "contact_radius"}),
        ("inner", set()),
    ],
)
def test_a_length_whose_points_are_gone_is_not_a_number(lost: str, unknown: set[str]):
    body = rod_lattice(3.0, 10.0, 0.5)
    surface, position = body.surface, body.position.copy()
    inner = np.setdiff1d(surface.impact_face[:, 0], surface.ring)
    place = {
        "ring": surface.ring[5, 0],
        "tail": np.setdiff1d(surface.rear_face[:, 0], surface.ring)[0],
        "foot": inner[0],
        "inner": np.flatnonzero((np.hypot(*position[:, :2].T) < 1.0) & (np.abs(position[:, 2] - 5.0) < 1.0))[0],
    }[lost]
    position[place] = np.nan
    found = measure(surface, position)
    extremes = {"lowest_point", "highest_point", "widest_point"}  # of all points
    for name in Measurements._fields:
        assert math.isnan(getattr(found, name)) == (name in unknown | extremes), name


def test_elements_are_not_deleted_by_the_dozen_without_a_word():
    case = vp.Case.load("paper", {"time.end": "40 us", "time.snapshots": []}, method="fem")
    run = vp.run(case.with_({"method.delete_below": 0.9}), figures=False)
    assert run.status == "stopped"
    assert "elements deleted, 1" in run.results.reason
    assert "guards.lost_share allows 1 %" in run.results.reason
    assert run.rows[-1].lost_mass > 0.01 * run.results.mass
