"""How material points look: discs a little wider than their spacing.

Of more than ``MOST`` points only those are drawn that are foremost in some square of the picture, as wider discs.
"""

from typing import Any

import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Normalize

from viscopoint.figures import COLOURS
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.model.body import spacing
from viscopoint.results.reader import Reader, Snapshot

COVER = 1.5  # width of a point's disc in spacings
MOST = 20_000  # discs in one picture; more would be smaller than its pixels
GAP = 2.0  # in edges of a square of the picture: how far neighbours may be apart, so that discs leave no gap
SLICE = 0.6  # half the thickness of the slice that is shown of a rod cut open, in spacings


def outside(run: Reader, snapshot: Snapshot) -> Indices:
    """Return the points of the rod's surface."""
    surface = run.body.surface
    return np.unique(np.concatenate([surface.ring.ravel(), surface.rear_face[:, 0], surface.impact_face[:, 0]]))


def cut_open(run: Reader, snapshot: Snapshot) -> Indices:
    """Return the points that started beside the plane y = 0."""
    return np.flatnonzero(np.abs(run.body.position[:, 1]) < SLICE * np.cbrt(run.body.volume))


def paint(axis: Any, run: Reader, snapshot: Snapshot, points: Indices, seen: Array, colours: Normalize) -> None:
    """Draw points in their axial velocity, the far ones first, so that they cover what is behind."""
    points = points[snapshot["lost"][points] == 0]
    shown, apart = foremost(seen[points], spacing(run.body))
    scatter(axis, seen[points[shown]], apart, snapshot["velocity"][points[shown], 2], colours)


def scatter(axis: Any, seen: Array, apart: float, values: Array, colours: Normalize) -> None:
    """Draw discs at places ``seen[n, 3]``, about ``apart`` [mm], in the colours of values, in the order given."""
    width = np.full(len(seen), COVER * apart)
    axis.add_collection(
        EllipseCollection(
            width, width, np.zeros_like(width), units="xy", offsets=seen[:, :2], offset_transform=axis.transData,
            array=values, cmap=COLOURS, norm=colours, linewidths=0, rasterized=True,
        )
    )  # fmt: skip


def foremost(seen: Array, apart: float) -> tuple[Indices, float]:
    """Return which of the places ``seen[n, 3]`` to draw, the far ones first, and how far apart those are [mm].

    ``apart`` says how far all are; those that are kept, of neighbouring squares, may be two edges of a square apart.
    """
    depth = np.round(seen[:, 2], 9)  # places of one depth keep their order, on both sides of the axis alike
    order = np.argsort(-depth, kind="stable")
    if len(seen) <= MOST:
        return order, apart
    low, size = seen[:, :2].min(axis=0), np.ptp(seen[:, :2], axis=0)
    apart = max(apart, float(np.sqrt(size.prod() / MOST)))
    column, row = ((seen[order, :2] - low) / apart).astype(int).T
    nearest_first = (column * (row.max() + 1) + row)[::-1]
    _, last = np.unique(nearest_first, return_index=True)
    return order[np.sort(len(order) - 1 - last)], GAP * apart
