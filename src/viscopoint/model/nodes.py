"""Nodes that have a motion for good: those of a mesh, and those of a total Lagrangian grid."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import PARTS, inline, kernel
from viscopoint.kernels.slabs import CHUNKS, chunk
from viscopoint.kernels.vectors import Vec, dot, read_vector, write_vector

KINETIC, MASS, MOMENTUM, SUMS = 0, 1, 2, 5


class Nodes(NamedTuple):
    """Where nodes are and how they move.

    A node that stands on a wall may have handed the mass that moves along the wall's normal to a ``partner`` behind it
    (see ``interactions.on_nodes``): then ``normal_mass`` is not ``mass``.
    """

    position: Array  # [n, 3], mm
    velocity: Array  # [n, 3], mm/ms
    force: Array  # [n, 3], of the elements or points, N
    mass: Array  # [n], lumped, g
    inverse_mass: Array  # [n, 3], 1/g; 0 along axes along which a node cannot move
    normal_mass: Array  # [n], that moves along ``normal``, g
    normal: Array  # [3], of the wall on which mass is redistributed
    partner: Indices  # [n], of a node of the plane that comes to the wall first the one behind it; else -1
    in_contact: NDArray[np.uint8]  # [n], 1: stands on a wall or would pass it in this step


def nodes_at_rest(position: Array, mass: Array, free: Array) -> Nodes:
    """Return nodes without velocity; ``free[n, 3]`` is 0 along axes along which a node cannot move, else 1."""
    count = len(position)
    return Nodes(
        position=position.copy(),
        velocity=np.zeros((count, 3)),
        force=np.zeros((count, 3)),
        mass=mass.copy(),
        inverse_mass=free / mass[:, None],
        normal_mass=mass.copy(),
        normal=np.array([0.0, 0.0, 1.0]),
        partner=np.full(count, -1),
        in_contact=np.zeros(count, np.uint8),
    )


@kernel()
def kick(part: int, nodes: Nodes, time: float) -> None:
    """Give the nodes the impulse of their force, v += f/m Δt."""
    for n in chunk(part, PARTS, len(nodes.mass)):
        write_vector(nodes.velocity[n], read_vector(nodes.velocity[n]) + impulse_of_force(nodes, n, time))


@inline
def impulse_of_force(nodes: Nodes, n: int, time: float) -> Vec:
    """Return the change of velocity that a node's force makes in a time."""
    force, inverse = read_vector(nodes.force[n]), read_vector(nodes.inverse_mass[n])
    if nodes.normal_mass[n] == nodes.mass[n]:
        return Vec(time * inverse.x * force.x, time * inverse.y * force.y, time * inverse.z * force.z)
    normal = read_vector(nodes.normal)
    along = dot(force, normal)
    rest = force - along * normal
    push = time / nodes.normal_mass[n] * along if nodes.normal_mass[n] > 0.0 else 0.0
    return Vec(time * inverse.x * rest.x, time * inverse.y * rest.y, time * inverse.z * rest.z) + push * normal


@kernel()
def drift(part: int, nodes: Nodes, time: float) -> None:
    """Move the nodes, x += v Δt; the forces start afresh."""
    for n in chunk(part, PARTS, len(nodes.mass)):
        write_vector(nodes.position[n], read_vector(nodes.position[n]) + time * read_vector(nodes.velocity[n]))
        write_vector(nodes.force[n], Vec(0.0, 0.0, 0.0))


@kernel(CHUNKS)
def sum_motion(part: int, nodes: Nodes, sums: Array) -> None:
    """Sum over each chunk of nodes kinetic energy, mass and momentum into ``sums[chunk, 5]``."""
    row = sums[part]
    row[:] = 0.0
    for n in chunk(part, CHUNKS, len(nodes.mass)):
        m, v = nodes.mass[n], read_vector(nodes.velocity[n])
        momentum, twice = m * v, m * dot(v, v)
        if nodes.normal_mass[n] != m:
            normal = read_vector(nodes.normal)
            along, more = dot(v, normal), nodes.normal_mass[n] - m
            momentum, twice = momentum + (more * along) * normal, twice + more * along * along
        row[KINETIC] += 0.5 * twice
        row[MASS] += m
        row[MOMENTUM] += momentum.x
        row[MOMENTUM + 1] += momentum.y
        row[MOMENTUM + 2] += momentum.z
