"""Planes and the nodes of a mesh, or of a total Lagrangian grid: contact, its rows, and redistributed mass.

A node that would pass a wall arrives exactly on it, and is free as soon as it is pulled.

**Redistributed mass.** The plane of nodes that meets a wall first may have partners, the nodes behind it. If such a
node stopped with the mass of half a cell, that mass's kinetic energy would be gone: 2 % of the paper's rod at 20 µs. So
a node on the wall has no inertia of its own along the normal (mass redistribution; Khenous, Laborde & Renard 2008): at
first contact its momentum and its mass along the normal go to the partner, and come back, at that node's velocity, as
it leaves. In between the wall answers to the force on the node alone. Nodes without partner, and those of sides that
roll onto the wall, are stopped as they are.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from viscopoint.errors import InputError
from viscopoint.interactions import rows as of_rows
from viscopoint.interactions.planes import Interaction, Plane
from viscopoint.interactions.rows import REACTIONS, Rows, add_row, add_slot, load_slot, with_room
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import PARTS, inline, kernel, serial_kernel
from viscopoint.kernels.slabs import chunk
from viscopoint.kernels.vectors import Vec, dot, read_vector, write_vector
from viscopoint.model.nodes import Nodes, impulse_of_force

ON_PLANE = 1e-9  # of the body's extent: nodes closer than this to a plane stand on it


class PlanesOnNodes:
    """The planes that act on a body's nodes."""

    def __init__(self, interactions: Sequence[Interaction], nodes: Nodes) -> None:
        """Find which nodes stand on planes that hold what does; a wall may meet any of them.

        Raises:
            InputError: no node stands on a plane that holds what stands on it, or a plane moves and does not hold.
        """
        for each in interactions:
            if each.plane.speed and not each.plane.two_sided:
                raise InputError(f"{type(each).__name__}: on nodes a plane that moves must be two-sided")
        self.interactions = tuple(interactions)
        self.slot_of = np.full(len(nodes.mass), -1)
        self.reactions = np.zeros((len(self.interactions), REACTIONS))  # of each, since the start
        planes = [(number, each.plane, _nodes_on(each, nodes.position)) for number, each in enumerate(interactions)]
        self._planes = sorted(planes, key=lambda each: each[1].two_sided)  # walls first: they may hand mass on

    def add_rows(self, rows: Rows, body: int, first: int, nodes: Nodes, dt: float) -> Rows:
        """Add the rows of all planes to those of other bodies.

        Args:
            rows: to add to; the interactions' numbers in it begin at ``first``.
            body: the body's number.
            first: the number of its first interaction.
            nodes: the body's, with the velocity that half a step of their force has made.
            dt: the step, in which nodes will move with that velocity [ms].
        """
        for order, (number, plane, found) in enumerate(self._planes):
            if not plane.two_sided:
                detect_contact(nodes, plane, dt)
                found = np.flatnonzero(nodes.in_contact)
            if len(found):
                rows, owner, redistributes = with_room(rows, len(found)), first + number, order == 0
                reactions = self.reactions[number]
                add_contact_rows(nodes, plane, redistributes, found, self.slot_of, rows, body, owner, dt, reactions)
        return rows


def _nodes_on(interaction: Interaction, position: Array) -> Indices:
    """Return the nodes that a plane holds for good."""
    plane = interaction.plane
    normal, point = np.array(plane.normal), np.array(plane.point)
    if not interaction.holds:
        return np.empty(0, np.int64)
    on = np.flatnonzero(np.abs((position - point) @ normal) <= ON_PLANE * np.ptp(position, axis=0).max())
    if not len(on):
        place, along = ("({:g}, {:g}, {:g})".format(*words) for words in (point, normal))
        raise InputError(f"no node stands on the plane through {place} mm normal to {along}, which holds what does")
    return on


@kernel()
def detect_contact(part: int, nodes: Nodes, plane: Plane, dt: float) -> None:
    """Note which nodes would pass a wall in this step, or stand on it."""
    normal, point = read_vector(plane.normal), read_vector(plane.point)
    for n in chunk(part, PARTS, len(nodes.mass)):
        gap = dot(read_vector(nodes.position[n]) - point, normal)
        passes = dot(read_vector(nodes.velocity[n]), normal) < plane.speed - gap / dt
        nodes.in_contact[n] = passes or nodes.normal_mass[n] == 0.0


@serial_kernel
def add_contact_rows(
    nodes: Nodes, plane: Plane, redistributes: bool, found: Indices, slot_of: Indices, rows: Rows, body: int,
    owner: int, dt: float, reactions: Array,
) -> None:  # fmt: skip
    """Add rows for nodes that a plane holds, or that are on it or would pass it in this step.

    ``redistributes``: whether mass goes to partners on this wall, the first one.
    """
    normal, point, time = read_vector(plane.normal), read_vector(plane.point), 0.5 * dt
    redistributed = redistributes and not plane.two_sided
    if redistributed:
        for n in found:
            least = least_speed(nodes, n, plane, dt)
            if nodes.normal_mass[n] == 0.0:
                given = resting_contact(nodes, n, normal, plane.speed, time)
            elif nodes.partner[n] >= 0 and dot(read_vector(nodes.velocity[n]), normal) < least:
                given = first_contact(nodes, n, least, reactions)
            else:
                continue
            if nodes.normal_mass[n] == 0.0:
                s: Any = slot_of_node(nodes, n, slot_of, rows, body, time)
                add_row(rows, s, owner, normal, point, plane.speed, plane.friction, False, given)
    for n in found:
        least = least_speed(nodes, n, plane, dt)
        passes = plane.two_sided or dot(read_vector(nodes.velocity[n]), normal) < least
        if passes and not (redistributed and nodes.normal_mass[n] == 0.0):
            s: Any = slot_of_node(nodes, n, slot_of, rows, body, time)
            add_row(rows, s, owner, normal, point, least, plane.friction, plane.two_sided, -1.0)


@inline
def least_speed(nodes: Nodes, n: int, plane: Plane, dt: float) -> float:
    """Return the speed along a plane's normal that leads a node just onto it, or with it."""
    if plane.two_sided:
        return plane.speed
    gap = dot(read_vector(nodes.position[n]) - read_vector(plane.point), read_vector(plane.normal))
    return plane.speed - gap / dt


@inline
def slot_of_node(nodes: Nodes, n: int, slot_of: Indices, rows: Rows, body: int, time: float) -> Any:
    """Return the slot of a node, a new one if it has none."""
    if slot_of[n] < 0:
        slot_of[n] = add_slot(rows, body, n)
        load_node(nodes, n, rows, slot_of[n], time)
    return slot_of[n]


@inline
def load_node(nodes: Nodes, n: int, rows: Rows, s: Any, time: float) -> None:
    """Say how a node moves, in a slot."""
    velocity, inverse = read_vector(nodes.velocity[n]), read_vector(nodes.inverse_mass[n])
    load_slot(rows, s, velocity - impulse_of_force(nodes, n, time), velocity, inverse)
    m, along = nodes.mass[n], nodes.normal_mass[n]
    more = 0.0 if along == m else (1.0 / along if along > 0.0 else 0.0) - 1.0 / m
    write_vector(rows.motion[s], read_vector(nodes.normal), of_rows.DIRECTION)
    rows.motion[s, of_rows.MORE] = more


@serial_kernel
def update_rows(nodes: Nodes, rows: Rows, body: int, time: float) -> None:
    """Bring up to date what rows know of a body's nodes, and balance nodes in resting contact."""
    for r in range(rows.size[0]):
        s = rows.slot[rows.start[r]]
        if rows.node[s, 0] == body and rows.row[r, of_rows.GIVEN] >= 0.0:
            n: Any = rows.node[s, 1]
            normal, speed = read_vector(rows.row[r], of_rows.NORMAL), rows.row[r, of_rows.LEAST]
            rows.row[r, of_rows.GIVEN] = resting_contact(nodes, n, normal, speed, time)
    for s in range(rows.size[1]):
        if rows.node[s, 0] == body:
            load_node(nodes, rows.node[s, 1], rows, s, time)


@serial_kernel
def correct_velocity(nodes: Nodes, rows: Rows, body: int) -> None:
    """Let the nodes have the velocity that their slots have."""
    for s in range(rows.size[1]):
        if rows.node[s, 0] == body:
            write_vector(nodes.velocity[rows.node[s, 1]], read_vector(rows.motion[s], of_rows.VELOCITY))


@serial_kernel
def stop_nodes(nodes: Nodes, rows: Rows, body: int, slot_of: Indices) -> None:
    """Put the nodes that a wall has stopped onto it, to the last bit."""
    for r in range(rows.size[0]):
        s, row = rows.slot[rows.start[r]], rows.row[r]
        stopped = row[of_rows.LAMBDA] > 0.0 or row[of_rows.GIVEN] >= 0.0
        if rows.node[s, 0] == body and row[of_rows.TWO_SIDED] == 0.0 and stopped:
            n: Any = rows.node[s, 1]
            project(nodes, n, read_vector(row, of_rows.NORMAL), read_vector(row, of_rows.POINT))
    for s in range(rows.size[1]):
        if rows.node[s, 0] == body:
            slot_of[rows.node[s, 1]] = -1


@inline
def project(nodes: Nodes, n: int, normal: Vec, point: Vec) -> None:
    """Project a node onto a plane."""
    place = read_vector(nodes.position[n])
    write_vector(nodes.position[n], place - dot(place - point, normal) * normal)


@inline
def resting_contact(nodes: Nodes, n: int, normal: Vec, speed: float, time: float) -> float:
    """Keep a node without mass along the normal on its wall, and return the impulse that balances its force.

    Where that would take a pull the node has its mass back, the partner's speed, and no impulse.
    """
    if nodes.normal_mass[n] > 0.0:
        return 0.0
    force, velocity = dot(read_vector(nodes.force[n]), normal), read_vector(nodes.velocity[n])
    along = speed
    if force > 0.0:
        m, other = nodes.mass[n], nodes.partner[n]
        nodes.normal_mass[other] -= m
        nodes.normal_mass[n] = m
        nodes.in_contact[n] = 0
        along = dot(read_vector(nodes.velocity[other]), normal) + time / m * force
    write_vector(nodes.velocity[n], velocity + (along - dot(velocity, normal)) * normal)
    return 0.0 if force > 0.0 else -time * force


@inline
def first_contact(nodes: Nodes, n: int, least: float, reactions: Array) -> float:
    """Hand momentum and mass along the normal to the partner; what their difference in speed was worth is lost.

    Returns the impulse of the wall: none.
    """
    m, other, normal = nodes.normal_mass[n], nodes.partner[n], read_vector(nodes.normal)
    both = m + nodes.normal_mass[other]
    mine, its = read_vector(nodes.velocity[n]), read_vector(nodes.velocity[other])
    apart = dot(mine - its, normal)
    reactions[of_rows.NORMAL_WORK] -= 0.5 * m * nodes.normal_mass[other] / both * apart * apart
    write_vector(nodes.velocity[other], its + (m / both * apart) * normal)
    write_vector(nodes.velocity[n], mine + (least - dot(mine, normal)) * normal)
    nodes.normal_mass[other] = both
    nodes.normal_mass[n] = 0.0
    return 0.0
