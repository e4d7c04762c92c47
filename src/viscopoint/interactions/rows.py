"""Constraints on nodes as rows of one system, and its solution.

A row says of the velocity u = Σ w v of some nodes (weights w, over all bodies) that along its normal it is

    u · n >= least        (a wall, a contact: it pushes, rubs and separates freely)
    u · n  = least        (symmetry, prescribed motion, a tie)

The impulses that see to it are found by projected Gauss-Seidel from zero, in the order of the rows: each row takes what
its nodes lack, within λ >= 0 and the friction cone |τ| <= μ λ, until no row changes (Jean 1999; Erleben 2017). It needs
no penalty and bounds no step; linear momentum is exact after any number of sweeps. Rows that share no node, such as
those of a wall, are solved by the first sweep.
"""

from typing import NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array, Indices
from viscopoint.kernels.jit import called, inline, serial_kernel
from viscopoint.kernels.vectors import Vec, dot, read_vector, write_vector

# columns of ``Rows.row``
NORMAL, POINT, LEAST, FRICTION, TWO_SIDED, GIVEN, LAMBDA, TANGENTIAL, ROW = 0, 3, 6, 7, 8, 9, 10, 11, 14
# columns of ``Rows.motion``
VELOCITY, BEFORE, TRIAL, INVERSE, DIRECTION, MORE, MOTION = 0, 3, 6, 9, 12, 15, 16
# what an interaction does to a body: impulse x, y, z [N ms]; work of the normal and of the tangential impulse [mJ]
REACTIONS, NORMAL_WORK, FRICTION_WORK = 5, 3, 4
SWEEPS, CLOSE = 100, 1e-12  # at most; of the greatest change of velocity in the first sweep


class Rows(NamedTuple):
    """The constraints of one instant; nodes on which they act are gathered in slots, each once."""

    size: Indices  # [2], rows and slots in use
    start: Indices  # [r + 1], where each row's entries begin
    slot: Indices  # [k], of an entry
    weight: Array  # [k], w
    # [r, ROW]: n, a point on the plane, least u · n, μ, whether two-sided, λ if it is known (else -1); then λ, τ [N ms]
    row: Array
    owner: Indices  # [r], the interaction, whose reaction it is
    node: Indices  # [s, 2], body and node of a slot
    # [s, MOTION]: v; v before forces and constraints; v after the forces [mm/ms]; 1/m along x, y, z, and how much more
    # it is along a direction [1/g]
    motion: Array


def empty_rows(capacity: int) -> Rows:
    """Return room for so many rows of one node each."""
    return Rows(
        size=np.zeros(2, np.int64),
        start=np.zeros(capacity + 1, np.int64),
        slot=np.zeros(capacity, np.int64),
        weight=np.zeros(capacity),
        row=np.zeros((capacity, ROW)),
        owner=np.zeros(capacity, np.int64),
        node=np.zeros((capacity, 2), np.int64),
        motion=np.zeros((capacity, MOTION)),
    )


def with_room(rows: Rows, more: int) -> Rows:
    """Return the rows with room for ``more`` of one node each."""
    needed = int(rows.size.max()) + more
    if needed <= len(rows.owner):
        return rows
    larger = empty_rows(2 * needed)
    for old, new in zip(rows, larger, strict=True):
        new[: len(old)] = old
    return larger


@inline
def add_row(
    rows: Rows, slot: int, owner: int, normal: Vec, point: Vec, least: float, friction: float, two_sided: bool,
    given: float,
) -> None:  # fmt: skip
    """Add a row of one node; ``given`` is λ if it is known [N ms], and -1 if not."""
    r = rows.size[0]
    rows.slot[r], rows.weight[r], rows.owner[r] = slot, 1.0, owner
    rows.start[r + 1] = r + 1
    row = rows.row[r]
    write_vector(row, normal, NORMAL)
    write_vector(row, point, POINT)
    row[LEAST], row[FRICTION], row[TWO_SIDED], row[GIVEN] = least, friction, 1.0 if two_sided else 0.0, given
    rows.size[0] = r + 1


@inline
def add_slot(rows: Rows, body: int, node: int) -> int:
    """Return a new slot, for a node."""
    s = rows.size[1]
    rows.node[s, 0], rows.node[s, 1] = body, node
    rows.size[1] = s + 1
    return s


@inline
def load_slot(rows: Rows, s: int, before: Vec, velocity: Vec, inverse_mass: Vec) -> None:
    """Say how a slot's node moved before the forces, and moves after them."""
    motion = rows.motion[s]
    write_vector(motion, velocity, VELOCITY)
    write_vector(motion, before, BEFORE)
    write_vector(motion, velocity, TRIAL)
    write_vector(motion, inverse_mass, INVERSE)
    motion[MORE] = 0.0


@serial_kernel
def solve(rows: Rows, begin: int, end: int, reactions: Array) -> None:
    """Find the impulses of the rows ``begin`` to ``end``, which share no node with others.

    Their slots have the velocities then, and ``reactions[owner, REACTIONS]`` what the impulses were and did.
    """
    least, most = np.int64(len(rows.motion)), np.int64(-1)  # slots
    for r in range(begin, end):
        for column in range(LAMBDA, ROW):
            rows.row[r, column] = 0.0
        rows.row[r, LAMBDA] = max(rows.row[r, GIVEN], 0.0)
        for k in range(rows.start[r], rows.start[r + 1]):
            least, most = min(least, rows.slot[k]), max(most, rows.slot[k])
    independent = rows.start[end] - rows.start[begin] == most - least + 1  # each slot in one row
    first = 0.0
    for sweep in range(1 if independent else SWEEPS):
        change = 0.0
        for r in range(begin, end):
            change = max(change, _relax(rows, r))
        if sweep == 0:
            first = change
        elif change <= CLOSE * first:
            break
    for r in range(begin, end):
        _add_reaction(rows, r, reactions[rows.owner[r]])


@serial_kernel
def fix_active_set(rows: Rows) -> None:
    """Let one-sided rows that are active stay so, and no others act: for the second half of a step."""
    for r in range(rows.size[0]):
        if rows.row[r, TWO_SIDED] == 0.0 and rows.row[r, GIVEN] < 0.0:
            rows.row[r, LEAST] = 0.0 if rows.row[r, LAMBDA] > 0.0 else -np.inf


@called
def _relax(rows: Rows, r: int) -> float:
    """Make row r hold by impulses, as if it were alone; return the change of its velocity [mm/ms]."""
    row, change = rows.row[r], 0.0
    normal = read_vector(row, NORMAL)
    if row[GIVEN] < 0.0:
        before, inverse, along = row[LAMBDA], 0.0, 0.0
        for k in range(rows.start[r], rows.start[r + 1]):
            w, motion = rows.weight[k], rows.motion[rows.slot[k]]
            inverse += w * w * _inverse_along(motion, normal)
            along += w * dot(read_vector(motion, VELOCITY), normal)
        if not inverse > 0.0:  # held already
            return 0.0
        lacking = row[LEAST] - along
        if row[TWO_SIDED] == 0.0:
            lacking = max(lacking, -before * inverse)  # λ >= 0
        row[LAMBDA] = before + lacking / inverse
        _apply_impulse(rows, r, normal, lacking, inverse)
        change = abs(lacking)
    return change + (_apply_friction(rows, r, normal) if row[FRICTION] > 0.0 and row[LAMBDA] > 0.0 else 0.0)


@called
def _apply_friction(rows: Rows, r: int, normal: Vec) -> float:
    """Apply row r's friction, within the cone; return the change of velocity [mm/ms]."""
    row = rows.row[r]
    sliding = Vec(0.0, 0.0, 0.0)
    for k in range(rows.start[r], rows.start[r + 1]):
        sliding = sliding + rows.weight[k] * read_vector(rows.motion[rows.slot[k]], VELOCITY)
    sliding = sliding - dot(sliding, normal) * normal
    speed = np.sqrt(dot(sliding, sliding))
    if speed == 0.0:
        return 0.0
    direction, inverse = (1.0 / speed) * sliding, 0.0
    for k in range(rows.start[r], rows.start[r + 1]):
        w = rows.weight[k]
        inverse += w * w * _inverse_along(rows.motion[rows.slot[k]], direction)
    if not inverse > 0.0:
        return 0.0
    before = read_vector(row, TANGENTIAL)
    wanted = before - (1.0 / inverse) * sliding
    size, most = np.sqrt(dot(wanted, wanted)), row[FRICTION] * row[LAMBDA]
    if size <= most:
        write_vector(row, wanted, TANGENTIAL)
        if rows.start[r + 1] - rows.start[r] == 1 and rows.weight[rows.start[r]] == 1.0:  # to the last bit
            motion = rows.motion[rows.slot[rows.start[r]]]
            write_vector(motion, read_vector(motion, VELOCITY) - sliding, VELOCITY)
        else:
            _apply_impulse(rows, r, sliding, -1.0, inverse)
        return speed
    now = (most / size) * wanted
    write_vector(row, now, TANGENTIAL)
    _apply_impulse(rows, r, inverse * (now - before), 1.0, inverse)
    return inverse * np.sqrt(dot(now - before, now - before))


@called
def _apply_impulse(rows: Rows, r: int, direction: Vec, change: float, inverse: float) -> None:
    """Apply the impulse that changes the row's velocity by ``change`` along a direction, of a mass of 1/``inverse``.

    The masses' ratio comes first, so that a lone node that is stopped stands still to the last bit.
    """
    for k in range(rows.start[r], rows.start[r + 1]):
        w, motion = rows.weight[k], rows.motion[rows.slot[k]]
        for a in range(3):
            part = direction.x if a == 0 else direction.y if a == 1 else direction.z
            own = w * motion[INVERSE + a]
            share = 1.0 if own == inverse else own / inverse  # divisions by the same number become its reciprocal
            motion[VELOCITY + a] += share * (part * change)
        if motion[MORE] != 0.0:
            along = read_vector(motion, DIRECTION)
            more = (w * motion[MORE] / inverse * change * dot(direction, along)) * along
            write_vector(motion, read_vector(motion, VELOCITY) + more, VELOCITY)


@inline
def _inverse_along(motion: Array, n: Vec) -> float:
    """Return n · M⁻¹ n of a slot [1/g]."""
    plain = motion[INVERSE] * n.x * n.x + motion[INVERSE + 1] * n.y * n.y + motion[INVERSE + 2] * n.z * n.z
    if motion[MORE] == 0.0:
        return plain
    along = dot(n, read_vector(motion, DIRECTION))
    return plain + motion[MORE] * along * along


@called
def _add_reaction(rows: Rows, r: int, reactions: Array) -> None:
    """Add the impulse and the work of a row.

    Works are taken with the mean v̄ of the velocities before and after all impulses of this part of a step. The body's
    own force, of impulse F in it, is counted with the velocity v after, with which the body moves: what that lacks,
    F (v̄ - v), the normal work of the row takes in. On a wall at rest v = 0.
    """
    row = rows.row[r]
    normal, tangential = read_vector(row, NORMAL), read_vector(row, TANGENTIAL)
    for k in range(rows.start[r], rows.start[r + 1]):
        w, motion = rows.weight[k], rows.motion[rows.slot[k]]
        mean = 0.5 * (read_vector(motion, VELOCITY) + read_vector(motion, BEFORE))
        impulse = (w * row[LAMBDA]) * normal + w * tangential
        reactions[0] += impulse.x
        reactions[1] += impulse.y
        reactions[2] += impulse.z
        along = w * row[LAMBDA]
        if row[LAMBDA] != 0.0 and row[GIVEN] < 0.0:
            forced = dot(read_vector(motion, TRIAL) - read_vector(motion, BEFORE), normal)
            force = forced / _inverse_along(motion, normal)
            if row[TWO_SIDED] == 0.0:
                along += force
            else:
                slowed = dot(read_vector(motion, BEFORE) - read_vector(motion, VELOCITY), normal)
                reactions[NORMAL_WORK] += 0.5 * force * slowed
        reactions[NORMAL_WORK] += along * dot(mean, normal)
        reactions[FRICTION_WORK] += w * dot(tangential, mean)
