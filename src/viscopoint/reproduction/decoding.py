"""The evidence for how the paper's lattice and units are read."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from viscopoint.comparison.outline import outline
from viscopoint.methods.mpm.fills.lattice import rod_lattice
from viscopoint.reproduction.cases import DECAYS
from viscopoint.results.run import Run

POINTS = 21_172  # of the paper's lattice
UNITS = (
    'The paper prints "bulk modulus, short-time and long-time shear moduli, decay constant = 0.14 GPa, 550 GPa, 5 MPa, '
    '650 1/µs". That cannot be: its Figure 7 raises the long-time modulus to equal the short-time one, "both 140 MPa", '
    "so that the short-time modulus is the 140 and the bulk modulus the 550; a shear modulus of 550 GPa in a solid of "
    "1 g/cm³ would carry waves at 27 km/s, 21 times through the rod in the 20 µs shown. In g, mm and ms stress comes "
    "in MPa and the decay constant in 1/ms. Read in 1/µs, all three decay constants relax within 0.2 µs and give "
    "nearly one shape; read in 1/ms they differ clearly, as the paper says."
)
CAPTION = "The paper's rod at 20 µs for its three decay constants, read in 1/ms (left) and as printed, in 1/µs (right)."
RADIUS, LENGTH = 3.8, 25.4  # mm


class Lattice(NamedTuple):
    """How many points a lattice of some spacing gives."""

    spacing: float  # mm
    points: int


def lattices() -> list[Lattice]:
    """Return what the spacings around a tenth of the radius give; one of them is the paper's."""
    spacings = [round(0.34 + 0.01 * step, 2) for step in range(9)]
    return [Lattice(spacing, len(rod_lattice(RADIUS, LENGTH, spacing).position)) for spacing in spacings]


def spread(runs: Mapping[str, Run], prefix: str) -> list[float]:
    """Return the greatest radius at the end for each decay constant [mm]."""
    return [runs[f"{prefix}-{decay}"].rows[-1].greatest_radius for decay in DECAYS]


def units_figure(runs: Mapping[str, Run]) -> Figure:
    """Draw the outlines at 20 µs for the three decay constants, read in 1/ms and as printed in 1/µs."""
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    axes = figure.subplots(1, 2, sharex=True, sharey=True)
    for axis, prefix, unit in zip(axes, ("mpm", "printed"), ("1/ms, our reading", "1/µs, as printed"), strict=True):
        for decay, colour, dashes in zip(DECAYS, ("#0072b2", "#d55e00", "#009e73"), ("-", "--", ":"), strict=True):
            run = runs[f"{prefix}-{decay}"]
            radius, height = outline(run, run.snapshot(-1)).T
            line = np.r_[radius, -radius[::-1]], np.r_[height, height[::-1]]
            axis.plot(*line, color=colour, linestyle=dashes, linewidth=1.4, label=f"β = {decay}")
        axis.axhline(-runs["mpm-650"].case.impact.gap, color="0.3", linewidth=1.0)
        axis.set(title=f"β in {unit}", xlabel="r (mm)", aspect="equal")
        axis.legend(loc="upper center", ncols=1, bbox_to_anchor=(0.5, 0.8))
    axes[0].set_ylabel("z (mm)")
    return figure
