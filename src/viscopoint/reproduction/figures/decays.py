"""Rows of three rods at the end, one for each decay constant, and the colours that they share."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.colors import CenteredNorm

from viscopoint.kernels.arrays import Array
from viscopoint.reproduction.cases import DECAYS
from viscopoint.reproduction.figures.page import Page
from viscopoint.reproduction.figures.scene import outline
from viscopoint.reproduction.figures.solids import Paint, Part, colours, draw_rod, whole
from viscopoint.results.reader import Snapshot
from viscopoint.results.run import Run

END = "20 us"
TITLES = tuple(f"β = {decay} ms⁻¹" for decay in DECAYS)


def names(method: str) -> tuple[str, ...]:
    """Return the names of a method's runs."""
    return tuple(f"{method}-{decay}" for decay in DECAYS)


class Shot(NamedTuple):
    """A run and how it ends."""

    run: Run
    end: Snapshot


def shots(runs: Mapping[str, Run], names: Iterable[str]) -> list[Shot]:
    """Read the ends of runs."""
    return [Shot(runs[name], runs[name].snapshot(END)) for name in names]


def draw_row(page: Page, row: int, shown: Sequence[Shot], paint: Paint, part: Part = whole) -> None:
    """Draw rods side by side, with their undeformed outline."""
    for axis, (run, end) in zip(page.axes[row], shown, strict=True):
        draw_rod(axis, page.view, run, end, paint, part)
        outline(axis, page.view, run.case.rod)


def span(values: Callable[[Snapshot], Array], shown: Sequence[Shot]) -> tuple[float, float]:
    """Return the least and the greatest value; zero is always within."""
    there = np.concatenate([values(end)[end["lost"] == 0] for _, end in shown])
    return float(there.min(initial=0.0)), float(there.max(initial=0.0))


def axial_velocity(run: Run) -> Paint:
    """Colour by axial velocity, within the speed of impact: blue still falls, pale stands, red flies back up."""
    norm = CenteredNorm(0.0, run.case.impact.speed)
    return Paint("axial velocity (m/s)", lambda snapshot: snapshot["velocity"][:, 2], colours("coolwarm"), norm)


def beyond(paint: Paint, shown: Sequence[Shot]) -> Any:
    """Return at which ends of its bar a paint has values beyond."""
    least, greatest = span(paint.values, shown)
    below, above = least < float(paint.norm.vmin or 0.0), greatest > float(paint.norm.vmax or 0.0)
    return {(True, True): "both", (True, False): "min", (False, True): "max"}.get((below, above), "neither")
