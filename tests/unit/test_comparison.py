import io
import json
import shutil
from functools import partial
from pathlib import Path
from typing import cast

import h5py
import numpy as np
import pytest
import shell
from rich.console import Console

import viscopoint as vp
from viscopoint.comparison import Comparison, axis, compare, differing, outline, wall_force
from viscopoint.comparison.table import tables
from viscopoint.results.output.fields import INDEX

LAST = "fields/fields_00002.vtkhdf"
R, L = 1.5, 10.0


def copied(run: Path, tmp_path: Path) -> Path:
    return shutil.copytree(run, tmp_path / "copy")


def cylinder(radius: float, length: float, foot: float = 0.0) -> np.ndarray:
    return np.array([[0.0, foot], [radius, foot], [radius, foot + length], [0.0, foot + length]])


def test_a_wider_cylinder_is_apart_by_its_ring():
    found = outline.apart(cylinder(R, L), cylinder(1.1 * R, L), R * L)
    assert found.area == pytest.approx(0.1, rel=1e-12)
    assert found.distance == pytest.approx(0.1 * R, rel=1e-12)


def test_a_lifted_cylinder_is_apart_by_both_ends():
    found = outline.apart(cylinder(R, L), cylinder(R, L, foot=0.3), R * L)
    assert found.area == pytest.approx(2 * 0.3 / L, rel=1e-12)
    assert found.distance == pytest.approx(0.3, rel=1e-12)


def test_a_cone_is_apart_by_a_triangle():
    cone = np.array([[0.0, 0.0], [2 * R, 0.0], [R, L], [0.0, L]])
    found = outline.apart(cylinder(R, L), cone, R * L)
    assert found.area == pytest.approx(0.5, rel=1e-12)
    assert found.distance == pytest.approx(R, rel=1e-12)  # the rim of its foot


def test_layers_folded_over_each_other_still_enclose_an_area():
    folded = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, 2.0], [2.0, 1.0], [1.0, 3.0], [0.0, 3.0]])
    assert np.isfinite(outline.apart(cylinder(1.0, 3.0), folded, 3.0)).all()


def test_the_outline_at_the_start_is_the_rod(finished: Path, finished_fem: Path):
    for folder, length in ((finished, 36 * 0.7), (finished_fem, 25.4)):  # a lattice of 36 layers; the rod itself
        run = vp.Run(folder)
        shape = outline.outline(run, run.snapshot(0))
        assert shape[:, 0].max() == pytest.approx(3.8, rel=1e-12)
        assert np.ptp(shape[:, 1]) == pytest.approx(length, rel=1e-12)
        assert outline.apart(shape, cylinder(3.8, length), 3.8 * length).area < 1e-9


def test_before_the_wave_comes_the_axis_falls_at_the_impact_speed(finished: Path, finished_fem: Path):
    for folder in (finished, finished_fem):
        run = vp.Run(folder)
        height, speed = axis.axial_velocity(run, run.snapshot("2 us"))
        assert np.all(np.diff(height) > 0.0)
        fastest = np.sqrt((550 + 4 * 140 / 3) / 1e-3) * 2e-3  # mm that the plane wave goes in 2 us
        ahead = height > 2.0 * fastest + 2.0  # a grid carries a little ahead of it
        assert ahead.sum() > 5
        assert np.allclose(speed[ahead], -150.0, rtol=1e-3)
        assert speed[0] > -150.0


def test_profiles_are_compared_where_both_are():
    one, other = (np.array([0.0, 4.0]), np.array([0.0, 4.0])), (np.array([2.0, 6.0]), np.array([5.0, 9.0]))
    assert axis.apart(one, other) == pytest.approx(3.0)
    assert np.isnan(axis.apart(one, (np.array([5.0, 6.0]), np.zeros(2))))


def test_a_run_does_not_differ_from_itself(finished: Path):
    found = compare([finished, finished])
    assert found.times == (0.001, 0.002)
    for states in found.states:
        assert states[1] == states[0]
        assert states[1].apart == pytest.approx((0.0, 0.0), abs=1e-12)
        assert states[1].axial_velocity == 0.0


def test_the_wall_force_is_the_impulse_of_the_last_half_microsecond(finished_fem: Path):
    run = vp.Run(finished_fem)
    history = run.history
    before = np.interp(0.0015, history["time"], history["wall_impulse"])
    now = float(history["wall_impulse"].iloc[-1])
    assert wall_force(run, 0.002) == pytest.approx((now - before) / 0.0005, rel=1e-9)
    assert wall_force(run, 0.0002) * 0.0002 == pytest.approx(
        np.interp(0.0002, history["time"], history["wall_impulse"])
    )


def test_methods_at_different_resolutions_are_compared(finished: Path, finished_fem: Path):
    found = compare([finished_fem, finished])
    assert found.names == ("quick-fem", "quick")
    for states in found.states:
        other = states[1]
        assert 0.0 < other.apart.distance < 1.0  # within a cell of the coarse grid
        # the area between lies along the outline, nowhere further from it than the greatest distance
        around = 2 * 3.8 + 2 * 25.4
        assert 0.0 < other.apart.area * 3.8 * 25.4 < around * other.apart.distance


def test_runs_of_one_name_are_told_apart(finished: Path, tmp_path: Path):
    other = shutil.copytree(finished, tmp_path / "again" / finished.name)
    assert compare([finished, other]).names == (f"{finished.parent.name}/quick", "again/quick")


def test_other_physics_is_refused_with_its_keys(finished: Path, tmp_path: Path):
    other = copied(finished, tmp_path)
    text = (other / "case.toml").read_text()
    (other / "case.toml").write_text(text.replace("650.0 1/ms", "65.0 1/ms").replace("150.0 m/s", "100.0 m/s"))
    with pytest.raises(vp.InputError) as caught:
        compare([finished, other])
    assert "impact.speed: 150.0 m/s, 100.0 m/s" in str(caught.value)
    assert "material.decay: 650.0 1/ms, 65.0 1/ms" in str(caught.value)
    assert compare([finished, other], any_physics=True).physics == ("impact.speed", "material.decay")


def test_physics_that_differs_by_rounding_is_the_same(finished: Path, tmp_path: Path):
    other = copied(finished, tmp_path)
    text = (other / "case.toml").read_text()
    (other / "case.toml").write_text(text.replace("650.0 1/ms", "650.0000000000001 1/ms"))
    assert vp.Run(other).case.material.decay != 650.0
    assert compare([finished, other]).physics == ()
    (other / "case.toml").write_text(text.replace("650.0 1/ms", "650.00000001 1/ms"))
    assert differing(vp.Run(finished), vp.Run(other)) == ["material.decay"]


def test_a_law_with_other_keys_is_other_physics(finished: Path, tmp_path: Path):
    other = copied(finished, tmp_path)
    case = vp.Case.load(other / "case.toml").with_(
        material={"law": "elastic", "density": "1 g/cm^3", "bulk": "550 MPa", "shear": "140 MPa"}
    )
    (other / "case.toml").write_text(case.to_toml())
    with pytest.raises(vp.InputError, match=r"material\.decay: 650\.0 1/ms, none"):
        compare([finished, other])


def test_no_snapshot_in_common_is_refused_with_what_there_is(finished: Path, tmp_path: Path, quick: vp.Case):
    vp.run(quick.with_({"time.end": "1.5 us", "time.snapshots": []}), tmp_path / "other", figures=False)
    with pytest.raises(vp.InputError, match=r"no snapshot in common .* 0, 1, 2 us; .* 0, 1\.5 us"):
        compare([finished, tmp_path / "other"])


@pytest.mark.parametrize("name", ["case.toml", "provenance.json", "summary.json", "history.csv", LAST, INDEX])
@pytest.mark.parametrize("damage", ["missing", "empty", "cut", "garbage"])
def test_a_damaged_run_is_refused_by_name(finished: Path, tmp_path: Path, name: str, damage: str):
    other = copied(finished, tmp_path)
    whole = (other / name).read_bytes()
    (other / name).unlink()
    if damage != "missing":
        (other / name).write_bytes(
            {"empty": b"", "cut": whole[: len(whole) // 3], "garbage": b"\x93\xff{]" * 99}[damage]
        )
    with pytest.raises(vp.InputError, match="copy"):
        compare([finished, other])


def test_a_run_that_goes_on_and_a_missing_one_are_refused(finished: Path, tmp_path: Path):
    other = copied(finished, tmp_path)
    summary = json.loads((other / "summary.json").read_text())
    (other / "summary.json").write_text(json.dumps(summary | {"status": "running"}))
    with pytest.raises(vp.InputError, match="not finished"):
        compare([finished, other])
    with pytest.raises(vp.InputError, match="absent"):
        compare([finished, tmp_path / "absent"])
    with pytest.raises(vp.InputError, match="two runs or more"):
        compare([finished])


def test_numbers_of_the_file_are_those_of_the_runs(finished: Path, finished_fem: Path):
    found: Comparison = compare([finished_fem, finished])
    tables = json.loads(json.dumps(found.to_tables(), allow_nan=False))
    last = tables["snapshots"][-1]["runs"]["quick"]
    row = vp.Run(finished).rows[-1]
    for name in ("length", "impact_face_radius", "velocity", "kinetic", "numerical"):
        assert last[name] == getattr(row, name)
    assert set(last) == set(tables["units"])


called = partial(shell.call, "compare")


def test_the_command_prints_a_table_and_leaves_numbers_and_figures(finished: Path, finished_fem: Path, tmp_path: Path):
    code, out, messages = called(finished_fem, finished, "--out", tmp_path / "made")
    assert (code, messages) == (0, "")
    row = vp.Run(finished).rows[-1]
    for shown in ("2 us", f"{row.impact_face_radius:.3f}", f"{row.velocity:.2f}", "outline, area between", "made"):
        assert shown in out
    names = {path.name for path in (tmp_path / "made").rglob("*") if path.is_file()}
    assert names == {"comparison.json", "outlines.png", "axis.png", "histories.png", "energies.png"}
    code, _, messages = called(finished_fem, finished, "--out", tmp_path / "made")
    assert (code, "already there" in messages) == (2, True)
    assert called(finished_fem, finished, "--out", tmp_path / "made", "--force", "--no-figures")[0] == 0
    assert not (tmp_path / "made" / "figures").exists()


def test_force_replaces_comparisons_alone(finished: Path, finished_fem: Path, tmp_path: Path):
    run = copied(finished, tmp_path)
    code, _, messages = called(finished_fem, run, "--out", run, "--force")
    assert (code, "has no comparison.json" in messages) == (2, True)
    assert vp.Run(run).status == "complete"


def test_bad_input_leaves_nothing_behind(finished: Path, tmp_path: Path):
    for words in ([finished], [finished, tmp_path / "absent"], [finished, tmp_path]):
        code, out, messages = called(*words, "--out", tmp_path / "made")
        assert (code, out) == (2, "")
        assert messages.startswith("viscopoint: ")
        assert list(tmp_path.iterdir()) == []


def test_any_folder_name_is_shown_as_it_is(finished: Path, tmp_path: Path):
    names = ("a$\\x$", "_hidden", "[bold]")
    for name in names:
        shutil.copytree(finished, tmp_path / name)
    code, out, _ = called(*(tmp_path / name for name in names), "--out", tmp_path / "made")
    assert code == 0
    assert all(name in out for name in names)


def test_runs_of_other_versions_are_told(finished: Path, tmp_path: Path):
    other = copied(finished, tmp_path)
    facts = json.loads((other / "provenance.json").read_text())
    (other / "provenance.json").write_text(json.dumps(facts | {"sources": "0" * 16, "commit": "feedface"}))
    (warning,) = compare([finished, other]).warnings()
    assert "different versions" in warning
    assert "feedface" in warning


def test_times_that_no_run_has_are_refused(finished: Path):
    assert compare([finished, finished], [0.002]).times == (0.002,)
    with pytest.raises(vp.InputError, match=r"no snapshot in common at 5 us; there are 1, 2 us"):
        compare([finished, finished], [0.005])


@pytest.mark.parametrize(("field", "rows"), [("velocity", None), ("lost", None), ("velocity", 1), ("pressure", 7)])
def test_a_field_that_is_missing_or_cut_is_refused(finished: Path, tmp_path: Path, field: str, rows: int | None):
    other = copied(finished, tmp_path)
    with h5py.File(other / LAST, "a") as file:
        data: h5py.Dataset = file[f"VTKHDF/PointData/{field}"]  # pyright: ignore[reportAssignmentType]
        if rows is None:
            del file[f"VTKHDF/PointData/{field}"]
        else:
            data.resize(len(data) - rows, axis=0)
    with pytest.raises(vp.InputError, match=rf"fields.* cannot be read .*{field}"):
        compare([finished, other])


@pytest.mark.parametrize("line", ["", "a word,", "0.0,", "nan,"])
def test_a_history_that_is_no_table_of_numbers_is_refused(finished: Path, tmp_path: Path, line: str):
    other = copied(finished, tmp_path)
    lines = (other / "history.csv").read_text().splitlines()
    time, _, rest = lines[-2].partition(",")
    assert float(time) > 0.0
    changed = [*lines[:-2], line + rest, lines[-1]] if line else lines[:1]
    (other / "history.csv").write_text("\n".join(changed) + "\n")
    with pytest.raises(vp.InputError, match=r"history\.csv cannot be read"):
        compare([finished, other])


def test_a_full_disk_ends_with_code_3(
    finished: Path, finished_fem: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def full(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("viscopoint.comparison.write_json", full)
    code, _, messages = called(finished_fem, finished, "--out", tmp_path / "made")
    assert (code, "No space left on device" in messages) == (3, True)


@pytest.mark.parametrize("width", [80, 120])
@pytest.mark.parametrize("count", [2, 5, 12])
def test_any_number_of_runs_is_shown_in_full_at_any_width(finished: Path, finished_fem: Path, count: int, width: int):
    runs = [vp.Run(finished_fem), *([vp.Run(finished)] * (count - 1))]
    single = compare([finished_fem, finished])
    names = ("reference", *(f"a-run-with-a-name-longer-than-its-numbers-{number}" for number in range(1, count)))
    states = tuple((first, *[other] * (count - 1)) for first, other in single.states)
    many = Comparison(tuple(runs), names, single.times, states, ())
    screen = Console(width=width, file=io.StringIO(), highlight=False)
    for table in tables(many, width):
        screen.print(table)
    lines = cast(io.StringIO, screen.file).getvalue().splitlines()
    assert "…" not in "".join(lines)
    assert max(map(len, lines)) <= width
    row = vp.Run(finished).rows[-1]
    radius, speed = f"{row.contact_radius:.3f} (", f"{row.velocity:.2f} ("
    for shown, words in ((radius, "contact radius"), (speed, "velocity of centre of mass")):
        found = [line.count(shown) for line in lines if line.strip().startswith(words)]
        assert sum(found) == count - 1  # of the last time; each run once
    first = f"{vp.Run(finished_fem).rows[-1].contact_radius:.3f} "
    assert all(first in line for line in lines if "contact radius" in line and radius in line)  # beside its reference


def test_twelve_runs_are_compared_on_the_command_line(finished: Path, tmp_path: Path):
    runs = [shutil.copytree(finished, tmp_path / f"run-{number}") for number in range(12)]
    code, out, _ = called(*runs, "--out", tmp_path / "made", "--no-figures")
    assert (code, "…" in out) == (0, False)
    assert all(f"run-{number} " in out.replace("\n", " ") for number in range(12))
