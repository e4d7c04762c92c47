"""Control of the hourglass modes of one-point elements (Flanagan & Belytschko 1981).

The four modes that a uniform strain does not see deform an element without stress. A force h on each resists it; as it
works on the modes less what the mean gradient explains of them, it disturbs neither uniform strain nor rotation.
"""

import math
from typing import Any, NamedTuple

from viscopoint.fem.hexahedron import Hourglass
from viscopoint.jit import generic, implements, inline
from viscopoint.tensors import Matrix, Vec, applied, columns, product, total


class ViscousControl(NamedTuple):
    """h = -16 coefficient rho c (V/l) q', the damper of DYNA3D: LS-DYNA's form 1 (with l for the cube root of V).

    A force is that of the motion before it, and acts on half a step before and half a step after. Its work over a step
    is the mean of h_n·q' and h_n+1·q'; it remembers the power P_n of the step before, as h_n·q' = sqrt(P_n P_n+1) up to
    the second order in the step.
    """

    coefficient: float = 0.1  # Q_hg

    @property
    def memory(self) -> int:
        return 1


class StiffnessControl(NamedTuple):
    """h' = -coefficient M (V/l²) q', turning with the element: a spring on each mode.

    M = K + 4G/3 of a sudden strain. With coefficient 1 a mode would vibrate with c/l.
    """

    coefficient: float = 0.05

    @property
    def memory(self) -> int:
        return 12


HOURGLASS: dict[str, type[ViscousControl] | type[StiffnessControl]] = {
    "viscous": ViscousControl,
    "stiffness": StiffnessControl,
}


@generic
def resist(
    control: Any,
    memory: tuple[float, ...],
    slip: Hourglass,
    turn: Matrix,
    dt: float,
    mass: float,
    sound: float,
    length: float,
) -> tuple[Hourglass, tuple[float, ...], float]:
    """Return the forces on the four modes, the memory of them and the work done against them [mJ].

    Args:
        control: the control.
        memory: what it kept from the step before.
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
    memory: tuple[float, ...],
    slip: Hourglass,
    turn: Matrix,
    dt: float,
    mass: float,
    sound: float,
    length: float,
) -> tuple[Hourglass, tuple[float, ...], float]:
    force = scaled(-16.0 * control.coefficient * mass * sound / (length * dt), slip)
    loss = -work(force, slip) / dt
    return force, (loss,), 0.5 * dt * (math.sqrt(memory[0] * loss) + loss)


@implements(resist, StiffnessControl)
def spring(
    control: StiffnessControl,
    memory: tuple[float, ...],
    slip: Hourglass,
    turn: Matrix,
    dt: float,
    mass: float,
    sound: float,
    length: float,
) -> tuple[Hourglass, tuple[float, ...], float]:
    by = columns(turn)
    before = Hourglass(
        applied(by, Vec(memory[0], memory[1], memory[2])),
        applied(by, Vec(memory[3], memory[4], memory[5])),
        applied(by, Vec(memory[6], memory[7], memory[8])),
        applied(by, Vec(memory[9], memory[10], memory[11])),
    )
    change = scaled(-control.coefficient * mass * (sound / length) ** 2, slip)
    force = added(before, change)
    kept = (
        force.eta_zeta.x, force.eta_zeta.y, force.eta_zeta.z,
        force.zeta_xi.x, force.zeta_xi.y, force.zeta_xi.z,
        force.xi_eta.x, force.xi_eta.y, force.xi_eta.z,
        force.all.x, force.all.y, force.all.z,
    )  # fmt: skip
    return force, kept, -work(added(before, scaled(0.5, change)), slip)


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
