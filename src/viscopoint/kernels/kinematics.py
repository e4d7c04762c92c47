"""From a step's velocity gradient to strain, rotation and volume, objectively (Hughes & Winget 1980)."""

from viscopoint.kernels.jit import inline
from viscopoint.kernels.tensors import Matrix, Sym, determinant, minor, spun, trace


@inline
def volume_ratio(gradient: Matrix) -> float:
    """Return det(I + A) of the displacement gradient A of a step, ∂Δu/∂x at its start, so that F ← (I + A) F."""
    return determinant(Matrix(
        1.0 + gradient.xx, gradient.xy, gradient.xz,
        gradient.yx, 1.0 + gradient.yy, gradient.yz,
        gradient.zx, gradient.zy, 1.0 + gradient.zz,
    ))  # fmt: skip


@inline
def at_mid_step(gradient: Matrix) -> Matrix:
    """Return G = A (I + A/2)⁻¹ = 2 (I - (I + A/2)⁻¹), the displacement gradient A taken at mid-step."""
    xx, yy, zz = 1.0 + 0.5 * gradient.xx, 1.0 + 0.5 * gradient.yy, 1.0 + 0.5 * gradient.zz
    half = Matrix(  # I + A/2
        xx, 0.5 * gradient.xy, 0.5 * gradient.xz,
        0.5 * gradient.yx, yy, 0.5 * gradient.yz,
        0.5 * gradient.zx, 0.5 * gradient.zy, zz,
    )  # fmt: skip
    scale = -2.0 / determinant(half)
    return Matrix(
        2.0 + scale * minor(half.yy, half.yz, half.zy, half.zz),
        scale * minor(half.xz, half.xy, half.zz, half.zy),
        scale * minor(half.xy, half.xz, half.yy, half.yz),
        scale * minor(half.yz, half.yx, half.zz, half.zx),
        2.0 + scale * minor(half.xx, half.xz, half.zx, half.zz),
        scale * minor(half.xz, half.xx, half.yz, half.yx),
        scale * minor(half.yx, half.yy, half.zx, half.zy),
        scale * minor(half.xy, half.xx, half.zy, half.zx),
        2.0 + scale * minor(half.xx, half.xy, half.yx, half.yy),
    )


@inline
def strain_and_rotation(gradient: Matrix) -> tuple[Sym, Matrix]:
    """Split the displacement gradient G of a step, taken at mid-step, into strain and rotation.

    Its symmetric part is the strain increment and the Cayley transform of its antisymmetric part the rotation
    Q = (I - W/2)⁻¹ (I + W/2): a rigid rotation of any size gives no strain and turns stresses exactly. The strain,
    which belongs to mid-step, follows the stress through the rest of the rotation to first order in W/2: that makes
    the update of second order in the step.

    Returns:
        The strain increment at the end of the step and the rotation Q.
    """
    g = gradient
    strain = Sym(g.xx, g.yy, g.zz, 0.5 * (g.xy + g.yx), 0.5 * (g.yz + g.zy), 0.5 * (g.zx + g.xz))
    x, y, z = 0.25 * (g.zy - g.yz), 0.25 * (g.xz - g.zx), 0.25 * (g.yx - g.xy)  # of W/2
    return strain + spun(strain, x, y, z), cayley(x, y, z)


@inline
def cayley(x: float, y: float, z: float) -> Matrix:
    """Return Q = (I - H)⁻¹ (I + H) for the antisymmetric H with axial vector (x, y, z)."""
    scale = 2.0 / (1.0 + x * x + y * y + z * z)
    return Matrix(
        1.0 - scale * (y * y + z * z), scale * (x * y - z), scale * (x * z + y),
        scale * (x * y + z), 1.0 - scale * (x * x + z * z), scale * (y * z - x),
        scale * (x * z - y), scale * (y * z + x), 1.0 - scale * (x * x + y * y),
    )  # fmt: skip


@inline
def volumetric(gradient: Matrix) -> float:
    """Return tr Δε of the displacement gradient G of a step, taken at mid-step, to the last bit that of the strain."""
    strain, _ = strain_and_rotation(gradient)
    return trace(strain)


@inline
def rotation_of(gradient: Matrix) -> Matrix:
    """Return the rotation Q of the displacement gradient G of a step, taken at mid-step."""
    g = gradient
    return cayley(0.25 * (g.zy - g.yz), 0.25 * (g.xz - g.zx), 0.25 * (g.yx - g.xy))
