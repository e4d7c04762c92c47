"""The figures of a comparison: outlines, velocity along the axis, histories and energies, the runs overlaid."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from viscopoint.case.description import physics
from viscopoint.comparison import WINDOW, Comparison
from viscopoint.comparison.axis import axial_velocity
from viscopoint.comparison.outline import outline
from viscopoint.figures import save_all
from viscopoint.results.run import Run

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")  # told apart by any eye
DASHES = ("-", "--", "-.", ":")
MOST = 4  # times in one figure
PANELS = (("length", "length (mm)"), ("greatest_radius", "greatest radius (mm)"), ("velocity", "velocity (m/s)"))
TERMS = (
    ("kinetic", "kinetic"),
    ("stored", "stored"),
    ("dissipated", "dissipated by the law"),
    ("contact", "at the wall"),
)


def draw_all(comparison: Comparison, folder: Path) -> list[Path]:
    """Draw all figures into a folder and return their files."""
    caption = "" if comparison.physics else physics(comparison.runs[0].case)
    return save_all(FIGURES, comparison, folder, caption)


def outlines(comparison: Comparison) -> Figure:
    """Draw the half sections to scale, mirrored at the axis, one panel for each time."""
    times = _chosen(comparison.times)
    figure = Figure(figsize=(1.0 + 2.2 * len(times), 5.6), layout="constrained")
    axes = figure.subplots(1, len(times), sharex=True, sharey=True, squeeze=False)[0]
    for axis, time in zip(axes, times, strict=True):
        for style, name, run in _styled(comparison):
            radius, height = outline(run, run.snapshot(f"{time!r} ms")).T
            axis.plot(np.r_[radius, -radius[::-1]], np.r_[height, height[::-1]], label=name, **style)
        axis.axhline(-comparison.runs[0].case.impact.gap, color="0.3", linewidth=1.0)
        axis.set(title=f"{time * 1e3:g} µs", xlabel="r (mm)", aspect="equal")
    axes[0].set_ylabel("z (mm)")
    return _with_legend(figure, axes[0])


def along_the_axis(comparison: Comparison) -> Figure:
    """Draw the axial velocity beside the axis over height, one panel for each time."""
    times = _chosen(comparison.times)
    figure = Figure(figsize=(8.0, 1.0 + 1.5 * len(times)), layout="constrained")
    axes = figure.subplots(len(times), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for axis, time in zip(axes, times, strict=True):
        for style, name, run in _styled(comparison):
            axis.plot(*axial_velocity(run, run.snapshot(f"{time!r} ms")), label=name, **style)
        axis.set_ylabel(f"{time * 1e3:g} µs\n$v_z$ (m/s)")
    axes[-1].set_xlabel("z (mm)")
    return _with_legend(figure, axes[0])


def histories(comparison: Comparison) -> Figure:
    """Draw length, radius, velocity and the wall force, averaged over a window, over time."""
    figure = Figure(figsize=(8.0, 5.8), layout="constrained")
    axes = figure.subplots(2, 2, sharex=True).ravel()
    for style, name, run in _styled(comparison):
        time = run.history["time"].to_numpy()
        for axis, (column, _) in zip(axes, PANELS, strict=False):
            axis.plot(time * 1e3, run.history[column], label=name, **style)
        grid = np.arange(0.0, time[-1] + WINDOW / 2, WINDOW)
        impulse = np.interp(grid, time, run.history["wall_impulse"])
        axes[-1].stairs(np.diff(impulse) / WINDOW, grid * 1e3, baseline=None, label=name, **style)
    for axis, label in zip(axes, (*(label for _, label in PANELS), "wall force, mean over 0.5 µs (N)"), strict=True):
        axis.set_ylabel(label)
    for axis in axes[-2:]:
        axis.set_xlabel("time (µs)")
    return _with_legend(figure, axes[0])


def energies(comparison: Comparison) -> Figure:
    """Draw each term of the energy balance that any run has, in per cent of the initial kinetic energy."""
    runs = _styled(comparison)
    terms = [term for term in TERMS if any(bool((run.history[term[0]] != 0.0).any()) for _, _, run in runs)]
    rows = -(-len(terms) // 2)
    figure = Figure(figsize=(8.0, 0.6 + 2.0 * rows), layout="constrained")
    axes = figure.subplots(rows, 2, sharex=True, squeeze=False).ravel()
    for style, name, run in runs:
        initial = run.results.initial_energy
        for axis, (column, label) in zip(axes, terms, strict=False):
            axis.plot(run.history["time"] * 1e3, 100.0 * run.history[column] / initial, label=name, **style)
            axis.set_ylabel(f"{label} (%)")
    for axis in axes[len(terms) :]:
        axis.set_visible(False)
    for axis in axes[len(terms) - 2 : len(terms)]:
        axis.set_xlabel("time (µs)")
        axis.tick_params(labelbottom=True)
    return _with_legend(figure, axes[0])


FIGURES: dict[str, Callable[[Comparison], Figure]] = {
    "outlines": outlines,
    "axis": along_the_axis,
    "histories": histories,
    "energies": energies,
}


def _styled(comparison: Comparison) -> list[tuple[dict[str, Any], str, Run]]:
    styles = [
        {"color": COLOURS[n % len(COLOURS)], "linestyle": DASHES[n % len(DASHES)], "linewidth": 1.2}
        for n in range(len(comparison.runs))
    ]
    names = [_as_label(name) for name in comparison.names]
    return list(zip(styles, names, comparison.runs, strict=True))


def _as_label(name: str) -> str:
    """Return a folder's name as Matplotlib shows it: a dollar would begin a formula, a leading underscore hide it."""
    shown = name.replace("$", r"\$")
    return f" {shown}" if shown.startswith("_") else shown


def _chosen(times: tuple[float, ...]) -> list[float]:
    """Return up to ``MOST`` times, evenly spread, the first and the last among them."""
    last = len(times) - 1
    return [times[number] for number in sorted({round(last * share / (MOST - 1)) for share in range(MOST)})]


def _with_legend(figure: Figure, axis: Any) -> Figure:
    handles, labels = axis.get_legend_handles_labels()
    figure.legend(handles, labels, ncols=min(len(labels), 3), loc="outside upper center")
    return figure
