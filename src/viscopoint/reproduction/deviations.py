"""Where the paper's material point method differs from finite elements, and from which cause.

Each cause is switched off alone, everything else left as in the paper; then three cures are taken together.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from viscopoint.case.case import Case
from viscopoint.comparison import compare
from viscopoint.comparison.axis import axial_velocity
from viscopoint.reproduction.cases import WIDE, paper_case
from viscopoint.results.reader import Snapshot
from viscopoint.results.run import Run

MATERIALS = {"β = 650 1/ms": "650", "elastic": "elastic-650"}  # the widest foot; waves that nothing damps
FEM, AS_PAPER, TOGETHER = "FEM itself", "as in the paper", "boxes, rings, one dilatation"
MORE = "with more of early contact"
ALL = ("crossing", "steps", "locking")  # switched off together; boxes cure what more points in a cell cure


def _floor(gap: float) -> dict[str, Any]:
    """Return the change of a case that lets the paper's grid begin at a wall ``gap`` [mm] below the rod."""
    return {"method.box.z": [f"{0.0 - gap} mm", "26.5 mm"]}


class Cause(NamedTuple):
    """Something in the paper's method that makes an error, and what switches it off."""

    name: str
    mechanism: str  # how it makes an error, in a sentence or two
    switch: str  # in words
    changes: Mapping[str, Any]  # of the case
    shows: tuple[str, ...]  # the entries of ``Deviation`` that it is about
    physical: bool = False  # FEM is run with the changes too


CAUSES: dict[str, Cause] = {
    "points": Cause(
        "2.28 points in a cell",
        "Along an axis a cell holds one layer of points or two, so that its stiffness varies by a factor of two; in "
        "series that is too soft, and waves run too slowly.",
        "8 in a cell, 2 along each axis",
        {"method.spacing": "0.25 mm"},
        ("velocity", "impulse"),
    ),
    "crossing": Cause(
        "points that cross cells",
        "Trilinear slopes jump where cells meet, and with them the forces; bulk viscosity takes some of that noise. "
        "Boxes also fill cells evenly, as many points would.",
        "points as boxes (GIMP)",
        {"method.shape": "gimp"},
        ("noise", "velocity", "kinetic"),
    ),
    "steps": Cause(
        "the stair-stepped lattice",
        "It has 0.6 % too much area and 0.24 % too much length, and with that mass and kinetic energy.",
        "points on rings, of the cylinder's volume",
        {"method.fill": "rings"},
        ("impact_face_radius", "kinetic", "velocity"),
    ),
    "locking": Cause(
        "volumetric locking",
        "K / G∞ is 110 once the arm has relaxed: points that each resist their own change of volume hinder each other.",
        "one dilatation for each cell",
        {"method.volume": "cell-mean"},
        ("impact_face_radius", "velocity", "noise"),
    ),
    "contact": Cause(
        "early contact",
        "Nodes of the wall feel a point from a cell away. The paper's rod starts 0.01 mm above the wall, so that there "
        "is little to be early by; with a gap of a cell more, 0.51 mm, early contact adds impulse.",
        "no gap, for both methods",
        {"impact.gap": "0 mm", **_floor(0.0)},
        ("impulse",),
        physical=True,
    ),
}
FAR = CAUSES["contact"]._replace(switch="a gap of 0.51 mm, for both", changes={"impact.gap": "0.51 mm", **_floor(0.51)})


class Deviation(NamedTuple):
    """How far a variant of the paper's MPM is from FEM at 20 µs."""

    material: str
    variant: str  # the cause that is switched off
    switch: str
    impact_face_radius: float  # share of FEM's
    greatest_radius: float
    velocity: float  # share of the impact speed
    kinetic: float  # share of the initial kinetic energy
    impulse: float  # share of FEM's
    outline_distance: float  # mm
    axial_velocity: float  # root mean square along the axis, m/s
    noise: float  # of the pressure in the lowest diameter, MPa

    def to_table(self) -> dict[str, Any]:
        """Return the numbers by name."""
        return self._asdict()


def cases() -> Iterator[tuple[str, Case]]:
    """Yield name and case of the variants: "crossing-650", "all-elastic-650", "fem-contact-650" and so on."""
    together = {key: value for name in ALL for key, value in CAUSES[name].changes.items()}
    variants = CAUSES | {"far": FAR, "all": Cause("", "", "", together, ())}
    for name, cause in variants.items():
        for material in MATERIALS.values():
            for method in ("mpm", "fem") if cause.physical else ("mpm",):
                case = paper_case(method, "650", elastic=material.startswith("elastic"))
                own = {
                    key: value
                    for key, value in {**WIDE, **cause.changes}.items()
                    if method == "mpm" or "method" not in key
                }
                yield f"{_prefix(method)}{name}-{material}", case.with_(own)


def _prefix(method: str) -> str:
    return "" if method == "mpm" else f"{method}-"


def measured(runs: Mapping[str, Run], causes: Mapping[str, Run]) -> list[Deviation]:
    """Return how far the paper's MPM and each variant of it are from FEM."""
    found = []
    for label, material in MATERIALS.items():
        fem = runs[f"fem-{material}"]
        found.append(_deviation(label, FEM, "", fem, fem))
        found.append(_deviation(label, AS_PAPER, "", fem, runs[f"mpm-{material}"]))
        for name, cause in (CAUSES | {"far": FAR}).items():
            twin = causes[f"fem-{name}-{material}"] if cause.physical else fem
            title = _without(cause) if name != "far" else MORE
            found.append(_deviation(label, title, cause.switch, twin, causes[f"{name}-{material}"]))
        found.append(_deviation(label, TOGETHER, "all three", fem, causes[f"all-{material}"]))
    return found


def _deviation(material: str, variant: str, switch: str, fem: Run, mpm: Run) -> Deviation:
    comparison = compare([fem, mpm], [fem.rows[-1].time], any_physics=True)  # the wall may be lower
    one, other = comparison.states[-1]
    speed, energy = fem.case.impact.speed, fem.results.initial_energy
    return Deviation(
        material, variant, switch,
        impact_face_radius=other.row.impact_face_radius / one.row.impact_face_radius - 1.0,
        greatest_radius=other.row.greatest_radius / one.row.greatest_radius - 1.0,
        velocity=(other.row.velocity - one.row.velocity) / speed,
        kinetic=(other.row.kinetic - one.row.kinetic) / energy,
        impulse=other.row.wall_impulse / one.row.wall_impulse - 1.0,
        outline_distance=other.apart.distance,
        axial_velocity=other.axial_velocity,
        noise=noise(mpm, mpm.snapshot(-1)),
    )  # fmt: skip


def noise(run: Run, snapshot: Snapshot) -> float:
    """Return the root mean square of what the pressure of a layer differs by from the mean of its neighbours [MPa].

    Along each column of points or elements in the lowest diameter of the rod: a smooth field has next to none, what
    changes its sign from layer to layer has all.
    """
    body, field = run.body, snapshot.fields["pressure"]
    on_cells = field.on == "cells"
    height = body.position[body.cells].mean(axis=1)[:, 2] if on_cells else body.position[:, 2]
    solid = np.ones(len(height), bool) if on_cells else body.volume > 0.0  # some points only watch
    layers = len(np.unique(np.round(height[solid], 6)))
    columns = field.values[solid].reshape(layers, -1)
    lowest = columns[: round(layers * 2.0 * run.case.rod.radius / run.case.rod.length) + 1]
    return float(np.sqrt(np.mean((lowest[1:-1] - 0.5 * (lowest[:-2] + lowest[2:])) ** 2)))


LEAD = (
    "The paper's method, as it stands, against finite elements on elements as wide as its points are apart. Each cause "
    "of difference is switched off alone, everything else left as it is, in the material with the widest foot and in "
    "the one whose waves nothing damps."
)
CAPTION = (
    "Axial velocity around the axis (within a quarter of the radius) of the elastic rod at 20 µs: finite elements in "
    "grey, the paper's material point method and its variants in red. Where the front of the wave lags, waves run too "
    "slowly; the jags are noise of points that cross cells."
)
NOTE = (
    "At 20 µs, differences from FEM: of lengths and impulse in per cent of FEM's, of velocity in per cent of the "
    "impact speed, of kinetic energy in per cent of what there was at the start. Noise: root mean square of what the "
    "pressure of a layer differs by from the mean of its neighbours above and below, in the lowest diameter of the rod."
)
HEAD = (
    "", "foot radius (%)", "greatest radius (%)", "velocity (%)", "kinetic energy (%)",
    "impulse (%)", "outline (mm)", "velocity around the axis (m/s)", "noise of pressure (MPa)",
)  # fmt: skip


WORDS = {
    "impact_face_radius": "foot radius", "velocity": "velocity", "kinetic": "kinetic energy", "impulse": "impulse",
    "noise": "noise of pressure",
}  # fmt: skip


def told(rows: Sequence[Deviation]) -> list[str]:
    """Return what each cause does, with its numbers, in sentences."""
    told = []
    for cause in CAUSES.values():
        switched = f"{cause.switch}: {_changes(rows, _without(cause), cause.shows)}"
        if cause is CAUSES["contact"]:
            switched += f"; with 0.51 mm: {_changes(rows, MORE, cause.shows)}"
        told.append(f"{cause.name[0].upper()}{cause.name[1:]}. {cause.mechanism} Switched off by {switched}.")
    return told


def _changes(rows: Sequence[Deviation], variant: str, names: Iterable[str]) -> str:
    """Return by how much entries differ from FEM's, as in the paper and in a variant, for each material."""

    def pair(name: str, material: str) -> str:
        ends = [
            next(row for row in rows if (row.material, row.variant) == (material, it)) for it in (AS_PAPER, variant)
        ]
        if name == "noise":
            return " → ".join(f"{end.noise:.0f}" for end in ends) + f" MPa ({material})"
        return " → ".join(f"{100.0 * getattr(end, name):+.1f}" for end in ends) + f" % ({material})"

    return "; ".join(f"{WORDS[name]} {', '.join(pair(name, material) for material in MATERIALS)}" for name in names)


def shown(rows: Iterable[Deviation]) -> tuple[tuple[str, ...], ...]:
    """Return the cells of the table under ``HEAD``, for the rows of one material."""
    return tuple(
        (
            f"{row.variant}: {row.switch}" if row.switch else row.variant,
            *(f"{100.0 * share:+.1f}" for share in row[3:8]),
            f"{row.outline_distance:.3f}",
            f"{row.axial_velocity:.1f}",
            f"{row.noise:.1f}",
        )
        for row in rows
    )


def figure(runs: Mapping[str, Run], causes: Mapping[str, Run]) -> Figure:
    """Draw the axial velocity around the axis of the elastic rod: FEM, and each variant of the paper's MPM."""
    material = MATERIALS["elastic"]
    variants = {AS_PAPER: runs[f"mpm-{material}"]}
    variants |= {_without(cause): causes[f"{name}-{material}"] for name, cause in CAUSES.items()}
    variants |= {TOGETHER: causes[f"all-{material}"]}
    figure = Figure(figsize=(7.0, 0.6 + 1.2 * len(variants)), layout="constrained")
    axes = figure.subplots(len(variants), 1, sharex=True, sharey=True)
    fem = runs[f"fem-{material}"]
    for axis, (title, run) in zip(axes, variants.items(), strict=True):
        axis.plot(*axial_velocity(fem, fem.snapshot(-1)), color="0.55", linewidth=1.2, label="FEM")
        axis.plot(*axial_velocity(run, run.snapshot(-1)), color="#d55e00", linewidth=1.2, label="MPM")
        axis.set_title(title, loc="right", fontsize=9, y=0.72)
        axis.set_ylabel("$v_z$ (m/s)")
    axes[-1].set_xlabel("z (mm)")
    axes[0].legend(ncols=2, loc="upper right", bbox_to_anchor=(1.0, 0.75))
    return figure


def _without(cause: Cause) -> str:
    return f"without {cause.name}"
