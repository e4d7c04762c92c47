"""Figure 6: slow relaxation lets an elastic wave run up the rod, fast relaxation stops no more than the foot.

The paper shows the outside; here the quarter in front at the right is cut away, as the material that
flies back first is on the axis, where the outside does not show it.
"""

from collections.abc import Mapping

from matplotlib.figure import Figure

from viscopoint.reproduction.figures import register
from viscopoint.reproduction.figures.decays import TITLES, axial_velocity, beyond, draw_row, names, shots
from viscopoint.reproduction.figures.page import ONE_ROW, lay_out, letter
from viscopoint.reproduction.figures.solids import half_section
from viscopoint.results.run import Run

MPM = names("mpm")


@register(
    "MPM: axial velocity at 20 µs for β = 6.5, 65 and 650 ms⁻¹",
    "Axial velocity at 20 µs by material points, a quarter of the rod cut away: blue falls, pale stands still, red "
    "flies back. At β = 6.5 1/ms an elastic wave has run up almost half of the rod; at 650 1/ms all but the foot "
    "still falls at the impact speed. The speckles are noise of material points that cross cells.",
    needs=MPM,
)
def fig6(runs: Mapping[str, Run]) -> Figure:
    shown = shots(runs, MPM)
    velocity = axial_velocity(shown[0].run)
    page = lay_out(shown[0].run.case, (TITLES,), ONE_ROW)
    letter(page.axes[0, 0], "MPM")
    draw_row(page, 0, shown, velocity, half_section)
    page.bar(velocity, 0, 0, beyond(velocity, shown))
    return page.figure
