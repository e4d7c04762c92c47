"""A record as tables for the terminal."""

from collections.abc import Iterator

from rich.table import Table

from viscopoint.bench.record import Record, Spread

BUSY = 0.5  # load beside which figures are worth little
NOTES = (
    "medians with least and most. Parts are points or elements; M steps/s: millions of them advanced by one step in a "
    "second; scaling: over the fewest threads, and over the smallest size. Bytes are of one part. Those that a step "
    "moves are counted from the layout, once for each pass that reads or writes an array; limit: their rate over the "
    "triad's greatest on as many threads."
)


def tables(record: Record) -> Iterator[Table]:
    """Yield what was measured, a table for each kind."""
    yield _triad(record)
    yield _pace(record)
    yield _memory(record)
    if record.startup:
        yield _startup(record)


def notes(record: Record) -> Iterator[str]:
    """Yield what to know beside the figures."""
    machine = record.machine
    yield f"{machine['processor']}, {machine['cores']} cores, {machine['memory [bytes]'] / 2**30:.0f} GiB: {NOTES}"
    if machine["load"] > BUSY:
        yield f"NOTE: the machine was busy before the start, with a load of {machine['load']}: trust ratios only"


def right(*heads: str, left: int = 1) -> Table:
    """Return a table whose columns, but for the first ones, stand at the right."""
    table = Table(*heads, box=None, pad_edge=False)
    for column in table.columns[left:]:
        column.justify = "right"
    return table


def spread(values: Spread, digits: int = 2) -> tuple[str, str]:
    """Return a median, and least and most."""
    if values.repeats == 1:
        return f"{values.median:.{digits}f}", "once"
    return f"{values.median:.{digits}f}", f"{values.least:.{digits}f}–{values.most:.{digits}f}"


def _triad(record: Record) -> Table:
    table = right("bandwidth of the memory", "threads", "GB/s", "spread")
    for triad in record.triad:
        size = f"triad, arrays of {triad.array_bytes / 1e6:.0f} MB"
        table.add_row(size, str(triad.threads), *spread(triad.gigabytes_per_second, 1))
    return table


def _pace(record: Record) -> Table:
    table = right(
        "method", "variant", "law", "size", "threads", "M steps/s", "spread", "thread\nscaling", "size\nscaling",
        "bytes\na step", "limit\n%", left=4,
    )  # fmt: skip
    for pace in record.pace:
        table.add_row(
            pace.method, pace.variant, pace.law, pace.size, str(pace.threads), *spread(pace.million_steps_per_second),
            f"{pace.thread_scaling:.2f}", f"{pace.size_scaling:.2f}", f"{pace.bytes_per_step / pace.parts:.0f}",
            f"{100 * pace.bandwidth_share:.0f}",
        )  # fmt: skip
    return table


def _memory(record: Record) -> Table:
    table = right("method", "variant", "law", "size", "parts", "bytes held\nby each", "peak growth\nby each", left=4)
    for memory in record.memory:
        grown = "" if memory.peak_growth is None else f"{memory.peak_growth / memory.parts:.0f}"
        held = f"{memory.bytes_held / memory.parts:.0f}"
        table.add_row(memory.method, memory.variant, memory.law, memory.size, str(memory.parts), held, grown)
    return table


def _startup(record: Record) -> Table:
    table = right("start-up", "compiled kernels", "s", "spread", left=2)
    for startup in record.startup:
        there = "none" if startup.cache == "empty" else "there"
        table.add_row(startup.command, there, *spread(startup.seconds))
    return table
