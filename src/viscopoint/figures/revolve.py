"""Axisymmetric bodies as pictures show them: their half section, turned around the z axis.

What shows is some of the body's points, each as often as it is turned; so a value of a body's point is had by its
number, and a place or a vector by turning it.
"""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.methods.fem.section import outer_edges
from viscopoint.model.body import Body, spacing

AROUND = 48  # turns of what is drawn as faces
NONE: Indices = np.empty((0, 4), np.int64)  # no faces, or no quadrilaterals


class Revolved(NamedTuple):
    """Points turned around the axis, and the faces that they make, if any."""

    points: Indices  # [n], their numbers in the body
    angle: Array  # [n], by which each is turned
    faces: Indices  # [f, 4], counted in ``points`` from outside


def turned(vectors: Array, angle: Array) -> Array:
    """Return vectors ``[n, 3]`` turned around the z axis."""
    x, y, z = vectors.T
    return np.column_stack([x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle), z])


def mantle(body: Body, cells: Indices) -> Revolved:
    """Return what shows of quadrilaterals ``cells[e, 4]`` that turn: the surfaces that their outer edges sweep."""
    edges = edges_off_axis(body, cells)
    nodes = np.unique(edges)
    points, angle = turns(nodes, AROUND)
    return Revolved(points, angle, swept(np.searchsorted(nodes, edges), len(nodes), AROUND))


def turns(nodes: Indices, around: int) -> tuple[Indices, Array]:
    """Return points ``nodes[n]`` turned ``around`` times, and their angles, turn by turn."""
    return np.tile(nodes, around), np.repeat(2.0 * np.pi * np.arange(around) / around, len(nodes))


def swept(edges: Indices, count: int, around: int) -> Indices:
    """Return the faces that ``edges[f, 2]`` sweep, in ``turns`` of ``count`` points."""
    a, b = edges.T
    here = count * np.arange(around)[:, None]
    there = np.roll(here, -1, axis=0)
    return np.stack([a + here, a + there, b + there, b + here], axis=-1).reshape(-1, 4)


def halves(cells: Indices, count: int) -> Revolved:
    """Return both halves of the section of a body of ``count`` points, cut along the plane y = 0."""
    points, angle = np.tile(np.arange(count), 2), np.repeat([0.0, np.pi], count)
    return Revolved(points, angle, np.concatenate([cells, cells[:, ::-1] + count]))


def surface_points(body: Body, coarser: int = 1) -> Revolved:
    """Return the points of the body's surface, turned as often as they are spaced; ``coarser``: fewer of them."""
    surface, apart = body.surface, coarser * spacing(body)
    every = np.concatenate([surface.ring.ravel(), surface.rear_face[:, 0], surface.impact_face[:, 0]])
    points = np.unique(every[every >= 0])
    if coarser > 1:
        block = np.floor(body.position[points] / apart + 1e-6)
        points = points[np.sort(np.unique(block, axis=0, return_index=True)[1])]
    counts = np.maximum(1, np.rint(2.0 * np.pi * body.position[points, 0] / apart).astype(int))
    angle = np.concatenate([2.0 * np.pi * np.arange(count) / count for count in counts])
    return Revolved(np.repeat(points, counts), angle, NONE)


def edges_off_axis(body: Body, cells: Indices) -> Indices:
    """Return the edges ``[f, 2]`` off the axis that belong to one quadrilateral only; the body is to their left."""
    edges = outer_edges(cells)
    return edges[(body.position[edges, 0] > 0.0).any(axis=1)]  # on the axis they sweep nothing
