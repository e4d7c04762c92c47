"""All state of a body of finite elements but the nodes' motion, as arrays that kernels read by name."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Array, Indices, Real
from viscopoint.kernels.jit import inline
from viscopoint.kernels.workspace import columns, store
from viscopoint.materials.block import MaterialBlock
from viscopoint.methods.fem.cells import corner_values
from viscopoint.model.nodes import Nodes
from viscopoint.model.points import (
    OWN,
    MaterialState,
    VolumeState,
    load_volume,
    material_at_rest,
    volume_at_rest,
)

# what an element has in the workspace, beside what its points have
TWELVE = (0.0,) * 12
(
    PLACE,  # of the corners, then of the modes; in the end the corners' forces
    FLOW,  # their velocity; then what the hourglass modes moved
    ON,  # forces on the modes
    WEIGHTS,  # ∇N at a point; or the forces on the hourglass modes
    REFERENCE,  # volume at the start
    VOLUME,  # present; not positive: turned inside out
    WHOLE,  # least volume of the element or its points, also at mid-step; not positive: turned inside out
    MEAN,  # Σ V tr σ / 3 over the points, V their reference volumes
    SHARPEST,  # what the points take of shear (``cells.sharpest``)
    POINT_REFERENCE,  # volume of a point at the start
    COUNTED,  # volume for which a point's energy is counted, over its present one
    STIFFEST,  # greatest K + 4G/3 of the points so far
    HOURGLASS_WORK,
    REST_STEP,  # longest stable step without bulk viscosity
    STEP_LENGTH,  # longest stable step
    _,
) = columns(24, 24, 21, 12, *(1,) * 11, first=OWN)


class Elements(NamedTuple):
    """What the elements carry; an element has one integration point, or one for each corner.

    Point k of element e is row q = e points + k of what the material has. In single precision all of it is: what moves
    are the nodes. With energies in double the energy balance closed no better.
    """

    corner: NDArray[np.uint32]  # [e, corners], nodes
    volume: Array  # [q], reference volume, mm^3
    material: MaterialState  # [q]
    shared: VolumeState  # [e]
    hourglass_force: Array  # [e, 12], on the hourglass modes, N; no rows where there are none
    hourglass_work: Array  # [e], taken by the hourglass control, mJ


def elements_at_rest(
    corner: Indices, volume: Array, material: MaterialBlock, hourglass: bool, real: Real = np.float64
) -> Elements:
    """Return stress-free elements; ``volume[e, k]`` says how many points each has."""
    count = len(corner)
    return Elements(
        corner=corner.astype(np.uint32),
        volume=volume.ravel().astype(real),
        material=material_at_rest(material, volume.size, real),
        shared=volume_at_rest(count, real, real),
        hourglass_force=np.zeros((count if hourglass else 0, 12), real),
        hourglass_work=np.zeros(count, real),
    )


@inline
def load_motion(nodes: Nodes, elements: Elements, e: int, cell: Any, work: Any, i: int) -> None:
    """Take the corners' places and velocities, and what element e has as a whole, to the workspace."""
    corner = elements.corner[e]
    store(work, PLACE, i, corner_values(cell, nodes.position, corner))
    store(work, FLOW, i, corner_values(cell, nodes.velocity, corner))
    load_volume(elements.shared, e, work, i)
