"""Many runs at the same time: what is done, what is done again, and what goes wrong."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import viscopoint as vp
from viscopoint.reproduction.pool import Pool


def test_runs_in_parallel_are_those_of_a_run_alone(quick: vp.Case, tmp_path: Path):
    shares: list[float] = []
    cases = {"one": quick, "group/other": quick.with_({"material.decay": "65 1/ms"})}
    with Pool(len(cases)) as pool:
        runs = pool.finish(cases, tmp_path, lambda share, _: shares.append(share))
    assert list(runs) == list(cases)
    for name, case in cases.items():
        assert runs[name].folder == tmp_path / name
        assert runs[name].rows == vp.run(case, figures=False).rows
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_a_run_that_a_guard_stops_is_named_and_the_others_stay(quick: vp.Case, tmp_path: Path):
    cases = {"good": quick, "bad": quick.with_({"guards.energy_error": 1e-9})}
    with Pool(2) as pool, pytest.raises(vp.ViscopointError, match=r"run bad is stopped: .*energy"):
        pool.finish(cases, tmp_path)
    assert vp.Run(tmp_path / "good").status == "complete"


def test_a_folder_that_is_no_run_is_not_touched(quick: vp.Case, tmp_path: Path):
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "thesis.txt").write_text("all my work")
    with Pool(1) as pool, pytest.raises(vp.InputError, match=r"has no provenance\.json"):
        pool.finish({"one": quick}, tmp_path)
    assert (tmp_path / "one" / "thesis.txt").read_text() == "all my work"


def kill(*words: object) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_killed_worker_ends_with_a_message():
    with Pool(1) as pool, pytest.raises(vp.ViscopointError, match="a worker process was killed"):
        pool.begin(kill, [("now",)])()


def reproducing(folder: Path) -> subprocess.Popen[str]:
    """Begin to draw a figure in a process group of its own, as a terminal would."""
    command = [sys.executable, "-m", "viscopoint", "reproduce", "--only", "fig6", "--out", str(folder)]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True)


def wait_until(there: Callable[[], object]) -> None:
    end = time.monotonic() + 60.0
    while not there() and time.monotonic() < end:
        time.sleep(0.05)
    assert there()


def children(process: int) -> list[int]:
    listed = subprocess.run(["ps", "-o", "pid=", "--ppid", str(process)], capture_output=True, text=True).stdout
    return [int(word) for word in listed.split()]


def test_ctrl_c_ends_all_workers_with_a_word_and_leaves_what_can_be_completed(tmp_path: Path):
    folder = tmp_path / "made"
    process = reproducing(folder)
    wait_until(lambda: list(folder.glob("runs/paper/*/history.csv")))
    os.killpg(process.pid, signal.SIGINT)
    messages = process.communicate(timeout=60)[1]
    assert process.returncode == 130
    assert messages.strip() == "viscopoint: interrupted"
    for run in folder.glob("runs/paper/*"):
        assert vp.Run(run).status in ("interrupted", "complete")
    again = reproducing(folder)
    assert again.communicate(timeout=120)[1] == ""
    assert (folder / "figures" / "paper" / "fig6.png").is_file()


def test_two_reproductions_do_not_share_a_folder_and_a_killed_one_leaves_no_workers(tmp_path: Path):
    folder = tmp_path / "made"
    first = reproducing(folder)
    wait_until(lambda: list(folder.glob("runs/paper/*/history.csv")))
    second = reproducing(folder)
    assert "another process is at work there" in second.communicate(timeout=60)[1]
    assert second.returncode == 2
    workers = children(first.pid)
    assert workers
    first.kill()
    first.communicate(timeout=60)

    def alive(worker: int) -> bool:
        return Path(f"/proc/{worker}").exists()

    wait_until(lambda: not any(map(alive, workers)))
