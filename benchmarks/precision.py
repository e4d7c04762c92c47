"""What becomes of the paper's rods, of memory and of speed in single precision (docs/precision.md).

    python benchmarks/precision.py errors   # the paper's four cases by each method, in both precisions: a minute
    python benchmarks/precision.py bytes    # counted
    python benchmarks/precision.py speed    # on one thread, in turns, in time of the processor: some minutes

Both precisions of a method run within one process. Ratios are medians over blocks of steps that start from one state.
"""

import statistics
import sys
import time

import numba
from convergence import table

from viscopoint.bench.timing import started
from viscopoint.bench.traffic import arrays_of, bytes_held, bytes_per_step
from viscopoint.bench.work import HEADLINE, PAPER_LAW, Variant, Work, case_of, passes_of
from viscopoint.case.case import Case
from viscopoint.model.build import build
from viscopoint.model.energy_balance import Row
from viscopoint.model.method import Method
from viscopoint.model.simulation import Outcome, Simulation

CASES = ("paper", "paper-65", "paper-6.5", "paper-elastic")
METHODS = ("mpm", "tlmpm", "fem")
DOUBLE, SINGLE = {"method.precision": "double"}, {"method.precision": "single"}
MEASURED = ("length", "impact_face_radius", "greatest_radius", "velocity", "kinetic", "wall_impulse")
SIZES = ("21k", "169k")
BLOCK, REPEATS = 400_000, 15  # steps of a part in a block; blocks of each precision


def errors() -> None:
    """Print by how much results in single precision differ from those in double at 20 us."""
    differences, accounts = [], []
    for name in CASES:
        for method in METHODS:
            one, other = (outcome(name, method, precision) for precision in (DOUBLE, SINGLE))
            differences.append([name, method, str(one.steps), *compared(one.rows[-1], other.rows[-1])])
            accounts.append([name, method, *closed(one), *closed(other)])
    table(("case", "method", "steps", *MEASURED), differences)
    table(("case", "method", *(f"{what}, {one}" for one in ("double", "single") for what in ACCOUNTS)), accounts)


ACCOUNTS = ("remainder %", "momentum error")


def outcome(name: str, method: str, precision: dict[str, str]) -> Outcome:
    """Return how a run of the paper ended; each step has a line in its energy balance."""
    return Simulation(build(Case.load(name, precision, method=method))).run()


def compared(one: Row, other: Row) -> list[str]:
    """Return relative differences."""
    return [f"{getattr(other, name) / getattr(one, name) - 1.0:+.0e}" for name in MEASURED]


def closed(outcome: Outcome) -> list[str]:
    """Return what is missing in the accounts of energy, at the end, and of momentum over the impulse, at the worst."""
    first, last = outcome.rows[0], outcome.rows[-1]
    missing = 100.0 * last.numerical / (first.kinetic + first.stored)
    return [f"{missing:+.6f}", f"{outcome.momentum_error / abs(last.wall_impulse):.0e}"]


def at_work(variant: Variant, size: str, precision: dict[str, str]) -> tuple[Method, int]:
    """Return the paper's rod some steps into the impact, and its number of points or elements."""
    return started(case_of(Work(*variant, PAPER_LAW, size)).with_(precision))


def held() -> None:
    """Print bytes of a point or element: its state, all that the method holds, and what a step moves."""
    rows = []
    for variant in HEADLINE:
        counts = []
        for precision in (DOUBLE, SINGLE):
            method, parts = at_work(variant, SIZES[0], precision)
            state = {n: a for n, a in arrays_of(method).items() if n.startswith(("points.", "elements."))}
            passes = passes_of(Work(*variant, PAPER_LAW, SIZES[0]))
            sizes = sum(array.nbytes for array in state.values()), bytes_held(method), bytes_per_step(method, passes)
            counts.append([size / parts for size in sizes])
        rows.append([" ".join(variant), *(f"{a:.0f} to {b:.0f}" for a, b in zip(*counts, strict=True))])
    table(("method", "state", "held", "a step"), rows)


def speed() -> None:
    """Print how much faster a step is in single precision, on one thread."""
    numba.set_num_threads(1)
    rows = []
    for size in SIZES:
        for variant in HEADLINE:
            (one, parts), (other, _) = (at_work(variant, size, precision) for precision in (DOUBLE, SINGLE))
            ratios = ratios_of(one, other, max(BLOCK // parts, 3))
            spread = f"{min(ratios):.2f} to {max(ratios):.2f}"
            rows.append([" ".join(variant), size, f"{statistics.median(ratios):.3f}", spread])
    table(("method", "size", "speed, single over double", "spread"), rows)


def ratios_of(one: Method, other: Method, block: int) -> list[float]:
    """Return one method's time for a block of steps over the other's, again and again from the same state."""
    states, found = (one.state(), other.state()), []
    for _ in range(REPEATS):
        spent = []
        for method, state in zip((one, other), states, strict=True):
            method.restore(state)
            method.advance(method.stable_step())  # what was restored is not where it will be in caches
            began = time.process_time()
            for _ in range(block):
                method.advance(method.stable_step())
            spent.append(time.process_time() - began)
        found.append(spent[0] / spent[1])
    return found


if __name__ == "__main__":
    {"errors": errors, "bytes": held, "speed": speed}[sys.argv[1]]()
