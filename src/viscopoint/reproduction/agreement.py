"""How well MPM and FEM agree: the numbers that the paper has not."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from viscopoint.comparison import compare
from viscopoint.model.energy_balance import Row
from viscopoint.reproduction.cases import DECAYS
from viscopoint.results.run import Run

MATERIALS = {f"β = {decay} 1/ms": decay for decay in DECAYS} | {"elastic": f"elastic-{DECAYS[-1]}"}
TIMES = (5e-3, 10e-3, 20e-3)  # ms, the paper's


class Agreement(NamedTuple):
    """MPM beside FEM for one material at one time."""

    material: str
    time: float  # ms
    fem: Row
    mpm: Row
    speed: float  # of the impact, m/s
    outline_area: float  # between the outlines, over the rod's half section
    outline_distance: float  # greatest, mm
    axial_velocity: float  # root mean square difference along the axis, m/s

    def to_table(self) -> dict[str, Any]:
        """Return the numbers by name; units as in a run's summary."""
        both = {"fem": self.fem, "mpm": self.mpm}
        names = ("length", "impact_face_radius", "greatest_radius", "velocity", "kinetic", "wall_impulse")
        rows = {method: {name: getattr(row, name) for name in names} for method, row in both.items()}
        apart = (self.outline_area, self.outline_distance, self.axial_velocity)
        told = dict(zip(("outline_area", "outline_distance [mm]", "axial_velocity [m/s]"), apart, strict=True))
        return {"material": self.material, "time [ms]": self.time} | rows | told


def agreements(runs: Mapping[str, Run]) -> list[Agreement]:
    """Compare MPM with FEM for the four materials at the paper's times; ``runs`` by name."""
    found = []
    for material, name in MATERIALS.items():
        comparison = compare([runs[f"fem-{name}"], runs[f"mpm-{name}"]], TIMES)
        speed = comparison.runs[0].case.impact.speed
        for time, (fem, mpm) in zip(comparison.times, comparison.states, strict=True):
            found.append(
                Agreement(material, time, fem.row, mpm.row, speed, *mpm.apart, axial_velocity=mpm.axial_velocity)
            )
    return found


HEAD = (
    "material", "time (µs)", "length (mm)", "foot radius (mm)", "greatest radius (mm)",
    "velocity (m/s)", "outline, area (%)", "outline, distance (mm)",
)  # fmt: skip
NOTE = (
    "Each cell: FEM · MPM (difference, in per cent of the FEM value; of velocities, of the impact speed). Outlines: "
    "the area between them over the rod's half section, and their greatest distance."
)
LENGTHS = ("length", "impact_face_radius", "greatest_radius")


def both(rows: list[Agreement]) -> tuple[tuple[str, ...], ...]:
    """Return the cells of the table under ``HEAD``: FEM, MPM and the difference."""
    return tuple(
        (
            *_which(row),
            *(f"{_twins(row, name, 3)} ({_off(row, name)})" for name in LENGTHS),
            f"{_twins(row, 'velocity', 2)} ({_off(row, 'velocity')})",
            *_outlines(row),
        )
        for row in rows
    )


def differences(rows: list[Agreement]) -> tuple[tuple[str, ...], ...]:
    """Return the cells of the table under ``HEAD`` with the differences alone."""
    return tuple((*_which(row), *(_off(row, name) for name in (*LENGTHS, "velocity")), *_outlines(row)) for row in rows)


def _which(row: Agreement) -> tuple[str, str]:
    return row.material, f"{row.time * 1e3:g}"


def _twins(row: Agreement, name: str, digits: int) -> str:
    return f"{getattr(row.fem, name):.{digits}f}\u00a0·\u00a0{getattr(row.mpm, name):.{digits}f}"  # stay on one line


def _outlines(row: Agreement) -> tuple[str, str]:
    return f"{100.0 * row.outline_area:.2f}", f"{row.outline_distance:.3f}"


def _off(row: Agreement, name: str) -> str:
    fem, mpm = getattr(row.fem, name), getattr(row.mpm, name)
    return f"{100.0 * (mpm - fem) / (row.speed if name == 'velocity' else fem):+.1f}\u00a0%"
