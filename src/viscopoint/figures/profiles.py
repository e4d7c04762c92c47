"""``profiles.png``: the rod's outline r(z) at each snapshot."""

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from viscopoint.figures import COLOURS, FIGURES, chosen
from viscopoint.results.reader import Reader


@FIGURES.register("profiles")
def profiles(run: Reader) -> Figure:
    """Draw the outline to scale, from foot to tail and back on the other side of the axis."""
    figure = Figure(figsize=(8.0, 4.2), layout="constrained")
    axis = figure.subplots()
    numbers = chosen(run)
    colours = matplotlib.colormaps[COLOURS](np.linspace(0.0, 0.9, len(numbers)))
    for number, colour in zip(numbers, colours, strict=True):
        snapshot = run.snapshot(number, only=("position", "lost"))
        height, radius = run.profile(snapshot)
        outline = np.concatenate([height, height[::-1]]), np.concatenate([radius, -radius[::-1]])
        axis.plot(*outline, color=colour, label=f"{snapshot.time * 1e3:g} µs")
    axis.axvline(-run.case.impact.gap, color="0.3", linewidth=1.0)
    axis.set(xlabel="z (mm), wall at the left", ylabel="r (mm)", aspect="equal")
    figure.legend(ncols=4, loc="outside upper center")
    return figure
