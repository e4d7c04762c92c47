"""``shapes.png``: the rod at each snapshot, seen from outside and cut open, coloured by axial velocity."""

from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from viscopoint.arrays import Array
from viscopoint.body import in_half_plane
from viscopoint.figures import COLOURS, chosen, discs, faces, halves, offer
from viscopoint.results import Run, Snapshot

TILT = np.radians(15.0)  # the camera looks down on the rod by this angle
WIDTH, LEAST, HIGHEST = 1.25, 1.6, 3.4  # of one picture, and its bounds in height, inches


@offer("shapes")
def shapes(run: Run) -> Figure:
    """Draw snapshots side by side."""
    snapshots = [run.snapshot(number) for number in chosen(run)]
    speeds = [snapshot["velocity"][snapshot["lost"] == 0, 2] for snapshot in snapshots]
    colours = Normalize(min(v.min(initial=0.0) for v in speeds), max(v.max(initial=0.0) for v in speeds))
    there = np.concatenate([snapshot["position"][snapshot["lost"] == 0] for snapshot in snapshots])
    reach = 1.1 * float(np.abs(there[:, :2]).max())
    low, top = -np.sin(TILT) * reach, float(there[:, 2].max()) + np.tan(TILT) * reach

    height = np.clip(WIDTH * (top - low) / (2.0 * reach), LEAST, HIGHEST)  # of one picture
    figure = Figure(figsize=(1.2 + 1.7 * len(snapshots), 1.2 + 2.0 * height), layout="constrained")
    axes = figure.subplots(2, len(snapshots), sharex=True, squeeze=False)
    for column, snapshot in zip(axes.T, snapshots, strict=True):
        _draw(column, run, snapshot, colours)
        for axis in column:
            axis.set(xlim=(-reach, reach), ylim=(low, top), aspect="equal")
            axis.grid(False)
    axes[0, 0].set_ylabel("from outside,\nlooking down a little")
    for axis in axes[0]:
        axis.tick_params(left=False, labelleft=False)  # a height in this view is none of the rod
        axis.spines["left"].set_visible(False)
    axes[1, 0].set_ylabel("cut open, z (mm)")
    scale = ScalarMappable(colours, COLOURS)
    figure.colorbar(scale, ax=axes, label="axial velocity (m/s)", shrink=0.6)
    return figure


def _draw(axes: Any, run: Run, snapshot: Snapshot, colours: Normalize) -> None:
    """Draw one snapshot: from outside above, cut open below."""
    look = faces if len(run.body.cells) else discs
    above, below = axes
    if in_half_plane(run.body):
        (whole, outside), (section, cut_open) = halves.outside(run, snapshot), halves.cut_open(run, snapshot)
        halves.paint_outside(above, run, whole, outside, seen(whole["position"], TILT), colours)
        look.paint(below, run, section, cut_open, seen(section["position"], 0.0), colours)
    else:
        place = snapshot["position"]
        look.paint(above, run, snapshot, look.outside(run, snapshot), seen(place, TILT), colours)
        look.paint(below, run, snapshot, look.cut_open(run, snapshot), seen(place, 0.0), colours)
    above.set_title(f"{snapshot.time * 1e3:g} µs")
    below.set_xlabel("x (mm)")
    below.axhline(-run.case.impact.gap, color="0.3", linewidth=1.0)


def seen(position: Array, tilt: float) -> Array:
    """Return where points are in the picture, across, up and away from the camera, which looks along y and down."""
    x, y, z = position.T
    return np.column_stack([x, z * np.cos(tilt) + y * np.sin(tilt), y * np.cos(tilt) - z * np.sin(tilt)])
