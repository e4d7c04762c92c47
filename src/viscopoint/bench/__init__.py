"""Measures speed, memory and start-up on this machine, beside what its memory could do at most.

Everything is measured on the paper's rod some steps into the impact, and in one run, so that figures can be held
against each other: machines differ, and one machine differs from hour to hour.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numba

from viscopoint.bench.facts import facts
from viscopoint.bench.memory import measured_growth
from viscopoint.bench.record import Memory, Pace, Record, Spread, Startup, Triad
from viscopoint.bench.startup import startups
from viscopoint.bench.timing import paces, started
from viscopoint.bench.traffic import bytes_held, bytes_per_step
from viscopoint.bench.triad import bandwidths, triads
from viscopoint.bench.work import EXTENTS, GROWTH_SIZE, Work, case_of, passes_of, selection
from viscopoint.errors import InputError, nearest
from viscopoint.results.provenance import now

REPEATS, QUICK_REPEATS = 7, 3
USUAL_EXTENT, QUICK_EXTENT = "medium", "small"
Watch = Callable[[float, str], None]  # takes the share done and what comes next


class Plan(NamedTuple):
    """What one run measures."""

    works: tuple[Work, ...]
    threads: tuple[int, ...]  # ascending
    repeats: int
    quick: bool  # nothing that takes processes of their own for long: memory, cold start-up
    startup: bool


def planned(
    quick: bool = False, threads: str | None = None, extent: str | None = None, only: str | None = None
) -> Plan:
    """Return what to measure.

    Args:
        quick: one size, one law, fewer repeats.
        threads: numbers with commas between; by default 1, 2, 4, ... and all.
        extent: one of ``work.EXTENTS``, up to which problem size.
        only: the works whose name has this in it, and nothing else but the triad.

    Raises:
        InputError: an argument is not what it may be.
    """
    extent = extent or (QUICK_EXTENT if quick else USUAL_EXTENT)
    if extent not in EXTENTS:
        raise InputError(f"--size {extent}: not known; {nearest(extent, EXTENTS)}")
    works = selection(EXTENTS[extent], quick)
    chosen = tuple(work for work in works if only is None or only in work.name)
    if not chosen:
        names = "; ".join(work.name for work in works)
        raise InputError(f"--only {only}: in no name of what is measured; there are: {names}")
    repeats = QUICK_REPEATS if quick else REPEATS
    return Plan(chosen, thread_counts(threads), repeats, quick, startup=only is None)


def thread_counts(text: str | None) -> tuple[int, ...]:
    """Return thread counts as asked for, or doubling from one up to all."""
    most = numba.get_num_threads()
    if text is None:
        return tuple(sorted({*(2**power for power in range(most.bit_length())), most}))
    try:
        counts = tuple(sorted({int(number) for number in text.split(",")}))
    except ValueError:
        counts = (0,)
    if not 1 <= counts[0] <= counts[-1] <= most:
        raise InputError(f"--threads {text}: write numbers from 1 to {most}, as this machine has, with commas between")
    return counts


def measure(plan: Plan, watch: Watch) -> Record:
    """Measure what is planned; some minutes on two idle cores once kernels are compiled."""
    machine, began = facts(), now()
    startup = list(started_up(plan, watch))
    watch(0.15, "bandwidth of the memory")
    first = bandwidths(plan.threads, plan.repeats)
    timed = list(timed_works(plan, watch))
    memory = [Memory(**one.work._asdict(), parts=one.parts, bytes_held=one.held, peak_growth=None) for one in timed]
    memory = memory if plan.quick else grown(memory, plan.works, watch)
    watch(0.95, "bandwidth of the memory, once more")  # what else the machine did meanwhile shows in the spread
    limits = triads(first, bandwidths(plan.threads, plan.repeats))
    return Record(
        machine=machine,
        started=began,
        repeats=plan.repeats,
        triad=limits,
        pace=list(speeds(timed, limits)),
        memory=memory,
        startup=startup,
    )


class Timed(NamedTuple):
    """A work and what was found of it."""

    work: Work
    parts: int
    moved: int  # in a step, bytes
    held: int  # bytes
    paces: dict[int, Spread]  # by threads, ascending; million steps of a part in a second


def timed_works(plan: Plan, watch: Watch) -> Iterator[Timed]:
    """Time all works, one after the other."""
    for done, work in enumerate(plan.works):
        watch(0.2 + 0.5 * done / len(plan.works), work.name)
        method, parts = started(case_of(work))
        moved, held = bytes_per_step(method, passes_of(work)), bytes_held(method)
        found = paces(method, parts, plan.threads, plan.repeats)
        yield Timed(work, parts, moved, held, {threads: Spread.of(values) for threads, values in found.items()})


def speeds(timed: Sequence[Timed], limits: Sequence[Triad]) -> Iterator[Pace]:
    """Yield paces with what they are of the memory's bandwidth, of the fewest threads' and of the smallest size's.

    The bandwidth is the greatest found, as STREAM takes it: whatever disturbs only lowers it.
    """
    limit = {triad.threads: triad.gigabytes_per_second.most for triad in limits}
    smallest: dict[tuple[str, ...], float] = {}
    for work, parts, moved, _, found in timed:
        fewest = next(iter(found.values())).median
        for threads, pace in found.items():
            yield Pace(
                **work._asdict(),
                threads=threads,
                parts=parts,
                million_steps_per_second=pace,
                bytes_per_step=moved,
                bandwidth_share=moved / parts * pace.median * 1e6 / 1e9 / limit[threads],
                thread_scaling=pace.median / fewest,
                size_scaling=pace.median / smallest.setdefault((*work[:3], str(threads)), pace.median),
            )


def grown(memories: Sequence[Memory], works: Sequence[Work], watch: Watch) -> list[Memory]:
    """Return what models hold with what processes grow by, of the works of one size."""
    found = []
    for done, (memory, work) in enumerate(zip(memories, works, strict=True)):
        if work.size == GROWTH_SIZE:
            watch(0.7 + 0.25 * done / len(works), f"memory of {work.name}")
            memory = memory.model_copy(update={"peak_growth": measured_growth(work)})
        found.append(memory)
    return found


def started_up(plan: Plan, watch: Watch) -> Iterator[Startup]:
    """Yield how long commands take that do next to nothing."""
    if plan.startup:
        watch(0.0, "start-up")
        yield from startups(plan.repeats, cold=not plan.quick)
