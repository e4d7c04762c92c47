"""Figure 5: the slower the material relaxes, the less of a mushroom.

Coloured by how far material has moved outwards, as the shapes at 6.5 and 65 1/ms differ by a fraction of a millimetre.
"""

from collections.abc import Mapping

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from viscopoint.kernels.arrays import Array
from viscopoint.reproduction.figures import register
from viscopoint.reproduction.figures.decays import TITLES, draw_row, names, shots, span
from viscopoint.reproduction.figures.page import TWO_ROWS, lay_out, letter
from viscopoint.reproduction.figures.solids import Paint, colours
from viscopoint.results.reader import Snapshot
from viscopoint.results.run import Run

FEM, MPM = names("fem"), names("mpm")
SHADES = colours("magma_r", 0.03, 0.75)  # of a polymer where nothing has moved


def outwards(snapshot: Snapshot) -> Array:
    """Return how far each point has moved away from the axis [mm]."""
    now, start = snapshot["position"], snapshot["position"] - snapshot["displacement"]
    return np.hypot(now[:, 0], now[:, 1]) - np.hypot(start[:, 0], start[:, 1])


@register(
    "Shapes at 20 µs for β = 6.5, 65 and 650 ms⁻¹",
    "The rod at 20 µs by finite elements (a) and by material points (b), coloured by radial displacement; dashed, "
    "where it was at the start. At β = 6.5 1/ms the rod bulges a little and its foot springs back already, at 65 1/ms "
    "the foot stays wider, at 650 1/ms it is a mushroom, by both methods alike.",
    needs=FEM + MPM,
)
def fig5(runs: Mapping[str, Run]) -> Figure:
    fem, mpm = shots(runs, FEM), shots(runs, MPM)
    growth = Paint("radial displacement (mm)", outwards, SHADES, Normalize(*span(outwards, fem + mpm)))
    page = lay_out(fem[0].run.case, (TITLES, TITLES), TWO_ROWS)
    letter(page.axes[0, 0], "(a) FEM")
    draw_row(page, 0, fem, growth)
    letter(page.axes[1, 0], "(b) MPM")
    draw_row(page, 1, mpm, growth)
    page.bar(growth, 0, 1)
    return page.figure
