from pathlib import Path

import numpy as np
import pytest
from shell import call

import viscopoint as vp
from viscopoint.comparison import compare
from viscopoint.methods.tlmpm.inputs import TotalLagrangianInput
from viscopoint.report.scene import scene_of

SHORT = {"method.spacing": "0.95 mm", "method.cell": "1.9 mm", "time.end": "2 us", "time.snapshots": ["1 us"]}


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> vp.Run:
    return vp.run(vp.Case.load("paper", SHORT, method="tlmpm"), tmp_path_factory.mktemp("runs") / "tlmpm")


def test_a_case_runs_with_it_at_its_own_distance(tmp_path: Path):
    case = vp.Case.load("paper", method="tlmpm")
    assert isinstance(case.method, TotalLagrangianInput)
    assert (case.method.spacing, case.method.cell) == (0.38, 0.76)
    file = tmp_path / "case.toml"
    file.write_text(case.resolved().to_toml())
    assert vp.Case.load(file) == vp.Case.load(file, method="tlmpm") == case.resolved()
    fem = vp.Case.load(file, method="fem").method
    assert fem.resolution() == 0.38
    assert vp.Case.load("copper", method="tlmpm").method.resolution() == 0.32


@pytest.mark.parametrize(("changes", "told"), [
    (["method.cell=1 mm"], "method.cell: 1 mm is 2.632 times method.spacing, 0.38 mm; points that fill cells evenly"),
    (["method.cell=0.38 mm"], "need a whole number of them, 2 or more"),
    (["method.cell=3.04 mm"], "method.cell: 3.04 mm leaves no whole cells in the rod: rod.radius is 3.8 mm"),
    (["method.cell=7.6 mm"], "is larger than the rod: rod.radius is 3.8 mm"),
    (["rod.length=1 mm", "method.layers=2"], "method.spacing: 0.38 mm, 2 to a cell, leaves no two cells in rod.length"),
    (["method.spacing=1 um", "method.cell=2 um"], "take a larger one"),
    (["method.shape=quadratic"], "allowed: gimp, trilinear"),
    (["method.fill=trim"], "did you mean 'trimmed'"),
    (["method.scheme=musl"], "unknown key"),
])  # fmt: skip
def test_faults_are_told_with_key_value_and_what_is_allowed(changes: list[str], told: str, tmp_path: Path):
    words = [word for change in changes for word in ("--set", change)]
    code, _, messages = call("run", "paper", "--method", "tlmpm", "--out", tmp_path / "run", *words)
    assert code == 2
    assert told in " ".join(messages.split())
    assert not (tmp_path / "run").exists()


def test_an_undeformed_rod_measures_what_the_case_says(done: vp.Run):
    start = done.rows[0]
    assert (start.length, start.impact_face_radius, start.greatest_radius) == pytest.approx((25.4, 3.8, 3.8), rel=1e-12)
    assert (start.lowest_point, start.highest_point, start.widest_point) == pytest.approx((0.0, 25.4, 3.8), abs=1e-12)
    energy = 0.5 * 1e-3 * np.pi * 3.8**2 * 25.4 * 150.0**2
    assert start.kinetic == pytest.approx(energy, rel=1e-12)


def test_a_run_leaves_the_same_folder_as_any(done: vp.Run):
    assert done.status == "complete"
    assert done.times == pytest.approx([0.0, 1e-3, 2e-3])
    last = done.snapshot(-1)
    for name in ("position", "displacement", "velocity", "stress", "jacobian", "maxwell_stress", "lost"):
        assert len(last[name]) == len(done.body.position)
    assert len(list((done.folder / "figures").iterdir())) == 4
    terms = ["kinetic", "stored", "dissipated", "hypoelastic", "viscous", "contact", "friction", "numerical"]
    assert np.allclose(done.history[terms].sum(axis=1), done.history["kinetic"].iloc[0], rtol=1e-12)
    assert done.rows[-1].lowest_point == pytest.approx(-0.01, abs=1e-10)  # mm, on the wall


def test_it_is_compared_and_reported_like_any(done: vp.Run, tmp_path: Path):
    fem = vp.run(vp.Case.load("paper", {"method.size": "1.9 mm", "time.end": "2 us", "time.snapshots": ["1 us"]},
                              method="fem"), tmp_path / "fem", figures=False)  # fmt: skip
    fem_state, state = compare([fem, done]).states[-1]
    assert fem_state.row.velocity == pytest.approx(
        state.row.velocity, abs=3.0
    )  # of 150 m/s; waves have passed two cells
    assert state.axial_velocity < 15.0  # the front is a cell or two wide
    assert len(scene_of({("soft", "FEM"): fem, ("soft", "TLMPM"): done}).shapes) == 2
