"""One material point driven through prescribed motions, in plain Python."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.kinematics import at_mid_step, strain_and_rotation, volume_ratio
from viscopoint.kernels.tensors import IDENTITY as STILL
from viscopoint.kernels.tensors import Matrix, Sym
from viscopoint.materials import Increment, update_stress
from viscopoint.materials.block import MaterialBlock
from viscopoint.materials.elastic import Elastic
from viscopoint.materials.linear_viscoelastic import LinearViscoelastic
from viscopoint.materials.plastic import Plastic

ELASTIC = Elastic(density=1e-3, bulk=550.0, shear=140.0)
PAPER = LinearViscoelastic(density=1e-3, bulk=550.0, shear_long=5.0, shear_maxwell=135.0, decay=65.0)
PLASTIC = Plastic(ELASTIC, yield_stress=8.0, hardening=20.0)
POLYMER = Plastic(PAPER, yield_stress=8.0, hardening=20.0)
LAWS = {"elastic": ELASTIC, "viscoelastic": PAPER, "elastic-plastic": PLASTIC, "viscoelastic-plastic": POLYMER}


class State(NamedTuple):
    stress: Sym
    history: tuple[float, ...]
    jacobian: float = 1.0
    dissipated: float = 0.0  # per reference volume, mJ/mm^3


def at_rest(law: Any) -> State:
    return State(Sym(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), tuple(MaterialBlock(law).initial_history()))


def strained(law: Any, factors: Any, state: State, strain: Sym, turn: Matrix = STILL, ratio: float = 1.0) -> State:
    """Advance by a strain increment, a rotation and a volume ratio that need not come from one motion."""
    jacobian = state.jacobian * ratio
    increment = Increment(0.0, strain, turn, jacobian, STILL)  # these laws know of the step by their factors alone
    now = update_stress(law, factors, increment, state.stress, state.history)
    dissipated = state.dissipated + 0.5 * (state.jacobian + jacobian) * now.dissipated
    return State(now.stress, now.history, jacobian, dissipated)


def moved(law: Any, factors: Any, state: State, displacement_gradient: np.ndarray) -> State:
    """Advance by a step's motion, F <- (I + A) F, as the methods do."""
    return strained(law, factors, state, *increments(matrix(displacement_gradient)))


def increments(gradient: Matrix) -> tuple[Sym, Matrix, float]:
    """Return strain, rotation and volume ratio of a step's displacement gradient, taken at its start."""
    return *strain_and_rotation(at_mid_step(gradient)), volume_ratio(gradient)


def matrix(a: np.ndarray) -> Matrix:
    return Matrix(*map(float, a.ravel()))


def symmetric(a: np.ndarray) -> Sym:
    return Sym(*map(float, (a[0, 0], a[1, 1], a[2, 2], a[0, 1], a[1, 2], a[2, 0])))


def square(a: Sym | Matrix | Sequence[float]) -> np.ndarray:
    """Return the 3 x 3 array of a tensor, or of the six components of one."""
    if isinstance(a, Matrix):
        return np.array(a).reshape(3, 3)
    xx, yy, zz, xy, yz, zx = (a.xx, a.yy, a.zz, a.xy, a.yz, a.zx) if isinstance(a, Sym) else a
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])


def deviatoric(a: np.ndarray) -> np.ndarray:
    return a - np.trace(a) / 3 * np.eye(3)


def orders(errors: Sequence[float]) -> np.ndarray:
    """Return the observed order between runs of which each has half the step of the one before."""
    return np.log2(np.divide(errors[:-1], errors[1:]))
