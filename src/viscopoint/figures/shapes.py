"""``shapes.png``: the rod at each snapshot, seen from outside and cut open, coloured by axial velocity."""

from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from viscopoint.figures import COLOURS, chosen, offer
from viscopoint.results import Run, Snapshot

TILT = np.radians(15.0)  # the camera looks down on the rod by this angle
COVER = 1.5  # width of a point's disc in spacings


@offer("shapes")
def shapes(run: Run) -> Figure:
    """Draw snapshots side by side."""
    snapshots = [run.snapshot(number) for number in chosen(run)]
    speeds = [snapshot["velocity"][snapshot["lost"] == 0, 2] for snapshot in snapshots]
    colours = Normalize(min(v.min(initial=0.0) for v in speeds), max(v.max(initial=0.0) for v in speeds))
    reach = 1.1 * max(float(np.abs(snapshot["position"][:, :2]).max()) for snapshot in snapshots)
    top = max(float(snapshot["position"][:, 2].max()) for snapshot in snapshots) + np.tan(TILT) * reach
    low = -np.sin(TILT) * reach

    figure = Figure(figsize=(1.2 + 1.7 * len(snapshots), 8.0), layout="constrained")
    axes = figure.subplots(2, len(snapshots), sharex=True, squeeze=False)
    for column, snapshot in enumerate(snapshots):
        _outside(axes[0, column], run, snapshot, colours)
        _section(axes[1, column], run, snapshot, colours)
        axes[0, column].set_title(f"{snapshot.time * 1e3:g} µs")
        axes[1, column].set_xlabel("x (mm)")
        for axis in axes[:, column]:
            axis.set(xlim=(-reach, reach), ylim=(low, top), aspect="equal")
            axis.grid(False)
    axes[0, 0].set_ylabel("from outside, looking down a little")
    for axis in axes[0]:
        axis.tick_params(left=False, labelleft=False)  # a height in this view is none of the rod
        axis.spines["left"].set_visible(False)
    axes[1, 0].set_ylabel("cut open, z (mm)")
    scale = ScalarMappable(colours, COLOURS)
    figure.colorbar(scale, ax=axes, label="axial velocity (m/s)", shrink=0.6)
    return figure


def _outside(axis: Any, run: Run, snapshot: Snapshot, colours: Normalize) -> None:
    surface = run.body.surface
    shown = np.unique(np.concatenate([surface.ring.ravel(), surface.tail[:, 0], surface.foot[:, 0]]))
    x, y, z = snapshot["position"][shown].T
    depth = y * np.cos(TILT) - z * np.sin(TILT)
    _paint(axis, run, snapshot, shown, x, z * np.cos(TILT) + y * np.sin(TILT), depth, colours)


def _section(axis: Any, run: Run, snapshot: Snapshot, colours: Normalize) -> None:
    spacing = np.cbrt(run.body.volume)
    shown = np.flatnonzero(np.abs(run.body.position[:, 1]) < 0.6 * spacing)
    x, y, z = snapshot["position"][shown].T
    _paint(axis, run, snapshot, shown, x, z, y, colours)
    axis.axhline(-run.case.impact.gap, color="0.3", linewidth=1.0)


def _paint(
    axis: Any, run: Run, snapshot: Snapshot, shown: Any, across: Any, up: Any, depth: Any, colours: Normalize
) -> None:
    """Draw points as discs wider than their spacing, the far ones first, so that they cover what is behind."""
    order = np.argsort(-depth)
    order = order[snapshot["lost"][shown][order] == 0]
    width = np.full(len(order), COVER * np.cbrt(run.body.volume[0]))
    axis.add_collection(
        EllipseCollection(
            width, width, np.zeros_like(width), units="xy",
            offsets=np.column_stack([across[order], up[order]]), offset_transform=axis.transData,
            array=snapshot["velocity"][shown, 2][order], cmap=COLOURS, norm=colours, linewidths=0, rasterized=True,
        )
    )  # fmt: skip
