"""What a point reads from its nodes and adds to them, with gradients in the undeformed body."""

from typing import Any

from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import inline
from viscopoint.kernels.tensors import Matrix
from viscopoint.kernels.vectors import Float4
from viscopoint.methods.mpm.stencil import (
    gradient,
    interpolate_with_gradient,
    scatter_gradient,
    scatter_hoop_force,
    with_hoop_strain,
)
from viscopoint.methods.tlmpm.lattice import Lattice
from viscopoint.methods.tlmpm.points import Points


@inline
def reference_gradient(field: Array, lattice: Any, at: Any, scale: float) -> Matrix:
    """Return ``scale`` Σ field ⊗ ∇0 N at a point."""
    return per_length(gradient(field, lattice, at, scale), lattice)


@inline
def per_length(a: Matrix, lattice: Any) -> Matrix:
    """Return a gradient per cell as one per length."""
    x, y, z = lattice.per_x, lattice.per_y, lattice.per_z
    return Matrix(x * a.xx, y * a.xy, z * a.xz, x * a.yx, y * a.yy, z * a.yz, x * a.zx, y * a.zy, z * a.zz)


@inline
def move_and_deform(points: Points, p: int, lattice: Lattice, velocity: Array, at: Any, dt: float) -> Matrix:
    """Move point p with the nodes, x += Δt Σ N v_i, and return its change of F, Δt Σ v_i ⊗ ∇0 N."""
    mean, x, y, z = interpolate_with_gradient(velocity, lattice, at)
    points.position[p, 0] += dt * mean.x
    points.position[p, 1] += dt * mean.y
    points.position[p, 2] += dt * mean.z
    change = Matrix(
        dt * x.x, dt * y.x, dt * z.x,
        dt * x.y, dt * y.y, dt * z.y,
        dt * x.z, dt * y.z, dt * z.z,
    )  # fmt: skip
    return per_length(with_hoop_strain(at, mean, dt, change), lattice)


@inline
def scatter_stress(force: Array, lattice: Lattice, at: Any, s: Matrix) -> None:
    """Add s · ∇0 N to the nodes' force."""
    x, y, z = lattice.per_x, lattice.per_y, lattice.per_z
    scatter_gradient(
        force, lattice, at,
        x * Float4(s.xx, s.yx, s.zx, 0.0), y * Float4(s.xy, s.yy, s.zy, 0.0), z * Float4(s.xz, s.yz, s.zz, 0.0),
    )  # fmt: skip
    scatter_hoop_force(at, force, lattice, y * s.yy)
