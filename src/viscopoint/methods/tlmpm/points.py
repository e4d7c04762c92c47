"""The material points of a body that keeps its neighbours: all its state but the motion, which the nodes have."""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Real
from viscopoint.kernels.jit import inline
from viscopoint.kernels.tensors import Matrix
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


@inline
def load_deformation(points: Points, p: int) -> Matrix:
    """Return F of point p."""
    f = points.deformation[p]
    return Matrix(f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8])


@inline
def store_deformation(points: Points, p: int, f: Matrix) -> None:
    """Store F of point p."""
    row = points.deformation[p]
    row[0], row[1], row[2] = f.xx, f.xy, f.xz
    row[3], row[4], row[5] = f.yx, f.yy, f.yz
    row[6], row[7], row[8] = f.zx, f.zy, f.zz
