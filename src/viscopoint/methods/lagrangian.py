"""What bodies have in common whose nodes have the motion for good: a mesh, and a total Lagrangian grid."""

from abc import abstractmethod
from collections.abc import Sequence

from viscopoint.interactions.on_nodes import PlanesOnNodes, correct_velocity, stop_nodes, update_rows
from viscopoint.interactions.planes import Interaction
from viscopoint.interactions.rows import Rows
from viscopoint.kernels.arrays import AnyArray, Array
from viscopoint.methods.moving import MovingBody
from viscopoint.model import nodes as motion
from viscopoint.model.nodes import Nodes

NOT_STORED = ("mass", "inverse_mass", "normal", "partner", "in_contact")  # constant, or of one stage: in no checkpoint


class LagrangianBody(MovingBody):
    """A body of nodes, on its way through the steps of ``integrators.central_differences``."""

    nodes: Nodes
    planes: PlanesOnNodes
    critical: Array  # [slab], least stable step of each, ms

    def act_on(self, interactions: Sequence[Interaction]) -> None:
        """Let interactions act on the nodes."""
        self.planes = PlanesOnNodes(interactions, self.nodes)

    # --- the stages of a step ---

    def kick(self, dt: float) -> None:
        motion.kick(self.nodes, 0.5 * dt)

    def constrain(self, rows: Rows, number: int, first: int, dt: float) -> Rows:
        return self.planes.add_rows(rows, number, first, self.nodes, dt)

    def drift(self, rows: Rows, number: int, dt: float) -> None:
        if rows.size[0]:
            correct_velocity(self.nodes, rows, number)
        motion.drift(self.nodes, dt)
        if rows.size[0]:
            stop_nodes(self.nodes, rows, number, self.planes.slot_of)

    @abstractmethod
    def strain(self, dt: float) -> None:
        """Take the nodes' motion over the step to stresses, and these to the nodes' force."""

    def kick_again(self, dt: float) -> None:
        motion.kick(self.nodes, 0.5 * dt)

    def constrain_again(self, rows: Rows, number: int, dt: float) -> None:
        if rows.size[0]:
            update_rows(self.nodes, rows, number, 0.5 * dt)

    def correct_velocity(self, rows: Rows, number: int) -> None:
        if rows.size[0]:
            correct_velocity(self.nodes, rows, number)

    def stable_step(self) -> float:
        return self.time_step_factor * float(self.critical.min())

    # --- what the driver asks ---

    def sum_motion(self, sums: Array) -> None:
        motion.sum_motion(self.nodes, sums)

    def own_state(self) -> dict[str, AnyArray]:
        """Return what a method adds to ``state``."""
        return {}

    def state(self) -> dict[str, AnyArray]:
        material, shared, _ = self.states()
        nodes = {f"node_{name}": rows for name, rows in self.nodes._asdict().items() if name not in NOT_STORED}
        stored = {**material._asdict(), **shared._asdict(), **nodes, **self.own_state()}
        return {**stored, "critical": self.critical, "reactions": self.reactions}
