"""``energies.png``: the energy ledger over time, in per cent of the initial kinetic energy."""

from matplotlib.figure import Figure

from viscopoint.figures import offer
from viscopoint.results import Run

TERMS = {
    "kinetic": "kinetic",
    "stored": "stored",
    "dissipated": "dissipated by the law",
    "viscous": "bulk viscosity",
    "contact": "taken at the wall",
    "friction": "friction",
    "numerical": "numerical remainder",
}


@offer("energies")
def energies(run: Run) -> Figure:
    """Draw the terms that are not always zero."""
    figure = Figure(figsize=(8.0, 4.5), layout="constrained")
    axis = figure.subplots()
    history = run.history
    initial = float(history["kinetic"].iloc[0])
    for column, label in TERMS.items():
        share = 100.0 * history[column] / initial
        if bool((share != 0.0).any()):
            style = "--" if column == "numerical" else "-"
            axis.plot(history["time"] * 1e3, share, style, label=label)
    axis.axhline(0.0, color="0.3", linewidth=0.8)
    axis.set(xlabel="time (µs)", ylabel="% of the initial kinetic energy")
    axis.legend(ncols=4, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    return figure
