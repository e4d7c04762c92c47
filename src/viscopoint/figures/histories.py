"""``histories.png``: length, radii, velocity and wall force over time."""

from typing import Any

from matplotlib.figure import Figure

from viscopoint.figures import offer
from viscopoint.results import Run

PANELS = (
    (("length",), "length (mm)"),
    (("foot_radius", "greatest_radius"), "radius (mm)"),
    (("velocity",), "velocity of the centre of mass (m/s)"),
    (("wall_force",), "wall force (N)"),
)


def _leave_out_spikes(axis: Any, force: Any) -> None:
    """Scale the force by all but its highest percent: on a grid the first touch is a blow of one step."""
    usual, highest = 1.25 * float(force.quantile(0.99)), float(force.max())
    if highest > usual > 0.0:
        axis.set_ylim(-0.05 * usual, usual)
        axis.set_title(f"first touch: {highest:.3g} N", loc="right", fontsize="small")


@offer("histories")
def histories(run: Run) -> Figure:
    """Draw four panels over one time axis."""
    figure = Figure(figsize=(8.0, 5.5), layout="constrained")
    axes = figure.subplots(2, 2, sharex=True)
    time = run.history["time"] * 1e3
    for axis, (columns, label) in zip(axes.flat, PANELS, strict=True):
        for column, style in zip(columns, ("-", "--"), strict=False):
            axis.plot(time, run.history[column], style, label=column.replace("_", " "))
        axis.set_ylabel(label)
        if len(columns) > 1:
            axis.legend()
    _leave_out_spikes(axes.flat[-1], run.history["wall_force"])
    for axis in axes[-1]:
        axis.set_xlabel("time (µs)")
    return figure
