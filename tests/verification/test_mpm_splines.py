"""B-splines on the nodes against SciPy's, at walls and away from them, and what they do to waves."""

from typing import Any

import numpy as np
import pytest
from columns import COURANT, ELASTIC, LENGTH, Array, column, layers, one_thread, order, rod  # noqa: F401
from numpy.testing import assert_allclose
from scipy.interpolate import BSpline

from viscopoint.interactions.planes import rigid_wall, symmetry_plane
from viscopoint.kernels.arrays import Indices
from viscopoint.materials.block import MaterialBlock
from viscopoint.methods.mpm.points import at_rest
from viscopoint.methods.mpm.shapes import NOWHERE, SHAPES, along, stencil
from viscopoint.methods.mpm.shapes.splines import Quadratic
from viscopoint.methods.mpm.transfers import Transfer
from viscopoint.methods.mpm.transfers.affine_pic import Apic
from viscopoint.methods.mpm.transfers.flip import Flip

pytestmark = pytest.mark.usefixtures("one_thread")
ROUNDING = 100 * np.finfo(float).eps
DEGREES = {"quadratic": 2, "cubic": 3}
LOW, HIGH, COUNT = 3, 8, 12  # planes of the walls, nodes in all
POINTS = at_rest(np.zeros((1, 3)), np.ones(1), np.ones(1), MaterialBlock(ELASTIC))
SPLINE = pytest.mark.parametrize("name", sorted(DEGREES))
AXIS = pytest.mark.parametrize("axis", [0, 1, 2])
RINGING = [(Flip(0.0), 4), pytest.param(Apic(), 2, marks=pytest.mark.long)]  # and how many filters they leave of four


def between_walls(name: str, axis: int, low: int = LOW, high: int = HIGH) -> Any:
    """Return the shape function along one axis of a lattice that has walls on that axis only."""
    planes = [(NOWHERE, NOWHERE) if a != axis else (low, high) for a in range(3)]
    return along(SHAPES[name].fitted(0.5).walled(*planes), POINTS, 0, axis)


def acts(shape: Any, place: float) -> tuple[Indices, Array, Array]:
    first, weights, slopes = stencil(shape, place)
    return int(first) + np.arange(len(weights)), np.array(weights), np.array(slopes)


def spread(shape: Any, place: float) -> tuple[Array, Array]:
    """Return the weights and slopes of all nodes."""
    nodes, weights, slopes = acts(shape, place)
    all_weights, all_slopes = np.zeros(COUNT), np.zeros(COUNT)
    all_weights[nodes], all_slopes[nodes] = weights, slopes
    return all_weights, all_slopes


def basis(degree: int, node: int, place: float) -> tuple[float, float]:
    """Return SciPy's B-spline around a node, and its slope."""
    element = BSpline.basis_element(node - (degree + 1) / 2 + np.arange(degree + 2.0), extrapolate=False)
    return float(np.nan_to_num(element(place))), float(np.nan_to_num(element.derivative()(place)))


def places(low: float, high: float) -> Array:
    return np.concatenate([np.random.default_rng(2).uniform(low, high, 200), np.arange(low, high, 0.25) + 1e-9])


@SPLINE
def test_weights_are_scipy_s_b_splines(name: str) -> None:
    shape = SHAPES[name].fitted(0.5)
    for place in places(2.0, 10.0):
        expected = np.array([basis(DEGREES[name], node, place) for node in range(COUNT)]).T
        assert_allclose(spread(shape, place), expected, atol=ROUNDING)


@SPLINE
@AXIS
def test_nodes_beyond_a_wall_follow_those_in_front_on_a_straight_line(name: str, axis: int) -> None:
    """SciPy's B-splines on one side of the wall, with 2 v_0 - v_1 for the node behind it."""
    shape = between_walls(name, axis)
    for place in places(float(LOW), float(HIGH)):
        expected = np.array([basis(DEGREES[name], node, place) for node in range(COUNT)]).T
        for wall, front in ((LOW, 1), (HIGH, -1)):
            behind = expected[:, wall - front].copy()
            expected[:, wall] += 2 * behind
            expected[:, wall + front] -= behind
            expected[:, wall - front] = 0.0
        assert_allclose(spread(shape, place), expected, atol=ROUNDING)


@SPLINE
@AXIS
@pytest.mark.parametrize(("low", "high"), [(LOW, HIGH), (5, 6), (NOWHERE, 5), (5, NOWHERE)])
def test_walls_keep_unity_and_linear_fields_on_both_sides(name: str, axis: int, low: int, high: int) -> None:
    shape = between_walls(name, axis, low, high)
    for place in places(2.0, 10.0):
        nodes, weights, slopes = acts(shape, place)
        assert weights.min() >= -ROUNDING
        assert_allclose([weights.sum(), weights @ nodes], [1.0, place], atol=10 * ROUNDING)
        assert_allclose([slopes.sum(), slopes @ nodes], [0.0, 1.0], atol=10 * ROUNDING)


@SPLINE
def test_quadratic_fields_are_kept_inside_up_to_their_mean_over_a_spline(name: str) -> None:
    """Σ N_i i² = x² + (degree + 1) / 12, the variance of the B-spline; near a wall it is less."""
    spread_out = (DEGREES[name] + 1) / 12
    shape = between_walls(name, 2)
    for place in places(LOW + 1.0, HIGH - 1.0):
        nodes, weights, slopes = acts(shape, place)
        assert_allclose(weights @ nodes**2, place**2 + spread_out, rtol=10 * ROUNDING)
        assert_allclose(slopes @ nodes**2, 2 * place, rtol=100 * ROUNDING)
    nodes, weights, _ = acts(shape, LOW + 1e-9)
    assert_allclose(weights @ nodes**2, LOW**2, rtol=1e-8)


@SPLINE
@AXIS
def test_one_held_plane_of_nodes_decides_the_velocity_on_the_wall(name: str, axis: int) -> None:
    for wall, inward in ((LOW, 1), (HIGH, -1)):
        weights, _ = spread(between_walls(name, axis), wall + inward * 1e-13)
        others = np.arange(COUNT) != wall
        assert_allclose(weights[wall], 1.0, atol=1e-12)
        assert_allclose(weights[others], 0.0, atol=1e-12)
        free, _ = spread(SHAPES[name].fitted(0.5), float(wall))
        assert free[others].sum() > 0.2  # what holding the plane would leave without the wall's splines


@SPLINE
def test_slopes_are_continuous_between_walls(name: str) -> None:
    shape, step = between_walls(name, 2), 1e-7
    for border in np.arange(LOW + 0.5, HIGH, 0.5):
        before, after = (spread(shape, border + side)[1] for side in (-step, step))
        assert_allclose(after, before, atol=2 * step * 2.1)  # the slope's slope is 2 at most


def test_walls_are_found_on_their_side_of_the_body() -> None:
    method = rod(
        lift=1.0, shape="quadratic", walls=(rigid_wall(0.0, 0.0), symmetry_plane(0, 4.0), symmetry_plane(1, -3.0))
    )
    box_low, overhang = -6, 1
    x, y, z = method.planes.wall_planes(method.grid)
    assert (x, y, z) == ((NOWHERE, 4 - box_low + overhang), (-3 - box_low + overhang, NOWHERE), (overhang, NOWHERE))
    assert method.shape == Quadratic(*x, *y, *z)


@SPLINE
@pytest.mark.parametrize(("transfer", "filters"), RINGING)
def test_column_between_rollers_rings_at_the_spline_s_frequency(name: str, transfer: Transfer, filters: int) -> None:
    """sin(kz) held at both ends. Weights of variance s = (degree + 1) / 12 cells² filter a wave by 1 - s (kh)² / 2.

    Two such filters take velocities from points to nodes and back, unless the transfer makes up for them; two more are
    in strain and force: w² = c² k² (1 - 2 s (kh)²), or half of that, and leapfrog steps of Courant number C add
    C² / 12: w = c k (1 - (s - C² / 24) (kh)²), or s / 2.
    """
    off = []
    for cells in (24, 48):
        k, ends = np.pi / LENGTH, (symmetry_plane(2, 0.0), symmetry_plane(2, LENGTH))
        method = column(cells, ELASTIC, ends, lambda z, k=k: 1e-4 * np.sin(k * z), shape=name, transfer=transfer)
        mode, dt, found = np.sin(k * layers(method.body.position[:, 2])), method.stable_step(), []
        for _ in range(int(1.8 * cells / COURANT)):
            method.advance(dt)
            found.append(float(layers(method.points.velocity[:, 2]) @ mode))
        signs = np.array(found)
        at = np.flatnonzero(signs[1:] * signs[:-1] < 0)[:2]
        crossing = at + signs[at] / (signs[at] - signs[at + 1])
        frequency = np.pi / (np.diff(crossing)[0] * dt)
        off.append(1 - frequency / (k * method.sound))
    dispersion = filters / 4 * (DEGREES[name] + 1) / 12 - COURANT**2 / 24
    # the next terms: (kh)² of it, and the wall's cells, where the filter is another: a share kh
    short = np.pi / 48
    assert_allclose(off[1], dispersion * short**2, rtol=3 * short)
    assert 1.8 < order(off) < 2.2
