"""How material points look: discs a little wider than their spacing."""

from typing import Any

import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Normalize

from viscopoint.arrays import Array, Indices
from viscopoint.body import spacing
from viscopoint.figures import COLOURS
from viscopoint.results import Run, Snapshot

COVER = 1.5  # width of a point's disc in spacings
SLICE = 0.6  # half the thickness of the slice that is shown of a rod cut open, in spacings


def outside(run: Run, snapshot: Snapshot) -> Indices:
    """Return the points of the rod's surface."""
    surface = run.body.surface
    return np.unique(np.concatenate([surface.ring.ravel(), surface.tail[:, 0], surface.foot[:, 0]]))


def cut_open(run: Run, snapshot: Snapshot) -> Indices:
    """Return the points that started beside the plane y = 0."""
    return np.flatnonzero(np.abs(run.body.position[:, 1]) < SLICE * np.cbrt(run.body.volume))


def paint(axis: Any, run: Run, snapshot: Snapshot, points: Indices, seen: Array, colours: Normalize) -> None:
    """Draw points in their axial velocity, the far ones first, so that they cover what is behind."""
    depth = np.round(seen[points, 2], 9)  # points of one depth keep their order, on both sides of the axis alike
    order = points[np.argsort(-depth, kind="stable")]
    order = order[snapshot["lost"][order] == 0]
    width = np.full(len(order), COVER * spacing(run.body))
    axis.add_collection(
        EllipseCollection(
            width, width, np.zeros_like(width), units="xy", offsets=seen[order, :2], offset_transform=axis.transData,
            array=snapshot["velocity"][order, 2], cmap=COLOURS, norm=colours, linewidths=0, rasterized=True,
        )
    )  # fmt: skip
