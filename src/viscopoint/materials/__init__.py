"""Constitutive laws: one short file each, behind the same few operations.

A law is a NamedTuple of its parameters, in g, mm, ms (so MPa). It also says

- ``density`` [g/mm³],
- ``instantaneous_modulus`` [MPa]: K + 4G/3 of a sudden strain, which bounds the stable step,
- ``history_fields``: name and number of components of each group of history values,

and implements the operations declared below. Laws know nothing of points, elements or files; strain increment and
rotation come in, Cauchy stress goes out. A file put into this folder is found by itself: see CONTRIBUTING.
"""

from typing import Any, Protocol

from viscopoint.discovery import import_all
from viscopoint.kernels.jit import generic, inline
from viscopoint.kernels.tensors import Matrix, Sym

History = tuple[float, ...]


class Law(Protocol):
    """What the methods ask of a law beside the operations below."""

    @property
    def density(self) -> float: ...
    @property
    def instantaneous_modulus(self) -> float: ...
    @property
    def history_fields(self) -> tuple[tuple[str, int], ...]: ...


@generic
def step_factors(law: Any, dt: float) -> Any:
    """Return what ``update_stress`` needs of the step ``dt`` [ms] alone, computed once for all points."""


@generic
def update_stress(
    law: Any, factors: Any, strain: Sym, turn: Matrix, jacobian: float, stress: Sym, history: History
) -> tuple[Sym, History, float]:
    """Advance one point by a step.

    Args:
        law: the parameters.
        factors: ``step_factors(law, dt)``.
        strain: strain increment, turned like the stress to the end of the step.
        turn: rotation over the step.
        jacobian: J = det F at the end of the step.
        stress: Cauchy stress at its start [MPa].
        history: the law's history values at its start.

    Returns:
        Stress and history at the end of the step, and the energy the law dissipated per current volume [mJ/mm³].
    """
    raise NotImplementedError


@generic
def stored_energy(law: Any, jacobian: float, stress: Sym, history: History) -> float:
    """Return the recoverable energy per reference volume [mJ/mm³]."""
    raise NotImplementedError


@generic
def shear_energy(law: Any, stress: Sym, history: History) -> float:
    """Return the shear's share of the recoverable energy, per current volume [mJ/mm³]."""
    raise NotImplementedError


@inline
def hypoelastic_work(law: Any, growth: float, stress: Sym, history: History, after: Sym, later: History) -> float:
    """Return what a step in which J grows by ``growth`` takes, per reference volume [mJ/mm³], beside all other terms.

    The shear's energy e per current volume follows the strain: J de is work done, less what the law dissipates. The
    energy stored is J e; nothing pays for its other part, e dJ. Laws that are linear in Cauchy stress by the Jaumann
    rate have no potential where volume changes under shear, and give or take so much (see Simo & Pister 1984).

    Args:
        law: the parameters.
        growth: change of J.
        stress: Cauchy stress at the step's start [MPa].
        history: the law's history values at its start.
        after: the stress at its end.
        later: the history at its end.
    """
    return -0.5 * growth * (shear_energy(law, stress, history) + shear_energy(law, after, later))


@inline
def volumetric_energy(bulk: float, jacobian: float, log_jacobian: float) -> float:
    """Return ∫ K ln J dJ, the energy per reference volume that p = -K ln J stores."""
    return bulk * (jacobian * log_jacobian - jacobian + 1.0)


import_all(__name__)
