"""Disks that fill up, vanish or cannot be written: a clear message, nothing lost, and a run that goes on later."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import viscopoint as vp
from viscopoint.results.output.fields import INDEX
from viscopoint.results.verify import compare_bits

CASE = {"method.spacing": "0.6 mm", "time.end": "6 us", "time.snapshots": ["1 us", "2 us", "3 us", "4 us", "5 us"]}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> vp.Run:
    case = vp.Case.load("paper", CASE, method="tlmpm")
    return vp.run(case, tmp_path_factory.mktemp("disk") / "whole", figures=False)


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Path]:
    """A small disk of its own."""
    place = tmp_path / "disk"
    place.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=16m", "none", place], capture_output=True, check=False
    )
    if mounted.returncode:
        pytest.skip("mounting a small disk takes the rights of root")
    yield place
    subprocess.run(["umount", "-l", place], check=True)


def command(*words: str | Path, limit: int | None = None) -> tuple[int, str]:
    """Run a command, which may write no file larger than ``limit`` [bytes]."""
    limited = f"import resource; resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))\n" if limit else ""
    line = [sys.executable, "-c", f"{limited}from viscopoint.command_line.cli import main\nmain()", *map(str, words)]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    return done.returncode, done.stderr


@pytest.mark.parametrize(
    "room", [0, 900_000, *(pytest.param(room, marks=pytest.mark.long) for room in (30_000, 300_000, 1_600_000))]
)
def test_a_run_on_a_full_disk_ends_with_a_message_and_goes_on_when_there_is_room(disk: Path, whole: vp.Run, room: int):
    ballast = disk / "ballast"
    free = shutil.disk_usage(disk).free
    with ballast.open("wb") as file:
        file.write(bytes(free - room))
    folder = disk / "run"
    code, messages = command(
        "run", whole.folder / "case.toml", "--out", folder, "--no-figures", "--checkpoint-every", "1 us simulated"
    )
    assert code == 3, messages
    assert "No space left" in messages
    assert "Traceback" not in messages
    assert not list(disk.glob(".*"))  # no half-made folder
    if folder.exists():
        assert f"`viscopoint resume {folder}`" in messages
        run = vp.Run(folder)
        for number in range(len(run.times) if (folder / INDEX).exists() else 0):
            assert (run.snapshot(number)["stress"] == whole.snapshot(number)["stress"]).all()
        code, messages = command("resume", folder, "--no-figures")
        assert (code, "No space left" in messages) == (3, True)
        ballast.unlink()
        assert command("resume", folder, "--no-figures") == (0, "")
        assert compare_bits(whole, vp.Run(folder)).same
    else:
        assert room <= 30_000


@pytest.mark.parametrize("limit", [1_000, 400_000, 900_000])
def test_a_run_that_may_write_no_more_ends_with_a_message_and_goes_on_when_it_may(
    limit: int, whole: vp.Run, tmp_path: Path
):
    folder = tmp_path / "run"
    words = ("run", whole.folder / "case.toml", "--out", folder, "--no-figures", "--checkpoint-every", "1 us simulated")
    code, messages = command(*words, limit=limit)
    assert code == 3, messages
    assert "File too large" in messages
    assert "Traceback" not in messages
    assert not list(tmp_path.glob(".*"))
    if folder.exists():
        assert command("resume", folder, "--no-figures") == (0, "")
        assert compare_bits(whole, vp.Run(folder)).same
    else:
        assert limit == 1_000


def test_a_folder_that_is_removed_under_a_run_ends_it_with_a_message(tmp_path: Path, whole: vp.Run):
    folder = tmp_path / "run"
    line = [sys.executable, "-m", "viscopoint", "run", whole.folder / "case.toml", "--out", folder, "--no-figures"]
    process = subprocess.Popen([str(word) for word in line], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    while not (folder / INDEX).exists():
        assert process.poll() is None
        time.sleep(0.001)
    process.send_signal(signal.SIGSTOP)
    shutil.rmtree(folder)
    process.send_signal(signal.SIGCONT)
    _, messages = process.communicate()
    assert process.returncode == 3, messages
    assert "cannot be written (No such file or directory)" in messages
    assert "Traceback" not in messages


@pytest.mark.skipif(os.geteuid() == 0 and not shutil.which("setpriv"), reason="root can write everywhere")
def test_a_folder_that_may_not_be_written_is_refused(tmp_path: Path, whole: vp.Run):
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o555)
    lesser = ["setpriv", "--bounding-set=-all", "--inh-caps=-all"] if os.geteuid() == 0 else []
    line = [*lesser, sys.executable, "-m", "viscopoint", "run", str(whole.folder / "case.toml")]
    done = subprocess.run([*line, "--out", str(closed / "run")], capture_output=True, text=True, check=False)
    assert done.returncode == 2, done.stderr
    assert "cannot be made or written (Permission denied)" in done.stderr
    assert not list(closed.iterdir())
