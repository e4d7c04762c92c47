"""Measures what a step of a point costs in each variant of the material point method, over that in the paper's.

    python benchmarks/steps.py variants    # `viscopoint bench` measures everything else

Each figure is the median over repetitions of a block of steps, with least and greatest beside it; what is compared runs
within one process, in turns, because machines are noisy.
"""

import statistics
import sys
from typing import Any

import numba

from viscopoint.bench.timing import pace, started
from viscopoint.case import Case
from viscopoint.method import Method

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
REPEATS = 9


def variants() -> None:
    """Print what a step of a point costs in each variant, on one thread, over what it costs in the paper's."""
    numba.set_num_threads(1)
    print(f"| over {PAPER} | time of a point's step | spread |\n|---|---|---|")
    for name, method_name, changes in VARIANTS:
        (paper, parts), (method, count) = of_paper("mpm", {}), of_paper(method_name, changes)
        ratios = [pace(paper, parts) / pace(method, count) for _ in range(REPEATS)]
        spread = f"{min(ratios):.2f} to {max(ratios):.2f}"
        print("|", " | ".join((name, f"{statistics.median(ratios):.2f}", spread)), "|", flush=True)


def of_paper(method_name: str, changes: dict[str, Any]) -> tuple[Method, int]:
    """Return the paper's rod some steps into the impact, and its number of points."""
    return started(Case.load("paper", changes, method=method_name))


if __name__ == "__main__":
    {"variants": variants}[sys.argv[1]]()
