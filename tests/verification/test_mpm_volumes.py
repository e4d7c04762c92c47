"""Points that share the dilatation and the pressure of their cell: what that keeps, and that it cures locking."""

from typing import Any

import numpy as np
import pytest
from columns import CELL, Array, block, fresh_grid, one_thread, rod, scattered  # noqa: F401
from numpy.testing import assert_allclose

from viscopoint.kernels.tensors import components
from viscopoint.materials.elastic import Elastic
from viscopoint.methods.mpm.geometry import Box
from viscopoint.methods.mpm.method import MaterialPointMethod
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.mpm.volumes import VOLUMES, acting_stress

pytestmark = pytest.mark.usefixtures("one_thread")
ROUNDING = 100 * np.finfo(float).eps
STIFF, SOFT = 1000.0, 1.0  # K and G, MPa
RUBBER = Elastic(1e-3, STIFF, SOFT)
ROOM = Box((-4.0, -4.0, -4.0), (8.0, 8.0, 8.0))


def cube(volume: str, **choices: Any) -> MaterialPointMethod:
    """Return 3 x 3 x 3 cells of eight points."""
    return rod(RUBBER, (0.0, 0.0, 0.0), body=block(CELL, 3, 3, 3), box=ROOM, volume=volume, **choices)


def strained(method: MaterialPointMethod, motion: Any, dt: float) -> MaterialPointMethod:
    """Strain the points by nodes that move as ``motion(x, y, z)`` [mm/ms]."""
    grid = fresh_grid(method)
    n = np.arange(len(grid.velocity))
    nx, ny = int(grid.nx), int(grid.ny)
    x = grid.x0 + grid.cell * (grid.i0 + n % nx)
    y = grid.y0 + grid.cell * (grid.j0 + n // nx % ny)
    z = grid.z0 + grid.cell * (grid.k0 + n // (nx * ny))
    grid.velocity[:, :3] = np.column_stack(motion(x, y, z))
    method.update_stress(dt)
    return method


def pressure(method: MaterialPointMethod) -> Array:
    return -method.points.material.stress[:, :3].mean(axis=1)


def swirl(x: Array, y: Array, z: Array) -> tuple[Array, Array, Array]:
    noise = np.random.default_rng(2).normal(size=(3, len(x)))
    return x + 2 * y + noise[0], z * y + noise[1], x * z + noise[2]


@pytest.mark.parametrize("shape", sorted(SHAPES))
@pytest.mark.parametrize("volume", sorted(VOLUMES))
def test_uniform_strain_gives_uniform_stress(volume: str, shape: str) -> None:
    slope, dt = np.random.default_rng(7).normal(size=(3, 3)), 1e-2
    method = strained(cube(volume, shape=shape), lambda *x: tuple(slope @ np.array(x)), dt)
    points = method.points
    force = np.eye(3) + dt * slope
    assert_allclose(points.shared.jacobian, np.linalg.det(force), rtol=10 * ROUNDING)
    # coordinates up to 8 cells, and the bulk modulus over the shear modulus, stand before the rounding
    assert_allclose(
        points.material.stress,
        np.broadcast_to(points.material.stress[0], points.material.stress.shape),
        atol=10 * ROUNDING * STIFF,
    )
    assert np.abs(points.material.stress[0]).max() > SOFT * dt


def test_cell_mean_keeps_what_points_gain_together_and_how_they_shear() -> None:
    one, other = (strained(cube(name), swirl, 1e-2) for name in ("local", "cell-mean"))
    cell = np.floor(one.points.position).astype(int) @ [1, 10, 100]
    for points in (one.points, other.points):
        points.material.stress[:, :3] -= points.material.stress[:, :3].mean(axis=1, keepdims=True)
    assert_allclose(other.points.material.stress, one.points.material.stress, atol=ROUNDING * STIFF)
    for name in np.unique(cell):
        own, shared = one.points.shared.jacobian[cell == name], other.points.shared.jacobian[cell == name]
        assert len(own) == 8
        assert np.ptp(own) > 1e-4
        assert_allclose(shared, own.mean(), rtol=ROUNDING)


@pytest.mark.parametrize(("volume", "share"), [("local", 1.0), ("cell-mean", 0.0)])
def test_bending_locks_points_but_not_cells(volume: str, share: float) -> None:
    """The isochoric v = κ (x z, 0, -(x² + z²) / 2), by nodes: its z² is straight within a cell, its x z is exact.

    So the divergence is κ (z - z_mid), ± κ h / 4 at the points of a cell, and after a short time p = ∓ K κ h t / 4:
    with K/G = 1000, hundreds of times the shear stress, 2 G κ z t. The mean over the cell is right.
    """
    rate, dt = 1.0, 1e-6
    method = strained(cube(volume), lambda x, y, z: (rate * x * z, 0 * y, -rate * (x * x + z * z) / 2), dt)
    z = method.points.position[:, 2]
    expected = -STIFF * rate * (z - np.floor(z) - CELL / 2) * dt
    assert np.abs(expected).max() == STIFF * rate * CELL / 4 * dt
    # strains of up to 3 κ t: their squares, and the rounding of 1 + θ
    atol = STIFF * ((6 * rate * dt) ** 2 + ROUNDING)
    assert_allclose(pressure(method), share * expected, atol=atol)


def test_bending_vibration_makes_pressure_oscillate_within_cells_unless_it_is_shared() -> None:
    """With K/G = 1000, released with that motion and let go: shear stress grows as 2 G κ z t, at most."""
    rate, count, worst = 1e-3, 40, {}
    for volume in ("local", "cell-mean"):
        method = cube(volume, viscosity=(0.0, 0.0))
        x, _, z = (method.body.position - CELL * 1.5).T
        method.points.velocity[:] = np.column_stack([rate * x * z, 0 * x, -rate * (x * x + z * z) / 2])
        time = 0.0
        for _ in range(count):
            dt = method.stable_step()
            method.advance(dt)
            time += dt
        cell = np.floor(method.body.position).astype(int) @ [1, 10, 100]
        spread = [np.ptp(pressure(method)[cell == name]) for name in np.unique(cell)]
        worst[volume] = max(spread) / (2 * SOFT * rate * 1.5 * CELL * time)
    assert worst["local"] > 10.0
    # points that share every dilatation have one pressure; the law takes its logarithm with K before the rounding
    assert worst["cell-mean"] < count * ROUNDING * STIFF / (2 * SOFT * rate * 1.5 * time)


def test_all_points_of_a_cell_push_with_their_mean_pressure() -> None:
    method = cube("cell-mean")
    points = method.points
    random = np.random.default_rng(5)
    points.material.stress[:] = random.normal(size=points.material.stress.shape)
    points.shared.viscous_pressure[:] = random.uniform(size=len(points.mass))
    points.shared.jacobian[:] = random.uniform(0.9, 1.1, len(points.mass))
    shared = method.volume.of_pressure(points, method.grid)
    found = np.array([components(acting_stress(shared, points, p, method.grid)) for p in range(len(points.mass))])
    own = points.material.stress[:, :3].mean(axis=1) - points.shared.viscous_pressure
    cell = np.floor(points.position).astype(int) @ [1, 10, 100]
    for name in np.unique(cell):
        here = cell == name
        mean = np.average(own[here], weights=points.shared.jacobian[here])
        assert_allclose(found[here, :3].mean(axis=1), mean, atol=ROUNDING)
    spherical = found[:, :3].mean(axis=1) - points.material.stress[:, :3].mean(axis=1)
    assert_allclose(found[:, :3] - spherical[:, None], points.material.stress[:, :3], atol=ROUNDING)
    assert_allclose(found[:, 3:], points.material.stress[:, 3:], atol=ROUNDING)


def test_work_of_shared_pressure_on_the_nodes_is_that_of_the_shared_dilatation() -> None:
    """- Σ f_i v_i dt is what law and bulk viscosity are given, points of unlike pressure in one cell or not."""
    method, dt = cube("cell-mean"), 1e-7
    points, random = method.points, np.random.default_rng(6)
    tension = random.normal(size=len(points.mass))
    points.material.stress[:, :3] = tension[:, None]
    force = scattered(method).force[:, :3].copy()
    points.shared.viscous_pressure[:] = -tension  # keep for the account: it is what pulls, minus
    points.material.stress[:] = 0.0
    strained(method, swirl, dt)
    work = -float((force * method.grid.velocity[:, :3]).sum()) * dt
    taken = float(points.volume @ points.shared.viscous_loss)
    assert abs(work) > 1e-7
    assert_allclose(taken, work, rtol=1e-5)  # strain is taken at mid-step: of its own size, some 1e-6
