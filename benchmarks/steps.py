"""Measures material-point-steps and element-steps per second, for one thread and for all, on the paper's rod.

Run it with ``make bench``. Each figure is the median over repetitions of a block of steps, with the fastest and the
slowest beside it; threads are compared within one process, in turns, because machines are noisy.
"""

import statistics
import time
from typing import Any

import numba
from rich.console import Console
from rich.table import Table

from viscopoint.case import Case
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
START = 40  # steps into the impact before the clock starts
REPEATS = 9


def main() -> None:
    threads = sorted({1, numba.get_num_threads()})
    columns = ("method", "points or elements", "threads", "M steps of one/s", "spread", "to 1 thread")
    table = Table(*columns, box=None)
    for name, method_name, changes in BENCHES:
        model = build(Case.load("paper", changes, method=method_name))
        method, parts = model.method, len(model.body.cells) or len(model.body.position)
        for _ in range(START):
            method.advance(method.stable_step())
        block = max(3, 400_000 // parts)
        paces: dict[int, list[float]] = {count: [] for count in threads}
        for _ in range(REPEATS):
            for count in threads:
                numba.set_num_threads(count)
                began = time.perf_counter()
                for _ in range(block):
                    method.advance(method.stable_step())
                paces[count].append(parts * block / (time.perf_counter() - began) / 1e6)
        for count, pace in paces.items():
            middle = statistics.median(pace)
            ratio = middle / statistics.median(paces[1])
            spread = f"{min(pace):.2f} to {max(pace):.2f}"
            table.add_row(name, str(parts), str(count), f"{middle:.2f}", spread, f"{ratio:.2f}")
    Console(width=110).print(table)


if __name__ == "__main__":
    main()
