"""Two records side by side."""

from collections.abc import Iterator
from typing import NamedTuple

from rich.table import Table

from viscopoint.bench.record import Record, Spread
from viscopoint.bench.table import right

MACHINE = ("processor", "cores", "threads", "caches [bytes]", "memory [bytes]", "system", "python", "numba", "llvmlite")


class Ratio(NamedTuple):
    """One figure then and now."""

    name: str
    unit: str
    old: float
    new: float
    overlap: bool | None  # whether the spreads do; None for a single value

    @property
    def ratio(self) -> float:
        """Return new over old."""
        return self.new / self.old


def ratios(old: Record, new: Record) -> list[Ratio]:
    """Return the figures that both have."""
    before, after = figures(old), figures(new)
    return [
        Ratio(*key, then.median, now.median, then.overlaps(now) if min(then.repeats, now.repeats) > 1 else None)
        for key, now in after.items()
        if (then := before.get(key)) is not None and then.median
    ]


def figures(record: Record) -> dict[tuple[str, str], Spread]:
    """Return all figures by name and unit."""
    found = {(f"triad, threads: {triad.threads}", "GB/s"): triad.gigabytes_per_second for triad in record.triad}
    for pace in record.pace:
        found[f"{pace.name}, threads: {pace.threads}", "M steps/s"] = pace.million_steps_per_second
        found[pace.name, "bytes a step"] = Spread.of([pace.bytes_per_step / pace.parts])
    for memory in record.memory:
        found[memory.name, "bytes held"] = Spread.of([memory.bytes_held / memory.parts])
        if memory.peak_growth is not None:
            found[memory.name, "bytes, peak growth"] = Spread.of([memory.peak_growth / memory.parts])
    for startup in record.startup:
        there = "no kernels" if startup.cache == "empty" else "kernels there"
        found[f"{startup.command}, {there}", "s"] = startup.seconds
    return found


def table(old: Record, new: Record) -> Table:
    """Return the ratios as a table for the terminal, without what is counted and still the same."""
    shown = right("new over old", "unit", "old", "new", "ratio", "spreads", left=2)
    words = {True: "overlap", False: "apart", None: ""}
    changed = [one for one in ratios(old, new) if one.overlap is not None or one.new != one.old]
    for one in changed:
        shown.add_row(one.name, one.unit, f"{one.old:.4g}", f"{one.new:.4g}", f"{one.ratio:.3f}", words[one.overlap])
    return shown


def notes(old: Record, new: Record) -> Iterator[str]:
    """Yield what makes the ratios less comparable than they look."""
    different = [name for name in MACHINE if old.machine.get(name) != new.machine.get(name)]
    if different:
        told = "; ".join(f"{name}: {old.machine.get(name)}, now {new.machine.get(name)}" for name in different)
        yield f"NOTE: not the same machine or software: {told}"
    missing = len(figures(old).keys() ^ figures(new).keys())
    if missing:
        yield f"NOTE: {missing} figures are in one of the two only"
