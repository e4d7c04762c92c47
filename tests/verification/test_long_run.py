"""Two hundred thousand steps: what a run needs does not grow, and its accounts stay closed."""

from pathlib import Path

import numpy as np
import psutil
import pytest

import viscopoint as vp
from viscopoint.model.energy_balance import Row

STEPS = 200_000
ROD = {
    "rod.length": "10 mm",
    "impact.speed": "1 m/s",
    "method.geometry": "axisymmetric",
    "material.decay": "6.5 1/ms",
    "output.history": {"every": 1},
}
BOX = {"x": ["-8 mm", "8 mm"], "y": ["-8 mm", "8 mm"], "z": ["-0.01 mm", "300 mm"]}  # for the flight after the rebound
SIZES = {
    "mpm": {"method.spacing": "0.95 mm", "method.cell": "1.9 mm", "method.box": BOX},
    "tlmpm": {"method.spacing": "0.95 mm"},
    "fem": {"method.size": "0.95 mm"},
}


def memory() -> float:
    """Return the memory that this process has now [bytes]; the most it ever had was for compiling."""
    return float(psutil.Process().memory_info().rss)


@pytest.mark.long
@pytest.mark.parametrize("method", SIZES)
def test_two_hundred_thousand_steps_need_no_more_memory_and_keep_the_balance(method: str, tmp_path: Path):
    case = vp.Case.load("paper", ROD | SIZES[method], method=method)
    step = vp.run(case.with_({"time.end": "20 us"}), figures=False).columns["time_step"][-1].item()
    end = 1.1 * STEPS * step  # some steps are longer
    times = np.linspace(0.0, end, 21)[1:-1]
    case = case.with_({"time.end": f"{end!r} ms", "time.snapshots": [f"{time!r} ms" for time in times.tolist()]})
    had: dict[int, float] = {}

    def watch(share: float, row: Row) -> None:
        if row.step % 10_000 == 0:
            had[row.step] = memory()

    run = vp.run(case, tmp_path / "run", figures=False, checkpoint_every="2 s", watch=watch)
    assert run.status == "complete"
    rows = run.columns
    assert len(rows["time"]) == run.results.steps + 1 >= STEPS  # no row is missing, none is there twice
    assert (rows["step"] == np.arange(len(rows["step"]))).all()
    assert run.results.energy_error <= 100 * case.guards.energy_error
    # the history is kept, in an array that grows by a sixteenth; a leak of one small array a step would be 20 MB
    history = 8 * len(Row._fields)
    assert had[190_000] - had[20_000] < history * (170_000 + 190_000 / 16) + 4e6, had
    snapshot = sum(file.stat().st_size for file in (run.folder / "fields").iterdir()) / len(run.times)
    raw = sum(field.values.nbytes for field in run.snapshot(-1).fields.values())
    assert snapshot < 2 * raw + 20_000
    assert (run.folder / "history.csv").stat().st_size < 600 * len(rows["time"])
    print(method, run.results.steps, run.results.energy_error, run.results.momentum_error, had)
