"""All state of a finite element body, as arrays that kernels read by name."""

from typing import Any, NamedTuple

import numpy as np
from numba import prange
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Array, Indices, Real
from viscopoint.kernels.jit import kernel
from viscopoint.kernels.rows import load
from viscopoint.kernels.tensors import read
from viscopoint.materials import History, stored_energy
from viscopoint.methods.fem.forms import form_of
from viscopoint.model.body import Body

CHUNKS = 64  # pieces in which sums are taken, so that they do not depend on the thread count


class Nodes(NamedTuple):
    """Where the mesh is and how it moves."""

    position: Array  # [n, 3], mm
    velocity: Array  # [n, 3], mm/ms
    force: Array  # [n, 3], of the elements, N
    mass: Array  # [n], lumped, g
    fixed: NDArray[np.uint8]  # [n], bit a: held along axis a
    pressed: NDArray[np.uint8]  # [n], on the wall during this step


class Elements(NamedTuple):
    """What the elements carry; an element has one integration point or one at each corner, k.

    In single precision all of it is: what moves are the nodes. With energies in double the ledger closed no better.
    """

    corner: NDArray[np.uint32]  # [e, 8] or [e, 4], nodes
    alive: NDArray[np.uint8]  # [e], 0 where it was deleted
    volume: Array  # [e, k], reference volume of each point, mm^3
    jacobian: Array  # [e], J of the whole element
    stress: Array  # [e, k, 6], Cauchy, xx yy zz xy yz zx, MPa
    viscous_pressure: Array  # [e], of the bulk viscosity, MPa
    history: Array  # [e, k, h], the law's
    dissipated: Array  # [e, k], by the law per reference volume, mJ/mm^3
    hypoelastic: Array  # [e, k], taken by the law as volume changes under shear, per reference volume, mJ/mm^3
    viscous_loss: Array  # [e], by the bulk viscosity, mJ
    memory: Array  # [e, 3 modes], forces on the hourglass modes, N
    hourglass_work: Array  # [e], taken by the hourglass control, mJ


def nodes_at_rest(body: Body, density: float) -> Nodes:
    """Return the nodes of a mesh with their share of its mass."""
    count = len(body.position)
    return Nodes(
        position=body.position.copy(),
        velocity=np.zeros((count, 3)),
        force=np.zeros((count, 3)),
        mass=density * body.volume,
        fixed=form_of(body.cells).held(body.position),
        pressed=np.zeros(count, np.uint8),
    )


def elements_at_rest(
    corner: Indices, volume: Array, history_size: int, modes: int, real: Real = np.float64
) -> Elements:
    """Return stress-free elements of some hourglass modes; ``volume[e, k]`` says how many points each has."""
    count, points = volume.shape
    return Elements(
        corner=corner.astype(np.uint32),
        alive=np.ones(count, np.uint8),
        volume=volume.astype(real),
        jacobian=np.ones(count, real),
        stress=np.zeros((count, points, 6), real),
        viscous_pressure=np.zeros(count, real),
        history=np.zeros((count, points, history_size), real),
        dissipated=np.zeros((count, points), real),
        hypoelastic=np.zeros((count, points), real),
        viscous_loss=np.zeros(count, real),
        memory=np.zeros((count, 3 * modes), real),
        hourglass_work=np.zeros(count, real),
    )


def unload(elements: Elements) -> None:
    """Take from elements all they have but their shape."""
    for name, values in elements._asdict().items():
        if name not in ("corner", "volume"):
            values[...] = 1 if name in ("alive", "jacobian") else 0


@kernel
def sum_nodes(nodes: Nodes, sums: Array) -> None:
    """Sum over each chunk of nodes kinetic energy, mass and momentum into ``sums[chunk, 5]``."""
    total = len(nodes.mass)
    for chunk in prange(CHUNKS):
        row = sums[chunk]
        for n in range(chunk * total // CHUNKS, (chunk + 1) * total // CHUNKS):
            m, v = nodes.mass[n], nodes.velocity[n]
            row[0] += 0.5 * m * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
            row[1] += m
            for a in range(3):
                row[2 + a] += m * v[a]


@kernel
def sum_elements(elements: Elements, law: Any, blank: History, sums: Array) -> None:
    """Sum over each chunk of elements into ``sums[chunk, 6]``, in mJ.

    The energies are: stored, dissipated by the law, by the bulk viscosity, taken by the hourglass control, stored in
    elements when they were deleted, and taken by the law as volume changes under shear.
    """
    total = len(elements.alive)
    for chunk in prange(CHUNKS):
        row = sums[chunk]
        for e in range(chunk * total // CHUNKS, (chunk + 1) * total // CHUNKS):
            stored, jacobian = 0.0, np.float64(elements.jacobian[e])
            for k in range(elements.volume.shape[1]):
                volume = np.float64(elements.volume[e, k])
                stored += volume * stored_energy(
                    law, jacobian, read(elements.stress[e, k]), load(elements.history[e, k], blank)
                )
                row[1] += volume * elements.dissipated[e, k]
                row[5] += volume * elements.hypoelastic[e, k]
            row[0 if elements.alive[e] else 4] += stored
            row[2] += elements.viscous_loss[e]
            row[3] += elements.hourglass_work[e]
