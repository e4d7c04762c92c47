"""How finite elements look: their outer faces, as far as they are turned towards the camera.

More faces than a picture has room for are drawn as ``discs``.
"""

from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from numpy.typing import NDArray

from viscopoint.figures import COLOURS, discs
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.methods.fem.mesh import outer_faces
from viscopoint.model.body import in_half_plane
from viscopoint.results.reader import Reader, Snapshot

ON_CUT = 1e-9  # of the rod's width: an element whose centre is this close to the cut stays
FINEST = 0.08  # mean width of a face over the rod's radius at which edges are still drawn; they would hide the colours
EDGE: Any = {"edgecolors": (0.0, 0.0, 0.0, 0.3), "linewidths": 0.25}
# Of each run the two latest sets of elements, whole and cut open, and their outer faces: to find them takes a second
# for each million elements.
_KNOWN: WeakKeyDictionary[Reader, list[tuple[NDArray[np.bool_], Indices]]] = WeakKeyDictionary()
SEAM: Any = {"edgecolors": "face", "linewidths": 0.3}  # closes the gaps that smooth drawing leaves between faces


def outside(run: Reader, snapshot: Snapshot) -> Indices:
    """Return the outer faces ``[f, 4]`` of the elements that were not deleted."""
    return _outer_faces(run, snapshot["deleted"] == 0)


def cut_open(run: Reader, snapshot: Snapshot) -> Indices:
    """Return the outer faces of those elements that started behind the plane y = 0."""
    across = run.body.position[:, 1]
    behind = across[run.body.cells].mean(axis=1) > -ON_CUT * np.ptp(across)
    return _outer_faces(run, behind & (snapshot["deleted"] == 0))


def _outer_faces(run: Reader, elements: NDArray[np.bool_]) -> Indices:
    """Return the outer faces of some elements, which most often are those of the snapshot before."""
    known = _KNOWN.setdefault(run, [])
    for others, faces in known:
        if np.array_equal(others, elements):
            return faces
    faces = outer_faces(run.body.cells[elements])
    known[:] = [*known[-1:], (elements, faces)]
    return faces


def paint(axis: Any, run: Reader, snapshot: Snapshot, faces: Indices, seen: Array, colours: Normalize) -> None:
    """Draw faces in the mean axial velocity of their nodes, the far ones first, so that they cover what is behind."""
    draw(axis, snapshot, faces, seen, colours, lines(run))


def draw(axis: Any, snapshot: Snapshot, faces: Indices, seen: Array, colours: Normalize, edges: Any) -> None:
    """Draw faces like ``paint``, with other edges."""
    corners = seen[faces]
    order = far_first(corners)
    speed = snapshot["velocity"][faces[order], 2].mean(axis=1)
    if len(order) > discs.MOST:
        shown, apart = discs.foremost(corners[order].mean(axis=1), 0.0)
        discs.scatter(axis, corners[order[shown]].mean(axis=1), apart, speed[shown], colours)
        return
    polygons = list(corners[order, :, :2])
    axis.add_collection(PolyCollection(polygons, array=speed, cmap=COLOURS, norm=colours, snap=False, **edges))


def far_first(corners: Array) -> Indices:
    """Return which faces ``[f, 4, 3]`` are turned towards the camera, the far ones first."""
    towards = _area(corners) > 0.0
    return np.flatnonzero(towards)[np.argsort(-corners[towards, :, 2].mean(axis=1), kind="stable")]


def lines(run: Reader) -> Any:
    """Return how to draw the edges of faces: not at all, where they would hide the colours."""
    rod, count = run.case.rod, len(run.body.cells)
    section = in_half_plane(run.body)
    width = np.sqrt(rod.radius * rod.length / count) if section else np.cbrt(run.body.volume.sum() / count)
    return EDGE if width > FINEST * rod.radius else SEAM


def _area(corners: Array) -> Array:
    """Return twice the area ``[f]`` of quadrilaterals in the picture; above zero for those seen from outside."""
    one, other = corners[:, 2, :2] - corners[:, 0, :2], corners[:, 3, :2] - corners[:, 1, :2]
    return one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
