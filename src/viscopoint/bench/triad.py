"""The bandwidth of the memory: the triad of STREAM (McCalpin 1995), a = b + s c, on arrays far larger than caches."""

import time
from collections.abc import Mapping, Sequence

import numba
import numpy as np

from viscopoint.bench.facts import last_cache
from viscopoint.bench.record import Spread, Triad
from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import PARTS, kernel
from viscopoint.kernels.slabs import chunk
from viscopoint.model import memory

CACHES = 4  # last-level caches to an array, as STREAM asks
LEAST_BYTES = 64_000_000  # of an array
SHARE = 1 / 48  # of the machine's memory that an array may take
MOVED = 24  # bytes of an element: two read, one written, as STREAM counts


@kernel()
def fill(part: int, a: Array, b: Array, c: Array) -> None:
    """Let each thread be the first to touch what it will use."""
    for n in chunk(part, PARTS, len(a)):
        a[n], b[n], c[n] = 0.0, 1.0, 2.0


@kernel()
def triad(part: int, a: Array, b: Array, c: Array, s: float) -> None:
    """Set a = b + s c."""
    for n in chunk(part, PARTS, len(a)):
        a[n] = b[n] + s * c[n]


def length() -> int:
    """Return how many elements an array has."""
    wanted = max(LEAST_BYTES, CACHES * last_cache())
    return int(min(wanted, max(LEAST_BYTES, SHARE * memory.machine()))) // 8


def bandwidths(threads: Sequence[int], repeats: int) -> dict[int, list[float]]:
    """Measure the gigabytes per second of the triad on each number of threads, in turns."""
    a, b, c = (np.empty(length()) for _ in range(3))
    most = numba.get_num_threads()
    found: dict[int, list[float]] = {count: [] for count in threads}
    try:
        fill(a, b, c)
        triad(a, b, c, 3.0)  # may compile
        for _ in range(repeats):
            for count in threads:
                numba.set_num_threads(count)
                began = time.perf_counter()
                triad(a, b, c, 3.0)
                found[count].append(MOVED * len(a) / (time.perf_counter() - began) / 1e9)
    finally:
        numba.set_num_threads(most)
    return found


def triads(*rounds: Mapping[int, list[float]]) -> list[Triad]:
    """Return what some rounds of ``bandwidths`` found, all together."""
    return [
        Triad(
            threads=count,
            array_bytes=8 * length(),
            gigabytes_per_second=Spread.of([value for found in rounds for value in found[count]]),
        )
        for count in rounds[0]
    ]
