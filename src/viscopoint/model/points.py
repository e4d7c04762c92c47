"""What material points, points of total Lagrangian bodies and quadrature points have in common.

A method finds the displacement gradient of a block of points, the volumetric strain and J that they shall have, and
has strain become stress, history and energies by the material's block (``materials.block``), and bulk viscosity by
``apply_viscosity``. A method's own columns of the workspace begin at ``OWN``.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Array, Real
from viscopoint.kernels.jit import inline, kernel
from viscopoint.kernels.slabs import CHUNKS, chunk
from viscopoint.kernels.tensors import read, write
from viscopoint.kernels.workspace import BLOCK, HISTORY, add, columns, load, load_sym, store, workspace
from viscopoint.materials import block
from viscopoint.materials.block import (
    AFTER,
    DISSIPATED,
    HYPOELASTIC,
    JACOBIAN,
    MODULUS,
    STORED,
    STRESS,
    MaterialBlock,
    MaterialCode,
    call_block,
)
from viscopoint.model.viscosity import BulkViscosity, viscous_pressure

VISCOUS, VISCOUS_LOSS, OWN = columns(1, 1, first=block.OWN)
STORED_ENERGY, DISSIPATED_ENERGY, HYPOELASTIC_WORK, VISCOUS_WORK, ERODED_ENERGY, SUMS = range(6)


class MaterialState(NamedTuple):
    """What the material has at each point q: one or several in a cell that shares one dilatation."""

    stress: Array  # [q, 6], Cauchy, xx yy zz xy yz zx, MPa
    history: Array  # [q, h], the material's
    dissipated: Array  # [q], by the material per reference volume, mJ/mm^3
    hypoelastic: Array  # [q], taken as volume changes under shear, per reference volume, mJ/mm^3


class VolumeState(NamedTuple):
    """What points that share one dilatation have in common: an element, or a point alone."""

    alive: NDArray[np.uint8]  # [e], 0 where it was eroded
    jacobian: Array  # [e], J
    viscous_pressure: Array  # [e], of the bulk viscosity, MPa
    viscous_loss: Array  # [e], by the bulk viscosity per reference volume, mJ/mm^3


def material_at_rest(material: MaterialBlock, count: int, real: Real = np.float64) -> MaterialState:
    """Return stress-free points."""
    return MaterialState(
        stress=np.zeros((count, 6), real),
        history=material.history(count, real),
        dissipated=np.zeros(count, real),
        hypoelastic=np.zeros(count, real),
    )


def volume_at_rest(count: int, real: Real = np.float64, jacobian: Real = np.float64) -> VolumeState:
    """Return undeformed volumes; ``jacobian`` is the precision of J."""
    return VolumeState(
        alive=np.ones(count, np.uint8),
        jacobian=np.ones(count, jacobian),
        viscous_pressure=np.zeros(count, real),
        viscous_loss=np.zeros(count, real),
    )


@inline
def load_material(state: MaterialState, q: int, work: Any, i: int, n_history: int) -> None:
    """Take what the material has at point q to the workspace."""
    store(work, STRESS, i, read(state.stress[q]))
    for h in range(n_history):
        store(work, HISTORY + h, i, state.history[q, h])
    store(work, DISSIPATED, i, state.dissipated[q])
    store(work, HYPOELASTIC, i, state.hypoelastic[q])


@inline
def store_material(state: MaterialState, q: int, work: Any, i: int, n_history: int) -> None:
    """Give point q back what the material has there."""
    write(state.stress[q], load_sym(work, STRESS, i))
    for h in range(n_history):
        state.history[q, h] = load(work, HISTORY + h, i)
    state.dissipated[q] = load(work, DISSIPATED, i)
    state.hypoelastic[q] = load(work, HYPOELASTIC, i)


@inline
def load_volume(state: VolumeState, e: int, work: Any, i: int) -> None:
    """Take what the points of e share to the workspace."""
    store(work, JACOBIAN, i, state.jacobian[e])
    store(work, VISCOUS, i, state.viscous_pressure[e])
    store(work, VISCOUS_LOSS, i, state.viscous_loss[e])


@inline
def store_volume(state: VolumeState, e: int, work: Any, i: int) -> None:
    """Give e back what its points share."""
    state.jacobian[e] = load(work, JACOBIAN, i)
    state.viscous_pressure[e] = load(work, VISCOUS, i)
    state.viscous_loss[e] = load(work, VISCOUS_LOSS, i)


@inline
def apply_viscosity(
    work: Any, i: int, material: MaterialCode, viscosity: BulkViscosity, length: float, rate: float,
    swept_before: float, swept: float,
) -> tuple[float, float]:  # fmt: skip
    """Find the bulk viscosity of point i after the step, count its work, and let J be that at the step's end.

    Args:
        work: the block.
        i: the point.
        material: whose wave speed counts.
        viscosity: the coefficients.
        length: of the cell [mm].
        rate: of volumetric strain [1/ms].
        swept_before: change of volume, over the reference volume, on which the pressure of the step's start works.
        swept: that on which the new pressure does.

    Returns:
        The present wave speed [mm/ms], and q / (rho l |d|) [mm/ms].
    """
    after = load(work, AFTER, i)
    sound = math.sqrt(load(work, MODULUS, i) * after * (1.0 / material.density))
    pressure, damping = viscous_pressure(viscosity, material.density / after, length, sound, rate)
    add(work, VISCOUS_LOSS, i, -(swept_before * load(work, VISCOUS, i) + swept * pressure))
    store(work, VISCOUS, i, pressure)
    store(work, JACOBIAN, i, after)
    return sound, damping


@kernel(CHUNKS)
def sum_energies(
    part: int, state: MaterialState, volume_state: VolumeState, volume: Array, material: MaterialCode, sums: Array
) -> None:
    """Sum over each chunk of points the energies [mJ], into ``sums[chunk, SUMS]``.

    They are: stored, dissipated by the material, taken as volume changes under shear, taken by the bulk viscosity, and
    stored in what was eroded. ``volume[q]`` is the reference volume of each point [mm^3].
    """
    per, row = len(volume) // len(volume_state.alive), sums[part]
    row[:] = 0.0
    cells = chunk(part, CHUNKS, len(volume_state.alive))
    work = workspace(material.n_history)  # pyright: ignore[reportCallIssue]  (an intrinsic)
    for first in range(cells.start * per, cells.stop * per, BLOCK):
        count = min(BLOCK, cells.stop * per - first)
        for i in range(count):
            store(work, JACOBIAN, i, volume_state.jacobian[(first + i) // per])
            load_material(state, first + i, work, i, material.n_history)
        call_block(material.energies, work, count, material.numbers)
        for i in range(count):
            e, v = (first + i) // per, np.float64(volume[first + i])
            row[STORED_ENERGY if volume_state.alive[e] else ERODED_ENERGY] += v * load(work, STORED, i)
            row[DISSIPATED_ENERGY] += v * load(work, DISSIPATED, i)
            row[HYPOELASTIC_WORK] += v * load(work, HYPOELASTIC, i)
            row[VISCOUS_WORK] += v * volume_state.viscous_loss[e]
