import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import shell

from viscopoint.bench import Plan, compare, measure, planned
from viscopoint.bench.memory import measured_growth
from viscopoint.bench.record import Record, Spread, read, write
from viscopoint.bench.startup import startups
from viscopoint.bench.timing import started
from viscopoint.bench.traffic import PASSES, arrays_of, bytes_held, bytes_per_step
from viscopoint.bench.triad import bandwidths, triad, triads
from viscopoint.bench.work import MATERIALS, PAPER_LAW, VARIANTS, Work, case_of, passes_of, selection
from viscopoint.case.case import Case
from viscopoint.command_line.terminal import progress
from viscopoint.kernels.arrays import AnyArray
from viscopoint.model.build import build
from viscopoint.model.method import Method

TINY = [Work(*variant, PAPER_LAW, "3k") for variant in VARIANTS]
# the body at the start, what only the foot's nodes on the wall ask for, and what points ask for in sums alone
SELDOM = ("body.position", "body.volume", "body.cells", "reference", "nodes.partner", "points.shared.alive")


call = partial(shell.call, "bench")


@pytest.fixture(scope="module", autouse=True)
def _short_triad() -> Iterator[None]:
    """Let the triad's arrays be short: what it finds matters to no test."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("viscopoint.bench.triad.length", lambda: 1000)
        yield


@pytest.fixture(scope="module")
def record() -> Record:
    """What a small run measured, of one method on one thread."""
    work = next(work for work in TINY if work.name.startswith("fem one-point"))
    with progress("") as watch:
        return measure(Plan((work,), (1,), repeats=2, quick=True, startup=False), watch)


def test_triad_adds_and_counts_two_reads_and_a_write_of_eight_bytes():
    a, b, c = np.zeros((3, 1000)) + [[0.0], [1.0], [2.0]]
    triad(a, b, c, 3.0)
    assert (a == 7.0).all()
    began = time.perf_counter()
    found = bandwidths((1,), repeats=2)
    taken = time.perf_counter() - began
    assert sum(24 * 1000 / (rate * 1e9) for rate in found[1]) < taken
    (both,) = triads(found, {1: [found[1][0] + 1.0]})
    assert both.array_bytes == 8000
    assert both.gigabytes_per_second.repeats == 3


@pytest.fixture(scope="module", params=[work for work in TINY if work.variant != "cubic"], ids=lambda work: work.name)
def built(request: pytest.FixtureRequest) -> tuple[Work, Method]:
    """A small model of each kind, not yet moved."""
    return request.param, build(case_of(request.param)).method


def test_passes_name_arrays_that_exist_and_miss_none_with_a_row_for_each_part(built: tuple[Work, Method]):
    work, method = built
    arrays = arrays_of(method)
    named = {name for one in passes_of(work) for name in f"{one.reads} {one.writes}".split()}
    assert named <= arrays.keys()
    fewest = min(len(method.positions()), len(arrays.get("elements.shared.alive", method.positions()))) // 2
    long = {name for name, array in arrays.items() if len(array) >= fewest and array.size}
    hourglass = {"elements.hourglass_work"} if work.variant == "selective" else set[str]()  # it has none
    surface = {name for name in long if name.startswith("body.surface")}
    assert long - named - surface - hourglass <= set(SELDOM)


def test_bytes_of_a_step_are_those_of_the_arrays_that_passes_name():
    work = next(work for work in TINY if work.name.startswith("fem selective"))
    method = build(case_of(work)).method
    elements, nodes = len(arrays_of(method)["elements.shared.alive"]), len(method.positions())
    material = 8 * (8 * (6 + 6 + 1 + 1) + 3)  # stress, arm's stress and two losses of each point; J and viscosity
    answer = elements * (8 + 1 + 8 * 4 + 8 * 8 + 2 * material) + nodes * (3 + 1) * 24  # order, alive, corners, volumes
    kick = nodes * (4 * 24 + 2 * 8)  # velocity, twice, force, inverse mass; two masses
    meet, stand = nodes * (8 + 2 * 24 + 1), nodes * 8  # the mass that meets the wall; place, velocity; pressed
    drift = nodes * 4 * 24
    assert bytes_per_step(method, passes_of(work)) == 2 * kick + meet + drift + answer + stand


def test_bytes_held_count_an_array_once():
    class Two:
        def __init__(self) -> None:
            self.first: AnyArray = np.zeros((10, 3))
            self.second = self.first

    assert bytes_held(Two()) == 240


def test_every_method_and_law_of_the_package_is_measured():
    works = selection(("21k", "169k"), quick=False)
    assert {work[:2] for work in works} == set(VARIANTS)
    assert {work.law for work in works} == set(MATERIALS)
    assert {passes_of(work) for work in works} == set(PASSES.values())
    laws = {Case.load("paper").with_(material={"law": law, **keys}).material.law for law, keys in MATERIALS.items()}
    assert laws == set(MATERIALS)
    assert all(work.law == PAPER_LAW and work.size == "21k" for work in selection(("21k",), quick=True))


def test_the_problem_is_the_same_every_time():
    case = case_of(TINY[-1])
    (one, parts), (other, count) = started(case), started(case)
    assert parts == count
    assert all((one.state()[name] == values).all() for name, values in other.state().items())


def test_a_record_comes_back_from_its_file_as_it_was(tmp_path: Path, record: Record):
    write(record, tmp_path / "bench.json")
    assert read(tmp_path / "bench.json") == record
    assert [path.name for path in tmp_path.iterdir()] == ["bench.json"]
    assert record.memory[0].peak_growth is None


def test_limit_is_bytes_times_steps_over_the_greatest_bandwidth(record: Record):
    (pace,), (limit,) = record.pace, record.triad
    rate = pace.bytes_per_step / pace.parts * pace.million_steps_per_second.median * 1e6
    assert pace.bandwidth_share == pytest.approx(rate / (limit.gigabytes_per_second.most * 1e9))
    assert limit.gigabytes_per_second.repeats == 2 * record.repeats  # before and after all else
    assert pace.thread_scaling == pace.size_scaling == 1.0


def test_comparing_gives_new_over_old_and_whether_spreads_overlap(record: Record):
    (pace,) = record.pace
    values = pace.million_steps_per_second
    twice = Spread(median=2 * values.median, least=2 * values.most, most=2 * values.most, repeats=values.repeats)
    faster = pace.model_copy(update={"million_steps_per_second": twice, "bytes_per_step": pace.bytes_per_step // 2})
    changed = record.model_copy(update={"pace": [faster], "machine": record.machine | {"processor": "another"}})
    found = {(one.name, one.unit): one for one in compare.ratios(record, changed)}
    assert found[f"{pace.name}, threads: 1", "M steps/s"].ratio == 2.0
    assert found[f"{pace.name}, threads: 1", "M steps/s"].overlap is False
    assert found[pace.name, "bytes a step"].ratio == pytest.approx(0.5, rel=1e-4)
    assert found["triad, threads: 1", "GB/s"].overlap is True
    assert "another" in "".join(compare.notes(record, changed))
    assert list(compare.notes(record, record)) == []


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--size", "huge"], "--size huge: not known"),
        (["--threads", "0"], "--threads 0: write numbers from 1 to"),
        (["--threads", "two"], "--threads two: write numbers from 1 to"),
        (["--threads", "1000"], "--threads 1000: write numbers from 1 to"),
        (["--only", "quintic"], "--only quintic: in no name"),
        (["--compare", "absent.json"], "absent.json: not a file that `viscopoint bench --out` wrote (No such file"),
        (
            ["--compare", "text.json"],
            "text.json: not a file that `viscopoint bench --out` wrote (the file: Invalid JSON",
        ),
        (["--compare", "list.json"], "list.json: not a file that `viscopoint bench --out` wrote"),
        (["--compare", "later.json"], "later.json: not a file that `viscopoint bench --out` wrote (format: "),
        (["--out", "text.json"], "--out text.json: already there; --force replaces it"),
        (["--out", "text.json", "--force"], "text.json: not a file that `viscopoint bench --out` wrote"),
        (["--out", "text.json/deep.json"], "cannot be made"),
        (["--out", "/proc/self/bench.json"], "cannot be made"),  # a folder that even root cannot write
        (["--out", "deep/bench.json", "--threads", "0"], "--threads 0"),
    ],
)
def test_bad_input_gives_one_message_and_code_2_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], message: str
):
    monkeypatch.chdir(tmp_path)
    texts = {"text.json": "all my work", "list.json": "[1]", "later.json": '{"kind": "viscopoint bench", "format": 2}'}
    for name, text in texts.items():
        Path(name).write_text(text)
    code, out, messages = call(*words)
    assert (code, out) == (2, "")
    assert message in messages
    assert len(messages.splitlines()) == 1
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == texts


def test_a_quick_run_prints_keeps_and_compares(tmp_path: Path):
    file = tmp_path / "deep" / "bench.json"
    words = ("--quick", "--size", "tiny", "--threads", "1", "--only", "fem one-point")
    code, out, messages = call(*words, "--out", file)
    assert (code, messages) == (0, "")
    assert "one-point" in out
    assert str(file) in out.replace("\n", "")
    before = read(file)
    assert planned(quick=True, extent="tiny", only="fem one-point").works == (Work(*before.pace[0].name.split()),)
    code, out, messages = call(*words, "--compare", file, "--out", file, "--force")
    assert (code, messages) == (0, "")
    assert "new over old" in out
    assert read(file) != before


@pytest.mark.long  # compiles all kernels of a run anew
def test_a_start_without_kernels_takes_longer_than_one_with_them():
    shown, cold, warm = startups(1, cold=True)
    assert (shown.command, cold.cache, warm.cache) == ("viscopoint --help", "empty", "filled")
    assert cold.seconds.median > 2 * warm.seconds.median > 2 * shown.seconds.median


@pytest.mark.long
def test_a_process_grows_by_what_its_model_holds_and_more():
    work = Work("fem", "selective", PAPER_LAW, "169k")
    held = bytes_held(build(case_of(work)).method)
    small = bytes_held(build(case_of(work._replace(size="3k"))).method)  # which the process had before
    assert held - small < measured_growth(work) < 2 * held
