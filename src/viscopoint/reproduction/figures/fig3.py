"""Figure 3: the rod of finite elements that relaxes fastest turns into a mushroom."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from viscopoint.reproduction.figures import register
from viscopoint.reproduction.figures.growth import draw_growth
from viscopoint.results.run import Run


@register(
    "FEM, β = 650 ms⁻¹: height at 5, 10 and 20 µs",
    "The rod of finite elements at β = 650 1/ms, coloured by height; dashed, where it was at the start. The foot grows "
    "into a mushroom while the rest keeps its radius and falls on.",
    needs=("fem-650",),
)
def fig3(runs: Mapping[str, Run]) -> Figure:
    return draw_growth(runs["fem-650"], "FEM")
