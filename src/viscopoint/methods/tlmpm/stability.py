"""How far a wave may run in a step: the highest frequency of the nodes, from the undeformed body.

ω² is the largest eigenvalue of stiffness over lumped mass. Of an isotropic solid of modulus M = K + 4G/3 the energy of
a strain is linear in G at constant M, so that no K and G give more than the two extremes do: M (tr ε)² at G = 0 and
3/2 M ε':ε' at K = 0. Both eigenvalues are found by power iteration; ``stable_length`` = 2 c/ω is what a wave may cross.

Under a uniform F, let v = F w: then tr ε of v in space is tr ε of w in the undeformed body, and |v|² >= |w|² over the
largest eigenvalue of C⁻¹. So the present one is the undeformed one times the smallest stretch; where F varies the
smallest of all is taken.
"""

from typing import Any

import numpy as np

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import PARTS, kernel
from viscopoint.kernels.slabs import COLOURS, coloured_slabs_of
from viscopoint.kernels.tensors import full, spherical, symmetric, trace
from viscopoint.methods.tlmpm.extension import Extension, multiply
from viscopoint.methods.tlmpm.interpolation import reference_gradient, scatter_stress
from viscopoint.methods.tlmpm.lattice import Lattice, stencil_at
from viscopoint.methods.tlmpm.points import Points

ROUNDS = 60
SHORT = 0.03  # by which the estimate may fall short after so many rounds


def stable_length(
    points: Points, lattice: Lattice, shape: Any, extension: Extension, mass: Array, free: Array, density: float
) -> float:
    """Return 2 c/ω of the undeformed body [mm].

    Args:
        points: the points.
        lattice: the grid.
        shape: the shape function.
        extension: which nodes are in their own right.
        mass: theirs [g].
        free: 1 where symmetry lets them move, 0 where not, [n, 3].
        density: g/mm^3.
    """
    per_mass = density / mass[:, None]
    highest = 0.0
    for lame, shear in ((1.0, 0.0), (-0.5, 1.5)):
        motion = free * np.random.default_rng(1).normal(size=free.shape)
        square = 0.0
        for _ in range(ROUNDS):
            motion /= np.sqrt((motion**2 / per_mass).sum())
            multiply(extension.out, motion, lattice.velocity)
            lattice.force[:] = 0.0
            scatter_stiffness(points, lattice, shape, lame, shear)
            force = np.empty_like(motion)
            multiply(extension.back, lattice.force, force)
            square = float((motion * force).sum())
            motion = free * force * per_mass
        highest = max(highest, square)
    lattice.velocity[:] = 0.0
    lattice.force[:] = 0.0
    return 2.0 / np.sqrt((1.0 + SHORT) * highest)


@kernel(PARTS, COLOURS)
def scatter_stiffness(part: int, points: Points, lattice: Lattice, shape: Any, lame: float, shear: float) -> None:
    """Add to the nodes Σ V_p s ∇0 N of the stress s = λ (tr ε) I + 2μ ε, ``lame`` and ``shear``."""
    start = lattice.start
    for slab in coloured_slabs_of(start, len(start) - 1, part):
        for q in range(lattice.cells[start[slab]], lattice.cells[start[slab + 1]]):
            p: int = lattice.order[q]
            at = stencil_at(points, p, lattice, shape)
            a = reference_gradient(lattice.velocity, lattice, at, 1.0)
            strain, size = symmetric(a), points.volume[p]
            stress = spherical(size * lame * trace(strain)) + (size * shear) * strain
            scatter_stress(lattice.force, lattice, at, full(stress))
