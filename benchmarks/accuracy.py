"""How accurate each method is for what it costs: the tables and figures of docs/accuracy.md.

    python benchmarks/accuracy.py run     # about an hour on two cores; complete runs are used again
    python benchmarks/accuracy.py cost    # processor time of each variant, on an otherwise idle machine: some minutes
    python benchmarks/accuracy_shown.py   # tables as Markdown, docs/accuracy.csv, figures into docs/figures

Runs go to runs/accuracy. Errors are differences from the limit (Richardson) of axisymmetric finite elements of three
sizes; outlines are held against those of the finest.
"""

import itertools
import json
import multiprocessing
import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from convergence import limit

import viscopoint as vp
from viscopoint.comparison.outline import apart, outline
from viscopoint.reproduction.deviations import noise

FOLDER = Path("runs", "accuracy")
CASES = {"paper-6.5": "β = 6.5", "paper-65": "β = 65", "paper": "β = 650", "paper-elastic": "elastic"}
SPACINGS = (0.76, 0.38, 0.19)  # mm
USUAL = 0.38
TIMES = ("5 us", "10 us", "20 us", "40 us", "60 us")
REFERENCE = (0.38, 0.19, 0.095)  # mm; finer ones are torn where waves focus on the axis
RELATIVE = ("impact_face_radius", "greatest_radius", "kinetic", "wall_impulse")  # in per cent of themselves
PAPER_GRID, TWO = 0.5 / 0.38, 2.0  # spacings to a cell


class Variant(NamedTuple):
    """A method, with the choices that make it."""

    label: str
    method: Mapping[str, Any]
    ratio: float = PAPER_GRID  # spacings to a cell
    fine: bool = False  # also at the smallest spacing

    def table(self, spacing: float) -> dict[str, Any]:
        """Return the ``[method]`` table."""
        if self.method["name"] == "fem":
            return {**self.method, "size": f"{spacing!r} mm"}
        return {**self.method, "spacing": f"{spacing!r} mm", "cell": f"{spacing * self.ratio!r} mm"}


def mpm(shape: str, transfer: str = "flip", **more: Any) -> dict[str, Any]:
    """Return a material point method's table."""
    return {"name": "mpm", "shape": shape, "transfer": transfer, "fill": "lattice", "contact": "nodes", **more}


VARIANTS = {
    "paper": Variant("trilinear, FLIP (the paper's)", mpm("trilinear"), fine=True),
    "trilinear-8": Variant("trilinear, FLIP, 8 points a cell", mpm("trilinear"), TWO),
    "trilinear-apic": Variant("trilinear, APIC", mpm("trilinear", "apic")),
    "gimp": Variant("GIMP, FLIP", mpm("gimp"), fine=True),
    "gimp-8": Variant("GIMP, FLIP, 8 points a cell", mpm("gimp"), TWO),
    "gimp-apic": Variant("GIMP, APIC", mpm("gimp", "apic"), fine=True),
    "gimp-tpic": Variant("GIMP, TPIC", mpm("gimp", "tpic")),
    "gimp-mean": Variant("GIMP, APIC, rings, cell-mean", mpm("gimp", "apic", fill="rings", volume="cell-mean")),
    "gimp-gated": Variant("GIMP, APIC, gated contact", mpm("gimp", "apic", contact="gated")),
    "cpgimp": Variant("cpGIMP, APIC", mpm("cpgimp", "apic")),
    "quadratic": Variant("quadratic, FLIP", mpm("quadratic")),
    "quadratic-apic": Variant("quadratic, APIC", mpm("quadratic", "apic"), fine=True),
    "cubic-apic": Variant("cubic, APIC", mpm("cubic", "apic")),
    "tlmpm": Variant("total Lagrangian (recommended)", {"name": "tlmpm"}, TWO, fine=True),
    "tlmpm-local": Variant("total Lagrangian, no shared dilatation", {"name": "tlmpm", "volume": "local"}, TWO),
    "fem": Variant("FEM, one-point", {"name": "fem"}, fine=True),
    "fem-selective": Variant("FEM, selective", {"name": "fem", "element": "selective"}, fine=True),
}


def case(name: str, variant: Variant, spacing: float) -> vp.Case:
    """Return a paper's case by another method; long runs of 60 µs where they are not too dear."""
    quick = spacing >= USUAL or variant.method["name"] != "mpm"
    times = TIMES if quick else TIMES[:3]
    tables = vp.Case.load(name).to_tables() | {
        "method": variant.table(spacing),
        "time": {"end": times[-1], "snapshots": list(times)},
        "guards": {"energy_error": 1.0},  # what is lost shall be seen
    }
    return vp.Case.from_tables(tables, name)


def planned() -> Iterator[tuple[str, vp.Case]]:
    """Yield folder and case of all runs, the cheap ones first."""
    for name, size in itertools.product(CASES, REFERENCE):
        elements = {"name": "fem", "geometry": "axisymmetric", "element": "selective", "delete_below": 0.1}
        yield f"{name}-reference-{size}", case(name, Variant("", elements), size)
    for spacing, (key, variant), name in itertools.product(SPACINGS, VARIANTS.items(), CASES):
        if spacing >= USUAL or variant.fine:
            yield f"{name}-{key}-{spacing}", case(name, variant, spacing)


def finish(folder: str, wanted: vp.Case) -> str:
    """Make a run that is not there, on one thread; say how it went."""
    place = FOLDER / folder
    if place.exists() and vp.Run(place).status != "running":
        return ""
    run = vp.run(wanted, place, force=True, figures=False)
    return f"{folder}: {run.status} {run.results.reason}"


def on_cores(work: Callable[..., Any], tasks: list[tuple[Any, ...]], workers: int | None = None) -> Iterator[Any]:
    """Call a function with each tuple of arguments, on a process for each core."""
    os.environ["NUMBA_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield from pool.map(work, *zip(*tasks, strict=True))


def run_all() -> None:
    """Make all runs."""
    for told in on_cores(finish, list(planned())):
        if told:
            print(told, file=sys.stderr, flush=True)


def seconds(key: str, spacing: float) -> float:
    """Return the processor time that a step takes on one thread (median of several stretches of some steps) [s]."""
    from viscopoint.model.build import build

    method = build(case("paper", VARIANTS[key], spacing)).method
    stretches = []
    for _ in range(8):
        began = time.process_time()
        for _ in range(4):
            method.advance(method.stable_step())
        stretches.append((time.process_time() - began) / 4)
    return float(np.median(stretches[1:]))  # the first compiles


def cost() -> None:
    """Measure what a step of each variant costs."""
    tasks = [(key, spacing) for key in VARIANTS for spacing in (0.76, USUAL)]
    found = dict(zip((f"{key}-{spacing}" for key, spacing in tasks), on_cores(seconds, tasks, 1), strict=True))
    (FOLDER / "cost.json").write_text(json.dumps(found, indent=1))


class Errors(NamedTuple):
    """How far a run is from the limit at one time, in per cent; what is not an error says what it is."""

    impact_face_radius: float
    greatest_radius: float
    velocity: float  # of the impact speed
    kinetic: float
    wall_impulse: float
    length: float
    outline: float  # area between, of the half section's
    noise: float  # of the pressure at the foot, MPa
    energy_error: float  # worst ever, of the initial energy


def reference(name: str) -> tuple[dict[tuple[str, str], float], vp.Run]:
    """Return the limits of all quantities at all times, and the finest run."""
    runs = [vp.Run(FOLDER / f"{name}-reference-{size}") for size in REFERENCE]
    asked = (*RELATIVE, "velocity", "length")
    limits = {
        (moment, quantity): limit([float(getattr(run.rows[at], quantity)) for run in runs], REFERENCE).value
        for at, moment in enumerate(TIMES, 1)
        for quantity in asked
    }
    return limits, runs[-1]


def errors(name: str, key: str, spacing: float) -> dict[str, Errors]:
    """Return the errors of a run at each of its snapshots."""
    limits, finest = reference(name)
    run = vp.Run(FOLDER / f"{name}-{key}-{spacing}")
    rod, speed = run.case.rod, run.case.impact.speed
    found = {}
    for row, moment in zip(run.rows[1:], TIMES, strict=False):
        if run.status != "complete" and row is run.rows[-1]:
            continue
        mine, best = run.snapshot(moment), finest.snapshot(moment)
        off = {it: 100 * (float(getattr(row, it)) / limits[moment, it] - 1) for it in (*RELATIVE, "length")}
        off["velocity"] = 100 * (row.velocity - limits[moment, "velocity"]) / speed
        area = 100 * apart(outline(finest, best), outline(run, mine), rod.radius * rod.length).area
        found[moment] = Errors(**off, outline=area, noise=noise(run, mine), energy_error=run.results.energy_error)
    return found


def processor_time(name: str, key: str, spacing: float, end: str) -> float:
    """Return what a run costs up to an instant on one core [s]: its steps times what a step was measured to take."""
    costs = json.loads((FOLDER / "cost.json").read_text())
    run = vp.Run(FOLDER / f"{name}-{key}-{spacing}")
    steps = run.rows[1 + TIMES.index(end)].step
    growth = (USUAL / spacing) ** 3 if spacing < USUAL else 1.0  # a step costs as much for each point
    return steps * growth * costs[f"{key}-{max(spacing, USUAL)}"]


if __name__ == "__main__":
    {"run": run_all, "cost": cost}[sys.argv[1]]()
