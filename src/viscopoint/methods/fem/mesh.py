"""A mesh of hexahedra: its elements in slabs that threads share, its volumes and its quality.

Elements are visited slab by slab. A slab is one or more levels of neighbours, counted from the lowest nodes up; a node
touches two levels at most, so that slabs of one colour (even, odd) share no node: threads add to nodes without atomics,
and every node sums its elements in the same order, whatever the thread count.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import PARTS, kernel
from viscopoint.kernels.slabs import chunk
from viscopoint.kernels.workspace import BLOCK
from viscopoint.methods.fem import cells
from viscopoint.methods.fem.cells.hexahedron import GAUSS
from viscopoint.methods.fem.cells.hexahedron_modes import ETA, XI, ZETA, Hexahedron, modes

EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))  # seen from outside


class Slabs(NamedTuple):
    """The order in which kernels visit the elements."""

    order: NDArray[np.uint64]  # [e]
    start: Indices  # [slabs + 1], where each slab begins in ``order``


class Form(NamedTuple):
    """What depends on the shape of a mesh's elements; functions take ``position[n, 3]`` and ``corner[e, k]``."""

    edges: tuple[tuple[int, int], ...]  # corners that an edge joins
    point_volumes: Callable[[Array, Indices], Array]  # that each integration point of a full rule stands for, mm^3
    scaled_jacobians: Callable[[Array, Indices], Array]  # 1 for a brick, 0 where an element degenerates
    free: Callable[[Array], Array]  # of positions [n, 3]: 0 along axes along which a node cannot move, else 1
    cell: Any  # of ``cells``
    moving: tuple[float, float, float]  # 1 for the axes along which the whole body has a momentum, 0 for the others


def slabs(position: Array, corner: Indices) -> Slabs:
    """Sort elements into slabs by their distance, in elements, from the lowest nodes."""
    level = np.full(len(corner), -1)
    reached = np.zeros(len(position), bool)
    around = _elements_around(corner, len(position))
    height = position[:, 2]
    newly, deepest = np.empty(0, np.int64), 0  # nodes of the level before
    while True:
        found = around(newly)
        found = np.unique(found[level[found] < 0])
        if not len(found):  # the start, or another body
            rest = np.flatnonzero(level < 0)
            if not len(rest):
                break
            low = height[corner[rest]].min(axis=1)
            found = rest[low <= low.min() + 1e-9 * np.ptp(height)]
        level[found] = deepest
        newly = np.unique(corner[found])
        newly = newly[~reached[newly]]
        reached[newly] = True
        deepest += 1
    ends: list[int] = [0]
    for end in np.cumsum(np.bincount(level)).tolist():  # levels of few elements make a slab together
        if end - ends[-1] >= BLOCK:
            ends.append(end)
    ends[1:] = [*ends[1:-1], len(corner)] if len(ends) > 1 else [len(corner)]
    return Slabs(np.argsort(level, kind="stable").astype(np.uint64), np.array(ends, np.int64))


def _elements_around(corner: Indices, count: int) -> Callable[[Indices], Indices]:
    """Return a function from nodes, of ``count``, to the elements that touch them, those of several nodes repeated."""
    element = np.argsort(corner.ravel(), kind="stable") // corner.shape[1]
    many = np.bincount(corner.ravel(), minlength=count)
    first = np.cumsum(many) - many

    def around(nodes: Indices) -> Indices:
        here = many[nodes]
        return element[np.repeat(first[nodes] - (np.cumsum(here) - here), here) + np.arange(here.sum())]

    return around


def shape_functions(xi: float, eta: float, zeta: float) -> Array:
    """Return the eight N at a place in the element."""
    return (1 + XI * xi) * (1 + ETA * eta) * (1 + ZETA * zeta) / 8


def jacobians(x: Array, xi: float, eta: float, zeta: float) -> Array:
    """Return det ∂x/∂ξ of elements with corners at ``x[e, 8, 3]``, at a place in them."""
    slopes = [
        XI * (1 + ETA * eta) * (1 + ZETA * zeta) / 8,
        ETA * (1 + XI * xi) * (1 + ZETA * zeta) / 8,
        ZETA * (1 + XI * xi) * (1 + ETA * eta) / 8,
    ]
    along = [np.einsum("k,ekd->ed", slope, x) for slope in slopes]
    return np.einsum("ed,ed->e", along[0], np.cross(along[1], along[2]))


def gauss_places() -> list[tuple[float, float, float]]:
    """Return the points of the 2 x 2 x 2 rule, in the order of the corners."""
    return [
        (GAUSS * float(xi), GAUSS * float(eta), GAUSS * float(zeta))
        for xi, eta, zeta in zip(XI, ETA, ZETA, strict=True)
    ]


def point_volumes(position: Array, corner: Indices) -> Array:
    """Return the volume that each of an element's 2 x 2 x 2 points stands for, ``[e, 8]`` [mm^3]."""
    x = position[corner]
    return np.column_stack([jacobians(x, *place) for place in gauss_places()])


def node_volumes(position: Array, corner: Indices) -> Array:
    """Return the volume that each node stands for, ∫N over its elements [mm^3]."""
    shares = point_volumes(position, corner) @ np.array([shape_functions(*place) for place in gauss_places()])
    return np.bincount(corner.ravel(), shares.ravel(), minlength=len(position)).astype(float)


def stable_lengths(position: Array, corner: Indices) -> Array:
    """Return of each element the length that a wave must not cross in a step [mm]."""
    lengths = np.empty(len(corner))
    _measure_lengths(position, corner.astype(np.uint64), lengths)
    return lengths


@kernel()
def _measure_lengths(part: int, position: Array, corner: NDArray[np.uint64], lengths: Array) -> None:
    for e in chunk(part, PARTS, len(corner)):
        place = modes(position, corner[e])
        gradient = cells.volume_gradient(place)
        lengths[e] = cells.stable_length(place, gradient, cells.volume(place, gradient))


def scaled_jacobians(position: Array, corner: Indices) -> Array:
    """Return the least determinant of the three unit edge vectors at a corner, of each element."""
    x = position[corner]
    least = np.full(len(corner), np.inf)
    for k in range(len(XI)):
        along = [j for j in range(len(XI)) if sum((XI[j] != XI[k], ETA[j] != ETA[k], ZETA[j] != ZETA[k])) == 1]
        towards = sorted(along, key=lambda j, k=k: (XI[j] == XI[k], ETA[j] == ETA[k]))  # along xi, eta, zeta
        vectors = [x[:, j] - x[:, k] for j in towards]
        sizes = np.prod([np.linalg.norm(vector, axis=1) for vector in vectors], axis=0)
        volume = np.einsum("ed,ed->e", vectors[0], np.cross(vectors[1], vectors[2])) * -XI[k] * -ETA[k] * -ZETA[k]
        least = np.minimum(least, np.divide(volume, sizes, out=np.zeros_like(volume), where=sizes > 0))
    return least


def outer_faces(corner: Indices) -> Indices:
    """Return the quadrilaterals that belong to one element only, ``[f, 4]`` nodes counted from outside."""
    faces = np.concatenate([corner[:, face] for face in FACES])
    a, b, c, d = np.sort(faces, axis=1).T
    count = int(corner.max(initial=0)) + 1
    one, other = a * count + b, c * count + d
    order = np.lexsort((other, one))
    one, other = one[order], other[order]
    differs = (one[1:] != one[:-1]) | (other[1:] != other[:-1])
    alone = np.ones(len(order), bool)
    alone[1:] &= differs
    alone[:-1] &= differs
    return faces[np.sort(order[alone])]


HEXAHEDRA = Form(EDGES, point_volumes, scaled_jacobians, np.ones_like, Hexahedron(), (1.0, 1.0, 1.0))
