"""Run as a module with the four words of a work, this prints by how much its process grows for it [bytes].

A small model of the same kind comes first, so that code, and what it needs once, is there already.
"""

import resource
import sys
from pathlib import Path

from viscopoint.bench.work import SIZES, Work, case_of
from viscopoint.model.build import build

STEPS = 3


def growth(work: Work) -> int:
    """Return by how much the most memory that this process ever had grows for a work [bytes]."""
    take_steps(work._replace(size=next(iter(SIZES))))
    before = peak()
    take_steps(work)
    return peak() - before


def take_steps(work: Work) -> None:
    """Build a work's model and advance it a little."""
    method = build(case_of(work)).method
    for _ in range(STEPS):
        method.advance(method.stable_step())


def peak() -> int:
    """Return the most memory that this process ever had [bytes]."""
    try:  # what getrusage tells on Linux starts at what the parent had
        lines = Path("/proc/self/status").read_text().splitlines()
        return 1024 * int(next(line.split()[1] for line in lines if line.startswith("VmHWM")))
    except (OSError, StopIteration):
        unit = 1 if sys.platform == "darwin" else 1024
        return unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


if __name__ == "__main__":
    print(growth(Work(*sys.argv[1:])))
