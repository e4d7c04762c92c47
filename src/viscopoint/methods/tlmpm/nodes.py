"""The nodes of the undeformed grid that have a motion of their own."""

from typing import NamedTuple

import numpy as np
from numba import prange
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import kernel
from viscopoint.methods.fem.state import CHUNKS


class Nodes(NamedTuple):
    """Where the nodes are now and how they move; sorted from the lowest plane up."""

    position: Array  # [n, 3], mm
    velocity: Array  # [n, 3], mm/ms
    force: Array  # [n, 3], of the points, N
    mass: Array  # [n], lumped, g
    upright: Array  # [n], mass that moves along z: of what stands on the wall, none; of the node above, both, g
    fixed: NDArray[np.uint8]  # [n], bit a: held along axis a
    pressed: NDArray[np.uint8]  # [n], stopped by the wall during this step
    above: Indices  # [n], of a node of the foot the next one up; else -1


def nodes_at_rest(position: Array, mass: Array, foot: float, height: float) -> Nodes:
    """Return nodes without velocity; those at z = ``foot`` are the body's foot, the next ones ``height`` above."""
    count = len(position)
    rounded = np.round(position / height, 6)
    feet = np.flatnonzero(np.abs(position[:, 2] - foot) < 1e-6 * height)
    next_up = np.round((position[feet] + [0.0, 0.0, height]) / height, 6)
    level = np.flatnonzero(np.isin(rounded[:, 2], next_up[:, 2]))
    index = {tuple(place): n for n, place in zip(level.tolist(), rounded[level].tolist(), strict=True)}
    above = np.full(count, -1)
    above[feet] = [index.get(tuple(place), -1) for place in next_up.tolist()]
    return Nodes(
        position=position.copy(),
        velocity=np.zeros((count, 3)),
        force=np.zeros((count, 3)),
        mass=mass.copy(),
        upright=mass.copy(),
        fixed=np.zeros(count, np.uint8),
        pressed=np.zeros(count, np.uint8),
        above=above,
    )


@kernel
def sum_nodes(nodes: Nodes, sums: Array) -> None:
    """Sum over each chunk of nodes kinetic energy, mass and momentum into ``sums[chunk, 5]``."""
    total = len(nodes.mass)
    for chunk in prange(CHUNKS):
        row = sums[chunk]
        for n in range(chunk * total // CHUNKS, (chunk + 1) * total // CHUNKS):
            m, up, v = nodes.mass[n], nodes.upright[n], nodes.velocity[n]
            row[0] += 0.5 * (m * (v[0] * v[0] + v[1] * v[1]) + up * v[2] * v[2])
            row[1] += m
            row[2] += m * v[0]
            row[3] += m * v[1]
            row[4] += up * v[2]
