"""The material point method as the driver sees it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from viscopoint.interactions.planes import TALLY, RigidWall, Symmetry
from viscopoint.kernels.arrays import Array, Real, Rows
from viscopoint.materials import Law, step_factors
from viscopoint.methods.mpm.contact import touch, walls_around
from viscopoint.methods.mpm.contacts import Contact
from viscopoint.methods.mpm.contacts.nodes import Nodes
from viscopoint.methods.mpm.grid import CHUNKS, Box, Grid, around_points, forget, lattice
from viscopoint.methods.mpm.points import Points, at_rest
from viscopoint.methods.mpm.schemes import Scheme
from viscopoint.methods.mpm.shapes import Shape
from viscopoint.methods.mpm.stress import sum_points, update_points
from viscopoint.methods.mpm.transfers import Transfer
from viscopoint.methods.mpm.volumes import Volume
from viscopoint.methods.mpm.volumes.local import Local
from viscopoint.model.body import Body, half_height
from viscopoint.model.method import Advice, Field, Totals, history_fields, von_mises_of
from viscopoint.model.viscosity import BulkViscosity, signal_speed

CONSTANT = ("mass", "volume")  # of what points carry


@dataclass(frozen=True)
class Discretisation:
    """The choices that make an MPM."""

    cell: float  # mm
    box: Box
    shape: Shape  # of ``mpm.shapes``
    scheme: Scheme  # of ``mpm.schemes``
    transfer: Transfer  # of ``mpm.transfers``
    safety: float  # share of the critical step to take
    viscosity: BulkViscosity
    volume: type[Volume] = Local  # of ``mpm.volumes``
    contact: type[Contact] = Nodes  # of ``mpm.contacts``
    grid: type[Grid] = Grid  # of ``mpm.grid``
    real: Real = np.float64  # of the points' state


class MaterialPointMethod:
    """A body of material points on a background grid, moving at ``velocity`` [mm/ms] at the start."""

    def __init__(
        self,
        body: Body,
        law: Law,
        boundaries: tuple[RigidWall | Symmetry, ...],
        choices: Discretisation,
        velocity: tuple[float, float, float] | Array,
    ) -> None:
        self.body, self.law, self.boundaries = body, law, boundaries
        self.box, self.scheme, self.safety = choices.box, choices.scheme, choices.safety
        self.transfer, self.gate, self.half_height = choices.transfer, choices.contact, half_height(body)
        self.viscosity, self.volume = choices.viscosity, choices.volume
        self.blank = (0.0,) * sum(size for _, size in law.history_fields)
        self.sound = float(np.sqrt(law.instantaneous_modulus / law.density))
        mass, history, affine = law.density * body.volume, len(self.blank), choices.transfer.affine
        self.points: Points = at_rest(body.position, mass, body.volume, history, affine, choices.real)
        self.points.velocity[:] = velocity
        if choices.shape.stretches or choices.contact.stretches:
            self.points = self.points._replace(stretch=np.ones((len(body.position), 3), choices.real))
        overhang = choices.shape.overhang
        spares = max(choices.volume.spares, choices.contact.spares)
        self.grid: Grid = lattice(choices.box, choices.cell, len(body.position), overhang, choices.grid, spares)
        fastest = float(np.linalg.norm(self.points.velocity, axis=1).max())
        self.grid.critical[:] = choices.cell / (signal_speed(self.sound, 0.0) + fastest)
        self.tally = np.zeros(TALLY)  # of all boundaries, since the start
        self.middle = tuple(body.position.mean(axis=0))
        self.shortage = ""  # of memory for the grid
        self.shape: Shape = choices.shape.walled(*walls_around(boundaries, self.grid, self.middle))
        self._sort()

    @property
    def advice(self) -> Advice:
        return Advice(
            lost="the body does not stay in the box; give it more room (method.box)",
            losses="points left the box",
            unstable="the integration became unstable; take a smaller method.safety, or the scheme 'musl' instead of "
            "'usl', whose nodes of nearly no mass run away",
            dissipating=f"{self.transfer.dissipates}, or the integration is becoming unstable (scheme "
            "'usl' does where points come to nodes of nearly no mass; 'musl' does not)",
            gaining="noise of points that cross cells, or steps too long; take a smaller method.safety",
            collapsed="points fly apart or are crushed: the integration became unstable, or the impact is too violent "
            "for this resolution; look at the last snapshot",
        )

    def stable_step(self) -> float:
        return self.safety * float(self.grid.critical.min())

    def advance(self, dt: float) -> None:
        self.scheme(self, dt)
        try:
            self._sort()
        except MemoryError as error:  # points fly apart; no step can be taken on the grid that is there
            self.shortage = str(error)
            self.grid.critical[:] = 0.0

    def _sort(self) -> None:
        self.grid = around_points(self.grid, self.points, self.box)

    # --- the parts of a step that schemes share ---

    def fresh_grid(self) -> Grid:
        """Return the grid without mass, momentum or force."""
        forget(self.grid.momentum)
        forget(self.grid.change)
        return self.grid

    def contact(self, grid: Grid) -> None:
        """Let the boundaries act on the body through the nodes, and keep account of it."""
        for boundary in self.boundaries:
            self.tally += touch(self._gate(boundary, grid), boundary, grid, self.middle)

    def hold(self, grid: Grid) -> None:
        """Hold the nodes where strain is taken; points do not feel it, so no account is kept."""
        for boundary in self.boundaries:
            touch(self._gate(boundary, grid), boundary, grid, self.middle)

    def _gate(self, boundary: RigidWall | Symmetry, grid: Grid) -> Contact:
        """Return where a boundary acts: planes of symmetry everywhere."""
        if isinstance(boundary, Symmetry):
            return Nodes()
        return self.gate.at(boundary, self.points, grid, self.shape, self.half_height)

    def pressed(self) -> Volume:
        """Return how the points' pressures act on the nodes of this step."""
        return self.volume.pressed(self.points, self.grid)

    def update_stress(self, grid: Grid, dt: float) -> None:
        """Strain the points by the nodes' velocity and let the law answer."""
        points, shape, law = self.points, self.shape, self.law
        factors, volume = step_factors(law, dt), self.volume.strained(points, grid, shape, dt)
        update_points(points, grid, shape, law, factors, self.blank, self.sound, self.viscosity, volume, dt)

    # --- what the driver and the outputs ask ---

    def totals(self) -> Totals:
        chunks = np.zeros((CHUNKS, 9))
        sum_points(self.points, self.law, self.blank, chunks)
        sums = chunks.sum(axis=0)
        return Totals(
            *(float(energy) for energy in sums[:5]),
            hourglass=0.0,
            eroded=0.0,
            contact=0.0 - float(self.tally[3]),
            friction=0.0 - float(self.tally[4]),
            momentum=sums[6:9] * self.grid.geometry.resultant,
            impulse=self.tally[:3] * self.grid.geometry.resultant,
            mass=float(sums[5]),
        )

    def positions(self) -> Array:
        if self.lost() == 0:
            return self.points.position
        found = self.points.position.copy()
        found[self._lost()] = np.nan
        return found

    def lost(self) -> int:
        return int(self.grid.start[-1] - self.grid.start[-2])

    def lost_mass(self) -> float:
        return float(self.points.mass[self._lost()].sum())

    def weakest(self) -> str:
        return self.shortage

    def _lost(self) -> NDArray[np.uint64]:
        return self.grid.order[self.grid.start[-2] :]

    def snapshot(self) -> dict[str, Field]:
        points = self.points
        lost = np.zeros(len(points.mass), np.uint8)
        lost[self._lost()] = 1
        fields = {
            "position": Field(points.position, "mm"),
            "displacement": Field(points.position - self.body.position, "mm"),
            "velocity": Field(points.velocity, "m/s"),
            "stress": Field(points.stress, "MPa"),
            "von_mises": Field(von_mises_of(points.stress), "MPa"),
            "pressure": Field(-points.stress[:, :3].mean(axis=1), "MPa"),
            "jacobian": Field(points.jacobian, "1"),
            "viscous_pressure": Field(points.viscous_pressure, "MPa"),
            "dissipated_energy": Field(points.dissipated, "mJ/mm^3"),
            "lost": Field(lost, "1"),
        }
        fields |= history_fields(self.law, points.history)
        return {name: Field(np.array(field.values), field.unit) for name, field in fields.items()}

    def state(self) -> dict[str, Rows]:
        moving = {name: rows for name, rows in self.points._asdict().items() if name not in CONSTANT}
        return {**moving, "critical": self.grid.critical, "tally": self.tally}

    def restore(self, state: dict[str, Rows]) -> None:
        for name, rows in self.state().items():
            rows[...] = state[name]
        self._sort()
