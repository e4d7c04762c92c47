"""How hostile but valid cases end, by method (docs/hostile.md).

    python benchmarks/hostile_cases.py   # about an hour on two cores

The matrix is that of ``tests/verification/hostile.py``.
"""

import os
import sys
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

from convergence import table

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "verification"))

from hostile import FAILED, FINISHED, KINDS, SPEEDS, End, Hostile, ends_of, matrix

CAUSES = {  # words of a guard's message, and what it stopped
    "the stable step fell": "the stable step collapsed",
    "the energy balance does not close": "the energy balance did not close",
    "is not finite": "a quantity was not finite",
}


def outcome(end: End) -> str:
    """Return how a case ended, in few words."""
    if end.how != "stopped":
        return end.how
    return next((cause for words, cause in CAUSES.items() if words in end.why), "stopped otherwise")


def count(ends: Iterable[End]) -> list[str]:
    """Return how many ended in each way, and the worst that those which finished show."""
    ends = list(ends)
    ways = Counter(map(outcome, ends))
    done = [end for end in ends if end.how == FINISHED]
    return [
        str(len(ends)), *(str(ways[way]) for way in (FINISHED, *CAUSES.values(), FAILED)),
        f"{100.0 * max((end.energy for end in done), default=0.0):.2f}",
        f"{max((end.momentum for end in ends), default=0.0):.0e}", f"{max(end.seconds for end in ends):.0f}",
    ]  # fmt: skip


def show(ends: Mapping[Hostile, End]) -> None:
    """Print the tables."""
    head = ("cases", FINISHED, *CAUSES.values(), FAILED, "worst energy error, %", "worst momentum", "longest, s")
    table(("method", *head), [[kind, *count(end for it, end in ends.items() if it.kind == kind)] for kind in KINDS])
    table(
        ("speed, m/s", *head),
        [[f"{speed:g}", *count(end for it, end in ends.items() if it.speed == speed)] for speed in SPEEDS],
    )
    for hostile, end in ends.items():
        if end.how == FAILED:
            print(hostile, end)


if __name__ == "__main__":
    show(ends_of(matrix(), os.cpu_count() or 1))
