"""A run that is interrupted, killed or damaged goes on as if nothing had happened, or says why it cannot."""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import pyvista

import viscopoint as vp
from viscopoint.methods.fem.rod import rod_mesh
from viscopoint.model.build import build
from viscopoint.model.energy_balance import Row
from viscopoint.model.simulation import Simulation
from viscopoint.results import checkpoint, running
from viscopoint.results.checkpoint import Every
from viscopoint.results.folder import alone
from viscopoint.results.output import OUTPUTS
from viscopoint.results.output import fields as field_files
from viscopoint.results.verify import compare_bits

MPM = {"method.cell": "1 mm", "method.spacing": "0.72 mm", "time.end": "4 us", "time.snapshots": ["1 us", "3 us"]}
FEM = {"method.size": "1.2 mm", "time.end": "4 us", "time.snapshots": ["1 us", "3 us"]}
TLMPM = {"method.spacing": "0.6 mm", "time.end": "4 us", "time.snapshots": ["1 us", "3 us"]}
LENIENT = {"guards.energy_error": 0.5}  # a coarse rod of a few points
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "mpm": ("mpm", MPM),
    "gimp-apic": ("mpm", {**MPM, "method.shape": "gimp", "method.transfer": "apic", "impact.friction": 0.3}),
    "cpgimp-gated": ("mpm", {**MPM, "method.shape": "cpgimp", "method.contact": "gated"}),
    "cubic-tpic": (
        "mpm",
        {**MPM, "method.shape": "cubic", "method.transfer": "tpic", "method.volume": "cell-mean", **LENIENT},
    ),
    "usf-axisymmetric": ("mpm", {**MPM, "method.scheme": "usf", "method.geometry": "axisymmetric"}),
    "mpm-single": ("mpm", {**MPM, "method.precision": "single"}),
    "fem": ("fem", FEM),
    "fem-selective": ("fem", {**FEM, "method.element": "selective", "impact.friction": 0.3}),
    "fem-viscous-deleted": (
        "fem", {**FEM, "method.hourglass.form": "viscous", "method.delete_below": 0.8, **LENIENT},
    ),
    "fem-axisymmetric": ("fem", {**FEM, "method.geometry": "axisymmetric", "method.element": "selective"}),
    "tlmpm": ("tlmpm", TLMPM),
    "tlmpm-gimp": ("tlmpm", {**TLMPM, "method.shape": "gimp", "method.precision": "single"}),
    "tlmpm-axisymmetric": ("tlmpm", {**TLMPM, "method.geometry": "axisymmetric"}),
    "sparse-history": ("tlmpm", {**TLMPM, "output.history": {"every": "0.3 us"}}),
}  # fmt: skip
SIMULATED = "0.2 us simulated"


def case_of(name: str) -> vp.Case:
    method, changes = CASES[name]
    return vp.Case.load("paper", changes, method=method)


def interrupted_at(place: float) -> Callable[[float, Row], None]:
    """Return what ends a run the hard way, between two checkpoints, at some share of its time."""

    def watch(share: float, row: Row) -> None:
        if share >= place:
            raise KeyboardInterrupt

    return watch


def cut_off(case: vp.Case, folder: Path, place: float, every: str = SIMULATED) -> vp.Run:
    run = vp.run(case, folder, figures=False, checkpoint_every=every, watch=interrupted_at(place))
    assert run.status == "interrupted"
    return run


@pytest.fixture(scope="module")
def cut_once(tmp_path_factory: pytest.TempPathFactory) -> vp.Run:
    return cut_off(case_of("tlmpm"), tmp_path_factory.mktemp("once") / "cut", 0.7)


@pytest.fixture
def cut(cut_once: vp.Run, tmp_path: Path) -> Path:
    """A run folder that was cut off, to be damaged."""
    return Path(shutil.copytree(cut_once.folder, tmp_path / "cut"))


def assert_same(one: vp.Run, other: vp.Run) -> None:
    verdict = compare_bits(one, other)
    assert verdict.same, "\n".join(map(str, verdict.differences))
    assert verdict.numbers > 1000


USUAL = ("mpm", "fem", "tlmpm", "sparse-history")  # what others add to the state is tested with the methods


@pytest.mark.parametrize("name", [pytest.param(n, marks=() if n in USUAL else pytest.mark.long) for n in CASES])
def test_a_resumed_run_has_the_bits_of_one_that_was_never_interrupted(name: str, tmp_path: Path):
    case = case_of(name)
    whole = vp.run(case, tmp_path / "whole", figures=False, checkpoint_every="never")
    for share in (0.3, 0.6, 0.9):  # again and again, on the way
        cut = tmp_path / "cut"
        if not cut.exists():
            cut_off(case, cut, share)
        else:
            vp.resume(cut, figures=False, checkpoint_every=SIMULATED, watch=interrupted_at(share))
        assert 1 <= len(list((cut / "checkpoints").iterdir())) <= checkpoint.KEPT
    resumed = vp.resume(cut, figures=False)
    assert resumed.status == "complete"
    assert len(resumed.provenance["resumed"]) == 3
    assert_same(whole, resumed)
    assert not (cut / "checkpoints").exists()


def test_a_run_that_was_cut_off_before_its_first_checkpoint_begins_again(tmp_path: Path):
    case = case_of("tlmpm")
    cut_off(case, tmp_path / "cut", 0.5, "never")
    assert_same(vp.run(case, figures=False), vp.resume(tmp_path / "cut", figures=False))


def test_a_complete_run_is_returned_as_it_is(finished: Path, tmp_path: Path):
    folder = tmp_path / "run"
    shutil.copytree(finished, folder)
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.name != ".lock"}
    assert vp.resume(folder, figures=False).status == "complete"
    assert {path: path.stat().st_mtime_ns for path in before} == before


def damaged(file: Path, place: float) -> None:
    data = bytearray(file.read_bytes())
    data[int(place * (len(data) - 1))] ^= 0x10
    file.write_bytes(data)


def test_a_damaged_checkpoint_is_told_and_the_one_before_taken(tmp_path: Path):
    case = case_of("tlmpm")
    cut_off(case, tmp_path / "cut", 0.7)
    _, newer = sorted((tmp_path / "cut" / "checkpoints").iterdir())
    damaged(newer, 0.7)
    with pytest.warns(vp.ViscopointWarning, match=f"{newer.name}.*the one before is taken"):
        resumed = vp.resume(tmp_path / "cut", figures=False)
    assert_same(vp.run(case, figures=False), resumed)
    cut_off(case, tmp_path / "other", 0.7)
    for place, file in zip((0.01, 0.99), (tmp_path / "other" / "checkpoints").iterdir(), strict=True):
        damaged(file, place)
    with pytest.raises(vp.InputError, match="no checkpoint can be read"):
        vp.resume(tmp_path / "other")


def contents(folder: Path) -> dict[str, bytes]:
    """Return what is in all files of a folder, but for the lock."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.name != ".lock")
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def first_snapshot(folder: Path) -> Path:
    return field_files.file_of(folder, 0)


@pytest.mark.parametrize("change", ["sources", "state", "fields", "no fields", "link", "format"])
def test_what_does_not_go_with_a_checkpoint_is_refused_and_left_as_it_is(change: str, cut: Path, tmp_path: Path):
    if change in ("sources", "format"):
        data = json.loads((cut / "provenance.json").read_text())
        (cut / "provenance.json").write_text(json.dumps(data | {change: "1234"}))
        message = "begun by other sources" if change == "sources" else "format 1234"
    elif change == "state":
        cut_off(case_of("mpm"), tmp_path / "mpm", 0.7)
        shutil.rmtree(cut / "checkpoints")
        shutil.copytree(tmp_path / "mpm" / "checkpoints", cut / "checkpoints")
        message = "other arrays than those of the case"
    elif change == "fields":
        first_snapshot(cut).write_bytes(first_snapshot(cut).read_bytes()[:100])
        message = "does not go with its checkpoint"
    elif change == "no fields":
        first_snapshot(cut).unlink()
        message = "does not go with its checkpoint"
    else:
        (cut / "history.csv").rename(tmp_path / "elsewhere.csv")
        (cut / "history.csv").symlink_to(tmp_path / "elsewhere.csv")
        message = "is a link or a device"
    before = contents(cut)
    with pytest.raises(vp.InputError, match=message):
        vp.resume(cut)
    assert contents(cut) == before


@pytest.mark.parametrize("every", [SIMULATED, "never"])
def test_a_run_is_not_resumed_as_another_case(every: str, tmp_path: Path):
    folder = tmp_path / "cut"
    cut_off(case_of("tlmpm"), folder, 0.7, every)
    text = (folder / "case.toml").read_text()
    (folder / "case.toml").write_text(text.replace("150.0 m/s", "151.0 m/s"))
    before = contents(folder)
    with pytest.raises(vp.InputError, match=r"its case\.toml, or the mesh that it names, is not what it was"):
        vp.resume(folder)
    assert contents(folder) == before


@pytest.mark.parametrize("every", [SIMULATED, "never"])
def test_a_run_is_not_resumed_with_another_mesh(every: str, tmp_path: Path):
    rod = rod_mesh(3.8, 25.4, 1.9)
    pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: rod.cells}, rod.position).save(tmp_path / "rod.vtu")
    method = {"name": "fem", "mesh": str(tmp_path / "rod.vtu")}
    case = vp.Case.load("paper", {"method": method, "time.end": "4 us", "time.snapshots": []})
    folder = tmp_path / "cut"
    cut_off(case, folder, 0.7, every)
    sound = (folder / "mesh.vtu").read_bytes()
    inside = np.hypot(*rod.position[:, :2].T) < 1.0
    moved = rod.position + 1e-6 * (inside & (rod.position[:, 2] > 1.0) & (rod.position[:, 2] < 20.0))[:, None]
    pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: rod.cells}, moved).save(folder / "mesh.vtu")
    with pytest.raises(vp.InputError, match="or the mesh that it names, is not what it was"):
        vp.resume(folder)
    (folder / "mesh.vtu").write_bytes(sound)
    assert_same(vp.run(case, figures=False), vp.resume(folder, figures=False))


def state_of(folder: Path) -> dict[str, Any]:
    """Return the state of a run as it is built anew, as its checkpoints have it."""
    model = build(vp.Run(folder).case)
    return Simulation(model, [make(folder, model) for make in OUTPUTS.values()]).state()


def test_checkpoints_that_are_damaged_or_not_ours_keep_no_sound_one_away(tmp_path: Path):
    case, folder = case_of("tlmpm"), tmp_path / "cut"
    cut_off(case, folder, 0.5)
    place = folder / "checkpoints"
    _, newer = sorted(place.iterdir())
    damaged(newer, 0.7)
    others = {"zzz.safetensors", "999999999.safetensors"}
    (place / "zzz.safetensors").touch()
    (place / "999999999.safetensors").mkdir()
    with pytest.warns(vp.ViscopointWarning, match="the one before is taken"):
        vp.resume(folder, figures=False, checkpoint_every=SIMULATED, watch=interrupted_at(0.9))
    files = sorted(file for file in place.iterdir() if file.name not in others)
    assert len(files) == checkpoint.KEPT
    like = state_of(folder)
    assert all(checkpoint.load(file, like).state.keys() == like.keys() for file in files)
    assert_same(vp.run(case, figures=False), vp.resume(folder, figures=False))


@pytest.mark.parametrize(
    ("name", "place", "value"),
    [
        ("history.rows", (0, 1, 1), np.inf), ("history.rows", (0, 1, 0), -1.0), ("history.rows", (0, -1, 0), 9.0),
        ("history.accounts", slice(None), 0.0), ("history.accounts", (0, -4), -1.0),
        ("history.of_snapshots", 0, 1), ("history.of_snapshots", 0, 1000),
        ("fields.times", 0, 1e-6), ("fields.checks", 0, 1),
    ],
)  # fmt: skip
def test_a_whole_checkpoint_of_what_no_run_had_is_refused(name: str, place: Any, value: float, cut: Path):
    found, _ = checkpoint.newest(cut, state_of(cut))
    assert found is not None
    found.state[name] = found.state[name].copy()
    found.state[name][place] = value
    shutil.rmtree(cut / "checkpoints")
    checkpoint.save(cut / "checkpoints" / f"{found.words.step:09d}.safetensors", *found)
    before = contents(cut)
    with pytest.raises(vp.InputError, match=r"checkpoint|does not go with"):
        vp.resume(cut, figures=False)
    assert contents(cut) == before


@pytest.mark.parametrize("change", ["digit", "letter", "cut", "none"])
def test_a_history_that_is_not_what_was_written_is_written_again(change: str, cut: Path, cut_once: vp.Run):
    if change == "cut":
        (cut / "history.csv").write_bytes((cut / "history.csv").read_bytes()[:100])
    elif change == "none":
        (cut / "history.csv").unlink()
    else:
        change_a_digit(cut, {"digit": b"2", "letter": b"x"}[change])
    assert_same(vp.run(cut_once.case), vp.resume(cut, figures=False))


def change_a_digit(folder: Path, other: bytes) -> None:
    lines = (folder / "history.csv").read_bytes().splitlines(keepends=True)
    lines[2] = lines[2].replace(b"1", other, 1)
    (folder / "history.csv").write_bytes(b"".join(lines))


def change_a_number(folder: Path) -> None:
    with h5py.File(first_snapshot(folder), "r+") as file:
        stress: Any = file["VTKHDF/PointData/stress"]
        stress[3, 1] += 1.0  # its checksum is right


def damage_a_piece(folder: Path, name: str = "PointData/stress") -> None:
    with h5py.File(first_snapshot(folder), "r") as file:
        dataset: Any = file[f"VTKHDF/{name}"]
        piece = dataset.id.get_chunk_info(0)
    with first_snapshot(folder).open("rb+") as raw:
        raw.seek(piece.byte_offset + piece.size // 2)
        raw.write(b"\x55" * 4)


def damage_the_cells(folder: Path) -> None:
    damage_a_piece(folder, "Connectivity")


@pytest.mark.parametrize(
    "change",
    [change_a_number, damage_a_piece, damage_the_cells],
)
def test_results_that_are_not_what_was_written_are_not_gone_on_with(change: Callable[[Path], None], cut: Path):
    change(cut)
    before = contents(cut)
    with pytest.raises(vp.InputError, match="does not go with its checkpoint"):
        vp.resume(cut, figures=False)
    assert contents(cut) == before


# --- folders that are replaced or moved ---


def test_a_folder_that_cannot_be_replaced_stays(finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    folder, renames = tmp_path / "run", []
    shutil.copytree(finished, folder)
    real = Path.rename

    def failing(self: Path, target: Path) -> Path:
        renames.append(target)
        if len(renames) == 2:
            raise OSError(122, "Disk quota exceeded")
        return real(self, target)

    monkeypatch.setattr(Path, "rename", failing)
    before = contents(folder)
    with pytest.raises(vp.InputError, match="Disk quota exceeded"):
        vp.run(case_of("tlmpm"), folder, force=True, figures=False)
    assert contents(folder) == before
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@pytest.mark.parametrize("there", [False, True])
def test_a_folder_whose_replacement_was_killed_comes_back(finished: Path, tmp_path: Path, there: bool):
    shutil.copytree(finished, tmp_path / ".run.0123456789abcdef.old")
    os.utime(tmp_path / ".run.0123456789abcdef.old", (0.0, 0.0))
    if there:
        (tmp_path / "run").mkdir()
    vp.run(case_of("tlmpm"), tmp_path / "other", figures=False)
    assert not list(tmp_path.glob(".*"))
    assert ((tmp_path / "run" / "summary.json").exists(), (tmp_path / "run").exists()) == (not there, True)


def test_force_through_a_link_replaces_what_it_leads_to(finished: Path, tmp_path: Path):
    shutil.copytree(finished, tmp_path / "run")
    (tmp_path / "link").symlink_to("run")
    vp.run(case_of("tlmpm"), tmp_path / "link", force=True, figures=False)
    assert (tmp_path / "link").is_symlink()
    assert vp.Run(tmp_path / "run").case.method.name == "tlmpm"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link", "run"]


def test_a_run_whose_folder_is_moved_writes_nothing_into_another_and_can_be_resumed(tmp_path: Path):
    case = case_of("tlmpm")
    other = vp.run(case.with_({"impact.speed": "100 m/s"}), tmp_path / "other", figures=False)
    before = contents(other.folder)

    def move(share: float, row: Row) -> None:
        if share > 0.5 and not (tmp_path / "moved").exists():
            (tmp_path / "run").rename(tmp_path / "moved")
            other.folder.rename(tmp_path / "run")

    with pytest.raises(vp.OutputError, match="the folder was moved, another one is in its place"):
        vp.run(case, tmp_path / "run", figures=False, checkpoint_every=SIMULATED, watch=move)
    assert contents(tmp_path / "run") == before
    assert_same(vp.run(case, figures=False), vp.resume(tmp_path / "moved", figures=False))


def test_of_two_that_make_one_folder_the_later_takes_it_and_the_other_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    others: list[bool] = []

    def late(folder: Path, made: os.stat_result | None = None) -> Any:
        if not others:  # another process replaces the folder before this one has locked it
            others.append(True)
            vp.run(case_of("fem"), folder, force=True, figures=False)
        return alone(folder, made)

    monkeypatch.setattr("viscopoint.results.running.alone", late)
    with pytest.raises(vp.InputError, match="another process is at work there"):
        vp.run(case_of("tlmpm"), tmp_path / "run", figures=False)
    assert_same(vp.run(case_of("fem"), figures=False), vp.Run(tmp_path / "run"))


def test_resuming_looks_at_a_run_once_nobody_else_works_on_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    cut_off(case_of("tlmpm"), tmp_path / "run", 0.7)
    others: list[bool] = []

    def late(folder: Path, made: os.stat_result | None = None) -> Any:
        if not others:
            others.append(True)
            vp.resume(folder, figures=False)
        return alone(folder, made)

    monkeypatch.setattr("viscopoint.results.running.alone", late)
    assert len(vp.resume(tmp_path / "run", figures=False).provenance["resumed"]) == 1


def test_a_snapshot_happens_as_a_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    # every write to the disk fails once, as on a disk that is full; whatever happened, fields are those of a snapshot
    case = case_of("mpm")
    whole = vp.run(case, tmp_path / "whole", figures=False)
    counted, real = [0], os.fsync

    def failing(number: int) -> None:
        counted[0] += 1
        if counted[0] == at:
            raise OSError(28, "No space left on device")
        real(number)

    outcomes = set()
    monkeypatch.setattr(os, "fsync", failing)
    for at in range(1, 60, 4):
        counted[0] = 0
        folder = tmp_path / str(at)
        try:
            vp.run(case, folder, figures=False, checkpoint_every="1 us simulated")
            outcomes.add("complete")
        except vp.OutputError:
            outcomes.add("full")
        except vp.InputError:
            outcomes.add("refused")
        counted[0] = 1000
        if folder.exists():
            run = vp.Run(folder)
            if (folder / field_files.INDEX).exists():
                assert len(run.times) <= 4
                assert all(run.snapshot(number) for number in range(len(run.times)))
            assert_same(whole, vp.resume(folder, figures=False))
    assert outcomes >= {"complete", "full"}


@pytest.mark.parametrize("text", ["10", "0 s", "-1 s", "10 kg", "often", "5 us simulate"])
def test_a_wrong_interval_of_checkpoints_is_told(text: str):
    with pytest.raises(vp.InputError, match="write a time on the clock"):
        Every.read(text)


def test_intervals_are_read_in_both_kinds_of_time():
    assert Every.read("10 s") == (10.0, np.inf)
    assert Every.read("1 min") == (60.0, np.inf)
    assert Every.read("5 us simulated") == (np.inf, 0.005)
    assert Every.read("never") == (np.inf, np.inf)


# --- processes of their own: signals, kills ---

SLOW = {**TLMPM, "time.end": "30 us", "method.spacing": "0.4 mm", "time.snapshots": ["10 us", "15 us", "20 us"]}


def command(*words: str | Path) -> subprocess.Popen[str]:
    line = [sys.executable, "-m", "viscopoint", *map(str, words)]
    return subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.fixture(scope="module")
def slow(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, vp.Run, float]:
    """A case file that takes some seconds, its whole run, and how long that took as a command."""
    folder = tmp_path_factory.mktemp("slow")
    file = folder / "slow.toml"
    file.write_text(vp.Case.load("paper", SLOW, method="tlmpm").to_toml())
    for place in ("warm", "whole"):
        began = time.monotonic()
        process = command("run", file, "--out", folder / place, "--no-figures")
        assert process.communicate()[1] == ""
    return file, vp.Run(folder / "whole"), time.monotonic() - began


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_a_run_with_a_checkpoint_and_a_word_on_how_to_go_on(
    slow: tuple[Path, vp.Run, float], tmp_path: Path, number: signal.Signals, code: int
):
    file, whole, _ = slow
    folder = tmp_path / "run"
    process = command("run", file, "--out", folder, "--no-figures", "--checkpoint-every", "never")
    while not (folder / "history.csv").exists() or (folder / "history.csv").stat().st_size < 20_000:
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(number)
    _, messages = process.communicate()
    assert process.returncode == code, messages
    assert f"go on with `viscopoint resume {folder}`" in messages
    assert len(list((folder / "checkpoints").iterdir())) == 1
    run = vp.Run(folder)
    assert (run.status, run.results.signal) == ("interrupted", number.name)
    process = command("resume", folder, "--no-figures")
    assert process.communicate()[1] == ""
    assert process.returncode == 0
    assert_same(whole, vp.Run(folder))


def killed_at_random(
    slow: tuple[Path, vp.Run, float], folder: Path, kills: int, seed: int, numbers: tuple[int, ...]
) -> dict[str, int]:
    """Kill runs at random instants until each is complete; return how often what was found."""
    file, whole, duration = slow
    chance, found = random.Random(seed), {"nothing yet": 0, "resumed": 0, "complete before": 0}
    for kill in range(kills):
        place = folder / f"{kill}"
        process = command("run", file, "--out", place, "--no-figures", "--checkpoint-every", "0.02 s")
        time.sleep(chance.uniform(0.3, 1.1) * duration)
        for number in numbers:
            process.send_signal(number)
        process.communicate()
        if not place.exists():
            found["nothing yet"] += 1
            word = ("run", file, "--out", place)
        else:
            late = vp.Run(place).status == "complete"
            found["complete before" if late else "resumed"] += 1
            duration *= 0.9 if late else 1.0  # the machine has become faster
            word = ("resume", place)
        process = command(*word, "--no-figures")
        assert process.communicate()[1] == ""
        assert process.returncode == 0
        assert_same(whole, vp.Run(place))
        own = {"case.toml", "provenance.json", "summary.json", "history.csv", "fields", "fields.vtkhdf.series", ".lock"}
        assert {path.name for path in place.iterdir()} == own
        shutil.rmtree(place)
    return found


def test_runs_that_are_killed_can_be_resumed(slow: tuple[Path, vp.Run, float], tmp_path: Path):
    killed_at_random(slow, tmp_path, 2, 1, (signal.SIGKILL,))


def test_a_second_ctrl_c_ends_at_once_and_the_run_can_be_resumed(slow: tuple[Path, vp.Run, float], tmp_path: Path):
    killed_at_random(slow, tmp_path, 1, 2, (signal.SIGINT, signal.SIGINT))


@pytest.mark.long
@pytest.mark.parametrize("numbers", [(signal.SIGKILL,), (signal.SIGINT, signal.SIGINT), (signal.SIGTERM,)])
def test_runs_killed_at_fifty_random_instants_have_the_bits_of_a_whole_one(
    slow: tuple[Path, vp.Run, float], tmp_path: Path, numbers: tuple[int, ...]
):
    found = killed_at_random(slow, tmp_path, 50, 3, numbers)
    print(found)
    assert found["resumed"] >= 25


def test_two_processes_never_work_in_one_folder(slow: tuple[Path, vp.Run, float], tmp_path: Path):
    file, whole, _ = slow
    folder = tmp_path / "run"
    first = command("run", file, "--out", folder, "--no-figures")
    while not (folder / "history.csv").exists():
        assert first.poll() is None
        time.sleep(0.01)
    first.send_signal(signal.SIGSTOP)
    for words in (("run", file, "--out", folder, "--force"), ("resume", folder)):
        second = command(*words)
        _, messages = second.communicate()
        assert (second.returncode, "another process is at work there" in messages) == (2, True), messages
    first.send_signal(signal.SIGCONT)
    assert first.communicate()[1] == ""
    assert first.returncode == 0
    assert_same(whole, vp.Run(folder))


def test_checkpoints_are_off_where_nobody_wants_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(checkpoint, "save", None)  # nothing may be written
    assert vp.run(case_of("tlmpm"), figures=False, checkpoint_every="never").status == "complete"
    assert running.USUAL_CHECKPOINTS == "60 s"
