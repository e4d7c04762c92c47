"""Slabs of a body, shared out among threads.

A slab is a few layers of cells (or one of elements) along z. Slabs of one colour (even, odd) share no node, so that
threads add to them without atomics and every node sums its points in the same order, whatever the thread count.
"""

from viscopoint.kernels.arrays import Indices
from viscopoint.kernels.jit import PARTS, inline

COLOURS = 2
CHUNKS = 64  # pieces in which sums are taken, so that they do not depend on the thread count


@inline
def chunk(part: int, parts: int, total: int) -> range:
    """Return which of ``total`` rows are in a part of the rows."""
    return range(part * total // parts, (part + 1) * total // parts)


@inline
def slabs_of(start: Indices, slabs: int, part: int) -> range:
    """Return the slabs of a part of the body; slab s begins at ``start[s]``."""
    return range(_border(start, slabs, part), _border(start, slabs, part + 1))


@inline
def coloured_slabs_of(start: Indices, slabs: int, part: int) -> range:
    """Return the slabs of one colour of a part of the body; all parts of a colour follow one another."""
    colour, part = part // PARTS, part % PARTS
    begin, end = _border(start, slabs, part), _border(start, slabs, part + 1)
    return range(begin + (begin - colour) % COLOURS, end, COLOURS)


@inline
def _border(start: Indices, slabs: int, part: int) -> int:
    """Return the first slab of a part: the first whose middle is at the part's border or behind it."""
    if part == PARTS:
        return slabs
    begin, end = 0, slabs
    while begin < end:
        slab = (begin + end) // 2
        if PARTS * (start[slab] + start[slab + 1]) < 2 * part * start[slabs]:
            begin = slab + 1
        else:
            end = slab
    return begin
