"""``shapes.png``: the rod at each snapshot, seen from outside and cut open, coloured by axial velocity."""

from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from viscopoint.figures import COLOURS, FIGURES, chosen, discs, faces, halves
from viscopoint.kernels.arrays import Array
from viscopoint.model.body import in_half_plane
from viscopoint.results.reader import Reader, Snapshot

TILT = np.radians(15.0)  # the camera looks down on the rod by this angle
SEEN = ("position", "velocity", "lost", "deleted")  # the fields that pictures take
WIDTH, LEAST, HIGHEST = 1.25, 1.6, 3.4  # of one picture, and its bounds in height, inches
LEFT, RIGHT, TOP, BELOW, GAP = 0.65, 1.4, 0.35, 0.5, 0.35  # room for words around and between the pictures, inches


@FIGURES.register("shapes")
def shapes(run: Reader) -> Figure:
    """Draw snapshots side by side."""
    numbers, colours = chosen(run), Normalize()
    figure = Figure()
    axes = figure.subplots(2, len(numbers), sharex=True, squeeze=False)
    # one at a time: all snapshots of millions of points would not fit into memory
    slow, fast, reach, highest = np.transpose([
        _draw(column, run, run.snapshot(number, only=SEEN), colours)
        for column, number in zip(axes.T, numbers, strict=True)
    ])  # fmt: skip
    colours.vmin, colours.vmax = slow.min(), fast.max()
    reach = 1.1 * float(reach.max())
    low, top = -np.sin(TILT) * reach, float(highest.max()) + np.tan(TILT) * reach
    height = np.clip(WIDTH * (top - low) / (2.0 * reach), LEAST, HIGHEST)  # of one picture
    wide = LEFT + len(numbers) * (WIDTH + GAP) - GAP + RIGHT
    tall = TOP + 2.0 * height + GAP + BELOW
    figure.set_size_inches(wide, tall)
    # by hand, as everything has its known place: to find room by drawing all twice takes as long as drawing
    figure.subplots_adjust(
        left=LEFT / wide, right=1.0 - RIGHT / wide, bottom=BELOW / tall, top=1.0 - TOP / tall,
        wspace=GAP / WIDTH, hspace=GAP / height,
    )  # fmt: skip
    for axis in axes.flat:
        axis.set(xlim=(-reach, reach), ylim=(low, top), aspect="equal")
        axis.grid(False)
    for axis in axes[0]:
        axis.set_yticks([])  # a height in this view is none of the rod
        axis.spines["left"].set_visible(False)
    for axis in axes[1, 1:]:
        axis.tick_params(labelleft=False)
    axes[0, 0].set_ylabel("from outside,\nlooking down a little")
    axes[1, 0].set_ylabel("cut open, z (mm)")
    scale = ScalarMappable(colours, COLOURS)
    place = (1.0 - (RIGHT - GAP) / wide, 0.25, 0.2 / wide, 0.5)
    figure.colorbar(scale, cax=figure.add_axes(place), label="axial velocity (m/s)").ax.grid(False)
    return figure


def _draw(axes: Any, run: Reader, snapshot: Snapshot, colours: Normalize) -> tuple[float, float, float, float]:
    """Draw one snapshot: from outside above, cut open below.

    Returns:
        The lowest and highest axial velocity [m/s] and how far the points reach from the axis and upwards [mm].
    """
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
    there = snapshot["lost"] == 0
    speed, place = snapshot["velocity"][there, 2], snapshot["position"][there]
    return (
        speed.min(initial=0.0), speed.max(initial=0.0),
        np.abs(place[:, :2]).max(initial=0.0), place[:, 2].max(initial=-np.inf),
    )  # fmt: skip


def seen(position: Array, tilt: float) -> Array:
    """Return where points are in the picture, across, up and away from the camera, which looks along y and down."""
    x, y, z = position.T
    return np.column_stack([x, z * np.cos(tilt) + y * np.sin(tilt), y * np.cos(tilt) - z * np.sin(tilt)])
