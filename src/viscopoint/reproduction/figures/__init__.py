"""The paper's Figures 2 to 7, drawn again from finished runs: one short file each, found by itself.

A run's name tells its method, "elastic" where the long-time shear modulus is raised to the short-time one, and the
decay constant in 1/ms: ``fem-650``, ``mpm-elastic-6.5``. Every run has snapshots at 5, 10 and 20 µs.
"""

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from matplotlib import rc_context
from matplotlib.figure import Figure
from PIL import Image

from viscopoint.discovery import import_all
from viscopoint.results.folder import whole
from viscopoint.results.run import Run

Draw = Callable[[Mapping[str, Run]], Figure]
DPI = 200  # at which a PNG of a figure is as sharp as the material points in it were drawn
GREYS = (0, 26, 115, 184, 224, 255)  # of letters, lines, wall and paper: they must not be dithered
STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.labelsize": 9,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "axes.grid": False,
    "savefig.dpi": DPI,
}


class PaperFigure(NamedTuple):
    """A figure of the paper and how to draw it."""

    name: str
    title: str
    caption: str  # what is shown and what to look for
    needs: tuple[str, ...]  # names of runs
    draw: Draw  # takes all needed runs by name


FIGURES: dict[str, PaperFigure] = {}


def register(title: str, caption: str, needs: tuple[str, ...]) -> Callable[[Draw], Draw]:
    """Let the decorated function draw a figure, under the name of its module."""

    def add(draw: Draw) -> Draw:
        def styled(runs: Mapping[str, Run]) -> Figure:
            with rc_context(STYLE):
                return draw(runs)

        name = draw.__module__.rpartition(".")[2]
        FIGURES[name] = PaperFigure(name, title, caption, needs, styled)
        return draw

    return add


def save(figure: Figure, file: Path) -> None:
    """Write a PNG with a palette of 256 colours, dithered: a third of the size, and not to be told by eye."""
    pixels = io.BytesIO()
    figure.savefig(pixels, dpi=DPI)
    picture = Image.open(pixels).convert("RGB")
    greys = [grey for grey in GREYS for _ in range(3)]
    palette = picture.quantize(256 - len(GREYS), Image.Quantize.MAXCOVERAGE)
    palette.putpalette((palette.getpalette() or [])[: 768 - len(greys)] + greys)
    with whole(file) as part:
        picture.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG).save(part, format="PNG", optimize=True)


import_all(__name__)
