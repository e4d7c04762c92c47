"""Materials: one short file each, behind the same few operations.

A material is a NamedTuple of its parameters, in g, mm, ms (so MPa), or of parts that are such NamedTuples. It also says

- ``density`` [g/mm³],
- ``p_wave_modulus`` [MPa]: K + 4G/3 of a sudden strain of the undeformed material, which bounds the first step,
- ``history_fields``: name, unit, number of components and initial values of each group of history values;

and implements the operations declared below, which must not raise: a kernel could not tell (NaN in what they return
stops the run). Materials know nothing of points, elements or files; strain increment and
rotation come in, Cauchy stress goes out. A file put into this folder is found by itself: see CONTRIBUTING.

A material that sets ``needs_deformation = True`` is handed F with each increment, and one that lists a history field
named ``temperature`` [K], with its value at the start, carries it from step to step.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

from viscopoint.discovery import import_all
from viscopoint.kernels.jit import generic, inline
from viscopoint.kernels.logarithm import log
from viscopoint.kernels.tensors import Matrix, Sym

History = tuple[float, ...]


class HistoryField(NamedTuple):
    """A group of history values of a point."""

    name: str
    unit: str = "1"
    components: int = 1  # 6: a symmetric tensor, xx yy zz xy yz zx; 9: a general one, row by row
    initial: Sequence[float] | float = 0.0  # at the start, of each component or of all


class Material(Protocol):
    """What the methods ask of a material beside the operations below."""

    @property
    def density(self) -> float: ...
    @property
    def p_wave_modulus(self) -> float: ...
    @property
    def history_fields(self) -> tuple[HistoryField, ...]: ...


class Increment(NamedTuple):
    """What a point goes through in a step."""

    dt: float  # ms
    strain: Sym  # increment, turned like the stress to the end of the step
    rotation: Matrix  # over the step
    jacobian: float  # J = det F at the end of the step
    deformation: Matrix  # F at the end of the step, if the material sets ``needs_deformation``; else the identity


class Response(NamedTuple):
    """A point at the end of a step."""

    stress: Sym  # Cauchy, MPa
    history: History
    dissipated: float  # by the material, per current volume, mJ/mm³
    p_wave_modulus: float  # of a small strain from here on, MPa: it bounds the next step


@generic
def step_factors(material: Any, dt: float) -> Any:
    """Return what ``update_stress`` needs of the step ``dt`` [ms] alone, computed once for all points."""


@generic
def update_stress(material: Any, factors: Any, increment: Increment, stress: Sym, history: History) -> Response:
    """Advance one point by a step.

    Args:
        material: the parameters.
        factors: ``step_factors(material, dt)``.
        increment: what the point goes through.
        stress: Cauchy stress at the start of the step [MPa].
        history: the material's history values there.
    """
    raise NotImplementedError


@generic
def stored_energy(material: Any, jacobian: float, stress: Sym, history: History) -> float:
    """Return the recoverable energy per reference volume [mJ/mm³]."""
    raise NotImplementedError


@generic
def shear_energy(material: Any, stress: Sym, history: History) -> float:
    """Return the shear's share of the recoverable energy, per current volume [mJ/mm³]."""
    raise NotImplementedError


@inline
def hypoelastic_work(material: Any, growth: float, stress: Sym, history: History, after: Sym, later: History) -> float:
    """Return what a step in which J grows by ``growth`` takes, per reference volume [mJ/mm³], beside all other terms.

    The shear's energy e per current volume follows the strain: J de is work done, less what the material dissipates.
    The energy stored is J e; nothing pays for its other part, e dJ. Materials that are linear in Cauchy stress by the
    Jaumann rate have no potential where volume changes under shear, and give or take so much (see Simo & Pister 1984).

    Args:
        material: the parameters.
        growth: change of J.
        stress: Cauchy stress at the step's start [MPa].
        history: the material's history values at its start.
        after: the stress at its end.
        later: the history at its end.
    """
    return -0.5 * growth * (shear_energy(material, stress, history) + shear_energy(material, after, later))


@inline
def volume_and_shear_energy(material: Any, jacobian: float, stress: Sym, history: History) -> float:
    """Return the stored energy of a material of p = -K ln J, K its ``bulk``: ∫ K ln J dJ, and that of shear."""
    own = jacobian * shear_energy(material, stress, history)
    return material.bulk * (jacobian * log(jacobian) - jacobian + 1.0) + own


@inline
def p_wave_modulus(bulk: float, shear: float) -> float:
    """Return K + 4G/3 [MPa]."""
    return bulk + 4 * shear / 3


import_all(__name__)
