import json
import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
from vtkmodules.vtkIOHDF import vtkHDFReader

import viscopoint as vp
from viscopoint.model.schedule import Schedule
from viscopoint.results import vtkhdf
from viscopoint.results.reader import Snapshot
from viscopoint.results.verify import TIMED, UNKNOWN, compare_bits


def test_snapshots_are_hit_exactly(finished: Path):
    run = vp.Run(finished)
    assert run.times.tolist() == [0.0, 0.001, 0.002]
    assert run.history["time"].iloc[-1] == 0.002
    assert 0.001 in set(run.history["time"])
    assert run.snapshot("1 us").time == 0.001
    assert run.snapshot(-1).time == 0.002
    with pytest.raises(vp.InputError, match="no snapshot at"):
        run.snapshot("1.5 us")
    with pytest.raises(vp.InputError, match="write a time"):
        run.snapshot("1.5")
    with pytest.raises(vp.InputError, match="no snapshot 99"):
        run.snapshot(99)


def test_a_snapshot_is_found_by_its_time_as_it_is_shown(tmp_path: Path, quick: vp.Case):
    times = ["0.1000034 us", "0.3686168449 us", "0.36861689 us"]
    case = quick.with_({"time.end": "0.7000016 us", "time.snapshots": times})
    run = vp.run(case, tmp_path / "run", figures=False)
    with pytest.raises(vp.InputError, match=r"there are 0 us, 0\.100003 us, 0\.368617 us, 0\.368617 us, 0\.700002 us"):
        run.snapshot("0.5 us")
    assert run.snapshot("0.100003 us").time == 0.1000034e-3
    assert run.snapshot("0.700002 us").time == 0.7000016e-3
    for number, text in enumerate(times, 1):  # of those that look alike, the nearest
        assert run.snapshot(text).time == run.times[number]
    for near in ("0.10001 us", "0.36862 us", "0.7 us"):
        with pytest.raises(vp.InputError, match="no snapshot at"):
            run.snapshot(near)


def test_a_snapshot_reads_only_the_fields_that_are_wanted(finished: Path):
    run = vp.Run(finished)
    some, whole = run.snapshot(-1, only=("position", "stress", "deleted")), run.snapshot(-1)
    assert set(some.fields) == {"position", "stress"}  # material points are never deleted
    assert all(np.array_equal(some[name], whole[name]) for name in some.fields)


def test_a_run_tells_what_it_begins(quick: vp.Case, tmp_path: Path):
    told: list[str] = []
    vp.run(quick, tmp_path / "run", tell=told.append)
    assert [words.split()[0] for words in told] == ["building", "starting;", "drawing"]


def test_history_has_a_unit_for_every_column(finished: Path):
    header = (finished / "history.csv").read_text().splitlines()[0]
    assert header.startswith("time [ms],step [1],time_step [ms],length [mm]")
    history = vp.Run(finished).history
    assert history.attrs["units"]["wall_impulse"] == "N ms"
    assert history["step"].tolist() == list(range(len(history)))


def test_rows_of_the_energy_balance_close(finished: Path):
    history = vp.Run(finished).history
    terms = ["kinetic", "stored", "dissipated", "hypoelastic", "viscous", "contact", "friction", "numerical"]
    total = history[terms].sum(axis=1)
    assert np.allclose(total, total.iloc[0], rtol=1e-12)


def test_wall_force_integrates_to_the_impulse(finished: Path):
    history = vp.Run(finished).history
    summed = (history["wall_force"] * history["time"].diff().fillna(0.0)).cumsum()
    assert np.allclose(summed, history["wall_impulse"], rtol=1e-10, atol=1e-10)


def assert_shows(mesh: Any, snapshot: Snapshot) -> None:
    """Check that a mesh of VTK's has all fields of a snapshot of material points."""
    assert np.array_equal(mesh.points, snapshot["position"])
    for name, field in snapshot.fields.items():
        if name != "position":
            assert np.array_equal(mesh.point_data[name], field.values), name
    assert mesh.n_cells == mesh.n_points


def test_fields_open_in_pyvista_as_a_series_in_time(finished: Path):
    run = vp.Run(finished)
    reader: Any = pyvista.get_reader(finished / "fields.vtkhdf.series")
    assert reader.time_values == run.times.tolist()
    for number, time in enumerate(run.times):
        reader.set_active_time_value(time)
        mesh = reader.read()
        assert_shows(mesh, run.snapshot(number))


def test_fields_open_in_paraview_as_a_series_in_time(finished: Path):
    # ParaView reads the index (JSON: version 1.0, names beside it, times) itself, and gives each file to VTK's reader
    run = vp.Run(finished)
    index = json.loads((finished / "fields.vtkhdf.series").read_text())
    assert index["file-series-version"] == "1.0"
    assert [entry["time"] for entry in index["files"]] == run.times.tolist()
    for number, entry in enumerate(index["files"]):
        reader = vtkHDFReader()
        assert reader.CanReadFile(str(finished / entry["name"]))
        reader.SetFileName(str(finished / entry["name"]))
        reader.Update()
        mesh = pyvista.wrap(reader.GetOutputDataObject(0))
        assert_shows(mesh, run.snapshot(number))
        assert mesh.field_data["TimeValue"].tolist() == [run.times[number]]


def test_fields_are_those_of_the_physics(finished: Path):
    run = vp.Run(finished)
    last = run.snapshot(-1)
    assert {
        "position", "displacement", "velocity", "stress", "von_mises", "pressure", "jacobian",
        "maxwell_stress", "lost",
    } <= set(last.fields)  # fmt: skip
    assert last.fields["stress"].unit == "MPa"
    assert np.allclose(last["position"] - last["displacement"], run.body.position)
    bulk = run.case.material.bulk
    assert np.allclose(last["pressure"], -bulk * np.log(last["jacobian"]), rtol=1e-9, atol=1e-9)
    tensor = np.zeros((len(last["stress"]), 3, 3))
    for column, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]):
        tensor[:, i, j] = tensor[:, j, i] = last["stress"][:, column]
    shape = tensor - np.trace(tensor, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    assert np.allclose(last["von_mises"], np.sqrt(1.5 * (shape**2).sum(axis=(1, 2))))


def test_summary_and_history_agree(finished: Path):
    run = vp.Run(finished)
    rows = {row["time"]: row for row in run.summary["snapshots"]}
    for _, line in run.history[run.history["time"].isin(list(rows))].iterrows():
        for name, value in rows[line["time"]].items():
            assert line[name] == value, name


def test_provenance_says_what_made_the_run(finished: Path):
    provenance = vp.Run(finished).provenance
    assert provenance["format"] == 8
    for key in ("viscopoint", "python", "numpy", "numba", "machine", "threads", "started", "ended"):
        assert provenance[key], key


def test_a_run_of_another_format_is_refused(finished: Path, tmp_path: Path):
    for name in ("provenance.json", "summary.json"):
        (tmp_path / name).write_bytes((finished / name).read_bytes())
    data = json.loads((tmp_path / "provenance.json").read_text())
    (tmp_path / "provenance.json").write_text(json.dumps(data | {"format": 99}))
    with pytest.raises(vp.InputError, match="format 99"):
        vp.Run(tmp_path)


def unpacked(number: int, folder: Path) -> vp.Run:
    """Return a run that is regression data: written by the last version that wrote its format."""
    shutil.unpack_archive(Path(__file__).parent / "older" / f"format-{number}.zip", folder)
    run = vp.Run(folder)
    assert run.provenance["format"] == number
    return run


def test_a_run_of_format_6_is_read_in_present_words_and_on_its_own_mesh(tmp_path: Path):
    older = unpacked(6, tmp_path / "older")
    assert older.case.impact.wall == "no-separation"
    assert older.rows[0].impact_face_radius == pytest.approx(3.8)
    assert math.isnan(older.rows[-1].contact_radius)
    assert np.isnan(older.columns["contact_radius"]).all()
    # its outermost nodes stood on the circumference; now they would stand 5 % further out
    assert np.hypot(*older.body.position[:, :2].T).max() == pytest.approx(3.8, rel=1e-12)
    last = older.snapshot(-1)
    _, radius = older.profile(last)
    assert radius[0] == pytest.approx(older.rows[-1].impact_face_radius, rel=1e-12)
    assert older.draw()
    assert vp.compare([older, older]).times


def test_a_run_of_format_7_is_read_with_the_present_key_of_its_history_and_computed_again(tmp_path: Path):
    older = unpacked(7, tmp_path / "older")
    assert older.case.output.history == Schedule(steps=1)
    assert older.times.tolist() == [0.0, 0.001, 0.002]
    verdict = compare_bits(older, vp.run(older.case))
    # another processor or compiler may round otherwise; the summary is compared as text
    assert [found for found in verdict.differences if found.greatest > 1e-9 and found.place != "the summary"] == []
    assert older.draw()


def test_a_run_of_an_older_format_is_read_compared_and_drawn(tmp_path: Path):
    older = unpacked(5, tmp_path / "older")
    now = vp.run(older.case, tmp_path / "now", figures=False)
    verdict = compare_bits(older, now)
    # another processor or compiler may round otherwise; the summary is compared as text
    beyond = [found for found in verdict.differences if found.greatest > 1e-9 and found.place != "the summary"]
    assert beyond == []
    summaries = [run.results.model_dump(exclude=TIMED | UNKNOWN) for run in (older, now)]
    before, after = (words.pop("mesh") | words for words in summaries)
    assert before.keys() == after.keys()
    for key, value in before.items():
        close = pytest.approx(after[key], rel=0, abs=1e-9) if isinstance(value, float) else after[key]
        assert value == close, key
    assert verdict.notes[0].startswith("sources: ")
    assert older.draw()


def test_a_run_of_an_older_format_that_was_not_finished_is_not_resumed(tmp_path: Path):
    shutil.unpack_archive(Path(__file__).parent / "older" / "format-5.zip", tmp_path / "older")
    summary = json.loads((tmp_path / "older" / "summary.json").read_text())
    (tmp_path / "older" / "summary.json").write_text(json.dumps(summary | {"status": "interrupted"}))
    before = {path: path.read_bytes() for path in (tmp_path / "older").iterdir()}
    with pytest.raises(vp.InputError, match="begun by other sources"):
        vp.resume(tmp_path / "older")
    assert {path: path.read_bytes() for path in before} == before


def test_a_run_in_memory_writes_no_file_and_has_the_bits_of_one_in_a_folder(
    quick: vp.Case, finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    opened: list[Path] = []
    real = Path.open

    def noted(self: Path, mode: str = "r", *rest: Any, **named: Any) -> Any:
        if mode.strip("b") != "r":
            opened.append(self)
        return real(self, mode, *rest, **named)

    monkeypatch.setattr(Path, "open", noted)
    run = vp.run(quick)
    assert (run.status, opened, list(tmp_path.iterdir())) == ("complete", [], [])
    assert compare_bits(run, vp.Run(finished)).same
    assert run.history.attrs["units"]["length"] == "mm"
    assert len(run.profile(run.snapshot("2 us"))[0]) > 10
    assert run.provenance["format"] == 8
    with pytest.raises(vp.InputError, match="in memory only"):
        _ = run.folder
    assert len(run.draw(tmp_path / "figures")) == 4


def test_a_full_disk_ends_with_an_output_error_and_keeps_what_is_there(
    quick: vp.Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    usage = shutil.disk_usage(tmp_path)

    def nearly_full(path: Path) -> object:
        return usage._replace(free=1_000_000)

    monkeypatch.setattr(shutil, "disk_usage", nearly_full)
    with pytest.raises(vp.OutputError, match="No space left on device"):
        vp.run(quick, tmp_path / "run")
    left = vp.Run(tmp_path / "run")
    assert left.status == "interrupted"
    assert "No space left on device" in left.results.reason


def test_a_vanished_folder_ends_with_an_output_error(quick: vp.Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def full(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(vtkhdf, "write", full)
    with pytest.raises(vp.OutputError, match="No space left on device") as caught:
        vp.run(quick, tmp_path / "run")
    assert caught.value.exit_code == 3
