"""Figure 7: an elastic rod has no mushroom, and the decay constant no effect.

A quarter of the rod is cut away as in Figure 6. The displacement along x shows how far material moved aside; seen
obliquely, x runs to the right and a little away.
"""

from collections.abc import Mapping

from matplotlib.colors import CenteredNorm
from matplotlib.figure import Figure

from viscopoint.kernels.arrays import Array
from viscopoint.reproduction.figures import register
from viscopoint.reproduction.figures.decays import TITLES, axial_velocity, beyond, draw_row, names, shots, span
from viscopoint.reproduction.figures.page import TWO_ROWS, lay_out, letter
from viscopoint.reproduction.figures.solids import Paint, colours, half_section
from viscopoint.results.reader import Snapshot
from viscopoint.results.run import Run

FEM, MPM = names("fem-elastic"), names("mpm-elastic")


def aside(snapshot: Snapshot) -> Array:
    """Return the displacement along x [mm]."""
    return snapshot["displacement"][:, 0]


@register(
    "Elastic control, G₀ = G∞ = 140 MPa, at 20 µs",
    "The same rods without relaxation at 20 µs, a quarter cut away: displacement along x by finite elements (a), axial "
    "velocity by material points (b). No mushroom; waves run up the rod; the three decay constants give the same.",
    needs=FEM + MPM,
)
def fig7(runs: Mapping[str, Run]) -> Figure:
    above, below = shots(runs, FEM), shots(runs, MPM)
    most = max(map(abs, span(aside, above)))
    displacement = Paint("x-displacement (mm)", aside, colours("PuOr_r", 0.08, 0.92), CenteredNorm(0.0, most))
    velocity = axial_velocity(below[0].run)
    page = lay_out(above[0].run.case, (TITLES, TITLES), TWO_ROWS)
    letter(page.axes[0, 0], "(a) FEM")
    draw_row(page, 0, above, displacement, half_section)
    page.bar(displacement, 0, 0)
    letter(page.axes[1, 0], "(b) MPM")
    draw_row(page, 1, below, velocity, half_section)
    page.bar(velocity, 1, 1, beyond(velocity, below))
    return page.figure
