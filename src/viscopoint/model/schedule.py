"""When something is done in the course of a run: at given times, at intervals, or every so many steps."""

import math
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from typing import NamedTuple

SAME_TIME = 1e-9  # relative: two instants of a run that differ by less are one


class Schedule(NamedTuple):
    """Due at the start, at each of ``times``, at multiples of ``every``, and every ``steps`` steps; all may be given.

    Whether it is due depends on the clock of the run alone, so that a resumed run does the same.
    """

    times: tuple[float, ...] = ()  # ms, in order
    every: float = math.inf  # ms
    steps: int = 0  # 0: not by steps

    def due(self, before: float, now: float, step: int) -> bool:
        """Return whether it is due at a step from time ``before`` to ``now`` [ms]."""
        if step == 0 or (self.steps and step % self.steps == 0):
            return True
        return self._passed(now * (1.0 + SAME_TIME)) > self._passed(before * (1.0 + SAME_TIME))

    def _passed(self, time: float) -> int:
        """Return how many of the times have passed."""
        return bisect_right(self.times, time) + _multiples(time, self.every)

    def instants(self, end: float) -> Iterator[float]:
        """Yield the times after the start and up to ``end`` at which it is due, but for those by steps [ms]."""
        yield from (time for time in self.times if 0.0 < time <= end)
        yield from (number * self.every for number in range(1, _multiples(end * (1.0 + SAME_TIME), self.every) + 1))


EACH_STEP = Schedule(steps=1)


def _multiples(time: float, every: float) -> int:
    """Return how many multiples of ``every`` have passed at a time."""
    return int(time / every)


def merged(instants: Iterable[float]) -> list[float]:
    """Return instants in order, those that are the same but for rounding once."""
    found: list[float] = []
    for instant in sorted(instants):
        if not found or instant > found[-1] * (1.0 + SAME_TIME):
            found.append(instant)
    return found
