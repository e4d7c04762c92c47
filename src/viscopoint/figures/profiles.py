"""``profiles.png``: the rod's outline r(z) at each snapshot."""

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from viscopoint.figures import COLOURS, chosen, offer
from viscopoint.results import Run


@offer("profiles")
def profiles(run: Run) -> Figure:
    """Draw the outline, both sides of the axis to scale."""
    figure = Figure(figsize=(8.0, 4.2), layout="constrained")
    axis = figure.subplots()
    numbers = chosen(run)
    colours = matplotlib.colormaps[COLOURS](np.linspace(0.0, 0.9, len(numbers)))
    for number, colour in zip(numbers, colours, strict=True):
        snapshot = run.snapshot(number)
        height, radius = run.profile(snapshot)
        axis.plot(height, radius, color=colour, label=f"{snapshot.time * 1e3:g} µs")
        axis.plot(height, -radius, color=colour)
    axis.axvline(-run.case.impact.gap, color="0.3", linewidth=1.0)
    axis.set(xlabel="z (mm), wall at the left", ylabel="r (mm)", aspect="equal")
    figure.legend(ncols=4, loc="outside upper center")
    return figure
