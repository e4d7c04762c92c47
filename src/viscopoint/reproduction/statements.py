"""What the paper says of its figures, each statement as a check with its number.

"Visible" and "alike" shapes are taken at the resolution of the paper's own method, one cell of its grid; a visible
change of speed is a tenth of the impact speed, about one of the colours of a contour plot.
"""

import itertools
from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

import numpy as np

from viscopoint.comparison import outline
from viscopoint.comparison.axis import layer_velocity
from viscopoint.kernels.arrays import Array
from viscopoint.reproduction.cases import DECAYS
from viscopoint.results.run import Run

CELL = 0.5  # mm, of the paper's grid
AT_SPEED = 0.1  # of the impact speed: material that differs by less from it still falls at it
TIMES = ("5 us", "10 us", "20 us")

Runs = Mapping[str, Run]


class Finding(NamedTuple):
    """Whether a statement holds, and by what number."""

    seen: bool
    measured: str


class Statement(NamedTuple):
    """One thing that the paper says must be seen in a figure."""

    figure: str
    words: str
    needs: tuple[str, ...]  # names of runs
    check: Callable[[Runs], Finding]


STATEMENTS: list[Statement] = []
_Check = Callable[[Runs], Finding]


def states(figure: str, words: str, needs: Iterable[str]) -> Callable[[_Check], _Check]:
    """Let the decorated check stand for a statement on a figure."""

    def register(check: _Check) -> _Check:
        STATEMENTS.append(Statement(figure, words, tuple(needs), check))
        return check

    return register


def _each(*methods: str) -> tuple[str, ...]:
    return tuple(f"{method}-{decay}" for method in methods for decay in DECAYS)


@states("fig2", "the FEM mesh follows the circumference", ["fem-650"])
def mesh_is_round(runs: Runs) -> Finding:
    radii, radius = _rim(runs["fem-650"]), runs["fem-650"].case.rod.radius
    off, outside = float(np.ptp(radii)), float(radii.mean()) / radius - 1.0
    told = f"its outer nodes stand on one circle within {off:.0e} mm, {100.0 * outside:.2f} % outside that of 3.8 mm"
    return Finding(off < 1e-9 and 0.0 <= outside < 0.002, f"{told}, whose area the polygon between them has")


@states("fig2", "the MPM points are stair-stepped", ["mpm-650"])
def lattice_is_stepped(runs: Runs) -> Finding:
    run = runs["mpm-650"]
    radii, spacing = _rim(run), float(np.cbrt(run.body.volume[0]))
    depth = float(np.ptp(radii))
    told = f"the outermost points stand {radii.min():.2f} to {radii.max():.2f} mm from the axis, {depth / spacing:.1f} "
    return Finding(depth > 0.5 * spacing, told + "spacings apart; more than half a spacing is a step")


@states("fig3", "FEM: a mushroom at the foot at 5, 10 and 20 µs", ["fem-650"])
def mushroom_in_elements(runs: Runs) -> Finding:
    return _mushroom(runs["fem-650"])


@states("fig4", "MPM: a mushroom at the foot at 5, 10 and 20 µs", ["mpm-650"])
def mushroom_in_points(runs: Runs) -> Finding:
    return _mushroom(runs["mpm-650"])


@states("fig4", "the same shapes as by FEM", ["fem-650", "mpm-650"])
def same_shapes(runs: Runs) -> Finding:
    far = [_distance(runs["fem-650"], runs["mpm-650"], time) for time in TIMES]
    return Finding(max(far) < CELL, f"outlines are at most {_listed(far, 2)} mm apart at 5, 10, 20 µs ({_a_cell()})")


@states("fig5", "β = 6.5: hardly any visible change", ["fem-6.5", "mpm-6.5"])
def little_change(runs: Runs) -> Finding:
    foot = _growth(runs, "6.5")
    bulge = [run.rows[-1].greatest_radius - run.case.rod.radius for run in runs.values()]
    told = f"the rod's widest place grows by {_listed(bulge, 2)} mm (FEM, MPM; {_a_cell()}), its foot by "
    return Finding(max(bulge) < CELL, told + f"{_listed(foot, 2)} mm")


@states("fig5", "clear growth at β = 65", ["fem-65", "mpm-65"])
def growth_at_65(runs: Runs) -> Finding:
    growth = _growth(runs, "65")
    return Finding(min(growth) > CELL, f"the foot grows by {_listed(growth, 2)} mm (FEM, MPM; {_a_cell()})")


@states("fig5", "and more at β = 650", ["fem-65", "mpm-65", "fem-650", "mpm-650"])
def growth_at_650(runs: Runs) -> Finding:
    less, more = _growth(runs, "65"), _growth(runs, "650")
    least = min(high - low for low, high in zip(less, more, strict=True))
    told = f"the foot grows by {_listed(more, 2)} mm (FEM, MPM), {least:.2f} mm or more beyond β = 65"
    return Finding(least > CELL, f"{told} ({_a_cell()})")


@states("fig5", "FEM and MPM alike", _each("fem", "mpm"))
def alike(runs: Runs) -> Finding:
    far = [_distance(runs[f"fem-{decay}"], runs[f"mpm-{decay}"], "20 us") for decay in DECAYS]
    told = f"outlines are at most {_listed(far, 2)} mm apart for β = 6.5, 65, 650"
    return Finding(max(far) < CELL, f"{told} ({_a_cell()})")


@states("fig6", "small β: an elastic wave runs up the rod", ["mpm-6.5"])
def wave_runs_up(runs: Runs) -> Finding:
    return _front(runs["mpm-6.5"])


@states("fig6", "large β: all but the foot still falls at the impact speed", ["mpm-6.5", "mpm-650"])
def most_still_falls(runs: Runs) -> Finding:
    length = runs["mpm-650"].case.rod.length
    slowed = [_slowed(runs[f"mpm-{decay}"], "20 us") for decay in ("6.5", "650")]
    small, large = (100.0 * (1.0 - foot / length) for foot in slowed)
    return Finding(
        large > 50.0 and large > small,
        f"{large:.0f} % of the rod's length still fall at the impact speed within a tenth at β = 650, {small:.0f} % "
        f"at β = 6.5 (a foot is less than half of the rod); the foot that has slowed is {slowed[1]:.1f} mm long",
    )


@states("fig7", "no mushroom", ["fem-elastic-650", "mpm-elastic-650"])
def no_mushroom(runs: Runs) -> Finding:
    growth = [run.rows[-1].impact_face_radius - run.case.rod.radius for run in runs.values()]
    narrower = [run.rows[-1].greatest_radius - run.rows[-1].impact_face_radius for run in runs.values()]
    told = f"the foot grows by {_listed(growth, 2)} mm (FEM, MPM; {_a_cell()}) and is not the widest place, which is "
    return Finding(max(growth) < CELL and min(narrower) > 0.0, told + f"{_listed(narrower, 2)} mm wider")


@states("fig7", "FEM: waves run up the rod", ["fem-elastic-650"])
def waves_in_elements(runs: Runs) -> Finding:
    return _front(runs["fem-elastic-650"])


@states("fig7", "MPM: waves run up the rod", ["mpm-elastic-650"])
def waves_in_points(runs: Runs) -> Finding:
    return _front(runs["mpm-elastic-650"])


@states("fig7", "FEM and MPM deform alike", ["fem-elastic-650", "mpm-elastic-650"])
def deform_alike(runs: Runs) -> Finding:
    far = _distance(runs["fem-elastic-650"], runs["mpm-elastic-650"], "20 us")
    return Finding(far < CELL, f"outlines are at most {far:.2f} mm apart ({_a_cell()})")


@states("fig7", "β has no effect", _each("fem-elastic", "mpm-elastic"))
def decay_has_no_effect(runs: Runs) -> Finding:
    def moved(method: str) -> float:
        places = [runs[f"{method}-elastic-{decay}"].snapshot("20 us")["position"] for decay in DECAYS]
        return max(float(np.abs(place - places[0]).max()) for place in places)

    far = [moved("fem"), moved("mpm")]
    where = "at the same places to the last bit" if max(far) == 0.0 else f"within {_listed(far, -1)} mm (FEM, MPM)"
    return Finding(max(far) < 1e-9, f"nodes and points of the three runs are {where}")


def _rim(run: Run) -> Array:
    """Return how far the surface's points stand from the axis at the start [mm]."""
    ring = run.body.surface.ring
    return np.hypot(*run.body.position[ring[ring >= 0], :2].T)


def _mushroom(run: Run) -> Finding:
    """The foot is the widest place of the rod, grows on, and is more than a tenth wider than the rod was."""
    rows = [min(run.rows, key=lambda row: abs(row.time - time)) for time in (5e-3, 10e-3, 20e-3)]
    feet = [row.impact_face_radius for row in rows]
    widest = all(row.impact_face_radius == row.greatest_radius for row in rows)
    grows = all(later > sooner for sooner, later in itertools.pairwise(feet))
    seen = widest and grows and feet[0] > 1.1 * run.case.rod.radius
    return Finding(
        seen, f"foot radius {_listed(feet, 2)} mm, {'the widest place' if widest else 'not the widest place'}"
    )


def _growth(runs: Runs, decay: str) -> list[float]:
    """Return by how much the foot's radius grew up to the end, by FEM and by MPM [mm]."""
    both = [runs[f"{method}-{decay}"] for method in ("fem", "mpm")]
    return [run.rows[-1].impact_face_radius - run.case.rod.radius for run in both]


def _distance(one: Run, other: Run, time: str) -> float:
    first, second = (outline.outline(run, run.snapshot(time)) for run in (one, other))
    return outline.apart(first, second, 1.0).distance


def _slowed(run: Run, time: str) -> float:
    """Return how much of the rod, by its first length from the foot up, has visibly changed its speed [mm]."""
    height, speed = layer_velocity(run, run.snapshot(time))
    lost = np.flatnonzero(np.abs(speed + run.case.impact.speed) > AT_SPEED * run.case.impact.speed)
    return float(height[lost[-1]]) if len(lost) else 0.0


def _front(run: Run) -> Finding:
    """The change of speed runs up at least as fast as the bar wave of the instantaneous moduli, the slowest."""
    material, times = run.case.material.build(), (10e-3, 15e-3, 20e-3)
    bulk, shear = material.bulk, 0.75 * (material.p_wave_modulus - material.bulk)
    bar = np.sqrt(9.0 * bulk * shear / (3.0 * bulk + shear) / material.density)
    fronts = [_slowed(run, f"{time} ms") for time in times]
    slowest = [float(bar) * time for time in times]
    seen = all(front >= least for front, least in zip(fronts, slowest, strict=True)) and fronts == sorted(fronts)
    told = (
        f"the front, where speed has changed by a tenth, stands {_listed(fronts, 1)} mm up the rod at 10, 15, 20 µs; "
    )
    return Finding(seen, told + f"a bar wave would have come to {_listed(slowest, 1)} mm")


def _listed(values: Iterable[float], digits: int) -> str:
    return ", ".join(f"{value:.{digits}f}" if digits >= 0 else f"{value:.0e}" for value in values)


def _a_cell() -> str:
    return f"a cell: {CELL} mm"
