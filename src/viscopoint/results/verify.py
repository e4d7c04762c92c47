"""Runs a run folder's case again and tells whether the results have the same bits."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.arguments import checked
from viscopoint.errors import InputError
from viscopoint.kernels.promise import differences
from viscopoint.messages import clipped, one_line
from viscopoint.results.interruption import raise_for
from viscopoint.results.older_formats import words as older
from viscopoint.results.run import Run
from viscopoint.results.running import Tell, Watch, run
from viscopoint.results.summary import ENDED

TIMED = {"wall_time"}  # of the summary, what differs from one run to the next
UNKNOWN = {"mass", "mass_error", "hourglass_share", "warnings", "units", "snapshots"}  # to older formats, or in others
MOST_TOLD = 10  # differences


class Difference(NamedTuple):
    """Where two runs have other numbers."""

    place: str  # such as "stress at 20 us"
    numbers: int  # that differ
    greatest: float  # absolute difference; infinite where shapes or types differ

    def __str__(self) -> str:
        return f"{self.place}: {self.numbers} numbers differ, by at most {self.greatest:.3g}"


class Verdict(NamedTuple):
    """What a comparison of two runs found."""

    numbers: int  # compared
    differences: list[Difference]
    notes: list[str]  # on what may explain a difference

    @property
    def same(self) -> bool:
        """Whether all bits are the same."""
        return not self.differences

    def words(self) -> Iterator[str]:
        """Say what was found, a line each."""
        if self.same:
            yield f"the same: {self.numbers} numbers of history, snapshots and summary, bit by bit"
        else:
            yield f"NOT the same: in {len(self.differences)} places"
            yield from map(str, self.differences[:MOST_TOLD])
        yield from self.notes


@checked
def verify(
    folder: str | Path, *, threads: int | None = None, watch: Watch | None = None, tell: Tell | None = None
) -> Verdict:
    """Run a finished run's case again, in memory, and compare history, fields and summary bit by bit.

    ``threads`` is as ``run`` takes it.

    Raises:
        InputError: the folder holds no finished run.
        KeyboardInterrupt: somebody wants to end it.
    """
    earlier = Run(folder)
    if earlier.status not in ENDED:
        raise InputError(f"run folder {folder}: not finished ({earlier.status}), so there is nothing to compare with")
    again = run(earlier.case, threads=threads, watch=watch, tell=tell)
    if again.status == "interrupted":
        raise_for(again.results.signal)
    return compare_bits(earlier, again)


def compare_bits(one: Run, other: Run) -> Verdict:
    """Compare all results of two runs of the same case."""
    found, numbers = [], 0
    for place, before, now in _pairs(one, other):
        numbers += before.size
        difference = _difference(place, before, now)
        if difference:
            found.append(difference)
    return Verdict(numbers, found, list(_notes(one.provenance, other.provenance)))


def _notes(before: dict[str, Any], now: dict[str, Any]) -> Iterator[str]:
    """Say what may explain a difference, a line each."""
    for key in ("sources", "processor"):
        if before.get(key) != now.get(key):
            yield one_line(clipped(f"{key}: {before.get(key)}, now {now.get(key)}"))
    for words in differences(before, now):
        yield one_line(clipped(words))
    for words in before.get("resumed_with", []):
        yield one_line(clipped(f"when it was resumed, {words}"))


def _pairs(one: Run, other: Run) -> Iterator[tuple[str, NDArray[Any], NDArray[Any]]]:
    """Yield what is to be the same, piece by piece."""
    nothing = np.empty(0)
    both = not (one.is_older or other.is_older)
    for name in dict.fromkeys([*one.columns, *other.columns]):
        if name in older.ADDED and not both:
            continue
        yield f"{name} in the history", one.columns.get(name, nothing), other.columns.get(name, nothing)
    left_out = TIMED if both else TIMED | UNKNOWN
    results = one.results.model_dump(exclude=left_out), other.results.model_dump(exclude=left_out)
    words = [np.array(sorted(f"{key}: {value}" for key, value in result.items())) for result in results]
    yield "the summary", words[0], words[1]
    yield "times of the snapshots", one.times, other.times
    for number, time in enumerate(one.times[: len(other.times)]):
        before, now = one.snapshot(number).fields, other.snapshot(number).fields
        for name in dict.fromkeys([*before, *now]):
            values = [fields[name].values if name in fields else nothing for fields in (before, now)]
            yield f"{name} at {time * 1e3:g} us", values[0], values[1]


def _difference(place: str, before: NDArray[Any], now: NDArray[Any]) -> Difference | None:
    if before.dtype != now.dtype or before.shape != now.shape:
        return Difference(place, max(before.size, now.size), np.inf)
    if before.tobytes() == now.tobytes():
        return None
    if before.dtype.kind not in "fiu":
        return Difference(place, int((before != now).sum()), np.inf)
    unlike = (_bytes(before) != _bytes(now)).any(axis=-1)
    apart = np.abs(before.astype(float) - now.astype(float))[unlike.reshape(before.shape)]
    return Difference(place, int(unlike.sum()), float(np.nan_to_num(apart, nan=np.inf).max()))


def _bytes(values: NDArray[Any]) -> NDArray[np.uint8]:
    """Return the bytes of each number, a row each."""
    return np.ascontiguousarray(values).reshape(-1, 1).view(np.uint8)
