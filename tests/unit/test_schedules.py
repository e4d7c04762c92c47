"""When rows and snapshots are taken, as a case says it."""

import itertools
from typing import Any

import numpy as np
import pytest

import viscopoint as vp
from viscopoint.errors import CaseError
from viscopoint.model.callbacks import Callback
from viscopoint.model.schedule import Schedule, merged
from viscopoint.model.simulation import Simulation

COARSE = {"method.spacing": "1.2 mm", "time.end": "4 us", "time.snapshots": []}


def case(**changes: Any) -> vp.Case:
    return vp.Case.load("paper", COARSE, method="tlmpm").with_(**changes)


def due(schedule: Schedule, times: list[float]) -> list[float]:
    """Return at which times of a run's steps a schedule is due."""
    steps = enumerate(itertools.pairwise([0.0, *times]))
    return [now for step, (before, now) in steps if schedule.due(before, now, step)]


def test_intervals_are_due_at_the_first_step_at_or_behind_their_multiples():
    times = [0.0, 0.4, 0.9, 1.0, 1.1, 3.5, 3.9, 4.0 - 1e-12, 4.1]
    assert due(Schedule(every=1.0), times) == [0.0, 1.0, 3.5, 4.0 - 1e-12]


def test_times_are_due_once_however_many_lie_between_two_steps():
    assert due(Schedule(times=(0.3, 0.5, 1.0)), [0.0, 0.2, 0.6, 1.0, 1.2]) == [0.0, 0.6, 1.0]


def test_steps_are_counted_from_the_start():
    assert due(Schedule(steps=3), [0.1 * step for step in range(8)]) == pytest.approx([0.0, 0.3, 0.6])


def test_instants_of_a_tenth_are_those_of_its_multiples_and_end_with_the_run():
    instants = merged((*Schedule(every=0.1).instants(1.0), 1.0))
    assert len(instants) == 10
    assert instants[-1] == 1.0
    assert np.allclose(instants, np.arange(1, 11) / 10, rtol=1e-12)


def test_snapshots_at_an_interval_are_hit_exactly():
    run = vp.run(case(time={"snapshots": {"every": "1 us"}}))
    assert run.times.tolist() == [0.0, 0.001, 0.002, 0.003, 0.004]
    assert [row.time for row in run.rows] == run.times.tolist()


def test_snapshots_and_rows_by_steps_change_no_step():
    usual = vp.run(case())
    run = vp.run(case(time={"snapshots": {"every": 3}}, output={"history": {"every": 2}}))
    last = run.results.steps
    assert [row.step for row in run.rows] == sorted({*range(0, last, 3), last})
    assert run.columns["step"].tolist() == sorted({*range(0, last, 2), *range(0, last, 3), last})
    kept = np.isin(usual.columns["step"], run.columns["step"])
    assert np.array_equal(usual.columns["kinetic"][kept], run.columns["kinetic"])


def test_a_schedule_is_written_as_it_is_read():
    for snapshots in (["0.001 ms"], {"every": "0.001 ms"}, {"every": 5}):
        assert case(time={"snapshots": snapshots}).to_tables()["time"]["snapshots"] == snapshots
    assert case().to_tables()["output"] == {}


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"time.snapshots": {"every": 0}}, r"time\.snapshots: .* is no schedule: every so many steps, 1 or more"),
        (
            {"time.snapshots": {"every": True}},
            r"time\.snapshots: .* is a bare number",
        ),
        ({"output.history": {"every": "0 us"}}, r"output\.history: .* an interval is greater than zero"),
        ({"output.history": {"every": "-1 us"}}, r"output\.history: .* an interval is greater than zero"),
        ({"time.snapshots": {"every": "1 kg"}}, r"time\.snapshots: .* has the wrong dimension"),
        ({"time.snapshots": {"every": "1 ns"}}, r"time\.snapshots: 2e\+04 snapshots; no more than 10,000 are kept"),
        (
            {"time.snapshots": {"each": "1 us"}},
            r"time\.snapshots: .* is no schedule; write a list of times, \{ every =",
        ),
        ({"time.snapshots": ["1 us", "2"]}, r'time\.snapshots\[1\]: "2" has no unit; write a time such as "20 us"'),
        ({"output.history": "1 us"}, r'output\.history: "1 us" must be a list'),
        (
            {"output.history_interval": "1 us"},
            r"output\.history_interval: is now output\.history, as in history = \{ every",
        ),
    ],
)
def test_a_wrong_schedule_is_told_by_its_key(changes: dict[str, Any], told: str):
    with pytest.raises(CaseError, match=told):
        vp.Case.load("paper", changes)


def test_snapshots_by_steps_that_would_be_too_many_are_refused():
    with pytest.raises(vp.InputError, match=r"time\.snapshots: each 1 of about .* steps; no more than 10,000"):
        vp.run(case(time={"end": "100 ms", "snapshots": {"every": 1}}))


class Heights(Callback):
    """What a user may add: the height of the rod's lowest point, at an interval."""

    schedule = Schedule(every=0.001)

    def __init__(self) -> None:
        self.found: list[tuple[float, float]] = []

    closed = False

    def close(self) -> None:
        self.closed = True

    def __call__(self, simulation: Simulation) -> None:
        self.found.append((simulation.time, simulation.model.bodies[0].positions()[:, 2].min()))


def test_a_callback_of_a_user_s_own_is_called_on_its_schedule():
    heights = Heights()
    run = vp.run(case(), callbacks=[heights])
    assert heights.closed
    times, lowest = np.transpose(heights.found)
    rows = np.searchsorted(run.columns["time"], times)
    assert np.array_equal(run.columns["time"][rows], times)
    assert np.allclose(run.columns["lowest_point"][rows], lowest, rtol=1e-12)
    assert (np.diff(np.floor(times / 0.001 + 1e-9)) == 1).all()
    assert len(times) == 5
