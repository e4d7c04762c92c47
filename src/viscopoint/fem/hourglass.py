"""Control of the hourglass modes of one-point elements (Flanagan & Belytschko 1981).

The four modes that a uniform strain does not see deform an element without stress. A force h on each resists it; as it
works on the modes less what the mean gradient explains of them, it disturbs neither uniform strain nor rotation. A
force acts on half a step before and half a step after it was found, so its work over a step is (h_n + h_n+1) · q / 2.
"""

from typing import Any, NamedTuple

from viscopoint.arrays import Array
from viscopoint.fem.hexahedron import Hourglass
from viscopoint.jit import generic, implements, inline
from viscopoint.tensors import Matrix, Vec, applied, columns, fetch, product, put, total


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
def recalled(memory: Array, element: Any) -> Hourglass:
    """Return the forces of the step before."""
    first = 4 * element
    return Hourglass(fetch(memory, first), fetch(memory, first + 1), fetch(memory, first + 2), fetch(memory, first + 3))


@inline
def remember(memory: Array, element: Any, force: Hourglass) -> None:
    """Keep the forces for the next step."""
    first = 4 * element
    put(memory, first, force.eta_zeta)
    put(memory, first + 1, force.zeta_xi)
    put(memory, first + 2, force.xi_eta)
    put(memory, first + 3, force.all)


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
    return total(
        product(force.eta_zeta, slip.eta_zeta)
        + product(force.zeta_xi, slip.zeta_xi)
        + product(force.xi_eta, slip.xi_eta)
        + product(force.all, slip.all)
    )
