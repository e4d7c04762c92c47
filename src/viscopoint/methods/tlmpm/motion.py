"""The nodes' part of a step: velocity Verlet, and a wall that takes no energy as it stops the foot.

A plane of nodes is the body's foot. A node that would pass the wall arrives exactly on it, and is free as soon as it is
pulled. If it stopped there with the mass of half a cell, that mass's kinetic energy would be gone: 2 % of the paper's
rod at 20 µs. So a node on the wall has no inertia along z of its own (mass redistribution; Khenous, Laborde & Renard
2008): as it touches, its momentum and its mass along z go to the node above, and come back, at that node's velocity, as
it leaves. In between the wall answers to the force of the points alone.

Other nodes, of sides that roll onto the wall, are stopped as they are.
"""

import math
from typing import Any

from numba import prange

from viscopoint.interactions.planes import RigidWall, held
from viscopoint.kernels.arrays import Array
from viscopoint.kernels.jit import inline, kernel, serial_kernel
from viscopoint.methods.fem.state import CHUNKS
from viscopoint.methods.tlmpm.nodes import Nodes


def set_off(nodes: Nodes, wall: RigidWall, dt: float, tally: Array) -> None:
    """Half a kick, v += f/m Δt/2, then x += v Δt as far as the wall allows."""
    kick(nodes, 0.5 * dt, tally)
    meet(nodes, wall, 0.5 * dt, dt, tally[0])
    move(nodes, wall, dt)


def arrive(nodes: Nodes, wall: RigidWall, dt: float, tally: Array) -> None:
    """The other half kick; nodes that the wall stopped do not move into it."""
    kick(nodes, 0.5 * dt, tally)
    meet(nodes, wall, 0.5 * dt, 0.0, tally[0])


@kernel
def kick(nodes: Nodes, time: float, tally: Array) -> None:
    """Give the nodes the impulse of their force, and of what holds them; ``tally[chunk]`` is as in ``wall.TALLY``."""
    velocity, force = nodes.velocity, nodes.force
    total = len(nodes.mass)
    for chunk in prange(CHUNKS):
        for n in range(chunk * total // CHUNKS, (chunk + 1) * total // CHUNKS):
            for a in range(3):
                m = nodes.upright[n] if a == 2 else nodes.mass[n]
                if m > 0.0:
                    before = velocity[n, a]
                    after = before + time / m * force[n, a]
                    if nodes.fixed[n] >> a & 1:
                        tally[chunk, a] -= m * after
                        tally[chunk, 3] -= 0.5 * m * after * before  # at the mean of the speeds, before / 2
                        after = 0.0
                    velocity[n, a] = after


@serial_kernel
def meet(nodes: Nodes, wall: RigidWall, time: float, flight: float, tally: Array) -> None:
    """Let the wall act on what is on it, or would pass it within ``flight`` (0: what it has stopped in this step)."""
    for n in range(len(nodes.mass)):
        if nodes.upright[n] == 0.0:
            stand(nodes, n, wall, time, tally)
            continue
        least = 0.0 if nodes.pressed[n] else -math.inf  # the speed that leads just onto the wall
        if flight > 0.0:
            least = (wall.height - nodes.position[n, 2]) / flight
            nodes.pressed[n] = nodes.velocity[n, 2] < least
        if nodes.velocity[n, 2] < least:
            if nodes.above[n] >= 0:
                touch(nodes, n, least, tally)
            else:
                stop(nodes, n, least, wall, time, tally)


@inline
def stand(nodes: Nodes, n: Any, wall: RigidWall, time: float, tally: Array) -> None:
    """Balance the force on a node of the foot that stands on the wall, or let it go where that would take a pull."""
    force = nodes.force[n, 2]
    nodes.velocity[n, 2] = 0.0
    if force <= 0.0:
        tally[2] -= time * force
        rub(nodes, n, -time * force, wall, time, tally)
        return
    m, other = nodes.mass[n], nodes.above[n]
    nodes.upright[other] -= m
    nodes.upright[n] = m
    nodes.velocity[n, 2] = nodes.velocity[other, 2] + time / m * force
    nodes.pressed[n] = 0


@inline
def touch(nodes: Nodes, n: Any, least: float, tally: Array) -> None:
    """Hand momentum and mass along z to the node above; what their difference in speed was worth is lost."""
    m, other = nodes.upright[n], nodes.above[n]
    both = m + nodes.upright[other]
    apart = nodes.velocity[n, 2] - nodes.velocity[other, 2]
    tally[3] -= 0.5 * m * nodes.upright[other] / both * apart * apart
    nodes.velocity[other, 2] += m / both * apart
    nodes.velocity[n, 2] = least
    nodes.upright[other] = both
    nodes.upright[n] = 0.0


@inline
def stop(nodes: Nodes, n: Any, least: float, wall: RigidWall, time: float, tally: Array) -> None:
    """Take a node's speed, but for ``least``; the normal work takes in what its force did to it in this half step."""
    m, up = nodes.upright[n], nodes.velocity[n, 2]
    before = up - time / m * nodes.force[n, 2]
    nodes.velocity[n, 2] = least
    tally[2] += m * (least - up)
    tally[3] += 0.5 * m * (least * least - before * before)
    rub(nodes, n, m * (least - up), wall, time, tally)


@inline
def rub(nodes: Nodes, n: Any, impulse: float, wall: RigidWall, time: float, tally: Array) -> None:
    """Give a node the friction of a normal impulse.

    Works are taken with the mean of the velocities before and after all impulses of this half step, as the forces' own
    are: what sticks costs nothing more.
    """
    m, x, y = nodes.mass[n], nodes.velocity[n, 0], nodes.velocity[n, 1]
    vx, vy, _ = held(wall, x, y, -impulse / m)
    nodes.velocity[n, 0], nodes.velocity[n, 1] = vx, vy
    tally[0] += m * (vx - x)
    tally[1] += m * (vy - y)
    x0, y0 = x - time / m * nodes.force[n, 0], y - time / m * nodes.force[n, 1]
    tally[4] += 0.5 * m * ((vx - x) * (vx + x0) + (vy - y) * (vy + y0))


@kernel
def move(nodes: Nodes, wall: RigidWall, dt: float) -> None:
    """X += v Δt; what the wall stopped arrives on it to the last bit."""
    position, velocity = nodes.position, nodes.velocity
    for n in prange(len(position)):
        for a in range(3):
            position[n, a] += dt * velocity[n, a]
        if nodes.pressed[n] or nodes.upright[n] == 0.0:
            position[n, 2] = wall.height
