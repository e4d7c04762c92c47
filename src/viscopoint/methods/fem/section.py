"""The half section of a rod as quadrilaterals that turn around the z axis: their volumes, quality and mesh."""

import numpy as np

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.methods.fem.cells.ring import ETA, GAUSS, TWO_PI, XI, Ring
from viscopoint.methods.fem.mesh import Form
from viscopoint.methods.fem.rod import heights, layers
from viscopoint.model.body import EXACT, Body, layered_surface

EDGES = ((0, 1), (1, 2), (2, 3), (3, 0))


def shape_functions(xi: float, eta: float) -> Array:
    """Return the four N at a place in the element."""
    return (1 + XI * xi) * (1 + ETA * eta) / 4


def point_volumes(position: Array, corner: Indices) -> Array:
    """Return the volume 2π r dA that each of an element's 2 x 2 points stands for, ``[e, 4]`` [mm^3]."""
    x = position[corner]
    found = []
    for xi, eta in _gauss_places():
        a = np.einsum("k,ekd->ed", XI * (1 + ETA * eta) / 4, x)
        b = np.einsum("k,ekd->ed", ETA * (1 + XI * xi) / 4, x)
        r = x[:, :, 0] @ shape_functions(xi, eta)
        found.append(TWO_PI * r * (a[:, 0] * b[:, 2] - a[:, 2] * b[:, 0]))
    return np.column_stack(found)


def node_volumes(position: Array, corner: Indices) -> Array:
    """Return the volume that each node stands for, ∫N over its rings [mm^3]."""
    shares = point_volumes(position, corner) @ np.array([shape_functions(*place) for place in _gauss_places()])
    return np.bincount(corner.ravel(), shares.ravel(), minlength=len(position)).astype(float)


def scaled_jacobians(position: Array, corner: Indices) -> Array:
    """Return the least sine of the angle between the edges at a corner, of each element; below zero: inside out."""
    x = position[corner]
    least = np.full(len(corner), np.inf)
    for k in range(len(EDGES)):
        one, other = x[:, (k + 1) % 4] - x[:, k], x[:, (k + 3) % 4] - x[:, k]
        sizes = np.linalg.norm(one, axis=1) * np.linalg.norm(other, axis=1)
        area = one[:, 0] * other[:, 2] - one[:, 2] * other[:, 0]
        least = np.minimum(least, np.divide(area, sizes, out=np.zeros_like(area), where=sizes > 0))
    return least


def off_the_axis(position: Array) -> Array:
    """Return 0 along axes along which nodes cannot move, those on the z axis along x; else 1."""
    free = np.ones_like(position)
    free[position[:, 0] == 0.0, 0] = 0.0
    return free


def outer_edges(corner: Indices) -> Indices:
    """Return the edges ``[f, 2]`` that belong to one element only; the body is to their left."""
    edges = np.concatenate([corner[:, edge] for edge in EDGES])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    return edges[np.sort(first[count == 1])]


QUADRILATERALS = Form(
    edges=EDGES,
    point_volumes=point_volumes,
    scaled_jacobians=scaled_jacobians,
    free=off_the_axis,
    cell=Ring(),
    moving=(0.0, 0.0, 1.0),
)


def section_mesh(radius: float, length: float, size: float, grading: float = 1.0) -> Body:
    """Mesh half of an upright rod's section, its foot at z = 0, with elements that grow up the rod by ``grading``."""
    across = np.linspace(0.0, radius, _columns(radius, size) + 1)
    planes = heights(length, size, grading)
    z, x = (grid.ravel() for grid in np.meshgrid(planes, across, indexing="ij"))
    position = np.column_stack([x, np.zeros_like(x), z])
    index = np.arange(len(position)).reshape(len(planes), len(across))
    low, high = slice(None, -1), slice(1, None)
    cells = np.column_stack(
        [index[low, low].ravel(), index[low, high].ravel(), index[high, high].ravel(), index[high, low].ravel()]
    )
    last, start = slice(-1, None), np.array([radius])
    surface = layered_surface(index, last, start, radius, end_overhang=0.0, contact_height=EXACT * radius)
    return Body(position, node_volumes(position, cells), surface, cells)


def section_elements(radius: float, length: float, size: float, grading: float) -> int:
    """Return how many elements the mesh has."""
    return _columns(radius, size) * layers(length, size, grading)


def _columns(radius: float, size: float) -> int:
    """Return the least number of columns no wider than ``size``."""
    return max(1, int(np.ceil(radius / size * (1.0 - 1e-9))))


def _gauss_places() -> list[tuple[float, float]]:
    """Return the points of the 2 x 2 rule, in the order of the corners."""
    return [(GAUSS * float(xi), GAUSS * float(eta)) for xi, eta in zip(XI, ETA, strict=True)]
