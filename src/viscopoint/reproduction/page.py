"""The report: what was reproduced, as one page."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from viscopoint.report.page import Page, Paragraph, Picture, Section, Table, Verdict, View
from viscopoint.report.scene import scene_of
from viscopoint.reproduction import agreement, decoding, deviations
from viscopoint.reproduction.agreement import MATERIALS
from viscopoint.reproduction.figures import FIGURES
from viscopoint.results.run import Run

if TYPE_CHECKING:
    from viscopoint.reproduction import Reproduction

LEAD = (
    "S. J. Kim, Particle-based Numerical Modeling of Linear Viscoelastic Materials using MPM based on FEM for Taylor "
    "Impact Simulations (in Korean, 2018): a polyethylene rod, 3.8 mm in radius and 25.4 mm long, hits a rigid plane "
    "at 150 m/s. The paper compares a material point program with finite elements by eye. Here both are run again on "
    "its rod, lattice and grid; every statement that its figures make is checked, and the agreement has numbers."
)
TWINS = {"fem": "FEM", "mpm": "MPM"}


def page(made: "Reproduction") -> Page:
    """Return the report of a whole reproduction."""
    return Page(
        title="The Taylor impact of a viscoelastic rod, reproduced",
        lead=LEAD,
        sections=(
            _overview(made), _figures(made), _view(made), _agreement(made), _deviations(made), _decoding(made),
            _balances(made), _provenance(made),
        ),
    )  # fmt: skip


def _overview(made: "Reproduction") -> Section:
    seen = sum(found.seen for _, found in made.findings)
    verdicts = tuple(Verdict(f"{_name(said.figure)}: {said.words}", *found) for said, found in made.findings)
    where = {"paper": "its own resolution", "fine": "half its distances"}[made.resolution]
    told = f"{seen} of {len(verdicts)} statements of the paper are seen at {where}."
    return Section("What the paper says, and whether it is seen", (Paragraph(told), *verdicts))


def _figures(made: "Reproduction") -> Section:
    def pictures() -> Iterator[Picture]:
        for name, figure in FIGURES.items():
            verdicts = tuple(Verdict(said.words, *found) for said, found in made.findings if said.figure == name)
            yield Picture(made.figures[name], f"{_name(name)}. {figure.title}. {figure.caption}", verdicts)

    return Section("The figures", tuple(pictures()))


def _view(made: "Reproduction") -> Section:
    runs = made.runs["paper"]  # finer surfaces would make the page too large
    shown = {
        (material, words): runs[f"{method}-{name}"]
        for material, name in MATERIALS.items()
        for method, words in TWINS.items()
    }
    told = "Finite elements beside material points at the paper's resolution, from the start to the end of the runs."
    return Section("The rods in three dimensions", (Paragraph(told), View(scene_of(shown))))


def _agreement(made: "Reproduction") -> Section:
    def tables() -> Iterator[Table]:
        for resolution, rows in made.agreement.items():
            fem, mpm = (made.runs[resolution][f"{method}-650"] for method in TWINS)
            title = (
                f"{fem.results.elements:,} elements of {fem.case.method.resolution():g} mm, "
                f"{mpm.results.points:,} points {mpm.case.method.resolution():g} mm apart"
            )
            yield Table(title, agreement.HEAD, agreement.both(rows), agreement.NOTE)

    return Section("Agreement of MPM and FEM", tuple(tables()))


def _deviations(made: "Reproduction") -> Section:
    tables = tuple(
        Table(
            f"One cause switched off at a time: {material}",
            deviations.HEAD,
            deviations.shown([row for row in made.deviations if row.material == material]),
            deviations.NOTE,
        )
        for material in deviations.MATERIALS
    )
    words = tuple(Paragraph(text) for text in deviations.told(made.deviations))
    picture = Picture(made.figures["deviations"], deviations.CAPTION)
    title = "Where the paper's method differs, and why"
    return Section(title, (Paragraph(deviations.LEAD), *words, picture, *tables))


def _decoding(made: "Reproduction") -> Section:
    runs = made.runs["paper"]
    lattice = Table(
        "Points of a lattice centred on the axis, with points at half spacings inside the circle of 3.8 mm",
        ("spacing (mm)", *(f"{row.spacing:.2f}" for row in decoding.lattices())),
        (("points", *(f"{row.points:,}" for row in decoding.lattices())),),
        f"The paper has {decoding.POINTS:,} points: 316 in each of 67 layers, 0.38 mm apart; 2.28 in a cell of 0.5 mm.",
    )
    ours, printed = (decoding.spread(runs, prefix) for prefix in ("mpm", "printed"))
    units = Table(
        "Greatest radius at 20 µs (mm), trilinear MPM on the paper's lattice and grid",
        ("β", "6.5", "65", "650", "largest less smallest"),
        tuple(
            (unit, *(f"{radius:.2f}" for radius in radii), f"{np.ptp(radii):.2f}")
            for unit, radii in (("in 1/ms", ours), ("in 1/µs, as printed", printed))
        ),
    )
    return Section("How the paper's lattice and units are read", (
        lattice, Paragraph(decoding.UNITS), Picture(made.figures["units"], decoding.CAPTION), units,
    ))  # fmt: skip


def _balances(made: "Reproduction") -> Section:
    head = (
        "run", "kinetic (mJ)", "stored", "dissipated", "hypoelastic", "bulk viscosity", "hourglass", "at the wall",
        "energy error", "worst (%)", "momentum error (N ms)", "mass error (%)",
    )  # fmt: skip
    rows = tuple(_balance(f"{group}/{name}", run) for group, runs in made.runs.items() for name, run in runs.items())
    note = (
        "At 20 µs, in mJ. The energy error is what the initial kinetic energy exceeds the sum of the others by; the "
        "worst one of any step is given in per cent of that energy. The mass of the paper's lattice is 0.8 % above the "
        "rod's."
    )
    return Section("The energy balance of each run", (Table("Energy, momentum and mass", head, rows, note),))


def _balance(name: str, run: Run) -> tuple[str, ...]:
    row = run.rows[-1]
    losses = (row.dissipated, row.hypoelastic, row.viscous, row.hourglass, row.contact, row.numerical)
    results = run.results
    worst = (f"{results.energy_error:.2f}", f"{results.momentum_error:.0e}", f"{results.mass_error:+.2f}")
    return (name, *(f"{energy:.1f}" for energy in (row.kinetic, row.stored, *losses)), *worst)


def _provenance(made: "Reproduction") -> Section:
    facts = made.runs[made.resolution]["mpm-650"].provenance
    keys = ("viscopoint", "commit", "sources", "python", "numpy", "numba", "h5py", "system", "machine", "processor")
    rows = tuple((key, str(facts.get(key))) for key in keys)
    runs = tuple(
        (f"{group}/{name}", str(run.results.steps), f"{run.results.wall_time:.1f}", str(run.provenance.get("ended")))
        for group, inside in made.runs.items()
        for name, run in inside.items()
    )
    return Section("Provenance", (
        Table("Made with", ("what", "which"), rows),
        Table("Runs", ("run", "steps", "time of the steps (s)", "ended (UTC)"), runs),
    ))  # fmt: skip


def _name(figure: str) -> str:
    return f"Figure {figure.removeprefix('fig')}"
