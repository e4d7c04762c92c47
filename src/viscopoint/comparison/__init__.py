"""Compares runs of the same impact: MPM or FEM, at any resolutions, with numbers."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from viscopoint.arguments import checked
from viscopoint.case.description import description
from viscopoint.comparison import axis, outline
from viscopoint.comparison.outline import Apart
from viscopoint.errors import InputError
from viscopoint.messages import one_line
from viscopoint.model.body import in_half_plane
from viscopoint.model.energy_balance import UNITS, Row
from viscopoint.results.folder import FIGURES, SUMMARY, create, disk_faults, write_json
from viscopoint.results.reader import NEAR
from viscopoint.results.run import Run

PHYSICS = ("rod", "impact", "material")  # tables of a case that say what happens; the others say how it is computed
WINDOW = 0.5e-3  # ms over which the wall force is averaged: on a grid it comes in blows
NAME = "comparison.json"
ROUNDING = 1e-12  # relative: numbers of two cases that differ by less are the same
MEASURED = (
    "length", "contact_radius", "impact_face_radius", "greatest_radius", "velocity", "wall_impulse",
    "kinetic", "stored", "dissipated", "hypoelastic", "viscous", "hourglass", "eroded", "contact", "friction",
    "numerical",
)  # fmt: skip


class State(NamedTuple):
    """What is compared of a run at one time."""

    row: Row
    wall_force: float  # mean over the last ``WINDOW``, N
    apart: Apart  # its outline from that of the first run
    axial_velocity: float  # root mean square difference from the first run along the axis, m/s


@dataclass(frozen=True)
class Comparison:
    """Runs, the times at which all have a snapshot, and their states there; the first run is the reference."""

    runs: tuple[Run, ...]
    names: tuple[str, ...]
    times: tuple[float, ...]  # ms
    states: tuple[tuple[State, ...], ...]  # [time][run]
    physics: tuple[str, ...]  # keys of the case that differ, if that was allowed

    def warnings(self) -> list[str]:
        """Return what makes the numbers less comparable than they look."""
        told = [f"INCOMPLETE: {_place(run)} ({run.results.reason})" for run in self.runs if not run.results.is_complete]
        told += [f"WARNING: {_place(run)}: {text}" for run in self.runs for text in run.results.warnings]
        if len({run.provenance.get("sources") for run in self.runs}) > 1:
            made = ", ".join(f"{_place(run)} by {run.provenance.get('commit') or 'another'}" for run in self.runs)
            told.append(f"NOTE: made by different versions of viscopoint: {made}")
        if self.physics:
            told.append(f"NOTE: of different physics: {', '.join(self.physics)}")
        return told

    def to_tables(self) -> dict[str, Any]:
        """Return all numbers under names, as ``comparison.json`` holds them; null: not a number."""
        units = {name: UNITS[name] for name in MEASURED}
        extra = {"wall_force": "N", "outline_area": "1", "outline_distance": "mm", "axial_velocity": "m/s"}
        return {
            "format": 1,
            "reference": self.names[0],
            "different_physics": list(self.physics),
            "runs": [_described(name, run) for name, run in zip(self.names, self.runs, strict=True)],
            "units": units | extra,
            "snapshots": [
                {
                    "time [ms]": time,
                    "runs": {name: _numbers(state) for name, state in zip(self.names, states, strict=True)},
                }
                for time, states in zip(self.times, self.states, strict=True)
            ],
        }


@checked
def compare(
    runs: Sequence[Run | str | Path], times: Sequence[float] | None = None, *, any_physics: bool = False
) -> Comparison:
    """Compare runs at the snapshots that all of them have, the first being the reference.

    Args:
        runs: two or more run folders.
        times: compare at these of them alone [ms].
        any_physics: compare also runs of different rods, impacts or materials.

    Raises:
        InputError: a folder holds no run, or one that is still going on; there is no snapshot in common after the
            start, or at the ``times`` asked for; the cases differ in what happens, and not only in how it is computed.
    """
    opened = tuple(run if isinstance(run, Run) else Run(run) for run in runs)
    if len(opened) < 2:
        raise InputError("comparing takes two runs or more")
    for run in opened:
        if run.status == "running":
            raise InputError(f"{run.place}: not finished: still running, or killed")
    different = sorted({key for run in opened[1:] for key in differing(opened[0], run)})
    if different and not any_physics:
        raise InputError(_told(opened, different))
    common = _common_times(opened)
    chosen = common if times is None else tuple(time for time in common if _is_among(time, times))
    if not chosen:
        raise InputError(f"no snapshot in common at {_in_words(times or ())}; there are {_in_words(common)}")
    reference = opened[0]
    area = reference.case.rod.radius * reference.case.rod.length
    states = tuple(_states(opened, time, area) for time in chosen)
    return Comparison(opened, _names(opened), chosen, states, tuple(different))


@checked
def write(comparison: Comparison, folder: Path, *, force: bool = False, figures: bool = True) -> None:
    """Leave ``comparison.json`` and the figures in a new folder.

    Raises:
        InputError: the folder is there already and may not be replaced, or cannot be made.
        OutputError: the disk is full or gone.
    """
    create(folder, force, NAME, (run.folder / SUMMARY for run in comparison.runs))
    with disk_faults(folder):
        write_json(folder / NAME, comparison.to_tables())
        if figures:
            from viscopoint.comparison.figures import draw_all

            draw_all(comparison, folder / FIGURES)


def differing(one: Run, other: Run) -> list[str]:
    """Return the keys of two cases' physics whose values differ by more than rounding."""
    first, second = (
        {f"{table}.{key}": value for table in PHYSICS for key, value in getattr(case, table)}
        for case in (one.case, other.case)
    )
    return sorted(key for key in first | second if not _is_same(first.get(key), second.get(key)))


def _is_same(one: Any, other: Any) -> bool:
    numbers = isinstance(one, float) and isinstance(other, float)
    return math.isclose(one, other, rel_tol=ROUNDING) if numbers else one == other


def wall_force(run: Run, time: float) -> float:
    """Return the wall force at a time [ms], averaged over the ``WINDOW`` before it [N]."""
    history, window = run.history, min(WINDOW, time)
    return float(np.diff(np.interp([time - window, time], history["time"], history["wall_impulse"]))[0]) / window


def _states(runs: Sequence[Run], time: float, area: float) -> tuple[State, ...]:
    text = f"{time!r} ms"
    snapshots = [run.snapshot(text) for run in runs]
    outlines = [outline.whole(run, snapshot) for run, snapshot in zip(runs, snapshots, strict=True)]
    speeds = [axis.whole(run, snapshot) for run, snapshot in zip(runs, snapshots, strict=True)]
    return tuple(
        State(
            row=min(run.rows, key=lambda row: abs(row.time - time)),
            wall_force=wall_force(run, time),
            apart=outline.apart(outlines[0], other, area),
            axial_velocity=axis.apart(speeds[0], speed),
        )
        for run, other, speed in zip(runs, outlines, speeds, strict=True)
    )


def _common_times(runs: Sequence[Run]) -> tuple[float, ...]:
    """Return the times after the start at which every run has a snapshot and a row of results."""
    rows = [[row.time for row in run.rows] for run in runs]
    fields = [run.times for run in runs]
    common = [time for time in rows[0] if time > 0.0 and all(_is_among(time, times) for times in (*rows, *fields))]
    if not common:
        told = "; ".join(f"{run.folder} has {_in_words(run.times)}" for run in runs)
        raise InputError(f"no snapshot in common after the start: {told}")
    return tuple(common)


def _is_among(time: float, times: Iterable[float]) -> bool:
    return any(abs(time - there) <= NEAR * time for there in times)


def _names(runs: Sequence[Run]) -> tuple[str, ...]:
    """Return the folders' names, with as many parent folders as tell them apart; of one folder twice, numbered."""
    places = [run.folder.resolve() for run in runs]
    names = [one_line(str(place)) for place in places]
    for depth in range(1, max(len(place.parts) for place in places) + 1):
        names = [one_line("/".join(place.parts[-depth:])) for place in places]
        if len(set(names)) == len(set(places)):
            break
    twice = {name for name in names if names.count(name) > 1}
    return tuple(f"{name} ({number})" if name in twice else name for number, name in enumerate(names, 1))


def _told(runs: Sequence[Run], different: list[str]) -> str:
    tables = [run.case.to_tables() for run in runs]
    lines = []
    for key in different:
        table, _, name = key.partition(".")
        lines.append(f"  {key}: " + ", ".join(str(values[table].get(name, "none")) for values in tables))
    folders = ", ".join(str(run.folder) for run in runs)
    head = f"{folders}: these runs are of different physics; --any-physics compares them all the same"
    return "\n".join([head, *lines])


def _described(name: str, run: Run) -> dict[str, Any]:
    case, results = run.case, run.results
    return {
        "name": name,
        "folder": _place(run),
        "title": case.title,
        "case": description(case),
        "method": case.method.name,
        "axisymmetric": in_half_plane(run.body),
        "resolution [mm]": case.method.resolution() or None,  # that of a mesh file is not known
        "points": results.points,
        "elements": results.elements,
        "mass [g]": results.mass if math.isfinite(results.mass) else None,
        "mass_error [%]": results.mass_error if math.isfinite(results.mass) else None,
        "status": run.status,
        "reason": results.reason,
        "viscopoint": run.provenance.get("viscopoint"),
        "commit": run.provenance.get("commit"),
        "sources": run.provenance.get("sources"),
    }


def _place(run: Run) -> str:
    """Return a run's folder as it may be shown: its name may hold what is no letter."""
    return one_line(str(run.folder))


def _numbers(state: State) -> dict[str, float | None]:
    values = {name: float(getattr(state.row, name)) for name in MEASURED} | {
        "wall_force": state.wall_force,
        "outline_area": state.apart.area,
        "outline_distance": state.apart.distance,
        "axial_velocity": state.axial_velocity,
    }
    return {name: value if math.isfinite(value) else None for name, value in values.items()}


def _in_words(times: Iterable[float]) -> str:
    return ", ".join(f"{time * 1e3:g}" for time in times) + " us"
