"""The figures of a run: one short file each, found by itself.

A figure is a function of a ``Reader`` that returns a Matplotlib figure, registered under the name of its PNG file.
"""

import textwrap
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from viscopoint.case.description import description
from viscopoint.discovery import Registry, import_all
from viscopoint.results.folder import whole

if TYPE_CHECKING:
    from viscopoint.results.reader import Reader

T = TypeVar("T")

FIGURES: "Registry[Callable[[Reader], Figure]]" = Registry()
STYLE: Any = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "legend.frameon": False,
    "savefig.dpi": 150,
}
COLOURS = "viridis"


MOST = 8  # snapshots in one figure
SMALL, LETTER, LINE = 7, 0.06, 0.13  # of a caption: size of the font, points; of a letter at most and a line, inches


def chosen(run: "Reader") -> list[int]:
    """Return the numbers of up to ``MOST`` snapshots, evenly spread, the first and the last among them."""
    last = len(run.times) - 1
    return sorted({round(last * share / (MOST - 1)) for share in range(MOST)})


def draw_all(run: "Reader", folder: Path) -> list[Path]:
    """Draw all figures of a run into a folder."""
    return save_all(FIGURES, run, folder, description(run.case))


def save_all(figures: Mapping[str, Callable[[T], Figure]], subject: T, folder: Path, caption: str = "") -> list[Path]:
    """Draw figures of something, each under its name and over a caption, and return their files."""
    folder.mkdir(exist_ok=True)
    files = []
    with rc_context(STYLE):
        for name, draw in figures.items():
            files.append(folder / f"{name}.png")
            figure = draw(subject)
            with whole(files[-1]) as part:
                figure.savefig(part, format="png", bbox_inches=_captioned(figure, caption))
    return files


def _captioned(figure: Figure, caption: str) -> Bbox:
    """Write a caption below a figure, and return what is to be saved, in inches."""
    width, height = figure.get_size_inches()
    lines = textwrap.wrap(caption, int(width / LETTER))
    figure.text(0.1 / width, 0.0, "\n".join(lines), va="top", fontsize=SMALL, color="0.3", parse_math=False)
    return Bbox.from_extents(0.0, -LINE * len(lines) - (0.1 if lines else 0.0), width, height)


import_all(__name__)
