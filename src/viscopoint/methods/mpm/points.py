"""The material points: all state of the body, as arrays that kernels read by name."""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Real
from viscopoint.materials.block import MaterialBlock
from viscopoint.model.points import MaterialState, VolumeState, material_at_rest, volume_at_rest


class Points(NamedTuple):
    """Row p is the same piece of material from start to end.

    Points are never re-ordered: neighbours in a solid stay neighbours, so that memory stays local by itself. In single
    precision x, v and J stay double: they are sums of small steps, and the account of momentum is only as good as v.
    """

    position: Array  # [p, 3], mm
    velocity: Array  # [p, 3], mm/ms
    grid_velocity: Array  # [p, 3], of the grid at the point, with which it moves, mm/ms
    mass: Array  # [p], g
    volume: Array  # [p], reference volume, mm^3
    material: MaterialState  # [p]
    shared: VolumeState  # [p]
    stretch: Array  # [p, 3], of the material along x, y and z; no rows where nobody asks for it
    affine: Array  # [p, 9], what a transfer keeps of the motion around the point; [0, 9] if it keeps nothing
    affine_energy: Array  # [p], kinetic energy per mass of that motion, mm^2/ms^2; no rows if there is none


def at_rest(
    position: Array, mass: Array, volume: Array, material: MaterialBlock, affine: bool = False, real: Real = np.float64
) -> Points:
    """Return stress-free points without velocity, with memory for ``affine`` motion if the transfer has such."""
    count = len(position)
    return Points(
        position=position.copy(),
        velocity=np.zeros((count, 3)),
        grid_velocity=np.zeros((count, 3), real),
        mass=mass.astype(real),
        volume=volume.astype(real),
        material=material_at_rest(material, count, real),
        shared=volume_at_rest(count, real),
        stretch=np.ones((0, 3), real),
        affine=np.zeros((count if affine else 0, 9), real),
        affine_energy=np.zeros(count if affine else 0, real),
    )
