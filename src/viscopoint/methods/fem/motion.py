"""The nodes' part of a step: velocity Verlet, with the wall's impulse on the nodes that would pass it.

Velocities are known at the same times as positions. Half a step's force sets the nodes off; the elements answer where
they arrive; the other half brings the velocity up to date. The wall acts on both halves: a node that would pass it
arrives exactly on it, and one that is on it does not move into it. What pulls away is free at once.
"""

import math
from typing import Any

from numba import prange

from viscopoint.interactions.planes import RigidWall, held
from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import inline, kernel
from viscopoint.methods.fem.state import CHUNKS, Nodes


@kernel
def set_off(nodes: Nodes, wall: RigidWall, dt: float, tally: Array) -> None:
    """Half a kick, v += f/m Δt/2, then x += v Δt as far as the wall allows; the forces start afresh."""
    position, velocity, force, pressed = nodes.position, nodes.velocity, nodes.force, nodes.pressed
    total = len(position)
    for chunk in prange(CHUNKS):
        for n in range(chunk * total // CHUNKS, (chunk + 1) * total // CHUNKS):
            least = (wall.height - position[n, 2]) / dt  # the speed that leads just onto the wall
            pressed[n] = kick(nodes, n, 0.5 * dt, wall, least, tally[chunk])
            for a in range(3):
                position[n, a] += dt * velocity[n, a]
                force[n, a] = 0.0
            if pressed[n]:
                position[n, 2] = wall.height  # to the last bit


@kernel
def arrive(nodes: Nodes, wall: RigidWall, dt: float, tally: Array) -> None:
    """The other half kick; nodes that the wall stopped do not move into it."""
    total = len(nodes.mass)
    for chunk in prange(CHUNKS):
        for n in range(chunk * total // CHUNKS, (chunk + 1) * total // CHUNKS):
            kick(nodes, n, 0.5 * dt, wall, 0.0 if nodes.pressed[n] else -math.inf, tally[chunk])


@inline
def kick(nodes: Nodes, n: Any, time: float, wall: RigidWall, least: float, tally: Array) -> bool:
    """Give a node the impulse of its force, of what holds it and of the wall, which leaves it v_z >= ``least``.

    Returns whether the wall acted. Works are taken with the mean of the velocities before and after all impulses, as
    the forces' own are: what stays on the wall costs nothing, and what is held only what it had at the start. Of a
    node that the wall stops, the normal work takes in what its force did to it in that half step.
    """
    m, fixed = nodes.mass[n], nodes.fixed[n]
    x0, y0, z0 = nodes.velocity[n, 0], nodes.velocity[n, 1], nodes.velocity[n, 2]
    push = time / m
    x, y, z = x0 + push * nodes.force[n, 0], y0 + push * nodes.force[n, 1], z0 + push * nodes.force[n, 2]
    stopped = z < least
    if not (fixed or stopped):  # free: the usual case
        nodes.velocity[n, 0], nodes.velocity[n, 1], nodes.velocity[n, 2] = x, y, z
        return False
    vx = 0.0 if fixed & 1 else x
    vy = 0.0 if fixed & 2 else y
    vz = 0.0 if fixed & 4 else z
    if fixed:
        tally[3] += 0.5 * m * ((vx - x) * (vx + x0) + (vy - y) * (vy + y0) + (vz - z) * (vz + z0))
    stopped = vz < least
    if stopped:
        vx, vy, vz = held(wall, vx, vy, vz - least)
        vz += least
        tally[3] += 0.5 * m * (vz * vz - z0 * z0)
        tally[4] += 0.5 * m * ((vx - x) * (vx + x0) + (vy - y) * (vy + y0))
    tally[0] += m * (vx - x)
    tally[1] += m * (vy - y)
    tally[2] += m * (vz - z)
    nodes.velocity[n, 0], nodes.velocity[n, 1], nodes.velocity[n, 2] = vx, vy, vz
    return stopped
