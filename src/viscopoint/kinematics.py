"""From a step's velocity gradient to strain, rotation and volume, objectively (Hughes & Winget 1980)."""

from viscopoint.jit import inline
from viscopoint.tensors import Matrix, Sym, spun


@inline
def determinant(a: Matrix) -> float:
    """Return det a."""
    return a.xx * (a.yy * a.zz - a.yz * a.zy) - a.xy * (a.yx * a.zz - a.yz * a.zx) + a.xz * (a.yx * a.zy - a.yy * a.zx)


@inline
def increments(gradient: Matrix) -> tuple[Sym, Matrix, float]:
    """Split the displacement gradient of a step into strain, rotation and volume ratio.

    ``gradient`` is A = ∂Δu/∂x at the start of the step, so that F ← (I + A) F. Taken at mid-step,
    G = A (I + A/2)⁻¹, its symmetric part is the strain increment and the Cayley transform of its antisymmetric part
    the rotation Q = (I - W/2)⁻¹ (I + W/2): a rigid rotation of any size gives no strain and turns stresses exactly.
    The strain, which belongs to mid-step, follows the stress through the rest of the rotation to first order in W/2:
    that makes the update of second order in the step.

    Returns:
        The strain increment at the end of the step, the rotation Q and the volume ratio det(I + A).
    """
    xx, yy, zz = 1.0 + 0.5 * gradient.xx, 1.0 + 0.5 * gradient.yy, 1.0 + 0.5 * gradient.zz
    half = Matrix(  # I + A/2
        xx, 0.5 * gradient.xy, 0.5 * gradient.xz,
        0.5 * gradient.yx, yy, 0.5 * gradient.yz,
        0.5 * gradient.zx, 0.5 * gradient.zy, zz,
    )  # fmt: skip
    # G = A (I + A/2)⁻¹ = 2 (I - (I + A/2)⁻¹)
    scale = -2.0 / determinant(half)
    gxx = 2.0 + scale * (half.yy * half.zz - half.yz * half.zy)
    gyy = 2.0 + scale * (half.xx * half.zz - half.xz * half.zx)
    gzz = 2.0 + scale * (half.xx * half.yy - half.xy * half.yx)
    gxy = scale * (half.xz * half.zy - half.xy * half.zz)
    gyx = scale * (half.yz * half.zx - half.yx * half.zz)
    gyz = scale * (half.xz * half.yx - half.xx * half.yz)
    gzy = scale * (half.xy * half.zx - half.xx * half.zy)
    gxz = scale * (half.xy * half.yz - half.xz * half.yy)
    gzx = scale * (half.yx * half.zy - half.yy * half.zx)
    strain = Sym(gxx, gyy, gzz, 0.5 * (gxy + gyx), 0.5 * (gyz + gzy), 0.5 * (gzx + gxz))
    x, y, z = 0.25 * (gzy - gyz), 0.25 * (gxz - gzx), 0.25 * (gyx - gxy)  # of W/2
    stretch = Matrix(
        1.0 + gradient.xx, gradient.xy, gradient.xz,
        gradient.yx, 1.0 + gradient.yy, gradient.yz,
        gradient.zx, gradient.zy, 1.0 + gradient.zz,
    )  # fmt: skip
    return strain + spun(strain, x, y, z), cayley(x, y, z), determinant(stretch)


@inline
def cayley(x: float, y: float, z: float) -> Matrix:
    """Return Q = (I - H)⁻¹ (I + H) for the antisymmetric H with axial vector (x, y, z)."""
    scale = 2.0 / (1.0 + x * x + y * y + z * z)
    return Matrix(
        1.0 - scale * (y * y + z * z), scale * (x * y - z), scale * (x * z + y),
        scale * (x * y + z), 1.0 - scale * (x * x + z * z), scale * (y * z - x),
        scale * (x * z - y), scale * (y * z + x), 1.0 - scale * (x * x + y * y),
    )  # fmt: skip
