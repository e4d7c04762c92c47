"""Figures 3 and 4: one rod at three times, coloured by height, laid out alike so that they go side by side."""

from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from viscopoint.reproduction.figures.page import ONE_ROW, lay_out, letter
from viscopoint.reproduction.figures.scene import outline
from viscopoint.reproduction.figures.solids import Paint, colours, draw_rod
from viscopoint.results.run import Run

SHADES = colours("viridis_r", 0.0, 0.9)  # bright at the foot, where the shape changes
TIMES = ("5 us", "10 us", "20 us")


def draw_growth(run: Run, method: str) -> Figure:
    """Draw a run at the paper's times."""
    rod = run.case.rod
    height = Paint("height z (mm)", lambda snapshot: snapshot["position"][:, 2], SHADES, Normalize(0.0, rod.length))
    page = lay_out(run.case, (tuple(time.replace("us", "µs") for time in TIMES),), ONE_ROW)
    letter(page.axes[0, 0], method)
    for axis, time in zip(page.axes[0], TIMES, strict=True):
        draw_rod(axis, page.view, run, run.snapshot(time), height)
        outline(axis, page.view, rod)
    page.bar(height, 0, 0)
    return page.figure
