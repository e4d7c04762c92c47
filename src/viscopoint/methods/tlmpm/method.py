"""The total Lagrangian material point method as the driver sees it."""

from dataclasses import dataclass

import numpy as np

from viscopoint.errors import InputError
from viscopoint.interactions.planes import TALLY, RigidWall, Symmetry
from viscopoint.kernels.arrays import Array, Real, Rows
from viscopoint.materials import Law, step_factors
from viscopoint.methods.fem.state import CHUNKS
from viscopoint.methods.mpm.shapes import Shape
from viscopoint.methods.tlmpm.extension import Extension, carry, extended
from viscopoint.methods.tlmpm.lattice import Lattice, around_body, cover
from viscopoint.methods.tlmpm.motion import arrive, set_off
from viscopoint.methods.tlmpm.nodes import Nodes, nodes_at_rest, sum_nodes
from viscopoint.methods.tlmpm.points import Points, at_rest
from viscopoint.methods.tlmpm.stability import reach
from viscopoint.methods.tlmpm.stress import strain_points, sum_points, watch
from viscopoint.methods.tlmpm.volumes import CellMean, Local
from viscopoint.model.body import Body
from viscopoint.model.method import Advice, Field, Totals, history_fields, von_mises_of
from viscopoint.model.viscosity import BulkViscosity, longest_step

ON_PLANE = 1e-9  # of the body's extent: nodes closer than this to a plane of symmetry stand on it
CONSTANT = ("reference", "volume", "mass", "fixed", "above")  # of what points and nodes have
NO_WALL = RigidWall(-np.inf, 0.0)


@dataclass(frozen=True)
class Discretisation:
    """The choices that make a total Lagrangian MPM."""

    cell: tuple[float, float, float]  # edges, mm
    shape: Shape  # of ``mpm.shapes``
    volume: type[Local] | type[CellMean]  # of ``tlmpm.volumes``
    safety: float  # share of the critical step to take
    viscosity: BulkViscosity
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of a node; surfaces that touch must be planes of nodes, mm
    lattice: type[Lattice] = Lattice  # of ``tlmpm.lattice``
    real: Real = np.float64  # of the points' state


class TotalLagrangianMethod:
    """A body of material points on the grid of its undeformed shape, moving at ``velocity`` [mm/ms] at the start.

    The grid's nodes have the motion for good: weights never change, so that nothing is ever mapped back to them.
    """

    advice = Advice(
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
        self,
        body: Body,
        law: Law,
        boundaries: tuple[RigidWall | Symmetry, ...],
        choices: Discretisation,
        velocity: tuple[float, float, float] | Array,
    ) -> None:
        """Set up points, grid and nodes; a velocity per row is that of the nodes that ``nodes_at`` lists."""
        self.body, self.law = body, law
        self.shape, self.volume = choices.shape, choices.volume()
        self.safety, self.viscosity = choices.safety, choices.viscosity
        self.blank = (0.0,) * sum(size for _, size in law.history_fields)
        self.sound = float(np.sqrt(law.instantaneous_modulus / law.density))
        self.points: Points = at_rest(body.position, body.volume, len(self.blank), choices.real)
        self.lattice: Lattice = around_body(
            body.position, choices.cell, choices.origin, choices.lattice, choices.shape.overhang
        )
        self.extension, self.nodes = self._nodes(choices)
        self.reference: Array = self.nodes.position.copy()
        self.wall = NO_WALL
        for boundary in boundaries:
            self._stand_between(boundary)
        free = self.lattice.geometry.free(self.reference, choices.cell[0])
        self.nodes.fixed[:] |= np.uint8(1) * (free[:, 0] == 0.0)  # on the axis
        self.reach = reach(self.points, self.lattice, self.shape, self.extension, self.nodes.mass, free, law.density)
        self.nodes.velocity[:] = velocity
        self.critical = np.full(len(self.lattice.start) - 1, self._first_step(choices))
        self.tally = np.zeros(TALLY)  # of wall and planes of symmetry, since the start
        self._extend()

    def _nodes(self, choices: Discretisation) -> tuple[Extension, Nodes]:
        """Return which nodes have a motion of their own, and what the others make of it."""
        lattice = self.lattice
        weight, filled, touched = np.zeros((3, len(lattice.force)))
        cover(self.points, lattice, self.shape, weight, filled, touched)
        nx, ny = int(lattice.nx), int(lattice.ny)
        shape = (len(weight) // (nx * ny), ny, nx)
        every = np.column_stack(np.unravel_index(np.arange(len(weight)), shape))[:, ::-1]
        steps: Array = (every - np.array([lattice.i0, lattice.j0, lattice.k0])).astype(float)
        places = np.array(choices.origin) + steps * np.array(choices.cell)
        room = lattice.geometry.room(places[:, 0], choices.cell)
        extension, rows = extended(shape, filled / room, touched)
        position = places[rows]
        mass = np.zeros((len(rows), 3))
        carry(extension.back, self.law.density * np.column_stack([weight] * 3), mass)
        if not (mass > 0.0).all():
            raise InputError("method.cell: too large for the body's shape; take a smaller one")
        foot, height = position[:, 2].min(), choices.cell[2]
        return extension, nodes_at_rest(position, mass[:, 0], foot, height)

    def _stand_between(self, boundary: RigidWall | Symmetry) -> None:
        if isinstance(boundary, RigidWall):
            self.wall = boundary
            return
        place = self.reference[:, boundary.axis]
        on = np.abs(place - boundary.position) <= ON_PLANE * np.ptp(self.reference, axis=0).max()
        if not on.any():
            raise InputError(
                f"no node stands on the plane of symmetry {'xyz'[boundary.axis]} = {boundary.position:g} mm"
            )
        self.nodes.fixed[on] |= np.uint8(1 << boundary.axis)

    def _first_step(self, choices: Discretisation) -> float:
        """Return the critical step [ms], with what bulk viscosity and flight may do in it."""
        fastest = float(np.linalg.norm(self.nodes.velocity, axis=1).max())
        linear, quadratic = self.viscosity
        damping = np.sqrt(3.0) * (linear * self.sound + quadratic * fastest)
        rest = longest_step(self.viscosity, self.reach, min(choices.cell), self.sound, damping)
        return rest / (1.0 + fastest / self.sound)

    def stable_step(self) -> float:
        return self.safety * float(self.critical.min())

    def advance(self, dt: float) -> None:
        """One step of velocity Verlet (central differences)."""
        nodes, tally = self.nodes, np.zeros((CHUNKS, TALLY))
        set_off(nodes, self.wall, dt, tally)  # v += f/m dt/2, wall, x += v dt
        self._extend()
        self._answer(dt)  # F, J, sigma, f
        arrive(nodes, self.wall, dt, tally)  # v += f/m dt/2, wall
        self.tally += tally.sum(axis=0)

    def _extend(self) -> None:
        """Let the nodes of hardly any mass follow."""
        carry(self.extension.out, self.nodes.velocity, self.lattice.velocity)

    def _answer(self, dt: float) -> None:
        points, lattice, shape, law = self.points, self.lattice, self.shape, self.law
        factors = step_factors(law, dt)
        lattice.force[:] = 0.0
        strain_points(
            points, lattice, shape, law, factors, self.blank, self.sound, self.viscosity, self.volume, self.reach,
            self.critical, dt,
        )  # fmt: skip
        carry(self.extension.back, lattice.force, self.nodes.force)

    # --- what the driver and the outputs ask ---

    def totals(self) -> Totals:
        moving, straining = np.zeros((CHUNKS, 5)), np.zeros((CHUNKS, 4))
        sum_nodes(self.nodes, moving)
        sum_points(self.points, self.law, self.blank, straining)
        kinetic, mass, *momentum = moving.sum(axis=0)
        stored, dissipated, viscous, hypoelastic = (float(energy) for energy in straining.sum(axis=0))
        return Totals(
            kinetic=float(kinetic),
            stored=stored,
            dissipated=dissipated,
            hypoelastic=hypoelastic,
            viscous=viscous,
            hourglass=0.0,
            eroded=0.0,
            contact=0.0 - float(self.tally[3]),
            friction=0.0 - float(self.tally[4]),
            momentum=np.array(momentum) * self.lattice.geometry.resultant,
            impulse=self.tally[:3] * self.lattice.geometry.resultant,
            mass=float(mass),
        )

    def positions(self) -> Array:
        return self.points.position

    def lost(self) -> int:
        return 0

    def lost_mass(self) -> float:
        return 0.0

    def weakest(self) -> str:
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
        watch(self.points, self.lattice, self.shape, self.lattice.velocity, found)
        return found

    def snapshot(self) -> dict[str, Field]:
        points = self.points
        fields = {
            "position": Field(points.position, "mm"),
            "displacement": Field(points.position - self.body.position, "mm"),
            "velocity": Field(self.velocities(), "m/s"),
            "stress": Field(points.stress, "MPa"),
            "von_mises": Field(von_mises_of(points.stress), "MPa"),
            "pressure": Field(-points.stress[:, :3].mean(axis=1), "MPa"),
            "jacobian": Field(points.jacobian, "1"),
            "viscous_pressure": Field(points.viscous_pressure, "MPa"),
            "dissipated_energy": Field(points.dissipated, "mJ/mm^3"),
            "lost": Field(np.zeros(len(points.volume), np.uint8), "1"),
        }
        fields |= history_fields(self.law, points.history)
        return {name: Field(np.array(field.values), field.unit) for name, field in fields.items()}

    def state(self) -> dict[str, Rows]:
        points = {f"point_{name}": rows for name, rows in self.points._asdict().items() if name not in CONSTANT}
        nodes = {f"node_{name}": rows for name, rows in self.nodes._asdict().items() if name not in CONSTANT}
        return {**points, **nodes, "critical": self.critical, "tally": self.tally}

    def restore(self, state: dict[str, Rows]) -> None:
        for name, rows in self.state().items():
            rows[...] = state[name]
