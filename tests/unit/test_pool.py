"""Many runs at the same time: what is done, what is done again, and what goes wrong."""

import os
import signal
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
    with Pool(2) as pool, pytest.raises(vp.ViscopointError, match=r"run bad did not end: .*energy"):
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
