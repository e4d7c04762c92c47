"""A comparison as tables for the terminal."""

from collections.abc import Iterator

from rich.markup import escape
from rich.table import Table

from viscopoint.comparison import Comparison

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
    "numerical": ("numerical remainder", "mJ", 1, "energy"),
}
SELDOM = ("hourglass", "eroded", "friction")  # left out where they are zero
NOTE = (
    "In brackets the difference from the first run, per cent: of its value; for velocities of the impact speed; for "
    "energies of the initial kinetic energy. The wall force is a mean over 0.5 us; outlines are told apart by the area "
    "between them over that of the rod, and by the greatest distance; velocity along the axis by the root mean square."
)


def tables(comparison: Comparison) -> Iterator[Table]:
    """Yield a table for each time, a column for each run."""
    reference = comparison.runs[0]
    bases: dict[str, float] = {"speed": reference.case.impact.speed, "energy": reference.results.initial_energy}
    for time, states in zip(comparison.times, comparison.states, strict=True):
        table = Table(f"{time * 1e3:g} us", "", *map(escape, comparison.names), box=None)
        for column in table.columns[2:]:
            column.justify = "right"
        for name, (words, unit, digits, base) in ROWS.items():
            values = [getattr(state.row, name) for state in states]
            if name in SELDOM and not any(values):
                continue
            table.add_row(words, unit, *_cells(values, digits, bases[base] if base in bases else values[0]))
        forces = [state.wall_force for state in states]
        others = states[1:]
        table.add_row("wall force", "N", *_cells(forces, 1, forces[0]))
        table.add_row("outline, area between", "%", "", *(f"{100.0 * state.apart.area:.2f}" for state in others))
        table.add_row("outline, distance", "mm", "", *(f"{state.apart.distance:.3f}" for state in others))
        table.add_row("velocity along the axis", "m/s", "", *(f"{state.axial_velocity:.2f}" for state in others))
        table.add_row()
        yield table


def _cells(values: list[float], digits: int, base: float) -> list[str]:
    """Return the first value, and the others with their difference from it in per cent of a base."""
    first, *others = values
    shares = (f" ({100.0 * (value - first) / abs(base):+.2f})" if base else "" for value in others)
    return [f"{first:.{digits}f}", *(f"{value:.{digits}f}{share}" for value, share in zip(others, shares, strict=True))]
