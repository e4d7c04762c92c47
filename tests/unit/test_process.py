"""The process in which a run computes: forks, a compiler that is switched off, threads."""

import multiprocessing
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numba
import pytest
from typer.testing import CliRunner

import viscopoint as vp
from viscopoint.command_line.cli import app
from viscopoint.kernels import threads

MOST = numba.get_num_threads()
LONG_ENOUGH = 120.0  # s

FORKED = """
import multiprocessing
import viscopoint as vp
from viscopoint.model.build import build
from viscopoint.model.simulation import Simulation
small = {"method.spacing": "0.6 mm", "time.end": "1 us", "time.snapshots": []}
case = vp.Case.load("paper", small, method="tlmpm")
vp.run(case, figures=False)
model = build(case)

def status(_):
    return vp.run(case, figures=False).status

def end(_):
    return Simulation(model).run().status

if __name__ == "__main__":
    for work in (status, end):
        with multiprocessing.get_context("fork").Pool(2) as pool:
            for result in [pool.apply_async(work, (n,)) for n in range(2)]:
                try:
                    print(result.get(60))
                except vp.ViscopointError as error:
                    print(error)
                except multiprocessing.TimeoutError:
                    print("hangs")
"""


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="this system has no fork")
def test_forks_of_a_process_that_has_computed_are_told_how_to_start_instead(tmp_path: Path):
    (tmp_path / "pool.py").write_text(FORKED)
    words = [sys.executable, "-W", "ignore", str(tmp_path / "pool.py")]
    done = subprocess.run(words, capture_output=True, text=True, timeout=3 * LONG_ENOUGH, check=True)
    lines = done.stdout.splitlines()
    assert len(lines) == 4
    for line in lines:  # a layer of threads that survives forks computes; GNU OpenMP does not
        assert line == "complete" or ("forked" in line and '"spawn"' in line), done.stdout


def test_numba_told_not_to_compile_is_refused_before_anything_is_written(tmp_path: Path):
    words = [sys.executable, "-m", "viscopoint", "run", "paper", "--out", str(tmp_path / "run")]
    done = subprocess.run(words, env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.strip().count("\n") == 0
    assert "NUMBA_DISABLE_JIT" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_an_exception_ends_says_so(quick: vp.Case, tmp_path: Path):
    def fail(share: float, row: object) -> None:
        if share > 0.3:
            raise RuntimeError("what users pass")

    with pytest.raises(RuntimeError, match="what users pass"):
        vp.run(quick, tmp_path / "run", figures=False, watch=fail)
    run = vp.Run(tmp_path / "run")
    assert run.status == "interrupted"
    assert run.results.reason == "RuntimeError: what users pass"
    assert vp.resume(tmp_path / "run", figures=False).status == "complete"


@pytest.fixture
def many_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the machine have at least two cores to choose from, with no word of anybody on how many to take."""
    if MOST < 2:
        pytest.skip("this machine has one core")
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    numba.set_num_threads(MOST)


def used(case: vp.Case, wanted: int | None = None) -> int:
    """Return on how many threads a run computed, by what its kernels saw and by its provenance."""
    seen: set[int] = set()
    run = vp.run(case, figures=False, threads=wanted, watch=lambda *_: seen.add(numba.get_num_threads()))
    assert seen == {run.provenance["threads"]}
    return seen.pop()


def test_a_small_model_takes_one_thread_unless_somebody_says_otherwise(quick: vp.Case, many_threads: None):
    assert used(quick) == 1
    assert used(quick, 2) == 2
    assert numba.get_num_threads() == MOST  # as before


def test_a_large_model_takes_all_threads_or_as_many_as_numba_was_told(
    quick: vp.Case, many_threads: None, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(threads, "SMALL", 10)
    assert used(quick) == MOST
    numba.set_num_threads(1)
    assert used(quick) == 1
    assert used(quick, 2) == 2
    assert numba.get_num_threads() == 1


def test_threads_named_in_the_environment_are_taken_for_small_models_too(
    quick: vp.Case, many_threads: None, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("NUMBA_NUM_THREADS", str(MOST))
    assert used(quick) == MOST


@pytest.mark.parametrize("wanted", [0, -1, 1000, 2.5, True, "2"])
def test_a_number_of_threads_that_cannot_be_is_refused_and_nothing_written(
    wanted: Any, quick: vp.Case, finished: Path, tmp_path: Path
):
    for call in (lambda: vp.run(quick, tmp_path / "run", threads=wanted), lambda: vp.resume(finished, threads=wanted)):
        with pytest.raises(vp.InputError, match=r"threads: .*(this machine has|is not a whole number)"):
            call()
    assert list(tmp_path.iterdir()) == []
    if type(wanted) is int:
        for words in (["run", "paper", "--out", str(tmp_path / "run")], ["resume", str(finished)]):
            assert CliRunner().invoke(app, [*words, "--threads", str(wanted)]).exit_code == 2
        assert list(tmp_path.iterdir()) == []
