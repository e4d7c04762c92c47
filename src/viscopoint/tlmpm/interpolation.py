"""What a point reads from its nodes and adds to them, with gradients in the undeformed body."""

from typing import Any

import numpy as np

from viscopoint.arrays import Array
from viscopoint.jit import inline
from viscopoint.mpm.support import Support, gradient, pull_in
from viscopoint.tensors import Matrix
from viscopoint.tlmpm.lattice import Lattice


@inline
def reference_gradient(field: Array, lattice: Any, at: Support, scale: float) -> Matrix:
    """Return ``scale`` Σ field ⊗ ∇0 N at a point."""
    a = gradient(field, lattice, at, scale)
    x, y, z = lattice.per_x, lattice.per_y, lattice.per_z
    return Matrix(x * a.xx, y * a.xy, z * a.xz, x * a.yx, y * a.yy, z * a.yz, x * a.zx, y * a.zy, z * a.zz)


@inline
def mean(field: Array, lattice: Lattice, at: Support) -> tuple[float, float, float]:
    """Return Σ N field at a point."""
    x, y, z = 0.0, 0.0, 0.0
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * lattice.ny + np.uint64(b)) * lattice.nx
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                w = at.wx[a] * at.wy[b] * at.wz[c]
                x += w * field[node, 0]
                y += w * field[node, 1]
                z += w * field[node, 2]
    return x, y, z


@inline
def push(force: Array, lattice: Lattice, at: Support, scale: float, s: Matrix) -> None:
    """Add ``scale`` s · ∇0 N to the nodes' force."""
    x, y, z = scale * lattice.per_x, scale * lattice.per_y, scale * lattice.per_z
    xx, xy, xz, yx, yy, yz = x * s.xx, y * s.xy, z * s.xz, x * s.yx, y * s.yy, z * s.yz
    zx, zy, zz = x * s.zx, y * s.zy, z * s.zz
    for c in range(len(at.wz)):
        for b in range(len(at.wy)):
            row = at.first + (np.uint64(c) * lattice.ny + np.uint64(b)) * lattice.nx
            for a in range(len(at.wx)):
                node = row + np.uint64(a)
                gx = at.dx[a] * at.wy[b] * at.wz[c]
                gy = at.wx[a] * at.dy[b] * at.wz[c]
                gz = at.wx[a] * at.wy[b] * at.dz[c]
                force[node, 0] += xx * gx + xy * gy + xz * gz
                force[node, 1] += yx * gx + yy * gy + yz * gz
                force[node, 2] += zx * gx + zy * gy + zz * gz
                force[node, 3] += 0.0  # keeps the row one vector
    pull_in(at, force, lattice, yy)
