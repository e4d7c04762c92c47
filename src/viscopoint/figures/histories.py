"""``histories.png``: length, radii, velocity and wall force over time."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from viscopoint.figures import FIGURES
from viscopoint.kernels.arrays import Array
from viscopoint.results.reader import Reader

PANELS = (
    (("length",), "length (mm)"),
    (("contact_radius", "greatest_radius"), "radius (mm)"),
    (("velocity",), "velocity of the centre of mass (m/s)"),
    (("wall_force",), "wall force (N)"),
)


def _leave_out_spikes(axis: Any, force: Array) -> None:
    """Scale the force by all but its highest percent: on a grid the first touch is a blow of one step."""
    usual, highest = 1.25 * float(np.quantile(force, 0.99)), float(force.max())
    if highest > usual > 0.0:
        axis.set_ylim(-0.05 * usual, usual)
        axis.set_title(f"first touch: {highest:.3g} N", loc="right", fontsize="small")


@FIGURES.register("histories")
def histories(run: Reader) -> Figure:
    """Draw four panels over one time axis."""
    figure = Figure(figsize=(8.0, 5.5))
    room = {"left": 0.12, "right": 0.985, "bottom": 0.09, "top": 0.975, "wspace": 0.32, "hspace": 0.14}
    axes = figure.subplots(2, 2, sharex=True, gridspec_kw=room)
    time = run.columns["time"] * 1e3
    for axis, (columns, label) in zip(axes.flat, PANELS, strict=True):
        for column, style in zip(columns, ("-", "--"), strict=False):
            axis.plot(time, run.columns[column], style, label=column.replace("_", " "))
        axis.set_ylabel(label)
        axis.yaxis.set_label_coords(-0.215, 0.5)
        if len(columns) > 1:
            axis.legend()
    _leave_out_spikes(axes.flat[-1], run.columns["wall_force"])
    for axis in axes[-1]:
        axis.set_xlabel("time (µs)")
    return figure
