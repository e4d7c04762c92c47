"""A comparison as tables for the terminal."""

import math
from collections.abc import Iterator

from rich.markup import escape
from rich.table import Table

from viscopoint.comparison import Comparison, State

ROWS = {  # quantity: what is printed, unit, decimals, what a difference is a share of
    "length": ("length", "mm", 3, "itself"),
    "contact_radius": ("contact radius", "mm", 3, "itself"),
    "impact_face_radius": ("radius of the impact face", "mm", 3, "itself"),
    "greatest_radius": ("greatest radius", "mm", 3, "itself"),
    "velocity": ("velocity of centre of mass", "m/s", 2, "speed"),
    "wall_impulse": ("wall impulse", "N ms", 2, "itself"),
    "kinetic": ("kinetic energy", "mJ", 1, "energy"),
    "stored": ("stored energy", "mJ", 1, "energy"),
    "dissipated": ("dissipated by the law", "mJ", 1, "energy"),
    "hypoelastic": ("hypoelastic (law)", "mJ", 1, "energy"),
    "viscous": ("bulk viscosity", "mJ", 1, "energy"),
    "hourglass": ("hourglass control", "mJ", 1, "energy"),
    "eroded": ("in deleted elements", "mJ", 1, "energy"),
    "contact": ("taken at the wall", "mJ", 1, "energy"),
    "friction": ("friction", "mJ", 1, "energy"),
    "numerical": ("energy error", "mJ", 1, "energy"),
}
PAD, LEAST = 2, 12  # between columns; of a name, before it is folded
SELDOM = ("hourglass", "eroded", "friction")  # left out where they are zero
NOTE = (
    "In brackets the difference from the first run, per cent: of its value; for velocities of the impact speed; for "
    "energies of the initial kinetic energy. The wall force is a mean over 0.5 us; outlines are told apart by the area "
    "between them over that of the rod, and by the greatest distance; velocity along the axis by the root mean square. "
    "The contact radius is that of what is on the wall or, off it, lowest: known to a layer of elements or half a "
    "spacing of points."
)


Line = tuple[str, str, list[str]]  # quantity, unit and a cell for each run


def tables(comparison: Comparison, width: int = 120) -> Iterator[Table]:
    """Yield for each time a table with a column for each run; several, each with the first run, if one is too wide."""
    for time, states in zip(comparison.times, comparison.states, strict=True):
        lines = list(_lines(comparison, states))
        widths = [
            max(min(len(name), LEAST), *(len(cells[run]) for *_, cells in lines))
            for run, name in enumerate(comparison.names)
        ]
        groups = list(_groups([max(len(line[column]) for line in lines) for column in (0, 1)], widths, width))
        for number, group in enumerate(groups, 1):
            part = f"\n{number} of {len(groups)}" if len(groups) > 1 else ""
            table = Table(f"{time * 1e3:g} us{part}", "", box=None)
            for run in group:
                table.add_column(escape(comparison.names[run]), justify="right", overflow="fold", width=widths[run])
            for quantity, unit, cells in lines:
                table.add_row(quantity, unit, *(cells[run] for run in group))
            table.add_row()
            yield table


def _groups(labels: list[int], widths: list[int], most: int) -> Iterator[list[int]]:
    """Yield the numbers of the runs of each table: the first one, and as many others as fit in beside the labels."""
    start = sum(PAD + width for width in (*labels, widths[0]))
    group, used = [0], start
    for run, width in enumerate(widths[1:], 1):
        if len(group) > 1 and used + PAD + width > most:
            yield group
            group, used = [0], start
        group.append(run)
        used += PAD + width
    yield group


def _lines(comparison: Comparison, states: tuple[State, ...]) -> Iterator[Line]:
    reference, others = comparison.runs[0], states[1:]
    bases: dict[str, float] = {"speed": reference.case.impact.speed, "energy": reference.results.initial_energy}
    for name, (words, unit, digits, base) in ROWS.items():
        values = [getattr(state.row, name) for state in states]
        if name not in SELDOM or any(values):
            yield words, unit, _cells(values, digits, bases[base] if base in bases else values[0])
    forces = [state.wall_force for state in states]
    yield "wall force", "N", _cells(forces, 1, forces[0])
    yield "outline, area between", "%", ["", *(_known(100.0 * state.apart.area, 2) for state in others)]
    yield "outline, distance", "mm", ["", *(_known(state.apart.distance, 3) for state in others)]
    yield "velocity along the axis", "m/s", ["", *(_known(state.axial_velocity, 2) for state in others)]


def _cells(values: list[float], digits: int, base: float) -> list[str]:
    """Return the first value, and the others with their difference from it in per cent of a base; a dash: not known."""
    first, *others = values

    def share(value: float) -> str:
        part = 100.0 * (value - first) / abs(base) if base else math.nan
        return f" ({part:+.2f})" if math.isfinite(part) else ""

    shown = [_known(value, digits) for value in values]
    return [shown[0], *(words + share(value) for words, value in zip(shown[1:], others, strict=True))]


def _known(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"
