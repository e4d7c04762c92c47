"""Refines the finite element mesh and extrapolates: the tables of docs/fem.md and docs/axisymmetric.md.

    python benchmarks/convergence.py paper    # four materials, two elements, three sizes: a quarter of an hour
    python benchmarks/convergence.py copper   # the published bar, two elements, three sizes: a quarter of an hour
    python benchmarks/convergence.py rings    # both as axisymmetric bodies, down to 0.0475 mm: half an hour

Runs go to runs/convergence and are used again when they are complete. With sizes h1 > h2 > h3 of one ratio r, the
observed order is p = log((f1 - f2) / (f2 - f3)) / log r and the limit f3 + (f3 - f2) / (r^p - 1) (Richardson). Where
the differences do not shrink in one direction, order 1 is assumed. The uncertainty is what the limit is away from f3.
"""

import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

import viscopoint as vp
from viscopoint.model.energy_balance import Row

FOLDER = Path("runs", "convergence")
ELEMENTS = ("one-point", "selective")
PAPER = ("paper-6.5", "paper-65", "paper", "paper-elastic")
PAPER_SIZES = (0.76, 0.38, 0.19)  # mm; 5, 10, 20 elements to the radius
COPPER_SIZES = {  # mm; 5, 10, 15 and 5, 7.5, 10 elements to the radius: eight points cost four times as much
    "one-point": (0.64, 0.32, 0.64 / 3),
    "selective": (0.64, 1.28 / 3, 0.32),
}
TIMES = {"time.end": "120 us", "time.snapshots": ["5 us", "10 us", "20 us", "60 us"]}


class Measured(NamedTuple):
    """What is measured of axisymmetric runs."""

    sizes: tuple[float, ...]  # mm
    changes: dict[str, object]  # to the case
    asked: tuple[tuple[int, str], ...]  # snapshot and quantity


AT_20 = ("impact_face_radius", "greatest_radius", "velocity", "kinetic", "wall_impulse")
PAPER_RINGS = Measured(
    sizes=(0.76, 0.38, 0.19, 0.095, 0.0475),
    changes={"time.end": "60 us", "time.snapshots": ["5 us", "10 us", "20 us", "40 us"]},
    asked=(
        *((n, name) for n in (1, 2, 3) for name in AT_20),  # the tail has not felt the wall
        *((n, name) for n in (4, 5) for name in ("length", *AT_20)),
    ),
)
COPPER_RINGS = Measured((0.64, 0.32, 0.16), {}, ((4, "length"), (4, "impact_face_radius")))


class Limit(NamedTuple):
    """An extrapolated value."""

    value: float
    uncertainty: float
    order: float  # nan where it was not observed


def finished(case: str, element: str, size: float, changes: dict[str, object], mark: str = "") -> vp.Run:
    """Return a run as far as it went, made now if it is not there."""
    folder = FOLDER / f"{case}{mark}-{element}-{size:.3f}"
    if folder.exists() and (run := vp.Run(folder)).status in ("complete", "stopped"):
        return run
    tables = {"method.element": element, "method.size": f"{size!r} mm", **changes}
    print(f"... {folder}", file=sys.stderr, flush=True)
    return vp.run(vp.Case.load(case, tables, method="fem"), folder, force=True, figures=False)


def limit(values: list[float], sizes: tuple[float, ...]) -> Limit:
    """Extrapolate three values to no size."""
    first, second, third = values
    coarse, fine = second - first, third - second
    ratio = sizes[1] / sizes[2]
    if not math.isclose(sizes[0] / sizes[1], ratio, rel_tol=0.05):  # order 1 is what such bars show
        step = fine / (ratio - 1.0)
        return Limit(third + step, abs(step), math.nan)
    order = math.log(coarse / fine) / math.log(ratio) if coarse * fine > 0.0 else math.nan
    if not 0.5 <= order <= 3.0:
        return Limit(third + fine / (ratio - 1.0), abs(fine) / (ratio - 1.0), math.nan)
    step = fine / (ratio**order - 1.0)
    return Limit(third + step, abs(step), order)


def table(head: Sequence[str], rows: list[list[str]]) -> None:
    """Print a Markdown table."""
    for row in (head, ["---"] * len(head), *rows):
        print("| " + " | ".join(row) + " |")
    print()


def paper() -> None:
    """Print results, limits and the rebound of the paper's materials."""
    runs = {
        (case, element, size): finished(case, element, size, dict(TIMES))
        for size in PAPER_SIZES
        for element in ELEMENTS
        for case in PAPER
    }
    results(runs)
    rebounds(runs)
    limits(runs)


def results(runs: dict[tuple[str, str, float], vp.Run]) -> None:
    """Print what is measured at 5, 10 and 20 us."""
    head = "case,element,size,t (us),length,foot radius,greatest radius,velocity,kinetic,impulse,hourglass %,error %"
    rows = []
    for (case, element, size), run in runs.items():
        if size > 0.5:
            continue
        for row in run.rows[1:4]:
            internal = row.stored + row.dissipated
            energy = run.results.initial_energy
            rows.append([
                case, element, f"{size}", f"{row.time * 1e3:g}", f"{row.length:.3f}", f"{row.impact_face_radius:.4f}",
                f"{row.greatest_radius:.4f}", f"{row.velocity:.3f}", f"{row.kinetic:.1f}", f"{row.wall_impulse:.3f}",
                f"{100 * row.hourglass / internal:.2f}", f"{100 * row.numerical / energy:+.2f}",
            ])  # fmt: skip
    table(head.split(","), rows)


def rebounds(runs: dict[tuple[str, str, float], vp.Run]) -> None:
    """Print how each rod leaves the wall, and the worst of the energy balance, by 120 us."""
    head = "case,element,size,separation (us),rebound (m/s),greatest shortening (mm),at (us),hourglass %,worst error %"
    rows = []
    for (case, element, size), run in runs.items():
        history, end = run.history, run.rows[-1]
        pushed = np.flatnonzero(np.diff(history["wall_impulse"]) > 0.0)
        last = float(history["time"].iloc[pushed[-1] + 1])
        left = f"{last * 1e3:.1f}" if last < 0.999 * end.time else "not yet"
        shortest = int(history["length"].argmin())
        short = float(history["length"].iloc[0] - history["length"].iloc[shortest])
        rows.append([
            case, element, f"{size}", left, f"{end.velocity:.3f}", f"{short:.4f}",
            f"{1e3 * float(history['time'].iloc[shortest]):.1f}",
            f"{100 * end.hourglass / (end.stored + end.dissipated):.2f}", f"{run.results.energy_error:.2f}",
        ])  # fmt: skip
    table(head.split(","), rows)


def limits(runs: dict[tuple[str, str, float], vp.Run]) -> None:
    """Print orders and limits for both elements, and how far they are apart."""
    asked = [(name, 3) for name in AT_20] + [("length", 4), ("impact_face_radius", 4)]
    head = ["case", "quantity", *(f"{element} {part}" for element in ELEMENTS for part in ("values", "order", "limit"))]
    rows = []
    for case in PAPER:
        for name, snapshot in asked:
            cells, found = [], []
            for element in ELEMENTS:
                values = [float(getattr(runs[case, element, h].rows[snapshot], name)) for h in PAPER_SIZES]
                found.append(limit(values, PAPER_SIZES))
                shown = ", ".join(f"{value:.6g}" for value in values)
                cells += [shown, _order(found[-1]), f"{found[-1].value:.6g} ± {found[-1].uncertainty:.2g}"]
            apart = 100 * abs(found[0].value - found[1].value) / abs(found[1].value)
            time = runs[case, ELEMENTS[0], PAPER_SIZES[0]].rows[snapshot].time * 1e3
            rows.append([case, f"{name}, {time:g} us", *cells, f"{apart:.2f} %"])
    table([*head, "apart"], rows)


def copper() -> None:
    """Print length and foot radius of the copper bar and their limits."""
    head = "element,size,length,foot radius,steps,hourglass %,worst energy error %"
    runs = {(el, h): finished("copper-fem", el, h, {}) for el in ELEMENTS for h in COPPER_SIZES[el]}
    rows = []
    for (element, size), run in runs.items():
        end: Row = run.rows[-1]
        share = 100 * end.hourglass / (end.stored + end.dissipated)
        rows.append([
            element, f"{size:.3f}", f"{end.length:.4f}", f"{end.impact_face_radius:.4f}", str(run.results.steps),
            f"{share:.2f}", f"{run.results.energy_error:.2f}",
        ])  # fmt: skip
    table(head.split(","), rows)
    for element in ELEMENTS:
        for name in ("length", "impact_face_radius"):
            sizes = COPPER_SIZES[element]
            values = [float(getattr(runs[element, h].rows[-1], name)) for h in sizes]
            found = limit(values, sizes)
            print(f"{element} {name}: {found.value:.4f} ± {found.uncertainty:.4f} mm")


def rings() -> None:
    """Print limits of axisymmetric runs at all snapshots, each from the three finest meshes that come so far."""
    head = ["case", "t (us)", "quantity", "sizes"]
    rows = []
    for case in (*PAPER, "copper"):
        measured = COPPER_RINGS if case == "copper" else PAPER_RINGS
        changes = {"method.geometry": "axisymmetric", **measured.changes}
        runs = {(el, h): finished(case, el, h, changes, "-rings") for el in ELEMENTS for h in measured.sizes}
        for snapshot, name in measured.asked:
            time = runs[ELEMENTS[0], measured.sizes[0]].rows[snapshot].time
            reach = [h for h in measured.sizes if all(_reaches(runs[el, h], snapshot, time) for el in ELEMENTS)][-3:]
            cells, found = [], []
            for element in ELEMENTS:
                values = [float(getattr(runs[element, h].rows[snapshot], name)) for h in reach]
                found.append(limit(values, tuple(reach)))
                cells += [f"{found[-1].value:.6g} ± {found[-1].uncertainty:.2g}", _order(found[-1])]
            apart = 100 * abs(found[0].value - found[1].value) / abs(found[1].value)
            shown = ", ".join(f"{h:.4g}" for h in reach)
            rows.append([case, f"{time * 1e3:g}", name, shown, *cells, f"{apart:.3f}"])
    table([*head, *(f"{el}: {part}" for el in ELEMENTS for part in ("limit", "order")), "apart, %"], rows)


def _reaches(run: vp.Run, snapshot: int, time: float) -> bool:
    return len(run.rows) > snapshot and math.isclose(run.rows[snapshot].time, time)


def _order(found: Limit) -> str:
    return "-" if math.isnan(found.order) else f"{found.order:.2f}"


if __name__ == "__main__":
    {"paper": paper, "copper": copper, "rings": rings}[sys.argv[1]]()
