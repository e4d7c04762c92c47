"""The material points: all state of the body, as arrays that kernels read by name."""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Real


class Points(NamedTuple):
    """Row p is the same piece of material from start to end.

    Points are never re-ordered: neighbours in a solid stay neighbours, so that memory stays local by itself. In single
    precision x, v and J stay double: they are sums of small steps, and the account of momentum is only as good as v.
    """

    position: Array  # [p, 3], mm
    velocity: Array  # [p, 3], mm/ms
    drift: Array  # [p, 3], velocity of the grid at the point, with which it moves, mm/ms
    mass: Array  # [p], g
    volume: Array  # [p], reference volume, mm^3
    jacobian: Array  # [p], J
    stress: Array  # [p, 6], Cauchy, xx yy zz xy yz zx, MPa
    viscous_pressure: Array  # [p], of the bulk viscosity, MPa
    history: Array  # [p, h], the law's
    dissipated: Array  # [p], by the law per reference volume, mJ/mm^3
    hypoelastic: Array  # [p], taken by the law as volume changes under shear, per reference volume, mJ/mm^3
    viscous_loss: Array  # [p], by the bulk viscosity per reference volume, mJ/mm^3
    stretch: Array  # [p, 3], of the material along x, y and z; no rows where nobody asks for it
    affine: Array  # [p, 9], what a transfer keeps of the motion around the point; [0, 9] if it keeps nothing
    affine_energy: Array  # [p], kinetic energy per mass of that motion, mm^2/ms^2; no rows if there is none


def at_rest(
    position: Array, mass: Array, volume: Array, history_size: int, affine: bool = False, real: Real = np.float64
) -> Points:
    """Return stress-free points without velocity, with memory for ``affine`` motion if the transfer has such."""
    count = len(position)
    return Points(
        position=position.copy(),
        velocity=np.zeros((count, 3)),
        drift=np.zeros((count, 3), real),
        mass=mass.astype(real),
        volume=volume.astype(real),
        jacobian=np.ones(count),
        stress=np.zeros((count, 6), real),
        viscous_pressure=np.zeros(count, real),
        history=np.zeros((count, history_size), real),
        dissipated=np.zeros(count, real),
        hypoelastic=np.zeros(count, real),
        viscous_loss=np.zeros(count, real),
        stretch=np.ones((0, 3), real),
        affine=np.zeros((count if affine else 0, 9), real),
        affine_energy=np.zeros(count if affine else 0, real),
    )
