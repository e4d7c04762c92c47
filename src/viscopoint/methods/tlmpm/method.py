"""The total Lagrangian material point method as the driver sees it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from viscopoint.errors import InputError
from viscopoint.interactions.planes import Interaction
from viscopoint.kernels.arrays import AnyArray, Array, Indices, Real
from viscopoint.materials import Material
from viscopoint.methods.lagrangian import LagrangianBody
from viscopoint.methods.mpm.shapes import Shape
from viscopoint.methods.tlmpm.extension import Extension, extended, multiply
from viscopoint.methods.tlmpm.lattice import Lattice, lattice_around, sum_volumes
from viscopoint.methods.tlmpm.points import Points, at_rest
from viscopoint.methods.tlmpm.stability import stable_length
from viscopoint.methods.tlmpm.stress import interpolate_to_points, strain_points
from viscopoint.methods.tlmpm.volumes import CellMean, Local
from viscopoint.model.body import Body
from viscopoint.model.method import FailureHints, Field
from viscopoint.model.nodes import Nodes, nodes_at_rest
from viscopoint.model.points import MaterialState, VolumeState
from viscopoint.model.viscosity import BulkViscosity, longest_step

NEAR = 1e-6  # of a cell: nodes closer than this to a plane of nodes stand on it


@dataclass(frozen=True)
class Discretisation:
    """The choices that make a total Lagrangian MPM."""

    cell: tuple[float, float, float]  # edges, mm
    shape: Shape  # of ``mpm.shapes``
    volume: type[Local] | type[CellMean]  # of ``tlmpm.volumes``
    time_step_factor: float  # share of the critical step to take
    viscosity: BulkViscosity
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of a node; surfaces that touch must be planes of nodes, mm
    lattice: type[Lattice] = Lattice  # of ``tlmpm.lattice``
    real: Real = np.float64  # of the points' state


class TotalLagrangianMethod(LagrangianBody):
    """A body of material points on the grid of its undeformed shape, moving at ``velocity`` [mm/ms] at the start.

    The grid's nodes have the motion for good: weights never change, so that nothing is ever mapped back to them.
    """

    failure_hints = FailureHints(
        lost="the integration became unstable; take a smaller method.safety",
        unstable="the integration became unstable; take a smaller method.safety",
        dissipating="the integration is becoming unstable; take a smaller method.safety",
        gaining="the body is too distorted for its undeformed grid, or the integration is becoming unstable; look at "
        "the last snapshot, take a smaller method.safety",
        collapsed="the impact is too violent for this resolution: where a soft body hits faster than its shear waves "
        'run, the rim of its foot is squeezed flat, cut points first. Take method.fill = "rings" or method.geometry = '
        '"axisymmetric", which cut none, a larger method.spacing, or the method "mpm", whose grid does not deform',
    )

    def __init__(
        self, body: Body, material: Material, interactions: Sequence[Interaction], choices: Discretisation,
        velocity: tuple[float, float, float] | Array,
    ) -> None:  # fmt: skip
        """Set up points, grid and nodes; a velocity per row is that of the nodes that ``reference`` lists."""
        super().__init__(body, material, choices.time_step_factor)
        self.shape, self.volume, self.viscosity = choices.shape, choices.volume(), choices.viscosity
        self.points: Points = at_rest(body.position, body.volume, self.block, choices.real)
        self.lattice: Lattice = lattice_around(
            body.position, choices.cell, choices.origin, choices.lattice, choices.shape.overhang
        )
        self.extension, self.nodes = self._nodes(choices)
        self.reference: Array = self.nodes.position.copy()
        self._redistribute(interactions, choices.cell)
        self.act_on(interactions)
        free = (self.nodes.inverse_mass > 0.0).astype(float)
        self.stable_length = stable_length(
            self.points, self.lattice, self.shape, self.extension, self.nodes.mass, free, material.density
        )
        self.nodes.velocity[:] = velocity
        self.critical = np.full(len(self.lattice.start) - 1, self._first_step(choices))
        self._extend()

    def _nodes(self, choices: Discretisation) -> tuple[Extension, Nodes]:
        """Return which nodes have a motion of their own, and what the others make of it."""
        lattice = self.lattice
        weight, filled, active = np.zeros((3, len(lattice.force)))
        sum_volumes(self.points, lattice, self.shape, weight, filled, active)
        nx, ny = int(lattice.nx), int(lattice.ny)
        shape = (len(weight) // (nx * ny), ny, nx)
        every = np.column_stack(np.unravel_index(np.arange(len(weight)), shape))[:, ::-1]
        steps: Array = (every - np.array([lattice.i0, lattice.j0, lattice.k0])).astype(float)
        places = np.array(choices.origin) + steps * np.array(choices.cell)
        room = lattice.geometry.room(places[:, 0], choices.cell)
        extension, rows = extended(shape, filled / room, active)
        position = places[rows]
        mass = np.zeros((len(rows), 3))
        multiply(extension.back, self.material.density * np.column_stack([weight] * 3), mass)
        if not (mass > 0.0).all():
            raise InputError("method.cell: too large for the body's shape; take a smaller one")
        return extension, nodes_at_rest(position, mass[:, 0], lattice.geometry.free(position, choices.cell[0]))

    def _redistribute(self, interactions: Sequence[Interaction], cell: tuple[float, float, float]) -> None:
        """Give partners to the plane of nodes that meets the first wall (``interactions.on_nodes``)."""
        for interaction in interactions:
            if not interaction.holds:
                self.nodes.normal[:] = interaction.plane.normal
                self.nodes.partner[:] = partners(self.reference, np.array(cell), self.nodes.normal)
                return

    def _first_step(self, choices: Discretisation) -> float:
        """Return the critical step [ms], with what bulk viscosity and flight may do in it."""
        fastest = float(np.linalg.norm(self.nodes.velocity, axis=1).max())
        linear, quadratic = self.viscosity
        damping = np.sqrt(3.0) * (linear * self.sound + quadratic * fastest)
        rest = longest_step(self.viscosity, self.stable_length, min(choices.cell), self.sound, damping)
        return rest / (1.0 + fastest / self.sound)

    def strain(self, dt: float) -> None:
        self._extend()
        self.lattice.force[:] = 0.0
        strain_points(
            self.points, self.lattice, self.shape, self.block.of_step(dt), self.viscosity, self.volume,
            self.stable_length, self.critical, dt,
        )  # fmt: skip
        multiply(self.extension.back, self.lattice.force, self.nodes.force)

    def _extend(self) -> None:
        """Let the nodes of hardly any mass follow."""
        multiply(self.extension.out, self.nodes.velocity, self.lattice.velocity)

    # --- what the driver and the outputs ask ---

    @property
    def resultant(self) -> Sequence[float]:
        return self.lattice.geometry.resultant

    def states(self) -> tuple[MaterialState, VolumeState, Array]:
        return self.points.material, self.points.shared, self.points.volume

    def own_state(self) -> dict[str, AnyArray]:
        return {"position": self.points.position, "deformation": self.points.deformation}

    def positions(self) -> Array:
        return self.points.position

    def lost(self) -> int:
        return 0

    def lost_mass(self) -> float:
        return 0.0

    def limiting_element(self) -> str:
        material = np.flatnonzero(self.points.volume > 0.0)
        deformation = self.points.deformation[material].astype(float).reshape(-1, 3, 3)
        if not np.isfinite(deformation).all():
            return ""
        stretch = np.linalg.svd(deformation, compute_uv=False)[:, 2] * np.sign(np.linalg.det(deformation))
        flattest = int(stretch.argmin())
        x, y, z = self.points.position[material[flattest]]
        state = "is turned inside out" if stretch[flattest] <= 0.0 else f"is squeezed to {stretch[flattest]:.2g} times"
        return f"the material at ({x:.3g}, {y:.3g}, {z:.3g}) mm {state}"

    def velocities(self) -> Array:
        """Return the points' velocity, Σ N v_i."""
        self._extend()
        found = np.empty((len(self.points.volume), 3))
        interpolate_to_points(self.points, self.lattice, self.shape, self.lattice.velocity, found)
        return found

    def snapshot(self) -> dict[str, Field]:
        lost = np.zeros(len(self.points.volume), np.uint8)
        return self.fields_of_points(self.points.position, self.velocities(), lost)


def partners(position: Array, cell: Array, normal: Array) -> Indices:
    """Return for each of the nodes that meet a wall first the one behind it, and -1 for others.

    They are the outermost plane of nodes towards the wall, along the grid's axis closest to its normal.
    """
    axis = int(np.abs(normal).argmax())
    towards = np.sign(normal[axis])
    rounded = np.round(position / cell[axis], 6)
    height = towards * position[:, axis]
    first = np.flatnonzero(np.abs(height - height.min()) < NEAR * cell[axis])
    step = np.zeros(3)
    step[axis] = towards * cell[axis]
    behind = np.round((position[first] + step) / cell[axis], 6)
    level = np.flatnonzero(np.isin(rounded[:, axis], behind[:, axis]))
    index = {tuple(place): n for n, place in zip(level.tolist(), rounded[level].tolist(), strict=True)}
    found = np.full(len(position), -1)
    found[first] = [index.get(tuple(place), -1) for place in behind.tolist()]
    return found
