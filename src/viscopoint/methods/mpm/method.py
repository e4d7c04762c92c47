"""The material point method as the driver sees it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from viscopoint.integrators.central_differences import CentralDifferences
from viscopoint.interactions.planes import Interaction
from viscopoint.interactions.rows import FRICTION_WORK, NORMAL_WORK, Rows
from viscopoint.kernels.arrays import AnyArray, Array, Real
from viscopoint.kernels.slabs import CHUNKS
from viscopoint.materials import Material
from viscopoint.materials.block import MaterialBlock
from viscopoint.methods.mpm import stress
from viscopoint.methods.mpm.contact import PlanesOnGrid, let_go
from viscopoint.methods.mpm.contacts import Contact
from viscopoint.methods.mpm.contacts.nodes import Nodes
from viscopoint.methods.mpm.geometry import Box
from viscopoint.methods.mpm.grid import Grid, around_points, lattice
from viscopoint.methods.mpm.points import Points, at_rest
from viscopoint.methods.mpm.schemes import Scheme
from viscopoint.methods.mpm.shapes import Shape
from viscopoint.methods.mpm.transfers import Transfer
from viscopoint.methods.mpm.volumes import Volume
from viscopoint.methods.mpm.volumes.local import Local
from viscopoint.model import points as points_of_any
from viscopoint.model.body import Body, half_height
from viscopoint.model.method import FailureHints, Field, Totals, history_fields, von_mises_of
from viscopoint.model.points import sum_energies
from viscopoint.model.viscosity import BulkViscosity, signal_speed

CONSTANT = ("mass", "volume", "material", "shared")  # of what points carry; the last two have names of their own


@dataclass(frozen=True)
class Discretisation:
    """The choices that make an MPM."""

    cell: float  # mm
    box: Box
    shape: Shape  # of ``mpm.shapes``
    scheme: Scheme  # of ``mpm.schemes``
    transfer: Transfer  # of ``mpm.transfers``
    time_step_factor: float  # share of the critical step to take
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
        material: Material,
        interactions: Sequence[Interaction],
        choices: Discretisation,
        velocity: tuple[float, float, float] | Array,
    ) -> None:
        self.body, self.material = body, material
        self.block = MaterialBlock(material)
        self.box, self.scheme, self.time_step_factor = choices.box, choices.scheme, choices.time_step_factor
        self.transfer, self.half_height = choices.transfer, half_height(body)
        self.viscosity, self.volume = choices.viscosity, choices.volume
        self.sound = float(np.sqrt(material.p_wave_modulus / material.density))  # of the undeformed material, mm/ms
        mass, affine = material.density * body.volume, choices.transfer.affine
        self.points: Points = at_rest(body.position, mass, body.volume, self.block, affine, choices.real)
        self.points.velocity[:] = velocity
        if choices.shape.stretches or choices.contact.stretches:
            self.points = self.points._replace(stretch=np.ones((len(body.position), 3), choices.real))
        overhang = choices.shape.overhang
        spares = max(choices.volume.spares, choices.contact.spares)
        self.grid: Grid = lattice(choices.box, choices.cell, len(body.position), overhang, choices.grid, spares)
        fastest = float(np.linalg.norm(self.points.velocity, axis=1).max())
        self.grid.critical[:] = choices.cell / (signal_speed(self.sound, 0.0) + fastest)
        self.planes = PlanesOnGrid(interactions, self.grid, body.position.mean(axis=0), choices.contact)
        self.shortage = ""  # of memory for the grid
        self.shape: Shape = choices.shape.walled(*self.planes.around(self.grid))
        self._sort()

    @property
    def failure_hints(self) -> FailureHints:
        return FailureHints(
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

    @property
    def reactions(self) -> Array:
        """What each interaction did to the body since the start (``interactions.rows.REACTIONS``)."""
        return self.planes.reactions

    @reactions.setter
    def reactions(self, place: Array) -> None:
        self.planes.reactions = place

    def stable_step(self) -> float:
        return self.time_step_factor * float(self.grid.critical.min())

    # --- the stages of a step ---

    def advance(self, dt: float) -> None:
        """Advance this body alone by one step [ms]."""
        if not hasattr(self, "_alone"):
            self._alone = CentralDifferences((self,))
        self._alone.advance(dt)

    def kick(self, dt: float) -> None:
        for act in self.scheme.kick:
            act(self, dt)

    def constrain(self, rows: Rows, number: int, first: int, dt: float) -> Rows:
        return self.planes.find(rows, number, first, self.grid, self.points, self.shape, self.half_height)

    def drift(self, rows: Rows, number: int, dt: float) -> None:
        self.planes.take_velocity(self.grid, rows, number)
        for act in self.scheme.drift:
            act(self, dt)

    def strain(self, dt: float) -> None:
        for act in self.scheme.strain:
            act(self, dt)
        self.planes.elapsed += dt
        try:
            self._sort()
        except MemoryError as error:  # points fly apart; no step can be taken on the grid that is there
            self.shortage = str(error)
            self.grid.critical[:] = 0.0

    def kick_again(self, dt: float) -> None:
        """Nothing: the grid lives for one step, and has had all of its kick."""

    def constrain_again(self, rows: Rows, number: int, dt: float) -> None:
        if rows.size[1]:
            let_go(rows, number)

    def arrive(self, rows: Rows, number: int) -> None:
        """Nothing, likewise."""

    def hold(self) -> None:
        """Hold the nodes where strain is taken."""
        self.planes.hold(self.grid, self.points, self.shape, self.half_height)

    def update_stress(self, dt: float) -> None:
        """Strain the points by the nodes' velocity and update their stress."""
        points, grid, shape = self.points, self.grid, self.shape
        volume = self.volume.strained(points, grid, shape, dt)
        stress.update_points(points, grid, shape, self.block.of_step(dt), self.viscosity, volume, dt)

    def _sort(self) -> None:
        self.grid = around_points(self.grid, self.points, self.box)

    # --- what the driver and the outputs ask ---

    def totals(self) -> Totals:
        points, along = self.points, np.array(self.grid.geometry.resultant)
        moving, straining = np.empty((CHUNKS, stress.SUMS)), np.empty((CHUNKS, points_of_any.SUMS))
        stress.sum_motion(points, moving)
        sum_energies(points.material, points.shared, points.volume, self.block.code, straining)
        kinetic, mass, *momentum = np.add.reduce(moving).tolist()
        energies, reactions = np.add.reduce(straining).tolist(), np.add.reduce(self.reactions)
        return Totals(
            kinetic=kinetic,
            stored=energies[points_of_any.STORED_ENERGY],
            dissipated=energies[points_of_any.DISSIPATED_ENERGY],
            hypoelastic=energies[points_of_any.HYPOELASTIC_WORK],
            viscous=energies[points_of_any.VISCOUS_WORK],
            hourglass=0.0,
            eroded=energies[points_of_any.ERODED_ENERGY],
            contact=0.0 - float(reactions[NORMAL_WORK]),
            friction=0.0 - float(reactions[FRICTION_WORK]),
            momentum=along * momentum,
            impulse=along * reactions[:3],
            mass=mass,
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

    def limiting_element(self) -> str:
        return self.shortage

    def _lost(self) -> NDArray[np.uint64]:
        return self.grid.order[self.grid.start[-2] :]

    def snapshot(self) -> dict[str, Field]:
        points, material, shared = self.points, self.points.material, self.points.shared
        lost = np.zeros(len(points.mass), np.uint8)
        lost[self._lost()] = 1
        fields = {
            "position": Field(points.position, "mm"),
            "displacement": Field(points.position - self.body.position, "mm"),
            "velocity": Field(points.velocity, "m/s"),
            "stress": Field(material.stress, "MPa"),
            "von_mises": Field(von_mises_of(material.stress), "MPa"),
            "pressure": Field(-material.stress[:, :3].mean(axis=1), "MPa"),
            "jacobian": Field(shared.jacobian, "1"),
            "viscous_pressure": Field(shared.viscous_pressure, "MPa"),
            "dissipated_energy": Field(material.dissipated, "mJ/mm^3"),
            "lost": Field(lost, "1"),
        }
        fields |= history_fields(self.block.history_fields, material.history)
        return {name: Field(np.array(field.values), field.unit) for name, field in fields.items()}

    def state(self) -> dict[str, AnyArray]:
        points = self.points
        moving = {name: rows for name, rows in points._asdict().items() if name not in CONSTANT}
        kept = {**moving, **points.material._asdict(), **points.shared._asdict()}
        return {**kept, "critical": self.grid.critical, "reactions": self.reactions, "elapsed": self.planes.elapsed}

    def restore(self, state: dict[str, AnyArray]) -> None:
        for name, rows in self.state().items():
            rows[...] = state[name]
        self._sort()
