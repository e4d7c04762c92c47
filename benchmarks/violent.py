"""The softest rod for long, and at twice the speed: what each method makes of large strains (docs/accuracy.md).

    python benchmarks/violent.py   # some ten minutes; complete runs are used again

The paper's rod of β = 650 1/ms at 150 m/s to 100 µs, and at 300 m/s to 60 µs.
"""

from pathlib import Path

import numpy as np
from accuracy import USUAL, VARIANTS
from convergence import table

import viscopoint as vp

FOLDER = Path("runs", "violent")
METHODS = ("fem", "fem-selective", "tlmpm", "paper", "gimp", "gimp-apic")
TIMES = {150: (20, 40, 60, 80, 100), 300: (10, 20, 30, 40, 60)}  # µs, by impact speed


def finished(speed: int, key: str) -> vp.Run:
    """Return a run, made now if it is not there."""
    folder = FOLDER / f"{speed}-{key}"
    if folder.exists() and (run := vp.Run(folder)).status != "running":
        return run
    times = [f"{time} us" for time in TIMES[speed]]
    tables = vp.Case.load("paper", {"impact.speed": f"{speed} m/s"}).to_tables() | {
        "method": VARIANTS[key].table(USUAL),
        "time": {"end": times[-1], "snapshots": times},
        "guards": {"energy_error": 0.5},
    }
    return vp.run(vp.Case.from_tables(tables), folder, force=True, figures=False)


def worst(run: vp.Run, number: int) -> tuple[float, str]:
    """Return the least J of a snapshot, and the least scaled Jacobian if it has elements."""
    snapshot = run.snapshot(number)
    shape = f"{snapshot['scaled_jacobian'].min():.3f}" if "scaled_jacobian" in snapshot.fields else "-"
    return float(snapshot["jacobian"].min()), shape


def show(speed: int) -> None:
    """Print what each method measures at each time, and how it ended."""
    head = (
        "method", "t (us)", "length", "foot radius", "greatest radius", "velocity", "kinetic (mJ)", "impulse (N ms)",
        "least J", "least scaled Jacobian", "step / first", "lost", "energy error, worst %",
    )  # fmt: skip
    rows, ends = [], []
    for key in METHODS:
        run = finished(speed, key)
        first = float(run.history["time_step"].iloc[1])
        for number, row in enumerate(run.rows[1:], 1):
            least, shape = worst(run, number)
            rows.append([
                VARIANTS[key].label, f"{row.time * 1e3:.4g}", f"{row.length:.3f}", f"{row.impact_face_radius:.3f}",
                f"{row.greatest_radius:.3f}", f"{row.velocity:.2f}", f"{row.kinetic:.0f}", f"{row.wall_impulse:.2f}",
                f"{least:.3f}", shape, f"{np.round(row.time_step / first, 3):g}", str(row.lost),
                f"{run.results.energy_error:.2f}",
            ])  # fmt: skip
        ends.append([VARIANTS[key].label, run.status, run.results.reason or "-", str(run.results.steps)])
    table(head, rows)
    table(("method", "ended", "because", "steps"), ends)


if __name__ == "__main__":
    for asked in TIMES:
        print(f"### {asked} m/s\n")
        show(asked)
