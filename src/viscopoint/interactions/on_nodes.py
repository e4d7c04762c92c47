"""Planes and the nodes of a mesh, or of a total Lagrangian grid: which rows there are, and who hands its mass on.

A node that would pass a wall arrives exactly on it, and is free as soon as it is pulled.

**Redistributed mass.** The plane of nodes that meets a wall first may have partners, the nodes behind it. If such a
node stopped with the mass of half a cell, that mass's kinetic energy would be gone: 2 % of the paper's rod at 20 µs. So
a node on the wall has no inertia of its own along the normal (mass redistribution; Khenous, Laborde & Renard 2008): as
it touches, its momentum and its mass along the normal go to the partner, and come back, at that node's velocity, as it
leaves. In between the wall answers to the force on the node alone. Nodes without partner, and those of sides that roll
onto the wall, are stopped as they are.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from viscopoint.errors import InputError
from viscopoint.interactions.planes import Interaction, Plane
from viscopoint.interactions.rows import (
    FRICTION_WORK,
    LAMBDA,
    NORMAL,
    NORMAL_WORK,
    POINT,
    REACTIONS,
    TWO_SIDED,
    VELOCITY,
    Rows,
    add_row,
    add_slot,
    load_slot,
    with_room,
)
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import inline, serial_kernel
from viscopoint.kernels.tensors import Vec, dot, read_vector, write_vector
from viscopoint.model.nodes import Nodes, impulse_of_force

ON_PLANE = 1e-9  # of the body's extent: nodes closer than this to a plane stand on it


class Guides(NamedTuple):
    """Planes that hold nodes, which slide on them alone."""

    normal: Array  # [g, 3]
    on: NDArray[np.uint8]  # [g, n], whether they hold a node


class PlanesOnNodes:
    """The planes that act on a body's nodes."""

    def __init__(self, interactions: Sequence[Interaction], nodes: Nodes, surface: Indices) -> None:
        """Find which of the nodes each plane may act on; of a wall those of the ``surface``.

        Raises:
            InputError: no node stands on a plane that holds what stands on it.
        """
        self.interactions = tuple(interactions)
        self.slot_of = np.full(len(nodes.mass), -1)
        self.reactions = np.zeros((len(self.interactions), REACTIONS))  # of each, since the start
        planes = [
            (number, each.plane, _reached(each, nodes.position, surface)) for number, each in enumerate(interactions)
        ]
        # walls first: they may hand mass on and rub before rows say how nodes move
        self._planes = sorted(planes, key=lambda each: each[1].two_sided)
        self._guides = _guides(planes, len(nodes.mass))
        self.most = sum(len(candidates) for _, _, candidates in planes)

    def find(self, rows: Rows, body: int, first: int, nodes: Nodes, time: float, flight: float) -> Rows:
        """Add the rows of all planes to those of other bodies.

        Args:
            rows: to add to; the interactions' numbers in it begin at ``first``.
            body: the body's number.
            first: the number of its first interaction.
            nodes: the body's, with the velocity that ``time`` of their force has made.
            time: half a step [ms].
            flight: how long nodes will move with that velocity [ms].
        """
        rows = with_room(rows, self.most)
        for number, plane, candidates in self._planes:
            meet(
                nodes, plane, candidates, self._guides, self.slot_of, rows, body, first + number, time, flight,
                self.reactions[number],
            )  # fmt: skip
        return rows

    def resume(self, rows: Rows, body: int, nodes: Nodes, time: float) -> None:
        """Bring up to date what rows know of this body's nodes, and balance nodes that stand on a wall."""
        for number, plane, candidates in self._planes:
            if not plane.two_sided:
                stand_still(nodes, plane, candidates, self._guides, time, self.reactions[number])
        if rows.size[1] > 0:
            reload(nodes, rows, body, time)


def _guides(planes: Sequence[tuple[int, Plane, Indices]], count: int) -> Guides:
    """Return the planes that hold nodes, and which."""
    holding = [(plane.normal, candidates) for _, plane, candidates in planes if plane.two_sided]
    guides = Guides(np.zeros((len(holding), 3)), np.zeros((len(holding), count), np.uint8))
    for row, (normal, candidates) in enumerate(holding):
        guides.normal[row] = normal
        guides.on[row, candidates] = 1
    return guides


def _reached(interaction: Interaction, position: Array, surface: Indices) -> Indices:
    """Return the nodes that a plane may act on, those that it meets first first."""
    plane = interaction.plane
    normal, point = np.array(plane.normal), np.array(plane.point)
    height = (position - point) @ normal
    if not interaction.holds:
        return surface[np.argsort(height[surface], kind="stable")]
    on = np.flatnonzero(np.abs(height) <= ON_PLANE * np.ptp(position, axis=0).max())
    if not len(on):
        place, along = ("({:g}, {:g}, {:g})".format(*words) for words in (point, normal))
        raise InputError(f"no node stands on the plane through {place} mm normal to {along}, which holds what does")
    return on


@serial_kernel
def meet(
    nodes: Nodes, plane: Plane, candidates: Indices, guides: Guides, slot_of: Indices, rows: Rows, body: int,
    owner: int, time: float, flight: float, reactions: Array,
) -> None:  # fmt: skip
    """Let a plane act on what is on it, or would pass it within ``flight``."""
    normal, point = read_vector(plane.normal), read_vector(plane.point)
    for n in candidates:
        if nodes.normal_mass[n] == 0.0 and not plane.two_sided:
            stand(nodes, n, plane, guides, time, reactions)
            continue
        least = plane.speed
        if not plane.two_sided:
            least -= dot(read_vector(nodes.position[n]) - point, normal) / flight  # leads just onto the plane
            nodes.pressed[n] = dot(read_vector(nodes.velocity[n]), normal) < least
            if not nodes.pressed[n]:
                continue
            if nodes.partner[n] >= 0:
                touch(nodes, n, least, reactions)
                continue
        s: Any = slot_of[n]
        if s < 0:
            s = slot_of[n] = add_slot(rows, body, n)
            load_node(nodes, n, rows, s, time)
        add_row(rows, s, owner, normal, point, least, plane.friction, plane.two_sided)


@serial_kernel
def stand_still(nodes: Nodes, plane: Plane, candidates: Indices, guides: Guides, time: float, reactions: Array) -> None:
    """Balance the nodes that stand on a wall."""
    for n in candidates:
        if nodes.normal_mass[n] == 0.0:
            stand(nodes, n, plane, guides, time, reactions)


@inline
def load_node(nodes: Nodes, n: int, rows: Rows, s: int, time: float) -> None:
    """Say how a node moves, in a slot."""
    velocity, inverse = read_vector(nodes.velocity[n]), read_vector(nodes.inverse_mass[n])
    load_slot(rows, s, velocity - impulse_of_force(nodes, n, time), velocity, inverse)


@serial_kernel
def reload(nodes: Nodes, rows: Rows, body: int, time: float) -> None:
    """Bring the slots of a body up to date."""
    for s in range(rows.size[1]):
        if rows.node[s, 0] == body:
            load_node(nodes, rows.node[s, 1], rows, s, time)


@serial_kernel
def take_velocity(nodes: Nodes, rows: Rows, body: int) -> None:
    """Let the nodes have the velocity that their slots have."""
    for s in range(rows.size[1]):
        if rows.node[s, 0] == body:
            write_vector(nodes.velocity[rows.node[s, 1]], read_vector(rows.motion[s][VELOCITY:]))


@serial_kernel
def settle(nodes: Nodes, rows: Rows, body: int, slot_of: Indices) -> None:
    """Put the nodes that a wall has stopped onto it, to the last bit."""
    for r in range(rows.size[0]):
        s = rows.slot[rows.start[r]]
        if rows.node[s, 0] == body and rows.row[r, TWO_SIDED] == 0.0 and rows.row[r, LAMBDA] > 0.0:
            n: Any = rows.node[s, 1]
            onto(nodes, n, read_vector(rows.row[r][NORMAL:]), read_vector(rows.row[r][POINT:]))
    for s in range(rows.size[1]):
        if rows.node[s, 0] == body:
            slot_of[rows.node[s, 1]] = -1


@inline
def onto(nodes: Nodes, n: int, normal: Vec, point: Vec) -> None:
    """Put a node onto a plane."""
    place = read_vector(nodes.position[n])
    write_vector(nodes.position[n], place - dot(place - point, normal) * normal)


@inline
def stand(nodes: Nodes, n: int, plane: Plane, guides: Guides, time: float, reactions: Array) -> None:
    """Balance the force on a node without mass along the normal, or let it go where that would take a pull."""
    normal, velocity = read_vector(plane.normal), read_vector(nodes.velocity[n])
    force = dot(read_vector(nodes.force[n]), normal)
    velocity = velocity - (dot(velocity, normal) - plane.speed) * normal
    write_vector(nodes.velocity[n], velocity)
    onto(nodes, n, normal, read_vector(plane.point))
    if force <= 0.0:
        push(reactions, (-time * force) * normal)
        rub(nodes, n, plane, guides, -time * force, time, reactions)
        return
    m, other = nodes.mass[n], nodes.partner[n]
    nodes.normal_mass[other] -= m
    nodes.normal_mass[n] = m
    along = dot(read_vector(nodes.velocity[other]), normal) + time / m * force
    write_vector(nodes.velocity[n], velocity + (along - plane.speed) * normal)
    nodes.pressed[n] = 0


@inline
def touch(nodes: Nodes, n: int, least: float, reactions: Array) -> None:
    """Hand momentum and mass along the normal to the partner; what their difference in speed was worth is lost."""
    m, other, normal = nodes.normal_mass[n], nodes.partner[n], read_vector(nodes.normal)
    both = m + nodes.normal_mass[other]
    mine, its = read_vector(nodes.velocity[n]), read_vector(nodes.velocity[other])
    apart = dot(mine - its, normal)
    reactions[NORMAL_WORK] -= 0.5 * m * nodes.normal_mass[other] / both * apart * apart
    write_vector(nodes.velocity[other], its + (m / both * apart) * normal)
    write_vector(nodes.velocity[n], mine + (least - dot(mine, normal)) * normal)
    nodes.normal_mass[other] = both
    nodes.normal_mass[n] = 0.0


@inline
def rub(nodes: Nodes, n: int, plane: Plane, guides: Guides, impulse: float, time: float, reactions: Array) -> None:
    """Give a node that stands on a plane the friction of a normal impulse; its work is that of ``rows.solve``.

    Planes that hold the node (and stand upright on this one) take part of its velocity only later, by their rows.
    """
    velocity, m = read_vector(nodes.velocity[n]), nodes.mass[n]
    normal = read_vector(plane.normal)
    sliding = velocity - dot(velocity, normal) * normal
    for g in range(len(guides.normal)):
        if guides.on[g, n]:
            across = read_vector(guides.normal[g])
            sliding = sliding - dot(sliding, across) * across
    speed = math.sqrt(dot(sliding, sliding))
    share = min(1.0, plane.friction * impulse / (m * speed)) if speed > 0.0 else 0.0
    taken = (-share) * sliding
    before = sliding - impulse_of_force(nodes, n, time)
    write_vector(nodes.velocity[n], velocity + taken)
    push(reactions, m * taken)
    reactions[FRICTION_WORK] += 0.5 * m * dot(taken, sliding + taken + before)


@inline
def push(reactions: Array, impulse: Vec) -> None:
    """Add an impulse to the account."""
    reactions[0] += impulse.x
    reactions[1] += impulse.y
    reactions[2] += impulse.z
