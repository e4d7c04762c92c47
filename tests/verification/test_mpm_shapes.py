"""The shape functions of the grid against what defines them, and what they do to uniform stress and to waves."""

from typing import Any

import numpy as np
import pytest
from columns import BOX, CELL, DENSITY, ELASTIC, SHEAR_SHORT, Array, block, one_thread, rod, scattered  # noqa: F401
from numpy.testing import assert_allclose

from viscopoint.interactions.planes import Interaction, rigid_wall, symmetry_plane
from viscopoint.kernels.arrays import Indices
from viscopoint.materials.block import MaterialBlock
from viscopoint.materials.elastic import Elastic
from viscopoint.methods.mpm.fills.trimmed import rod_trimmed
from viscopoint.methods.mpm.geometry import Box
from viscopoint.methods.mpm.method import Discretisation, MaterialPointMethod
from viscopoint.methods.mpm.points import at_rest
from viscopoint.methods.mpm.schemes import SCHEMES
from viscopoint.methods.mpm.shapes import SHAPES, along, stencil
from viscopoint.methods.mpm.shapes.gimp import WIDEST, ContiguousGimp, Gimp
from viscopoint.methods.mpm.shapes.trilinear import LEAST
from viscopoint.methods.mpm.transfers.flip import Flip
from viscopoint.model.viscosity import BulkViscosity

pytestmark = pytest.mark.usefixtures("one_thread")
ROUNDING = 100 * np.finfo(float).eps
WIDTHS = (0.2, 0.5, 0.76, 1.0)
RANDOM = np.random.default_rng(1)


def places(width: float) -> Array:
    """Return coordinates in cells: anywhere, on nodes, mid-cell, and where a box' edge is on a node."""
    nodes = np.arange(1.0, 6.0)
    return np.concatenate([RANDOM.uniform(1, 6, 200), nodes, nodes + 0.5, nodes + width / 2, nodes + 1 - width / 2])


def acts(shape: Any, place: float) -> tuple[Indices, Array, Array]:
    """Return nodes, weights and slopes."""
    first, weights, slopes = stencil(shape, place)
    return int(first) + np.arange(len(weights)), np.array(weights), np.array(slopes)


@pytest.mark.parametrize("name", sorted(SHAPES))
@pytest.mark.parametrize("width", WIDTHS)
def test_weights_are_a_partition_of_unity_and_reproduce_linear_fields(name: str, width: float) -> None:
    shape = SHAPES[name].fitted(width)
    for place in places(width):
        nodes, weights, slopes = acts(shape, place)
        assert place - 1 - shape.overhang < nodes[0]
        assert nodes[0] >= 0
        assert nodes[-1] <= int(place) + 2  # what the slabs and the grid's window allow for
        assert (weights >= 0).all()
        assert_allclose(weights.sum(), 1.0, atol=ROUNDING)
        assert_allclose(slopes.sum(), 0.0, atol=ROUNDING)
        assert_allclose(weights @ nodes, place, atol=10 * ROUNDING + 2 * LEAST)
        assert_allclose(slopes @ nodes, 1.0, atol=10 * ROUNDING)


@pytest.mark.parametrize(
    ("kind", "width"),
    [
        *((kind, width) for kind in (Gimp, ContiguousGimp) for width in WIDTHS),
        (ContiguousGimp, 1.4),
        (ContiguousGimp, 2.0),
    ],
)
def test_gimp_averages_hat_functions_over_the_point_s_box(kind: Any, width: float) -> None:
    shape = kind.fitted(width)
    for place in places(width):
        nodes, weights, slopes = acts(shape, place)
        ends = np.array([place - width / 2, place + width / 2])
        kinks = np.arange(0.0, 9.0)
        at = np.sort(np.concatenate([ends, kinks[(kinks > ends[0]) & (kinks < ends[1])]]))
        for node in range(9):  # no node that is left out has any share
            mean = np.trapezoid(hat(at - node), at) / width  # exact: the hats are linear in between
            slope = np.diff(hat(ends - node))[0] / width
            assert_allclose(weights[nodes == node].sum(), mean, atol=ROUNDING)
            assert_allclose(slopes[nodes == node].sum(), slope, atol=2 * ROUNDING / width)


def hat(s: Array) -> Array:
    return np.maximum(1 - np.abs(s), 0)


@pytest.mark.parametrize(("name", "jump"), [("gimp", 0.0), ("cpgimp", 0.0), ("trilinear", 1.0)])
def test_slope_is_continuous_across_cells_with_gimp_only(name: str, jump: float) -> None:
    width, step = 0.76, 1e-6
    shape, found = SHAPES[name].fitted(width), 0.0
    for border in (3.0, 3.5, 3.0 + width / 2, 4.0 - width / 2):
        slopes = np.zeros((2, 9))
        for row, place in zip(slopes, (border - step, border + step), strict=True):
            nodes, _, values = acts(shape, place)
            row[nodes] = values
        found = max(found, np.abs(np.diff(slopes, axis=0)).max() / 2)  # of the middle node, from 1 to -1
    assert_allclose(found, jump, atol=2.1 * step / width)  # between borders the slope's slope is 2 / width at most


UNEVEN = 0.75  # cells between points: of three cells in a row, the middle one has two layers of them


def uneven(shape: str, blocks: int, ends: tuple[Interaction, ...] = (), law: Elastic = ELASTIC) -> MaterialPointMethod:
    """Return a column of ``blocks`` times three cells, two blocks wide, its lowest corner in the origin."""
    body = block(2 * UNEVEN * CELL, 2, 2, 2 * blocks)
    side, height = 3 * CELL, 3 * blocks * CELL
    box = Box((0.0, 0.0, -CELL), (side, side, height + 3 * CELL))
    fitted, none = SHAPES[shape].fitted(UNEVEN), BulkViscosity(0.0, 0.0)
    choices = Discretisation(CELL, box, fitted, SCHEMES["musl"], Flip(0.0), 0.5, none)
    return MaterialPointMethod(body, law, ends, choices, (0.0, 0.0, 0.0))


@pytest.mark.parametrize(("shape", "left"), [("gimp", 0.0), ("cpgimp", 0.0), ("trilinear", UNEVEN)])
def test_uniform_stress_pulls_at_inner_nodes_of_an_uneven_lattice_without_gimp(shape: str, left: float) -> None:
    """A cell with one layer of points, 3/4 cell thick, beside one with two: 3/4 of the pressure is left over."""
    pressure = 7.0
    method = uneven(shape, 2)
    method.points.material.stress[:, :3] = -pressure
    grid = scattered(method)
    across = grid.force[:, 2].reshape(int(grid.nz), -1).sum(axis=1)  # of each plane of nodes
    height = grid.z0 + grid.cell * (grid.k0 + np.arange(len(across)))
    inside = (height > 0.5) & (height < 5.5)
    area = 9.0
    assert_allclose(np.abs(across[inside]).max(), left * pressure * area, atol=ROUNDING * 72 * pressure)
    assert_allclose(across.sum(), 0.0, atol=ROUNDING * 72 * pressure)


def test_boxes_cut_by_the_circumference_pull_only_beside_it_with_gimp() -> None:
    """Nodes within reach of whole boxes alone feel nothing of a uniform pressure; all nodes together never do."""
    radius, pressure = 3.0, 7.0
    method = rod(ELASTIC, shape="gimp", cell=CELL, lift=2.0, body=rod_trimmed(radius, 6.0, CELL / 2))
    method.points.material.stress[:, :3] = -pressure
    grid = scattered(method)
    node = np.stack(np.unravel_index(np.arange(len(grid.force)), (int(grid.nz), int(grid.ny), int(grid.nx))))[::-1].T
    x, y, z = (np.array(grid[:3]) + grid.cell * (node + [grid.i0, grid.j0, grid.k0])).T
    reach = 1.25 * CELL + CELL / 4  # of the shape function, and on to where the box of such a point ends
    deep = (np.hypot(np.abs(x) + reach, np.abs(y) + reach) < radius) & (np.abs(z - 5.0) < 3.0 - 1.25 * CELL)
    force, scale = grid.force[:, :3], 100 * pressure * CELL**2
    assert deep.sum() >= 15
    assert_allclose(force[deep], 0.0, atol=ROUNDING * scale)
    assert_allclose(force.sum(axis=0), 0.0, atol=ROUNDING * scale)
    assert np.abs(force).max() > 0.1 * pressure * CELL**2  # on the surface


@pytest.mark.parametrize(("shape", "even"), [("gimp", False), ("cpgimp", True)])
@pytest.mark.parametrize("stretch", [0.8, 1.5])
def test_uniform_stress_pulls_at_no_inner_node_of_a_stretched_lattice_with_boxes_that_follow(
    shape: str, even: bool, stretch: float
) -> None:
    """At 4/5 of their distance undeformed boxes overlap, at 3/2 they leave gaps: some nodes get more than others."""
    pressure = 7.0
    method, middle = uneven(shape, 3), 4.5
    points = method.points
    points.position[:, 2] = (points.position[:, 2] - middle) * stretch + middle
    points.shared.jacobian[:] = stretch
    points.stretch[:, 2:] = stretch
    points.material.stress[:, :3] = -pressure
    method.restore(method.state())  # finds the points' cells
    grid = scattered(method)
    across = grid.force[:, 2].reshape(int(grid.nz), -1).sum(axis=1)
    height = grid.z0 + grid.cell * (grid.k0 + np.arange(len(across)))
    inside = np.abs(height - middle) < middle * stretch - 1.5
    assert inside.sum() >= 2
    found = np.abs(across[inside]).max() / (9.0 * pressure)
    assert found < 72 * ROUNDING if even else found > 0.04


def test_box_of_a_point_follows_its_stretch_to_two_cells() -> None:
    points, shape = (
        at_rest(np.zeros((2, 3)), np.ones(2), np.ones(2), MaterialBlock(ELASTIC)),
        ContiguousGimp.fitted(0.8),
    )
    points = points._replace(stretch=np.array([[0.5, 1.0, 2.0], [3.0, 1.5, 1.0]]))
    half = np.array([[along(shape, points, p, axis).half for axis in range(3)] for p in range(2)])
    assert_allclose(half, [[0.2, 0.4, 0.8], [WIDEST, 0.6, 0.4]], rtol=ROUNDING)


@pytest.mark.parametrize(
    ("shape", "stiffness"), [("gimp", 1.0), ("cpgimp", 1.0), ("trilinear", 3 / (4 / 3 + 2 / 3 + 4 / 3))]
)
def test_waves_run_too_slowly_through_an_uneven_lattice_without_gimp(shape: str, stiffness: float) -> None:
    """A cell is as stiff as it has points: 3/4, 3/2, 3/4 of what it should be, one after the other.

    Springs in series add their compliances, (4/3 + 2/3 + 4/3) / 3 = 10/9: long waves run at sqrt(9/10) of the speed of
    sound. (No Poisson's ratio here: with one, uneven pressure on the sides slows them further, to 91 % for the paper's
    moduli.) Boxes side by side take the gradient of all cells they cover, and leave nothing out.
    """
    law = Elastic(DENSITY, 2 / 3 * SHEAR_SHORT, SHEAR_SHORT)
    blocks = 16
    length, speed = 3.0 * blocks, np.sqrt(law.p_wave_modulus / DENSITY)
    rollers = tuple(symmetry_plane(axis, place) for axis in (0, 1) for place in (0.0, 3.0))
    method = uneven(shape, blocks, rollers, law)
    mode = np.cos(np.pi * method.body.position[:, 2] / length)
    method.points.velocity[:, 2] = 1e-4 * mode
    dt, found = 0.5 / speed, []
    for _ in range(int(2 * length / speed / dt)):
        method.advance(dt)
        found.append(float(method.points.velocity[:, 2] @ mode))
    signs = np.array(found)
    at = np.flatnonzero(signs[1:] * signs[:-1] < 0)[:2]
    crossing = at + signs[at] / (signs[at] - signs[at + 1])
    frequency = np.pi / (np.diff(crossing)[0] * dt)
    # dispersion takes at most (1/24 + filter) (kh)^2, and filter is 1/8 of the support's second moment: < 1/8
    short = (1 / 24 + 1 / 8) * (np.pi / length) ** 2
    assert_allclose(frequency / (np.pi / length * speed), np.sqrt(stiffness), atol=2 * short)


def test_lattice_begins_outside_the_box_only_for_what_reaches_there() -> None:
    for shape, cells in (("trilinear", 0), ("gimp", 1), ("cpgimp", 1), ("quadratic", 1), ("cubic", 1)):
        grid = rod(shape=shape).grid
        assert (grid.x0, grid.y0, grid.z0) == tuple(low - cells * CELL for low in BOX.low)


def test_points_closer_to_the_box_than_half_their_size_keep_all_their_mass_and_force() -> None:
    method = rod(shape="gimp", cell=1.0, lift=-0.2, velocity=(1.0, 2.0, -3.0))  # boxes reach 0.2 below the floor
    assert method.points.position[:, 2].min() < 0.25
    assert method.lost() == 0
    points = method.points
    points.material.stress[:] = np.random.default_rng(3).normal(size=points.material.stress.shape)
    grid = scattered(method)
    mass = points.mass.sum()
    assert_allclose(grid.momentum.sum(axis=0), mass * np.array([1.0, 2.0, -3.0, 1.0]), rtol=ROUNDING)
    assert_allclose(grid.force[:, :3].sum(axis=0), 0.0, atol=ROUNDING * np.abs(grid.force).sum())


def test_wall_holds_what_reaches_beyond_it() -> None:
    method = rod(shape="gimp", cell=1.0, lift=-0.2, velocity=(0.0, 0.0, -3.0), walls=(rigid_wall(0.0, 0.0),))
    method.advance(1e-6)
    grid = method.grid
    height = grid.z0 + grid.cell * (grid.k0 + np.arange(int(grid.nz)))
    velocity = grid.velocity[:, 2].reshape(int(grid.nz), -1)
    assert grid.momentum[:, 3].reshape(int(grid.nz), -1)[height == -1.0].sum() > 0.0
    assert (velocity[height <= 0.0] == 0.0).all()
    assert velocity[height == 3.0].min() < -2.9
