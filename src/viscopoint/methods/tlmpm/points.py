"""The material points of a body that keeps its neighbours: all its state but the motion, which the nodes have."""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Real
from viscopoint.materials.block import MaterialBlock
from viscopoint.model.points import MaterialState, VolumeState, material_at_rest, volume_at_rest


class Points(NamedTuple):
    """Row p is the same piece of material from start to end. Points of no volume are tracers.

    In single precision X and x stay double; F in double brought nothing that could be measured (docs/precision.md).
    """

    reference: Array  # [p, 3], X, where the point stands in the background grid for good, mm
    position: Array  # [p, 3], x, mm
    volume: Array  # [p], reference volume, mm^3
    deformation: Array  # [p, 9], F, row by row
    material: MaterialState  # [p]
    shared: VolumeState  # [p]; J is what the material sees: det F, or its mean over a cell


def at_rest(position: Array, volume: Array, material: MaterialBlock, real: Real = np.float64) -> Points:
    """Return stress-free points."""
    count = len(position)
    return Points(
        reference=position.copy(),
        position=position.copy(),
        volume=volume.astype(real),
        deformation=np.tile(np.eye(3, dtype=real).ravel(), (count, 1)),
        material=material_at_rest(material, count, real),
        shared=volume_at_rest(count, real, real),
    )
