"""Control of the hourglass modes of one-point elements (Flanagan & Belytschko 1981).

The four modes that a uniform strain does not see deform an element without stress. A force h on each resists it; as it
works on the modes less what the mean gradient explains of them, it disturbs neither uniform strain nor rotation. A
force acts on half a step before and half a step after it was found, so its work over a step is (h_n + h_n+1) · q / 2.
"""

from typing import Any, NamedTuple

from viscopoint.kernels.jit import generic, implements, inline
from viscopoint.kernels.tensors import Matrix, Vec, applied, columns, fused_product, product, total
from viscopoint.methods.fem.hexahedron import Hourglass


class ViscousControl(NamedTuple):
    """h = -16 coefficient rho c (V/l) q', the damper of DYNA3D: LS-DYNA's form 1 (with l for the cube root of V)."""

    coefficient: float = 0.1  # Q_hg


class StiffnessControl(NamedTuple):
    """h' = -coefficient M (V/l²) q', turning with the element: a spring on each mode.

    M = K + 4G/3 of a sudden strain. With coefficient 1 a mode would vibrate with c/l.
    """

    coefficient: float = 0.05


HOURGLASS: dict[str, type[ViscousControl] | type[StiffnessControl]] = {
    "viscous": ViscousControl,
    "stiffness": StiffnessControl,
}


@generic
def resist(
    control: Any, before: Hourglass, slip: Hourglass, turn: Matrix, dt: float, mass: float, sound: float, length: float
) -> tuple[Hourglass, float]:
    """Return the forces on the four modes [N] and the work done against them [mJ].

    Args:
        control: the control.
        before: the forces of the step before [N].
        slip: what the modes moved in the step [mm].
        turn: rotation over the step.
        dt: step [ms].
        mass: of the element [g].
        sound: wave speed [mm/ms].
        length: the element's smallest [mm].
    """
    raise NotImplementedError


@implements(resist, ViscousControl)
def damp(
    control: ViscousControl,
    before: Hourglass,
    slip: Hourglass,
    turn: Matrix,
    dt: float,
    mass: float,
    sound: float,
    length: float,
) -> tuple[Hourglass, float]:
    force = scaled(-16.0 * control.coefficient * mass * sound / (length * dt), slip)
    return force, -0.5 * work(added(before, force), slip)


@implements(resist, StiffnessControl)
def spring(
    control: StiffnessControl,
    before: Hourglass,
    slip: Hourglass,
    turn: Matrix,
    dt: float,
    mass: float,
    sound: float,
    length: float,
) -> tuple[Hourglass, float]:
    start = turned(before, turn)
    change = scaled(-control.coefficient * mass * (sound / length) ** 2, slip)
    return added(start, change), -work(added(start, scaled(0.5, change)), slip)


@inline
def alone(force: Vec) -> Hourglass:
    """Return the only mode of a quadrilateral as one of four; the others are nil."""
    none = Vec(0.0, 0.0, 0.0)
    return Hourglass(none, none, none, force)


@inline
def recalled(memory: tuple[float, ...]) -> Hourglass:
    """Return the forces of the step before."""
    m = memory
    return Hourglass(Vec(m[0], m[1], m[2]), Vec(m[3], m[4], m[5]), Vec(m[6], m[7], m[8]), Vec(m[9], m[10], m[11]))


@inline
def remembered(force: Hourglass) -> tuple[float, ...]:
    """Return what to keep of the forces for the next step."""
    a, b, c, d = force
    return (a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z)


@inline
def turned(force: Hourglass, turn: Matrix) -> Hourglass:
    """Return the forces turned with the element."""
    by = columns(turn)
    return Hourglass(
        applied(by, force.eta_zeta), applied(by, force.zeta_xi), applied(by, force.xi_eta), applied(by, force.all)
    )


@inline
def scaled(factor: float, of: Hourglass) -> Hourglass:
    """Return factor times the modes."""
    return Hourglass(factor * of.eta_zeta, factor * of.zeta_xi, factor * of.xi_eta, factor * of.all)


@inline
def added(a: Hourglass, b: Hourglass) -> Hourglass:
    """Return the sum of both."""
    return Hourglass(a.eta_zeta + b.eta_zeta, a.zeta_xi + b.zeta_xi, a.xi_eta + b.xi_eta, a.all + b.all)


@inline
def work(force: Hourglass, slip: Hourglass) -> float:
    """Return Σ h · q."""
    linear = fused_product(product(force.eta_zeta, slip.eta_zeta), force.zeta_xi, slip.zeta_xi)
    return total(fused_product(fused_product(linear, force.xi_eta, slip.xi_eta), force.all, slip.all))
