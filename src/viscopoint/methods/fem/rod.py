"""The rod as hexahedra on a butterfly (O-grid) mesh, of exactly the cylinder's volume."""

import itertools
import math

import numpy as np

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.methods.fem.mesh import node_volumes
from viscopoint.model.body import EXACT, Body, layered_surface

CORE = 0.68  # radius of the core's corners over that of the rod
MANY = 10**8  # layers, beside which one more or less is nothing
BULGE = 0.3  # 0: a square core, 1: a round one; these two make the thinnest element thickest


def butterfly(radius: float, size: float) -> tuple[Array, Indices, Indices]:
    """Mesh a disc: a square core of curved sides, and rings around it that become circles.

    The outermost nodes stand outside the circle, by as much as gives the polygon of their edges the circle's area: the
    rod then has its mass and stiffness at any size.

    Returns:
        Places ``[n, 2]`` [mm], corners ``[q, 4]`` counter-clockwise, and the nodes on the circumference, in its order.
    """
    across, rings = _division(radius, size)
    s = np.linspace(-1.0, 1.0, across + 1)
    v, u = (grid.ravel() for grid in np.meshgrid(s, s, indexing="ij"))
    flat, round_ = (1.0 - BULGE) / math.sqrt(2.0), BULGE
    core = CORE * radius * np.column_stack([
        u * (flat + round_ * np.sqrt(1.0 - v**2 / 2.0)),
        v * (flat + round_ * np.sqrt(1.0 - u**2 / 2.0)),
    ])  # fmt: skip
    index = np.arange((across + 1) ** 2).reshape(across + 1, across + 1)
    edge = np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])  # from (-1, -1) around
    angle = -0.75 * np.pi + 2.0 * np.pi * np.arange(len(edge)) / len(edge)
    circle = rim_radius(radius, len(edge)) * np.column_stack([np.cos(angle), np.sin(angle)])
    places, quads = [core], [_quads(index)]
    inner = edge
    for ring in range(1, rings + 1):
        outer = len(core) + (ring - 1) * len(edge) + np.arange(len(edge))
        share = ring / rings
        places.append((1.0 - share) * core[edge] + share * circle)
        quads.append(np.column_stack([inner, outer, np.roll(outer, -1), np.roll(inner, -1)]))
        inner = outer
    return np.concatenate(places), np.concatenate(quads), inner


def rim_radius(radius: float, corners: int) -> float:
    """Return the radius of the corners of a regular polygon of the circle's area [mm]."""
    step = 2.0 * math.pi / corners
    return radius * math.sqrt(step / math.sin(step))


def heights(length: float, size: float, grading: float) -> Array:
    """Return the planes between layers, from the foot up.

    The lowest layer is ``size`` thick and the uppermost ``grading`` times that; between them they grow geometrically.
    All are made to fit, none larger than asked.
    """
    count = layers(length, size, grading)
    thick = grading ** (np.arange(count) / (count - 1))
    return length * np.concatenate([[0.0], np.cumsum(thick)]) / thick.sum()


def rod_mesh(radius: float, length: float, size: float, grading: float = 1.0) -> Body:
    """Mesh an upright rod, its foot at z = 0, with elements of a size [mm] that grow up the rod by ``grading``."""
    disc, quads, rim = butterfly(radius, size)
    planes = heights(length, size, grading)
    position = np.column_stack([np.tile(disc, (len(planes), 1)), np.repeat(planes, len(disc))])
    index = np.arange(len(position)).reshape(len(planes), len(disc))
    cells = np.concatenate([np.hstack([lower[quads], upper[quads]]) for lower, upper in itertools.pairwise(index)])
    start = np.full(len(rim), rim_radius(radius, len(rim)))
    surface = layered_surface(index, rim, start, radius, end_overhang=0.0, contact_height=EXACT * radius)
    return Body(position, node_volumes(position, cells), surface, cells)


def rod_elements(radius: float, length: float, size: float, grading: float) -> int:
    """Return how many elements the mesh has."""
    across, rings = _division(radius, size)
    return (across**2 + 4 * across * rings) * layers(length, size, grading)


def _division(radius: float, size: float) -> tuple[int, int]:
    """Return the number of elements across the core and that of rings."""
    return 2 * max(1, round(0.6 * radius / size)), max(1, round(0.4 * radius / size))


def layers(length: float, size: float, grading: float) -> int:
    """Return the least number of layers of which the lowest is no thicker than ``size``."""
    mean = (grading - 1.0) / math.log(grading) if grading != 1.0 else 1.0  # of many layers
    count = max(2, math.ceil(length / (size * mean)) - 2)  # few have more, as both ends are whole layers
    if count > MANY:
        return count
    while count > 2 and size * _relative_length(count - 1, grading) >= length * (1.0 - 1e-9):
        count -= 1
    while size * _relative_length(count, grading) < length * (1.0 - 1e-9):
        count += 1
    return count


def _relative_length(count: int, grading: float) -> float:
    """Return the thickness of all layers over that of the lowest."""
    ratio = grading ** (1.0 / (count - 1)) if count > 1 else 1.0
    return float(count) if ratio == 1.0 else (ratio**count - 1.0) / (ratio - 1.0)


def _quads(index: Indices) -> Indices:
    """Return the corners of the squares between the nodes of a table [row along y, column along x]."""
    return np.column_stack([
        index[:-1, :-1].ravel(), index[:-1, 1:].ravel(), index[1:, 1:].ravel(), index[1:, :-1].ravel(),
    ])  # fmt: skip
