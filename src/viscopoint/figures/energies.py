"""``energies.png``: the energy balance over time, in per cent of the initial kinetic energy."""

from matplotlib.figure import Figure

from viscopoint.figures import FIGURES
from viscopoint.results.reader import Reader

TERMS = {
    "kinetic": "kinetic",
    "stored": "stored",
    "dissipated": "dissipated by the law",
    "hypoelastic": "hypoelastic (law without potential)",
    "viscous": "bulk viscosity",
    "hourglass": "hourglass control",
    "eroded": "in deleted elements",
    "contact": "taken at the wall",
    "friction": "friction",
}


@FIGURES.register("energies")
def energies(run: Reader) -> Figure:
    """Draw the terms that are not always zero, and below what the method itself lost or gained."""
    figure = Figure(figsize=(8.0, 6.0))
    room = {"left": 0.125, "right": 0.985, "bottom": 0.085, "top": 0.875, "hspace": 0.1}
    axis, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1), gridspec_kw=room)
    history = run.columns
    initial = history["kinetic"][0]
    for column, label in TERMS.items():
        share = 100.0 * history[column] / initial
        if (share != 0.0).any():
            axis.plot(history["time"] * 1e3, share, label=label)
    below.plot(history["time"] * 1e3, 100.0 * history["numerical"] / initial, color="0.2")
    axis.set(ylabel="% of the initial kinetic energy")
    below.set(xlabel="time (µs)", ylabel="energy\nerror (%)")
    for each in (axis, below):
        each.yaxis.set_label_coords(-0.09, 0.5)
    figure.legend(ncols=3, loc="upper center")
    return figure
