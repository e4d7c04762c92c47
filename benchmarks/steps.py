"""Measures what a step of a point costs, over that of the paper's material point method (MUSL, FLIP, trilinear).

    python benchmarks/steps.py variants    # in each variant of the method
    python benchmarks/steps.py box         # in a box ten times as wide, deep and high
    python benchmarks/steps.py order       # with points in another order in memory

`viscopoint bench` measures everything else.

Each figure is the median over repetitions of a block of steps, with least and greatest beside it; what is compared runs
within one process, in turns, because machines are noisy.
"""

import statistics
import sys
from typing import Any

import numba
import numpy as np

from viscopoint.bench.timing import pace, started
from viscopoint.case.case import Case
from viscopoint.model.method import Method

PAPER = "mpm, trilinear, flip, musl"
SHAPES = ("trilinear", "gimp", "cpgimp", "quadratic", "cubic")
TRANSFERS: dict[str, dict[str, Any]] = {
    "flip": {},
    "flip, 0.01 PIC": {"method.pic_fraction": 0.01},
    "apic": {"method.transfer": "apic"},
    "tpic": {"method.transfer": "tpic"},
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
FINE = {"method.spacing": "0.19 mm", "method.cell": "0.25 mm"}
REPEATS = 9


def variants() -> None:
    """Print what a step of a point costs in each variant, on one thread, over what it costs in the paper's."""
    numba.set_num_threads(1)
    print(f"| over {PAPER} | time of a point's step (spread) |\n|---|---|")
    for name, method_name, changes in VARIANTS:
        (paper, parts), (method, count) = of_paper("mpm", {}), of_paper(method_name, changes)
        ratios = [pace(paper, parts) / pace(method, count) for _ in range(REPEATS)]
        print(f"| {name} | {told(ratios)} |", flush=True)


def box() -> None:
    """Print what a step costs in a box ten times larger: only the grid around the body is there."""
    numba.set_num_threads(1)
    limits = {"x": ["-65 mm", "65 mm"], "y": ["-65 mm", "65 mm"], "z": ["-0.01 mm", "508 mm"]}
    for changes in ({}, FINE):
        (usual, count), (large, _) = of_paper("mpm", changes), of_paper("mpm", {**changes, "method.box": limits})
        ratios = [pace(usual, count) / pace(large, count) for _ in range(REPEATS)]
        print(f"{count} points: {told(ratios)}")


def order() -> None:
    """Print what a step costs where points stand cell by cell, or anyhow, and not row by row of the lattice."""
    numba.set_num_threads(1)
    (usual, count), (other, _) = of_paper("mpm", FINE), of_paper("mpm", FINE)
    state = other.state()
    cells = np.floor(state["position"] / 0.25)
    for name, rows in (("cell by cell", np.lexsort(cells.T)), ("anyhow", np.random.default_rng(1).permutation(count))):
        other.restore({key: values[rows] if len(values) == count else values for key, values in state.items()})
        ratios = [pace(usual, count) / pace(other, count) for _ in range(REPEATS)]
        print(f"{name}: {told(ratios)}")


def told(ratios: list[float]) -> str:
    return f"{statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})"


def of_paper(method_name: str, changes: dict[str, Any]) -> tuple[Method, int]:
    """Return the paper's rod some steps into the impact, and its number of points."""
    return started(Case.load("paper", changes, method=method_name))


if __name__ == "__main__":
    {"variants": variants, "box": box, "order": order}[sys.argv[1]]()
