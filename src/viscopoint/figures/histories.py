"""``histories.png``: length, radii, velocity and wall force over time."""

from matplotlib.figure import Figure

from viscopoint.figures import offer
from viscopoint.results import Run

PANELS = (
    (("length",), "length (mm)"),
    (("foot_radius", "greatest_radius"), "radius (mm)"),
    (("velocity",), "velocity of the centre of mass (m/s)"),
    (("wall_force",), "wall force (N)"),
)


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
    for axis in axes[-1]:
        axis.set_xlabel("time (µs)")
    return figure
