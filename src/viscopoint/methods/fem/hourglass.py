"""Control of the hourglass modes of one-point elements (Flanagan & Belytschko 1981).

The four modes that a uniform strain does not see deform an element without stress. A force h on each resists it; as it
works on the modes less what the mean gradient explains of them, it disturbs neither uniform strain nor rotation. A
force acts on half a step before and half a step after it was found, so its work over a step is (h_n + h_n+1) · q / 2.
"""

from typing import Any, NamedTuple

from viscopoint.discovery import Registry
from viscopoint.kernels.jit import generic, implements, inline
from viscopoint.kernels.tensors import Matrix, applied, columns
from viscopoint.methods.fem.cells import Hourglass, dot_hourglass

HOURGLASS: Registry[Any] = Registry()


@HOURGLASS.register("viscous")
class ViscousControl(NamedTuple):
    """h = -16 coefficient rho c (V/l) q', the damper of DYNA3D: LS-DYNA's form 1 (with l for the cube root of V)."""

    coefficient: float = 0.1  # Q_hg


@HOURGLASS.register("stiffness")
class StiffnessControl(NamedTuple):
    """h' = -coefficient M (V/l²) q', turning with the element: a spring on each mode.

    M = K + 4G/3 of a sudden strain. With coefficient 1 a mode would vibrate with c/l.
    """

    coefficient: float = 0.05


@generic
def hourglass_force(
    control: Any, before: Hourglass, motion: Hourglass, rotation: Matrix, dt: float, mass: float, sound: float,
    length: float,
) -> tuple[Hourglass, float]:  # fmt: skip
    """Return the forces on the hourglass modes [N] and the work done against them [mJ].

    Args:
        control: the control.
        before: the forces of the step before [N].
        motion: what the modes moved in the step [mm].
        rotation: over the step.
        dt: step [ms].
        mass: of the element [g].
        sound: wave speed [mm/ms].
        length: the element's smallest [mm].
    """
    raise NotImplementedError


@implements(hourglass_force, ViscousControl)
def damp(
    control: ViscousControl, before: Hourglass, motion: Hourglass, rotation: Matrix, dt: float, mass: float,
    sound: float, length: float,
) -> tuple[Hourglass, float]:  # fmt: skip
    force = scaled(-16.0 * control.coefficient * mass * sound / (length * dt), motion)
    return force, -0.5 * dot_hourglass(added(before, force), motion)


@implements(hourglass_force, StiffnessControl)
def spring(
    control: StiffnessControl, before: Hourglass, motion: Hourglass, rotation: Matrix, dt: float, mass: float,
    sound: float, length: float,
) -> tuple[Hourglass, float]:  # fmt: skip
    start = rotated_forces(before, rotation)
    increment = scaled(-control.coefficient * mass * (sound / length) ** 2, motion)
    return added(start, increment), -dot_hourglass(added(start, scaled(0.5, increment)), motion)


@inline
def rotated_forces(force: Hourglass, rotation: Matrix) -> Hourglass:
    """Return the forces turned with the element."""
    by = columns(rotation)
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
