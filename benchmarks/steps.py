"""Measures material-point-steps per second, for one thread and for all, at two sizes of the paper's rod.

Run it with ``make bench``. Each figure is the median over repetitions of a block of steps, with the fastest and the
slowest beside it; threads are compared within one process, in turns, because machines are noisy.
"""

import statistics
import time

import numba
from rich.console import Console
from rich.table import Table

from viscopoint.case import Case
from viscopoint.model import build

SIZES = {"paper": {}, "half spacing": {"method.spacing": "0.19 mm", "method.cell": "0.25 mm"}}
START = 40  # steps into the impact before the clock starts
REPEATS = 9


def main() -> None:
    threads = sorted({1, numba.get_num_threads()})
    table = Table("case", "points", "threads", "M point-steps/s", "spread", "to 1 thread", box=None)
    for name, changes in SIZES.items():
        method = build(Case.load("paper", changes)).method
        for _ in range(START):
            method.advance(method.stable_step())
        points = len(method.positions())
        block = max(3, 400_000 // points)
        paces: dict[int, list[float]] = {count: [] for count in threads}
        for _ in range(REPEATS):
            for count in threads:
                numba.set_num_threads(count)
                began = time.perf_counter()
                for _ in range(block):
                    method.advance(method.stable_step())
                paces[count].append(points * block / (time.perf_counter() - began) / 1e6)
        for count, pace in paces.items():
            middle = statistics.median(pace)
            ratio = middle / statistics.median(paces[1])
            spread = f"{min(pace):.2f} to {max(pace):.2f}"
            table.add_row(name, str(points), str(count), f"{middle:.2f}", spread, f"{ratio:.2f}")
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
