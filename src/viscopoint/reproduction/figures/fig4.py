"""Figure 4: the rod of material points that relaxes fastest turns into a mushroom."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from viscopoint.reproduction.figures import register
from viscopoint.reproduction.figures.growth import draw_growth
from viscopoint.results.run import Run


@register(
    "MPM, β = 650 ms⁻¹: height at 5, 10 and 20 µs",
    "The rod of material points at β = 650 1/ms, coloured by height; dashed, where it was at the start. The foot grows "
    "into a mushroom while the rest keeps its radius and falls on.",
    needs=("mpm-650",),
)
def fig4(runs: Mapping[str, Run]) -> Figure:
    return draw_growth(runs["mpm-650"], "MPM")
