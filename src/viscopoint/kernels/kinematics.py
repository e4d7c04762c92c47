"""From a step's velocity gradient to strain, rotation and volume, objectively (Hughes & Winget 1980)."""

from viscopoint.kernels.jit import inline
from viscopoint.kernels.tensors import (
    IDENTITY,
    Matrix,
    Sym,
    added,
    cofactor,
    determinant,
    spun,
    symmetric,
    times,
    times_transposed,
    trace,
    transposed,
)


@inline
def volume_ratio(gradient: Matrix) -> float:
    """Return det(I + A) of the displacement gradient A of a step, ∂Δu/∂x at its start, so that F ← (I + A) F."""
    return determinant(added(IDENTITY, 1.0, gradient))


@inline
def at_mid_step(gradient: Matrix) -> Matrix:
    """Return G = A (I + A/2)⁻¹ = 2 (I - (I + A/2)⁻¹), the displacement gradient A taken at mid-step."""
    half = added(IDENTITY, 0.5, gradient)
    c, scale = cofactor(half), -2.0 / determinant(half)
    return Matrix(
        2.0 + scale * c.xx, scale * c.yx, scale * c.zx,
        scale * c.xy, 2.0 + scale * c.yy, scale * c.zy,
        scale * c.xz, scale * c.yz, 2.0 + scale * c.zz,
    )  # fmt: skip


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
    strain = symmetric(gradient)
    x, y, z = half_spin(gradient)
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
    x, y, z = half_spin(gradient)
    return cayley(x, y, z)


@inline
def half_spin(gradient: Matrix) -> tuple[float, float, float]:
    """Return the axial vector of W/2, half the antisymmetric part of G."""
    g = gradient
    return 0.25 * (g.zy - g.yz), 0.25 * (g.xz - g.zx), 0.25 * (g.yx - g.xy)


@inline
def deformed(before: Matrix, gradient: Matrix, jacobian: float) -> Matrix:
    """Return F at the end of the step, (I - G/2)⁻¹ (I + G/2) F of the gradient G at mid-step, scaled to ``jacobian``.

    Where points share a dilatation, their J is not what their own motion makes of it.
    """
    ahead, back = added(IDENTITY, 0.5, gradient), added(IDENTITY, -0.5, gradient)
    now = times(times(transposed(cofactor(back)), ahead), before)  # times det(I - G/2), which the scale takes out
    return times_transposed((jacobian / determinant(now)) ** (1.0 / 3.0), now, IDENTITY)
