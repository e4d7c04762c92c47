"""The figures of a run: one short file each, found by itself.

A figure is a function of a ``Run`` that returns a Matplotlib figure, offered under the name of its PNG file.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from matplotlib import rc_context
from matplotlib.figure import Figure

from viscopoint.discovery import import_all
from viscopoint.folder import whole

if TYPE_CHECKING:
    from viscopoint.results import Run

T = TypeVar("T")

FIGURES: dict[str, "Callable[[Run], Figure]"] = {}
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


def chosen(run: "Run") -> list[int]:
    """Return the numbers of up to ``MOST`` snapshots, evenly spread, the first and the last among them."""
    last = len(run.times) - 1
    return sorted({round(last * share / (MOST - 1)) for share in range(MOST)})


def offer(name: str) -> "Callable[[Callable[[Run], Figure]], Callable[[Run], Figure]]":
    """Let every run draw the decorated figure as ``name``.png."""

    def register(draw: "Callable[[Run], Figure]") -> "Callable[[Run], Figure]":
        FIGURES[name] = draw
        return draw

    return register


def draw_all(run: "Run", folder: Path) -> list[Path]:
    """Draw all figures of a run into a folder."""
    return save_all(FIGURES, run, folder)


def save_all(figures: Mapping[str, Callable[[T], Figure]], subject: T, folder: Path) -> list[Path]:
    """Draw figures of something, each under its name, and return their files."""
    folder.mkdir(exist_ok=True)
    files = []
    with rc_context(STYLE):
        for name, draw in figures.items():
            files.append(folder / f"{name}.png")
            with whole(files[-1]) as part:
                draw(subject).savefig(part, format="png")
    return files


import_all(__name__)
