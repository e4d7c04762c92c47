"""What a block of hexahedra has in the workspace while they answer to the nodes' motion."""

from typing import Any

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import inline
from viscopoint.kernels.rows import load, store
from viscopoint.kernels.tensors import components, read, write
from viscopoint.kernels.workspace import HISTORY, columns, keep, kept
from viscopoint.materials import History
from viscopoint.methods.fem.hexahedron import corner_values
from viscopoint.methods.fem.state import Elements, Nodes

SIX, NINE, TWELVE, FLAT, CORNERS = (0.0,) * 6, (0.0,) * 9, (0.0,) * 12, (0.0,) * 21, (0.0,) * 24
(
    PLACE,  # of the corners, then of the modes; in the end the corners' forces
    FLOW,  # their velocity
    ON,  # forces on the modes
    STRESS,  # σ
    MEMORY,  # forces on the hourglass modes
    REFERENCE,  # volume at the start
    VOLUME,  # present; not positive: turned inside out
    MID_VOLUME,  # at mid-step
    JACOBIAN,  # J
    BEFORE,  # J at the step's start
    VISCOUS,  # pressure
    LOSS,
    HYPOELASTIC,
    VISCOUS_LOSS,
    HOURGLASS,  # work
    SWELLING,  # tr Δε of the whole element
    MEAN,  # Σ det tr σ / 3 over the points
    SHARPEST,  # greatest (areas²/det) over the points
    WHOLE,  # least det of the points, 1 at most: not positive if one is turned inside out
    REST_STEP,  # longest stable step without bulk viscosity
    STEP_LENGTH,  # longest stable step
    _,
) = columns(24, 24, 21, 6, 12, *(1,) * 16)


@inline
def recall_motion(nodes: Nodes, elements: Elements, e: int, work: Any, i: int) -> None:
    """Take the corners' places and velocities, and what element e has as a whole, to the workspace."""
    corner = elements.corner[e]
    keep(work, PLACE, i, corner_values(nodes.position, corner))
    keep(work, FLOW, i, corner_values(nodes.velocity, corner))
    keep(work, BEFORE, i, elements.jacobian[e])
    keep(work, VISCOUS, i, elements.viscous_pressure[e])
    keep(work, VISCOUS_LOSS, i, elements.viscous_loss[e])


@inline
def remember_whole(elements: Elements, e: int, work: Any, i: int) -> None:
    """Give element e back what it has as a whole."""
    elements.jacobian[e] = kept(work, JACOBIAN, i, 0.0)
    elements.viscous_pressure[e] = kept(work, VISCOUS, i, 0.0)
    elements.viscous_loss[e] = kept(work, VISCOUS_LOSS, i, 0.0)


@inline
def recall_point(elements: Elements, e: int, k: int, work: Any, i: int, blank: History) -> None:
    """Take what integration point k of element e has to the workspace."""
    keep(work, STRESS, i, components(read(elements.stress[e, k])))
    keep(work, HISTORY, i, load(elements.history[e, k], blank))
    keep(work, LOSS, i, elements.dissipated[e, k])
    keep(work, HYPOELASTIC, i, elements.hypoelastic[e, k])


@inline
def remember_point(elements: Elements, e: int, k: int, work: Any, i: int, blank: History) -> None:
    """Give integration point k of element e back what it has."""
    write(elements.stress[e, k], read(kept(work, STRESS, i, SIX)))
    store(elements.history[e, k], kept(work, HISTORY, i, blank))
    elements.dissipated[e, k] = kept(work, LOSS, i, 0.0)
    elements.hypoelastic[e, k] = kept(work, HYPOELASTIC, i, 0.0)


@inline
def spread(force: Array, corner: Any, work: Any, i: int) -> None:
    """Add the corners' forces to those of the nodes ``force[n, 3]``."""
    forces = kept(work, PLACE, i, CORNERS)
    for k in range(8):
        force[corner[k], 0] += forces[3 * k]
        force[corner[k], 1] += forces[3 * k + 1]
        force[corner[k], 2] += forces[3 * k + 2]
