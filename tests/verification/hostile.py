"""Hostile but valid cases, and how each ends: within the limit of its energy error, or by a guard that says why."""

import math
import multiprocessing
import random
import time as clock
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from typing import Any, NamedTuple

import numba
import numpy as np

import viscopoint as vp
from viscopoint.model.build import build
from viscopoint.model.callbacks import OnRows
from viscopoint.model.simulation import Simulation

DENSITY, SHEAR, SHEAR_LONG = 1.0, 145.0, 5.0  # g/cm^3, MPa: about those of the paper
TRANSITS = 4.0  # of sound along the rod: the wave comes back twice
LONGEST = 1200.0  # s; a case that takes longer hangs
MOMENTUM = 1e-12  # of what the rod brought: rounding over some ten thousand steps
FINISHED, STOPPED, FAILED = "finished", "stopped", "failed"


class Kind(NamedTuple):
    """A method with its choices, sized by cells per radius."""

    table: Mapping[str, Any]
    sizes: Mapping[str, float]  # of [method], in cells
    fewest: float = 1.0  # cells per radius that it takes

    @property
    def flat(self) -> bool:
        """Whether it has but a meridian to fill."""
        return "geometry" in self.table


POINTS = {"cell": 1.0, "spacing": 0.5}
FLAT = {"geometry": "axisymmetric"}
LATTICE = {"name": "mpm", "fill": "lattice", "contact": "nodes"}  # the paper's
KINDS = {
    "mpm": Kind({**LATTICE, "shape": "trilinear"}, POINTS),
    "mpm, gimp, apic": Kind({**LATTICE, "shape": "gimp", "transfer": "apic"}, POINTS),
    "mpm, axisymmetric": Kind({**LATTICE, "shape": "trilinear", **FLAT}, POINTS),
    "tlmpm": Kind({"name": "tlmpm"}, POINTS, 1.4),
    "tlmpm, axisymmetric": Kind({"name": "tlmpm", **FLAT}, POINTS),
    "fem": Kind({"name": "fem"}, {"size": 1.0}),
    "fem, selective": Kind({"name": "fem", "element": "selective"}, {"size": 1.0}),
    "fem, axisymmetric": Kind({"name": "fem", **FLAT}, {"size": 1.0}),
}


class Hostile(NamedTuple):
    """One case of the matrix."""

    kind: str
    speed: float = 150.0  # m/s
    ratio: float = 4.0  # K/G at once
    decay: float = 650.0  # 1/ms
    friction: float = 0.0
    radius: float = 3.8  # mm
    flight: float = 0.0  # before the impact, in transits of sound
    cells: float = 3.0  # per radius
    slender: float = 3.0  # length over radius
    rows: float = 0.0  # between lines of history, in transits of sound; 0: every step

    def case(self) -> vp.Case:
        """Return the case."""
        kind, length, bulk = KINDS[self.kind], self.slender * self.radius, self.ratio * SHEAR
        cell = self.radius / max(self.cells, kind.fewest)
        transit = length / math.sqrt((bulk + 4.0 / 3.0 * SHEAR) / (DENSITY * 1e-3))  # ms
        return vp.Case.from_tables({
            "rod": {"radius": f"{self.radius!r} mm", "length": f"{length!r} mm"},
            "impact": {
                "speed": f"{self.speed!r} m/s", "gap": f"{self.flight * transit * self.speed!r} mm",
                "friction": self.friction,
            },
            "material": {
                "law": "linear-viscoelastic", "density": f"{DENSITY} g/cm^3", "bulk": f"{bulk!r} MPa",
                "shear_short": f"{SHEAR - SHEAR_LONG} MPa", "shear_long": f"{SHEAR_LONG} MPa",
                "decay": f"{self.decay!r} 1/ms",
            },
            "method": {**kind.table, **{key: f"{size * cell!r} mm" for key, size in kind.sizes.items()}},
            "time": {"end": f"{(self.flight + TRANSITS) * transit!r} ms"},
            "output": {"history": {"every": f"{self.rows * transit!r} ms" if self.rows else 1}},
        })  # fmt: skip


class End(NamedTuple):
    """How a case ended."""

    how: str  # FINISHED, STOPPED, or FAILED, which must not be
    why: str = ""
    share: float = 0.0  # of the time that it was to take
    steps: int = 0
    seconds: float = 0.0
    energy: float = 0.0  # worst numerical remainder, share of the energy brought
    momentum: float = 0.0  # worst error, share of the momentum brought


class EndlessError(Exception):
    """A case takes too long."""


def end_of(hostile: Hostile) -> End:
    """Run a case and judge how it ended."""
    began, seen = clock.perf_counter(), [0.0]

    class Watch(OnRows):
        def __call__(self, simulation: Simulation) -> None:
            seen[0] = simulation.share
            if clock.perf_counter() - began > LONGEST:
                raise EndlessError

    try:
        model = build(hostile.case())
        simulation = Simulation(model, [Watch()])
        outcome = simulation.run()
    except Exception as error:  # whatever it is, it is a finding
        return End(FAILED, repr(error), seen[0])
    brought = float(np.linalg.norm(simulation.balances[0].start.momentum))
    energy, momentum = outcome.energy_error, outcome.momentum_error / brought
    seconds = clock.perf_counter() - began
    if outcome.status == "complete":
        fault = _fault(model.method.snapshot(), energy, momentum, model.case.guards.energy_error)
        return End(FAILED if fault else FINISHED, fault, 1.0, outcome.steps, seconds, energy, momentum)
    named = "Likely cause: " in outcome.reason and momentum <= MOMENTUM
    return End(STOPPED if named else FAILED, outcome.reason, seen[0], outcome.steps, seconds, energy, momentum)


def _fault(fields: Mapping[str, Any], energy: float, momentum: float, limit: float) -> str:
    """Return what is wrong with a run that says it is complete."""
    wrong = [name for name, field in fields.items() if not np.isfinite(field.values).all()]
    if wrong:
        return f"not finite: {', '.join(wrong)}"
    if not energy <= limit:
        return f"energy off by {energy:.1e}"
    return "" if momentum <= MOMENTUM else f"momentum off by {momentum:.1e}"


def ends_of(cases: Sequence[Hostile], processes: int) -> dict[Hostile, End]:
    """Run cases side by side, each on one thread."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, mp_context=context, initializer=numba.set_num_threads, initargs=(1,)) as pool:
        return dict(zip(cases, pool.map(end_of, cases, chunksize=4), strict=True))


SPEEDS, RATIOS, DECAYS = (1.0, 150.0, 1500.0), (1.0, 100.0, 1e4), (0.0, 650.0, 1e9)  # m/s, 1, 1/ms
FRICTIONS, RADII, FLIGHTS = (0.0, 1.0), (1e-3, 3.8, 1e6), (0.0, 0.5)  # 1, mm, transits
COARSE_TO_FINE, FINEST = (1.0, 2.0, 10.0), 50.0  # cells per radius
FINEST_SOLID = ((1.0, 1.0, 1e9), (150.0, 100.0, 650.0), (1500.0, 1e4, 0.0))  # speed, ratio, decay: costly ones
SHAPES = ((0.2, 10.0), (20.0, 2.0))  # discs and needles: length over radius, cells per radius


def violent(kind: str) -> Iterator[Hostile]:
    """Yield all settings of speed, moduli, relaxation, friction, size and flight of a method, at few cells."""
    for setting in product(SPEEDS, RATIOS, DECAYS, FRICTIONS, RADII, FLIGHTS):
        yield Hostile(kind, *setting)


def sized(kind: str) -> Iterator[Hostile]:
    """Yield cases of few to many cells per radius, and of discs and needles."""
    extremes = [*product(SPEEDS, (1.0, 1e4), (0.0, 1e9))]
    for cells, setting in product(COARSE_TO_FINE, extremes):
        yield Hostile(kind, *setting, cells=cells, slender=1.0 if cells > 2.0 else 3.0)
    for setting in extremes if KINDS[kind].flat else FINEST_SOLID:
        yield Hostile(kind, *setting, cells=FINEST, slender=0.2)
    for (slender, cells), speed in product(SHAPES, SPEEDS):
        yield Hostile(kind, speed, cells=cells, slender=slender)


def matrix() -> list[Hostile]:
    """Return all hostile cases."""
    return [case for kind in KINDS for case in (*violent(kind), *sized(kind))]


def sample(each: int) -> list[Hostile]:
    """Return some violent cases of each method, the same ones every time."""
    return [case for kind in KINDS for case in random.Random(kind).sample([*violent(kind)], each)]
