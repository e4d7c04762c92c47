"""Transfers against their formulas as matrices, what they keep, and what they do to waves and spins."""

from typing import Any

import numpy as np
import pytest
from columns import ELASTIC, LENGTH, Array, block, column, layers, one_thread, rod  # noqa: F401
from dense import dense, orbital, whirl
from numpy.testing import assert_allclose
from test_schemes import DENSITY, SPEED, STRAIN, amplitude, energies, ringing

from viscopoint.methods.mpm.geometry import Box
from viscopoint.methods.mpm.method import MaterialPointMethod
from viscopoint.methods.mpm.transfers import Transfer
from viscopoint.methods.mpm.transfers.affine_pic import Apic, Tpic
from viscopoint.methods.mpm.transfers.flip import Flip

pytestmark = pytest.mark.usefixtures("one_thread")
ROUNDING = 100 * np.finfo(float).eps
ROOM = Box((-6.0, -6.0, -6.0), (9.0, 9.0, 9.0))
ALL = (Flip(0.0), Flip(0.4), Flip(1.0), Apic(), Tpic())
TRANSFER = pytest.mark.parametrize("transfer", ALL, ids=str)
SHAPE = pytest.mark.parametrize("shape", ["gimp", "trilinear"])
SCHEME = pytest.mark.parametrize("scheme", ["musl", "usf", "usl"])
SPIN = np.array([3.0, -5.0, 4.0])  # 1/ms
GRADIENT = np.array([[2.0, -3.0, 1.0], [5.0, 1.0, -2.0], [-4.0, 3.0, -1.5]])  # 1/ms


def cube(transfer: Transfer, cells: int = 2, uneven: float = 0.0, **choices: Any) -> MaterialPointMethod:
    """Return a cube of ``cells`` mm, with eight points to the cell, that stands on no account of its own."""
    body = block(1.0, cells, cells, cells)
    shift = uneven * np.random.default_rng(7).uniform(-0.2, 0.2, body.position.shape)
    body = body._replace(position=body.position + shift)
    none = np.zeros_like(body.position)
    return rod(ELASTIC, none, body=body, box=ROOM, transfer=transfer, viscosity=(0.0, 0.0), **choices)


def stirred(method: MaterialPointMethod) -> MaterialPointMethod:
    random = np.random.default_rng(3)
    points = method.points
    for values, size in ((points.velocity, 10.0), (points.material.stress, 20.0), (points.affine, 3.0)):
        values[:] = random.normal(size=values.shape, scale=size)
    return method


def affine_of(method: MaterialPointMethod) -> Array:
    return method.points.affine.reshape(-1, 3, 3).copy()


@TRANSFER
@SHAPE
def test_step_is_what_its_matrices_say(transfer: Any, shape: str) -> None:
    method, dt = stirred(cube(transfer, uneven=1.0, shape=shape)), 1e-4
    see, points = dense(method), method.points
    x, v, kept = points.position.copy(), points.velocity.copy(), affine_of(method)
    xx, yy, zz, xy, yz, zx = points.material.stress.T
    stress = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    change = -dt * np.einsum("p,abp,pnb->na", points.volume, stress, see.slopes) / see.lumped[:, None]
    node = see.averaged(v) + change
    if isinstance(transfer, Apic):
        node += see.affine(kept @ np.linalg.inv(see.inertia()))
    if isinstance(transfer, Tpic):
        node += see.affine(kept)
    moves = see.weights @ node
    pic = transfer.pic if isinstance(transfer, Flip) else 1.0
    expected = (1 - pic) * (v + see.weights @ change) + pic * moves
    method.advance(dt)
    # sums of eight to 27 terms; what a node of little mass multiplies comes back with as little weight
    assert_allclose(points.velocity, expected, rtol=0, atol=ROUNDING * np.abs(v).max() * 10)
    assert_allclose(points.position, x + dt * moves, rtol=0, atol=ROUNDING)
    if isinstance(transfer, Apic):
        assert_allclose(affine_of(method), see.moments(node), rtol=0, atol=ROUNDING * np.abs(v).max() * 10)
    if isinstance(transfer, Tpic):
        assert_allclose(affine_of(method), see.gradients(node), rtol=0, atol=ROUNDING * np.abs(node).max() * 10)


def test_only_affine_transfers_take_memory_for_it() -> None:
    assert {type(t).__name__: len(cube(t).points.affine) for t in ALL} == {"Flip": 0, "Apic": 64, "Tpic": 64}


@SHAPE
@pytest.mark.parametrize("transfer", [Apic(), Tpic()], ids=str)
def test_affine_transfers_reproduce_a_uniform_gradient(transfer: Transfer, shape: str) -> None:
    method = cube(transfer, uneven=1.0, shape=shape)
    points = method.points
    points.velocity[:] = points.position @ GRADIENT.T
    inertia = dense(method).inertia() if isinstance(transfer, Apic) else np.eye(3)
    points.affine[:] = (GRADIENT @ inertia).reshape(-1, 9)
    start, kept = points.velocity.copy(), points.affine.copy()
    method.advance(1e-9)  # no stress yet: nothing but the transfer
    assert_allclose(points.velocity, start, rtol=0, atol=10 * ROUNDING * np.abs(start).max())
    assert_allclose(points.affine, kept, rtol=0, atol=10 * ROUNDING * np.abs(start).max())


@SHAPE
@pytest.mark.parametrize("transfer", [Apic(), Tpic()], ids=str)
def test_kinetic_energy_of_a_rigid_rotation_is_that_of_the_nodes_inertia(transfer: Transfer, shape: str) -> None:
    """Points and the motion around them have w . I . w / 2, with I of the lumped nodes; points alone 4 to 9 % less."""
    method = cube(transfer, cells=3, uneven=1.0, shape=shape)
    see, points = dense(method), method.points
    inertia = see.inertia() if isinstance(transfer, Apic) else np.eye(3)
    points.velocity[:] = np.cross(SPIN, points.position - 1.5)
    points.affine[:] = (np.cross(np.eye(3), SPIN) @ inertia).reshape(-1, 9)
    nodes = points.position[0] + see.reach[0] - 1.5
    exact = 0.5 * see.lumped @ (np.cross(SPIN, nodes) ** 2).sum(axis=1)
    method.advance(1e-9)  # no stress yet: nothing but the transfer
    assert_allclose(method.totals().kinetic, exact, rtol=ROUNDING)
    assert 0.5 * points.mass @ (points.velocity**2).sum(axis=1) < 0.97 * exact


def test_tpic_keeps_a_rigid_rotation_while_points_fly_through_cells() -> None:
    """Turns of 1e-4 strain by 1e-8 at the most, per 1e-4 of the rotation; APIC's B D⁻¹ changes with D, by 3 % here."""
    errors = []
    for transfer in (Tpic(), Apic()):
        method, flight, spin = cube(transfer, shape="gimp"), np.array([3.0, -2.0, 1.0]), 1e-4 * SPIN
        points = method.points
        inertia = dense(method).inertia() if isinstance(transfer, Apic) else np.eye(3)
        points.affine[:] = (np.cross(np.eye(3), spin) @ inertia).reshape(-1, 9)
        points.velocity[:] = flight + np.cross(spin, points.position - 1.0)
        for _ in range(1000):  # 1.2 cells along x
            method.advance(4e-4)
        turning = np.cross(spin, points.position - points.position.mean(axis=0))
        errors.append(np.abs(points.velocity - flight - turning).max() / np.abs(turning).max())
    assert errors[0] < 1e-4
    assert errors[1] > 1e-3


def test_pic_damps_a_spin_by_the_moment_that_nodes_hold_and_points_do_not() -> None:
    """Nodes take the points' angular momentum and give it back around the mean place of the points they see.

    Along an axis, n cells of two points from the middle: points at odd h/4; inner nodes see them around themselves,
    outer ones, of half a node's mass, 3/8 h inside.
    """
    cells = 4
    method = cube(Flip(1.0), cells)
    points = method.points
    points.velocity[:] = np.cross(SPIN, points.position - 0.5 * cells)
    start = orbital(method) - np.cross([0.5 * cells] * 3, method.totals().momentum)
    method.advance(1e-9)
    found = orbital(method) - np.cross([0.5 * cells] * 3, method.totals().momentum)
    nodes = np.arange(-cells / 2, cells / 2 + 1)
    nodes[0], nodes[-1] = nodes[0] + 3 / 8, nodes[-1] - 3 / 8
    share = np.r_[0.5, np.ones(cells - 1), 0.5] / cells
    places = (np.arange(2 * cells) + 0.5) / 2 - cells / 2
    assert_allclose(found / start, (share @ nodes**2) / np.mean(places**2), rtol=1e-7)


@SCHEME
@SHAPE
@pytest.mark.parametrize("volume", ["local", "cell-mean"])
def test_apic_keeps_angular_momentum_to_rounding(scheme: str, shape: str, volume: str) -> None:
    method = cube(Apic(), cells=3, uneven=1.0, shape=shape, scheme=scheme, volume=volume)
    points, count = method.points, 10 if scheme == "usl" else 100
    points.velocity[:] = np.cross(SPIN, points.position) + np.random.default_rng(2).normal(size=points.position.shape)

    def whole() -> Array:
        return orbital(method) + (points.mass[:, None] * whirl(affine_of(method))).sum(axis=0)

    start, moved, speed = whole(), points.position.copy(), np.abs(points.velocity).max()
    for _ in range(count):
        method.advance(method.stable_step())
    assert np.abs(points.position - moved).max() > (0.02 if scheme == "usl" else 0.3)
    assert np.abs(points.material.stress).max() > 0.1
    assert_allclose(whole(), start, rtol=0, atol=count * ROUNDING * points.mass.sum() * speed * 3.0)


@SHAPE
@pytest.mark.parametrize("transfer", [Flip(0.0), Flip(1.0), Tpic()], ids=str)
def test_other_transfers_change_angular_momentum_as_derived(transfer: Any, shape: str) -> None:
    """What nodes have around the points, ε:Σ N v_i ⊗ (x_i - x_p), is lost but for what a point keeps of it."""
    method, dt = stirred(cube(transfer, uneven=1.0, shape=shape, scheme="usl")), 1e-3
    points, see = method.points, dense(method)
    m, before = points.mass[:, None], orbital(method)
    if isinstance(transfer, Tpic):
        before = before + (m * whirl(affine_of(method) @ see.inertia())).sum(axis=0)
    scale = np.abs(m * points.velocity).sum()
    method.advance(dt)
    node, change = nodal(method, see.lumped), nodal(method, see.lumped, "dv")
    if isinstance(transfer, Flip) and transfer.pic == 0.0:
        lost = m * whirl(see.moments(change)) - dt * m * np.cross(points.grid_velocity, points.velocity)
    else:
        lost = m * whirl(see.moments(node))
    after = orbital(method)
    if isinstance(transfer, Tpic):
        kept = affine_of(method)
        assert_allclose(kept, see.gradients(node), rtol=0, atol=ROUNDING * np.abs(node).max() * 10)
        after = after + (m * whirl(kept @ dense(method).inertia())).sum(axis=0)
        lost = lost - m * whirl(kept @ dense(method).inertia())
        if shape == "trilinear":  # C D is B until the point moves
            assert_allclose(see.moments(node), kept @ see.inertia(), rtol=0, atol=ROUNDING * np.abs(node).max())
    assert np.linalg.norm(lost.sum(axis=0)) > 1e-3 * scale * (dt if isinstance(transfer, Tpic) else 1.0)
    assert_allclose(after - before, -lost.sum(axis=0), rtol=0, atol=10 * ROUNDING * scale)


def nodal(method: MaterialPointMethod, lumped: Array, field: str = "velocity") -> Array:
    """Return a field of the nodes that have mass, in the order of ``dense``: x slowest."""
    grid = method.grid
    shape = (int(grid.nz), int(grid.ny), int(grid.nx))
    values = getattr(grid, field)[:, :3].reshape(*shape, 3).transpose(2, 1, 0, 3).reshape(-1, 3)
    there = grid.momentum[:, 3].reshape(shape).transpose(2, 1, 0).ravel() > 0.0
    assert there.sum() == len(lumped)
    return values[there]


# --- waves (see ``columns`` and ``test_schemes`` for what nodes and points see of each other) ---


def amplitudes(transfer: Any, scheme: str, k: float, cell: float, dt: float, steps: int) -> Array:
    """Return the velocity of a wave of the linear scheme; c is the nodes' wave whose slopes the points know.

    Of a piecewise linear wave the points' slopes give back to the nodes what S⁺S takes: 1 - F.
    """
    kh, affine = k * cell, isinstance(transfer, Apic | Tpic)
    see = np.array([3 * np.cos(kh / 4) + np.cos(3 * kh / 4), 3 * np.sin(kh / 4) - np.sin(3 * kh / 4)]) / 4
    slope, rest = 2 / cell * np.sin(kh / 2), 1 - see @ see
    u, stress, c, found = np.array([1.0, 0.0]), 0.0, 0.0, []
    growth = ELASTIC.p_wave_modulus * dt * slope
    for _ in range(steps):
        if scheme == "usf":
            stress += growth * (see @ u + rest * c)
        node = see @ u + rest * c - dt / DENSITY * slope * stress
        u, c = see * node, node if affine else 0.0
        if scheme == "usl":
            stress += growth * node
        if scheme == "musl":
            stress += growth * (see @ u + rest * c)
        found.append(u[0])
    return np.array(found)


@SCHEME
@pytest.mark.parametrize("transfer", [Apic(), Tpic(), Flip(1.0)], ids=str)
@pytest.mark.parametrize("waves", [1, 3])
def test_transfer_follows_its_discrete_dispersion_relation(scheme: str, transfer: Transfer, waves: int) -> None:
    cells, steps, k = 8, 100, waves * np.pi / LENGTH
    method, mode = ringing(cells, k, scheme=scheme, transfer=transfer)
    dt, found = method.stable_step(), []
    for _ in range(steps):
        method.advance(dt)
        found.append(amplitude(method, mode))
    expected = amplitudes(transfer, scheme, k, LENGTH / cells, dt, steps)
    assert_allclose(found, expected, rtol=0, atol=steps * STRAIN)


@pytest.mark.parametrize("scheme", ["musl", "usf", "usl"])
def test_apic_damps_no_wave_along_an_axis(scheme: str) -> None:
    means, turn = energies(5, transfer=Apic(), scheme=scheme, safety=0.4)
    assert np.abs(means - 1).max() < turn
    assert np.abs(means - means[0]).max() < 1e-3


def test_uniform_flight_needs_no_affine_state() -> None:
    method = column(8, ends=(), velocity=lambda z: np.full_like(z, SPEED), transfer=Apic())
    for _ in range(20):
        method.advance(method.stable_step())
    assert_allclose(layers(method.points.velocity[:, 2]), SPEED, rtol=20 * ROUNDING)
    assert_allclose(method.points.affine, 0.0, atol=20 * ROUNDING * SPEED * LENGTH)
