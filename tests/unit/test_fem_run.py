import json
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from shell import call

import viscopoint as vp
from viscopoint.figures import faces, shapes
from viscopoint.methods.fem.hourglass import StiffnessControl
from viscopoint.methods.fem.inputs import FEMInput
from viscopoint.methods.fem.mesh import point_volumes
from viscopoint.methods.mpm.inputs import MPMInput
from viscopoint.results.output.fields import file_of

SHORT = {"method.size": "1.9 mm", "time.end": "2 us", "time.snapshots": ["1 us"]}
FAST = {"method.size": "1.5 mm", "method.safety": 0.5, "impact.speed": "1000 m/s", "time.snapshots": []}

LOSSES_ALLOWED = {"guards.lost_share": 1.0, "guards.hourglass_share": 1.0}


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> vp.Run:
    return vp.run(vp.Case.load("paper", SHORT, method="fem"), tmp_path_factory.mktemp("runs") / "fem")


@pytest.fixture(scope="module")
def eroded() -> vp.Run:
    """A run so fast that elements are deleted, and which goes on without them."""
    changes = FAST | {"method.delete_below": 0.1, "time.end": "16 us", "time.snapshots": ["4 us"]} | LOSSES_ALLOWED
    with pytest.warns(vp.ResultWarning) as told:
        run = vp.run(vp.Case.load("paper", changes, method="fem"), figures=False)
    assert "elements deleted" in str(told[0].message)
    assert "hourglass control took" in str(told[1].message)
    return run


# --- choosing the method ---


def test_a_case_can_be_run_with_either_method_at_the_same_distance(tmp_path: Path):
    fem = vp.Case.load("paper", method="fem")
    assert isinstance(fem.method, FEMInput)
    assert fem.method.size == 0.38
    file = tmp_path / "fem.toml"
    file.write_text(fem.to_toml())
    back = vp.Case.load(file, method="mpm")
    assert isinstance(back.method, MPMInput)
    assert (back.method.spacing, back.method.cell) == (0.38, 0.76)
    assert vp.Case.load(file, method="fem") == fem
    assert vp.Case.load("paper", method="mpm") == vp.Case.load("paper")


def test_changes_apply_to_the_method_that_was_chosen():
    case = vp.Case.load("paper", {"method.size": "0.76 mm", "method.hourglass.form": "viscous"}, method="fem")
    assert isinstance(case.method, FEMInput)
    assert (case.method.size, case.method.hourglass.form) == (0.76, "viscous")
    with pytest.raises(vp.CaseError, match=r"method\.cell: unknown key"):
        vp.Case.load("paper", {"method.cell": "1 mm"}, method="fem")


def test_the_command_line_chooses_the_method_and_names_the_folder_by_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    short = ("--no-figures", "--set", "time.end=1 us", "--set", "time.snapshots=[]")
    code, out, messages = call("run", "paper", "--method", "fem", "--set", "method.size=1.9 mm", *short)
    assert (code, messages) == (0, "")
    assert "168 elements" in out
    assert "least scaled Jacobian" in out
    kept = tomllib.loads(Path("runs/paper-fem/case.toml").read_text())["method"]
    assert (kept["name"], kept["size"], kept["hourglass"]["coefficient"]) == (
        "fem",
        "1.9 mm",
        StiffnessControl().coefficient,
    )
    again = ("--method", "mpm", "--set", "method.cell=2 mm")
    code, out, messages = call("run", "runs/paper-fem/case.toml", *again, "--out", "back", *short)
    assert (code, messages) == (0, "")
    assert vp.Run("back").case.method.resolution() == 1.9


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--method", "sph"], "method 'sph' is not known; allowed: fem, mpm"),
        (["--method", "fem", "--set", "method.size=4 mm"], "method.size: 4 mm is larger than the rod: rod.radius is"),
        (["--method", "fem", "--set", "method.size=1 um"], "take a larger one"),
        (["--method", "fem", "--set", "rod.length=0.5 mm"], "leaves no two layers of elements in rod.length, 0.5 mm"),
        (
            ["--method", "fem", "--set", 'method.hourglass={form="viscous", coefficient=0.2}'],
            "unstable at method.safety 0.95",
        ),
        (["--method", "fem", "--set", "method.hourglass.form=stiff"], "did you mean 'stiffness'"),
        (["--method", "fem", "--set", "method.element=one"], "allowed: one-point, selective"),
        (["--method", "fem", "--set", "method.grading=0"], "must not be less than 0.01"),
        (
            ["--method", "fem", "--set", "method.grading=100"],
            "method.size: 0.38 mm, graded by 100, makes layers thicker",
        ),
        (["--method", "fem", "--set", "method.mesh_unit=1 m"], "1000 mm has no effect without method.mesh"),
        (["--set", "impact.wall=no-separation"], 'impact.wall: "no-separation" holds the impact face from the start'),
    ],
)
def test_bad_input_gives_one_message_and_code_2_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], message: str
):
    monkeypatch.chdir(tmp_path)
    code, out, messages = call("run", "paper", *words)
    assert (code, out) == (2, "")
    assert message in messages
    assert list(tmp_path.iterdir()) == []


def test_a_rule_on_keys_that_are_left_out_names_its_fault():
    with pytest.raises(vp.CaseError, match=r"1 fault:\n  impact\.wall: .* impact\.gap and impact\.friction must be 0"):
        vp.Case.load("copper-fem", {"impact.friction": 0.1})


def test_what_both_methods_share_is_kept_when_the_method_is_changed(tmp_path: Path):
    own = {"method.bulk_viscosity": {"linear": 0.5, "quadratic": 3.0}}
    (tmp_path / "own.toml").write_text(vp.Case.load("paper", own).to_toml())
    other = vp.Case.load(tmp_path / "own.toml", method="fem")
    assert other.method.bulk_viscosity == vp.Case.load("paper", own).method.bulk_viscosity


def test_schema_describes_both_methods():
    schema = vp.Case.file_schema()
    assert set(schema["properties"]["method"]["discriminator"]["mapping"]) == {"mpm", "fem", "tlmpm"}
    keys = schema["$defs"]["FEMInput"]["properties"]
    assert {"size", "grading", "mesh", "mesh_unit", "element", "hourglass", "delete_below", "safety"} <= set(keys)
    assert keys["element"]["enum"] == ["one-point", "selective"]


# --- what a run leaves ---


def test_the_case_that_a_run_leaves_gives_the_same_run_again(done: vp.Run, tmp_path: Path):
    again = vp.run(vp.Case.load(done.folder / "case.toml"), tmp_path / "again", figures=False)
    assert (again.folder / "case.toml").read_text() == (done.folder / "case.toml").read_text()
    assert (again.folder / "history.csv").read_text() == (done.folder / "history.csv").read_text()


def test_fields_open_in_vtk_as_hexahedra_of_the_right_volume(done: vp.Run):
    assert len(done.times) == 3
    start = point_volumes(done.body.position, done.body.cells).sum(axis=1)
    for number in range(len(done.times)):
        mesh: Any = pyvista.read(file_of(done.folder, number))
        snapshot = done.snapshot(number)
        assert np.array_equal(mesh.points, snapshot["position"])
        assert np.array_equal(mesh.cells_dict[pyvista.CellType.HEXAHEDRON], done.body.cells)
        assert mesh.n_cells == len(done.body.cells)
        for name, field in snapshot.fields.items():
            data = mesh.cell_data if field.on == "cells" else mesh.point_data
            assert name == "position" or np.array_equal(data[name], field.values), name
        volume = mesh.compute_cell_sizes()["Volume"]
        if number == 0:
            assert volume == pytest.approx(start, rel=1e-12)
        # VTK cuts hexahedra into tetrahedra, which matters where faces are warped
        assert volume == pytest.approx(snapshot["jacobian"] * start, rel=1e-2)
        assert volume.sum() == pytest.approx((snapshot["jacobian"] * start).sum(), rel=1e-4)


def test_summary_and_provenance_speak_of_elements(done: vp.Run):
    summary = json.loads((done.folder / "summary.json").read_text())
    assert (summary["points"], summary["elements"]) == (len(done.body.position), len(done.body.cells))
    assert 0.7 < summary["mesh"]["least_scaled_jacobian"] <= 1.0
    history = done.history
    terms = [
        "kinetic",
        "stored",
        "dissipated",
        "hypoelastic",
        "viscous",
        "hourglass",
        "eroded",
        "contact",
        "friction",
        "numerical",
    ]
    assert np.allclose(history[terms].sum(axis=1), history["kinetic"].iloc[0], rtol=1e-12)


# --- a mesh that tangles ---


def test_a_tangled_mesh_stops_with_element_place_time_and_hints(tmp_path: Path):
    # five times the speed of sound
    changes = {"method.size": "1.9 mm", "impact.speed": "4000 m/s", "time.snapshots": []}
    words = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]
    code, out, messages = call("run", "paper", "--method", "fem", "--out", tmp_path / "run", *words)
    assert (code, messages) == (1, "")
    told = " ".join(out.split())
    assert "INCOMPLETE (stopped at t = " in told
    assert re.search(r"element \d+, at \(\S+, \S+, \S+\) mm, is turned inside out", told)
    for hint in ("method.size", "smaller impact speed", "method.delete_below", "material point method"):
        assert hint in told
    run = vp.Run(tmp_path / "run")
    assert run.status == "stopped"
    assert len(run.times) == len(run.rows) == 2
    assert len(run.history) == run.results.steps + 1
    assert len(list((tmp_path / "run" / "figures").iterdir())) == 4


def test_the_last_state_of_a_stopped_run_has_its_own_time(tmp_path: Path):
    changes = {"method.size": "1.9 mm", "impact.speed": "4000 m/s", "output.history": {"every": "0.9 us"}}
    run = vp.run(vp.Case.load("paper", changes, method="fem"), tmp_path / "run", figures=False)
    assert run.status == "stopped"
    # the tail has not felt the wall yet: it tells the time
    tail = run.snapshot(-1)["displacement"][run.body.surface.rear_face[:, 0], 2].mean()
    assert run.times[-1] == pytest.approx(-tail / 4000.0, rel=1e-9)
    assert run.history["time"].iloc[-1] == run.times[-1]


def test_with_deletion_the_run_goes_on_and_counts(eroded: vp.Run):
    assert eroded.status == "complete with losses"
    assert [row.lost for row in eroded.rows][:2] == [0, 0]
    last, deleted = eroded.rows[-1], eroded.snapshot(-1)["deleted"]
    assert last.lost == np.count_nonzero(deleted) > 0
    assert last.eroded > 0.0
    assert abs(last.numerical) < 0.02 * eroded.rows[0].kinetic
    attached = np.isin(np.arange(len(eroded.body.position)), eroded.body.cells[deleted == 0])
    assert np.array_equal(eroded.snapshot(-1)["lost"] == 0, attached)
    assert (np.diff(eroded.history["lost"]) >= 0).all()


# --- how it looks ---


def shown_area(run: vp.Run, number: int, shown: Any, tilt: float) -> float:
    """Return the area of all faces that are drawn [mm^2]."""
    snapshot, axis = run.snapshot(number), Figure().subplots()
    faces.paint(axis, run, snapshot, shown(run, snapshot), shapes.seen(snapshot["position"], tilt), Normalize())
    corner = np.array([np.asarray(path.vertices)[:4] for path in axis.collections[0].get_paths()])
    (x, y), (u, v) = (corner[:, 2] - corner[:, 0]).T, (corner[:, 3] - corner[:, 1]).T
    return float(abs(x * v - y * u).sum()) / 2


def test_a_rod_is_drawn_as_its_silhouette(done: vp.Run):
    # what is turned away is not drawn, and a convex body covers its silhouette once
    section, end = 2 * done.body.surface.start[0] * 25.4, done.body.volume.sum() / 25.4
    assert shown_area(done, 0, faces.outside, 0.0) == pytest.approx(section)
    assert shown_area(done, 0, faces.cut_open, 0.0) == pytest.approx(section)
    tilted = section * np.cos(0.3) + end * np.sin(0.3)
    assert shown_area(done, 0, faces.outside, 0.3) == pytest.approx(tilted)


def test_deleted_elements_are_not_drawn(eroded: vp.Run, tmp_path: Path):
    snapshot = eroded.snapshot(-1)
    drawn = np.unique(faces.outside(eroded, snapshot))
    assert not snapshot["lost"][drawn].any()
    assert len(eroded.draw(tmp_path / "figures")) == 4
    snapshot.fields["deleted"].values[:] = 1
    axis = Figure().subplots()
    none = faces.cut_open(eroded, snapshot)
    faces.paint(axis, eroded, snapshot, none, shapes.seen(snapshot["position"], 0.0), Normalize(0.0, 1.0))
    assert len(axis.collections[0].get_paths()) == 0
