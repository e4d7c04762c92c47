"""Slabs of a body, shared out among threads.

A slab is a few layers of cells (or one of elements) along z. Slabs of one colour (even, odd) share no node, so that
threads add to them without atomics and every node sums its points in the same order, whatever the thread count.
"""

from viscopoint.kernels.arrays import Indices
from viscopoint.kernels.jit import inline

COLOURS = 2
PARTS = 24  # of the body, with as many points each; threads take the same number of them if they are 2, 3, 4, 6, 8, 12


@inline
def part_of(start: Indices, slabs: int, part: int, colour: int = 0, colours: int = 1) -> range:
    """Return the slabs of a part of the body that have the ``colour``; slab s begins at ``start[s]``."""
    begin, end = _border(start, slabs, part), _border(start, slabs, part + 1)
    return range(begin + (begin - colour) % colours, end, colours)


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
