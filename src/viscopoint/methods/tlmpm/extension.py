"""Nodes that hardly any material is on move as the nodes inside say.

A cell that the body's surface cuts to a sliver leaves its outer nodes next to no mass, and all its stiffness: they
would take any velocity, and no step would be short enough. So only the corners of cells that are filled by ``ENOUGH``
or more are nodes in their own right. The others continue the motion of the nearest such cell, trilinearly:

    v_i = Σ E_ij v_j,    f_j ← Σ E_ij f_i,    m_j ← Σ E_ij m_i

(the extension of Höllig, Reif & Wipper 2001). E reproduces linear fields, so that mass, linear and angular momentum are
what they are, and a uniform strain is one.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.errors import InputError
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import PARTS, kernel
from viscopoint.kernels.slabs import chunk

ENOUGH = 0.4  # share of a cell
FARTHEST = 3  # cells
AT_ONCE = 2000  # nodes, of which all cells around are looked at: 7 kB each
CORNERS = [(a, b, c) for c in (0, 1) for b in (0, 1) for a in (0, 1)]


class SparseRows(NamedTuple):
    """A sparse matrix, row by row."""

    start: Indices  # [row + 1]
    column: NDArray[np.uint64]  # [entry]
    value: Array  # [entry]


class Extension(NamedTuple):
    """E and its transpose: rows of the grid, columns of the nodes in their own right."""

    out: SparseRows
    back: SparseRows


def extended(shape: tuple[int, int, int], share: Array, active: Array) -> tuple[Extension, Indices]:
    """Return E and the grid's rows of the nodes in their own right.

    Args:
        shape: number of the grid's nodes along z, y, x.
        share: how far each cell is filled, in the row of its first node.
        active: not 0 for the nodes that points know.
    """
    inner = (share >= ENOUGH).reshape(shape)
    own = np.zeros(shape, bool)
    for a, b, c in CORNERS:
        own |= np.roll(inner, (c, b, a), (0, 1, 2))
    number = np.cumsum(own.ravel()) - 1
    nodes = np.flatnonzero(own)
    outside = np.flatnonzero((active != 0.0) & ~own.ravel())
    pieces = [_continued(inner, some) for some in np.array_split(outside, len(outside) // AT_ONCE + 1)]
    row, column, value = (np.concatenate(parts) for parts in zip(*pieces, strict=True))
    rows = np.concatenate([nodes, row])
    columns = np.concatenate([number[nodes], number[column]])
    values = np.concatenate([np.ones(len(nodes)), value])
    return Extension(_sorted(rows, columns, values, share.size), _sorted(columns, rows, values, len(nodes))), nodes


def _continued(inner: NDArray[np.bool_], nodes: Indices) -> tuple[Indices, Indices, Array]:
    """Return which nodes the others follow, and by how much: entries of E; cells at one distance share alike."""
    along = range(-FARTHEST, FARTHEST)
    offsets = np.array([(c, b, a) for c in along for b in along for a in along])  # from a node to a cell
    away = np.round(((offsets + 0.5) ** 2).sum(axis=1), 6)
    places = np.column_stack(np.unravel_index(nodes, inner.shape))
    cells = places[:, None, :] + offsets  # beyond the grid's end no cell is filled
    there = np.all((cells >= 0) & (cells < inner.shape), axis=2)
    there[there] = inner[tuple(cells[there].T)]
    distance = np.where(there, away, np.inf)
    nearest = distance.min(axis=1)
    if not np.isfinite(nearest).all():
        raise InputError("method.cell: the body has parts thinner than half a cell; take a smaller one")
    node, offset = np.nonzero(distance == nearest[:, None])
    share = 1.0 / np.bincount(node, minlength=len(nodes))[node]
    row, column, value = [], [], []
    for corner in CORNERS:
        steps = np.array(corner[::-1])
        along = np.where(steps == 1, -offsets[offset], 1 + offsets[offset])
        entry = share * along.prod(axis=1)
        kept = entry != 0.0
        row.append(nodes[node[kept]])
        column.append(np.ravel_multi_index(tuple((cells[node, offset] + steps)[kept].T), inner.shape))
        value.append(entry[kept])
    return np.concatenate(row), np.concatenate(column), np.concatenate(value)


def _sorted(rows: Indices, columns: Indices, values: Array, count: int) -> SparseRows:
    order = np.lexsort((columns, rows))
    start = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=count))])
    return SparseRows(start.astype(np.int64), columns[order].astype(np.uint64), values[order].astype(float))


@kernel()
def multiply(part: int, matrix: SparseRows, source: Array, target: Array) -> None:
    """Set ``target`` to the matrix times ``source``, of each of the first three columns."""
    start, column, value = matrix.start, matrix.column, matrix.value
    for n in chunk(part, PARTS, len(target)):
        x, y, z = 0.0, 0.0, 0.0
        for entry in range(start[n], start[n + 1]):
            m, w = column[entry], value[entry]
            x += w * source[m, 0]
            y += w * source[m, 1]
            z += w * source[m, 2]
        target[n, 0], target[n, 1], target[n, 2] = x, y, z
