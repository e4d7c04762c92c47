from operator import attrgetter
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import viscopoint as vp
from viscopoint.results.verify import verify


@pytest.mark.parametrize(
    ("name", "words", "named", "message"),
    [
        ("Case.load", [None], {}, "Case.load, source: None is not text or a path"),
        ("Case.load", ["paper"], {"method": 3}, "Case.load, method: 3 is not text or None"),
        ("Case.load", ["paper", "fem"], {}, "Case.load, changes: 'fem' is not a table with text as keys or None"),
        ("Case.load", ["paper", {3: 4}], {}, "Case.load, changes: {3: 4} is not a table with text as keys"),
        ("Case.from_tables", [["rod"]], {}, "Case.from_tables, tables: ['rod'] is not a table"),
        ("made.case.with_", [3], {}, "Case.with_, changes: 3 is not a table"),
        ("made.case.with_", [], {"rod": 3}, "rod: 3 must be a table"),
        ("run", [None], {}, "run, case: None is not a Case or text or a path"),
        ("run", [3], {}, "run, case: 3 is not a Case or text or a path"),
        ("run", ["papr"], {}, "there is no case 'papr', neither packaged nor a file; did you mean 'paper'?"),
        ("run", ["paper", 3], {}, "run, folder: 3 is not text or a path or None"),
        ("run", ["paper"], {"checkpoint_every": 10}, "run, checkpoint_every: 10 is not text"),
        ("run", ["paper"], {"force": "yes"}, "run, force: 'yes' is not True or False"),
        ("run", ["paper"], {"watch": 3}, "run, watch: 3 is not a function or None"),
        ("resume", [None], {}, "resume, folder: None is not text or a path"),
        ("Run", [None], {}, "Run, folder: None is not text or a path"),
        ("made.snapshot", [2.5], {}, "Run.snapshot, time: 2.5 is not text or a whole number"),
        ("made.snapshot", [None], {}, "Run.snapshot, time: None is not text or a whole number"),
        ("made.snapshot", [True], {}, "Run.snapshot, time: True is not text or a whole number"),
        ("made.snapshot", [0, "stress"], {}, "Run.snapshot, only: 'stress' is not a list of (text) or None"),
        ("made.profile", [0], {}, "Run.profile, snapshot: 0 is not a Snapshot"),
        ("compare", [[None]], {}, "compare, runs: [None] is not a list of (a Run or text or a path)"),
        ("compare", ["runs"], {}, "compare, runs: 'runs' is not a list of (a Run or text or a path)"),
        ("compare", [["a", "b"], 0.002], {}, "compare, times: 0.002 is not a list of (a number) or None"),
        ("compare", [["a", "b"]], {"any_physics": 1}, "compare, any_physics: 1 is not True or False"),
        ("reproduce", [None], {}, "reproduce, out: None is not text or a path"),
        ("reproduce", ["x", "fig5"], {}, "reproduce, only: 'fig5' is not a list of (text)"),
        ("reproduce", ["x"], {"resolution": 2}, "reproduce, resolution: 2 is not text"),
        ("verify", [3], {}, "verify, folder: 3 is not text or a path"),
    ],
)
def test_an_argument_of_the_wrong_kind_is_named_with_what_is_allowed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, finished: Path,
    name: str, words: list[Any], named: dict[str, Any], message: str,
):  # fmt: skip
    monkeypatch.chdir(tmp_path)
    api = SimpleNamespace(made=vp.Run(finished), verify=verify, **{each: getattr(vp, each) for each in vp.__all__})
    with pytest.raises(vp.InputError) as caught:
        attrgetter(name)(api)(*words, **named)
    assert message in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_what_is_as_good_is_taken(finished: Path):
    run = vp.Run(str(finished))
    second, times = cast(Any, np.int64(1)), cast(Any, np.array([0.002]))
    assert run.snapshot(second).time == run.snapshot(1, only={"velocity"}).time
    assert vp.compare((run, str(finished)), times).times == (0.002,)
    assert run.case.with_(title="mine").title == "mine"


def test_run_takes_the_name_or_the_path_of_a_case(tmp_path: Path, quick: vp.Case):
    file = tmp_path / "mine.toml"
    file.write_text(quick.with_({"time.end": "0.1 us", "time.snapshots": []}).to_toml())
    for source in (file, str(file)):
        assert vp.run(source, figures=False).case.time.end == 1e-4


def test_an_enormous_value_is_shown_short():
    with pytest.raises(vp.InputError) as caught:
        vp.Case.load(["x" * 10_000])  # pyright: ignore[reportArgumentType]
    assert len(str(caught.value)) < 150
