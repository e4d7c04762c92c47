"""How fast a method steps: blocks of steps that all start from the same state."""

import time
from collections.abc import Sequence

import numba

from viscopoint.case.case import Case
from viscopoint.model.build import build
from viscopoint.model.method import Method

START = 40  # steps into the impact before the clock starts
BLOCK, FEWEST = 400_000, 3  # steps of a part in a block; steps of all parts at least


def started(case: Case) -> tuple[Method, int]:
    """Return a case's method some steps into the impact, and its number of points or elements."""
    model = build(case)
    for _ in range(START):
        model.method.advance(model.method.stable_step())
    return model.method, len(model.body.cells) or len(model.body.position)


def pace(method: Method, parts: int) -> float:
    """Return how many million steps of one part a block of steps makes in a second."""
    block = max(FEWEST, BLOCK // parts)
    began = time.perf_counter()
    for _ in range(block):
        method.advance(method.stable_step())
    return parts * block / (time.perf_counter() - began) / 1e6


def paces(method: Method, parts: int, threads: Sequence[int], repeats: int) -> dict[int, list[float]]:
    """Measure the pace on each number of threads, in turns, so that what else the machine does meets all alike."""
    state, most = method.state(), numba.get_num_threads()
    found: dict[int, list[float]] = {count: [] for count in threads}
    try:
        for _ in range(repeats):
            for count in threads:
                numba.set_num_threads(count)
                method.restore(state)
                method.advance(method.stable_step())  # what was restored is not where it will be in caches
                found[count].append(pace(method, parts))
    finally:
        numba.set_num_threads(most)
    return found
