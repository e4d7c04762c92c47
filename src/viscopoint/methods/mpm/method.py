"""The material point method as the driver sees it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from viscopoint.interactions.planes import Interaction
from viscopoint.interactions.rows import Rows
from viscopoint.kernels.arrays import AnyArray, Array, Real
from viscopoint.materials import Material
from viscopoint.methods.moving import MovingBody
from viscopoint.methods.mpm import stress
from viscopoint.methods.mpm.contact import PlanesOnGrid, deactivate_rows
from viscopoint.methods.mpm.contacts import Contact
from viscopoint.methods.mpm.contacts.nodes import Nodes
from viscopoint.methods.mpm.geometry import Box
from viscopoint.methods.mpm.grid import Grid, fitted_to_points, lattice
from viscopoint.methods.mpm.points import Points, at_rest
from viscopoint.methods.mpm.schemes import Scheme
from viscopoint.methods.mpm.shapes import Shape
from viscopoint.methods.mpm.transfers import Transfer
from viscopoint.methods.mpm.volumes import Volume
from viscopoint.methods.mpm.volumes.local import Local
from viscopoint.model.body import Body, half_height
from viscopoint.model.method import FailureHints, Field
from viscopoint.model.points import MaterialState, VolumeState
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


class MaterialPointMethod(MovingBody):
    """A body of material points on a background grid, moving at ``velocity`` [mm/ms] at the start."""

    planes: PlanesOnGrid

    def __init__(
        self, body: Body, material: Material, interactions: Sequence[Interaction], choices: Discretisation,
        velocity: tuple[float, float, float] | Array,
    ) -> None:  # fmt: skip
        super().__init__(body, material, choices.time_step_factor)
        self.box, self.scheme, self.viscosity = choices.box, choices.scheme, choices.viscosity
        self.transfer, self.volume, self.half_height = choices.transfer, choices.volume, half_height(body)
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
        self.shape: Shape = choices.shape.walled(*self.planes.wall_planes(self.grid))
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

    def stable_step(self) -> float:
        return self.time_step_factor * float(self.grid.critical.min())

    # --- the stages of a step ---

    def kick(self, dt: float) -> None:
        for act in self.scheme.kick:
            act(self, dt)

    def constrain(self, rows: Rows, number: int, first: int, dt: float) -> Rows:
        return self.planes.add_rows(rows, number, first, self.grid, self.points, self.shape, self.half_height)

    def drift(self, rows: Rows, number: int, dt: float) -> None:
        self.planes.correct_velocity(self.grid, rows, number)
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
            deactivate_rows(rows, number)

    def correct_velocity(self, rows: Rows, number: int) -> None:
        """Nothing, likewise."""

    def constrain_velocity(self) -> None:
        """Apply the constraints to velocities from which strain is taken."""
        self.planes.constrain_velocity(self.grid, self.points, self.shape, self.half_height)

    def update_stress(self, dt: float) -> None:
        """Strain the points by the nodes' velocity and update their stress."""
        points, grid, shape = self.points, self.grid, self.shape
        volume = self.volume.of_strain(points, grid, shape, dt)
        stress.update_points(points, grid, shape, self.block.of_step(dt), self.viscosity, volume, dt)

    def _sort(self) -> None:
        self.grid = fitted_to_points(self.grid, self.points, self.box)

    # --- what the driver and the outputs ask ---

    @property
    def resultant(self) -> Sequence[float]:
        return self.grid.geometry.resultant

    def states(self) -> tuple[MaterialState, VolumeState, Array]:
        return self.points.material, self.points.shared, self.points.volume

    def sum_motion(self, sums: Array) -> None:
        stress.sum_motion(self.points, sums)

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
        lost = np.zeros(len(self.points.mass), np.uint8)
        lost[self._lost()] = 1
        return self.fields_of_points(self.points.position, self.points.velocity, lost)

    def state(self) -> dict[str, AnyArray]:
        points = self.points
        moving = {name: rows for name, rows in points._asdict().items() if name not in CONSTANT}
        stored = {**moving, **points.material._asdict(), **points.shared._asdict()}
        return {**stored, "critical": self.grid.critical, "reactions": self.reactions, "elapsed": self.planes.elapsed}

    def restore(self, state: dict[str, AnyArray]) -> None:
        super().restore(state)
        self._sort()
