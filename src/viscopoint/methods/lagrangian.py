"""What bodies have in common whose nodes have the motion for good: a mesh, and a total Lagrangian grid."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from viscopoint.integrators.central_differences import CentralDifferences
from viscopoint.interactions.on_nodes import PlanesOnNodes, resume, settle, take_velocity
from viscopoint.interactions.planes import Interaction
from viscopoint.interactions.rows import FRICTION_WORK, NORMAL_WORK, Rows
from viscopoint.kernels.arrays import AnyArray, Array
from viscopoint.kernels.slabs import CHUNKS
from viscopoint.materials import Material
from viscopoint.materials.block import MaterialBlock
from viscopoint.model import nodes as motion
from viscopoint.model import points
from viscopoint.model.body import Body
from viscopoint.model.method import Totals
from viscopoint.model.nodes import Nodes
from viscopoint.model.points import MaterialState, VolumeState, sum_energies

CONSTANT = ("mass", "inverse_mass", "normal", "partner")  # of what nodes have


class LagrangianBody(ABC):
    """A body of nodes, on its way through the steps of ``integrators.central_differences``."""

    nodes: Nodes
    critical: Array  # [slab], least stable step of each, ms

    def __init__(self, body: Body, material: Material, time_step_factor: float) -> None:
        self.body, self.material = body, material
        self.block = MaterialBlock(material)
        self.time_step_factor = time_step_factor
        self.sound = float(np.sqrt(material.p_wave_modulus / material.density))  # of the undeformed material, mm/ms

    def act_on(self, interactions: Sequence[Interaction]) -> None:
        """Let interactions act on the nodes."""
        self.planes = PlanesOnNodes(interactions, self.nodes)

    @property
    def reactions(self) -> Array:
        """What each interaction did to the body since the start (``interactions.rows.REACTIONS``)."""
        return self.planes.reactions

    @reactions.setter
    def reactions(self, place: Array) -> None:
        self.planes.reactions = place

    # --- the stages of a step ---

    def advance(self, dt: float) -> None:
        """Advance this body alone by one step [ms]."""
        if not hasattr(self, "_alone"):
            self._alone = CentralDifferences((self,))
        self._alone.advance(dt)

    def kick(self, dt: float) -> None:
        motion.kick(self.nodes, 0.5 * dt)

    def constrain(self, rows: Rows, number: int, first: int, dt: float) -> Rows:
        return self.planes.find(rows, number, first, self.nodes, 0.5 * dt, dt)

    def drift(self, rows: Rows, number: int, dt: float) -> None:
        if rows.size[0]:
            take_velocity(self.nodes, rows, number)
        motion.drift(self.nodes, dt)
        if rows.size[0]:
            settle(self.nodes, rows, number, self.planes.slot_of)

    @abstractmethod
    def strain(self, dt: float) -> None:
        """Take the nodes' motion over the step to stresses, and these to the nodes' force."""

    def kick_again(self, dt: float) -> None:
        motion.kick(self.nodes, 0.5 * dt)

    def constrain_again(self, rows: Rows, number: int, dt: float) -> None:
        if rows.size[0]:
            resume(self.nodes, rows, number, 0.5 * dt)

    def arrive(self, rows: Rows, number: int) -> None:
        if rows.size[0]:
            take_velocity(self.nodes, rows, number)

    def stable_step(self) -> float:
        return self.time_step_factor * float(self.critical.min())

    # --- what the driver asks ---

    @abstractmethod
    def states(self) -> tuple[MaterialState, VolumeState, Array]:
        """Return what the material has at the points, what they share, and their reference volumes [mm^3]."""

    @property
    @abstractmethod
    def resultant(self) -> Sequence[float]:
        """1 along axes along which the whole body has a momentum, else 0."""

    def hourglass_energy(self) -> float:
        """Return what the control of hourglass modes has taken [mJ]."""
        return 0.0

    def totals(self) -> Totals:
        moving, straining = np.empty((CHUNKS, motion.SUMS)), np.empty((CHUNKS, points.SUMS))
        motion.sum_motion(self.nodes, moving)
        sum_energies(*self.states(), self.block.code, straining)
        kinetic, mass, *momentum = np.add.reduce(moving).tolist()
        energies, reactions = np.add.reduce(straining).tolist(), np.add.reduce(self.reactions)
        along = np.array(self.resultant)
        return Totals(
            kinetic=kinetic,
            stored=energies[points.STORED_ENERGY],
            dissipated=energies[points.DISSIPATED_ENERGY],
            hypoelastic=energies[points.HYPOELASTIC_WORK],
            viscous=energies[points.VISCOUS_WORK],
            hourglass=self.hourglass_energy(),
            eroded=energies[points.ERODED_ENERGY],
            contact=0.0 - float(reactions[NORMAL_WORK]),
            friction=0.0 - float(reactions[FRICTION_WORK]),
            momentum=along * momentum,
            impulse=along * reactions[:3],
            mass=mass,
        )

    def own_state(self) -> dict[str, AnyArray]:
        """Return what a method adds to ``state``."""
        return {}

    def state(self) -> dict[str, AnyArray]:
        material, shared, _ = self.states()
        nodes = {f"node_{name}": rows for name, rows in self.nodes._asdict().items() if name not in CONSTANT}
        kept = {**material._asdict(), **shared._asdict(), **nodes, **self.own_state()}
        return {**kept, "critical": self.critical, "reactions": self.reactions}

    def restore(self, state: dict[str, AnyArray]) -> None:
        for name, rows in self.state().items():
            rows[...] = state[name]
