"""Measures material-point-steps and element-steps per second, for one thread and for all, on the paper's rod.

Run it with ``make bench``; ``steps.py variants`` compares the step of a point in each variant of the material point
method with that of the paper's. Each figure is the median over repetitions of a block of steps, with the fastest and
the slowest beside it; what is compared runs within one process, in turns, because machines are noisy.
"""

import statistics
import sys
import time
from typing import Any

import numba
from rich.console import Console
from rich.table import Table

from viscopoint.case import Case
from viscopoint.method import Method
from viscopoint.model import build

FINE_MPM = {"method.spacing": "0.19 mm", "method.cell": "0.25 mm"}
BENCHES: list[tuple[str, str, dict[str, Any]]] = [
    ("MPM, trilinear, MUSL", "mpm", {}),
    ("MPM, trilinear, MUSL", "mpm", FINE_MPM),
    ("FEM, one point, stiffness", "fem", {"method.size": "0.475 mm"}),
    ("FEM, one point, stiffness", "fem", {"method.size": "0.24 mm"}),
    ("FEM, one point, viscous", "fem", {"method.size": "0.24 mm", "method.hourglass.form": "viscous"}),
    ("FEM, selective", "fem", {"method.size": "0.475 mm", "method.element": "selective"}),
    ("FEM, selective", "fem", {"method.size": "0.24 mm", "method.element": "selective"}),
]
PAPER = "mpm, trilinear, flip, musl"
SHAPES = ("trilinear", "gimp", "cpgimp", "quadratic", "cubic")
TRANSFERS: dict[str, dict[str, Any]] = {
    "flip": {},
    "flip, 0.01 PIC": {"method.pic_fraction": 0.01},
    "apic": {"method.transfer": "apic"},
    "tpic": {"method.transfer": "tpic"},
    "fmpm 2": {"method.transfer": "fmpm"},
    "fmpm 4": {"method.transfer": "fmpm", "method.order": 4},
}
OTHERS: dict[str, dict[str, Any]] = {
    "cell-mean": {"method.volume": "cell-mean"},
    "gated": {"method.contact": "gated"},
}
VARIANTS: list[tuple[str, str, dict[str, Any]]] = [
    *(
        (f"{shape}, {name}", "mpm", {"method.shape": shape, **more})
        for shape in SHAPES
        for name, more in {**TRANSFERS, **OTHERS}.items()
        if (shape, name) != ("trilinear", "tpic")
    ),
    *((f"trilinear, {scheme}", "mpm", {"method.scheme": scheme}) for scheme in ("usl", "usf")),
    *((f"tlmpm, {volume}", "tlmpm", {"method.volume": volume}) for volume in ("local", "cell-mean")),
    ("tlmpm, gimp, cell-mean", "tlmpm", {"method.shape": "gimp"}),
]
START = 40  # steps into the impact before the clock starts
REPEATS = 9


def methods() -> None:
    """Print the pace of each method on one thread and on all."""
    threads = sorted({1, numba.get_num_threads()})
    columns = ("method", "points or elements", "threads", "M steps of one/s", "spread", "to 1 thread")
    table = Table(*columns, box=None)
    for name, method_name, changes in BENCHES:
        method, parts = started(method_name, changes)
        paces: dict[int, list[float]] = {count: [] for count in threads}
        for _ in range(REPEATS):
            for count in threads:
                numba.set_num_threads(count)
                paces[count].append(pace(method, parts))
        for count, found in paces.items():
            ratio = statistics.median(found) / statistics.median(paces[1])
            table.add_row(name, str(parts), str(count), *told(found), f"{ratio:.2f}")
    Console(width=110).print(table)


def variants() -> None:
    """Print what a step of a point costs in each variant, on one thread, over what it costs in the paper's."""
    numba.set_num_threads(1)
    print(f"| over {PAPER} | time of a point's step | spread |\n|---|---|---|")
    for name, method_name, changes in VARIANTS:
        (paper, parts), (method, count) = started("mpm", {}), started(method_name, changes)
        ratios = [pace(paper, parts) / pace(method, count) for _ in range(REPEATS)]
        print("|", " | ".join((name, *told(ratios))), "|", flush=True)


def started(method_name: str, changes: dict[str, Any]) -> tuple[Method, int]:
    """Return the paper's rod some steps into the impact, and its number of points or elements."""
    model = build(Case.load("paper", changes, method=method_name))
    for _ in range(START):
        model.method.advance(model.method.stable_step())
    return model.method, len(model.body.cells) or len(model.body.position)


def pace(method: Method, parts: int) -> float:
    """Return how many million steps of one point or element a block of steps makes in a second."""
    block = max(3, 400_000 // parts)
    began = time.perf_counter()
    for _ in range(block):
        method.advance(method.stable_step())
    return parts * block / (time.perf_counter() - began) / 1e6


def told(values: list[float]) -> tuple[str, str]:
    return f"{statistics.median(values):.2f}", f"{min(values):.2f} to {max(values):.2f}"


if __name__ == "__main__":
    variants() if sys.argv[1:] == ["variants"] else methods()
