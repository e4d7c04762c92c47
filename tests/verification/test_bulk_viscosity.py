"""What bulk viscosity does to a shock and to a wave, how much it takes, and what rate it sees; by every method."""

from collections.abc import Callable
from typing import Any, NamedTuple

import bricks
import columns
import lagrangian
import numpy as np
import pytest
import rings
from columns import DENSITY, ELASTIC, LENGTH, Array, one_thread  # noqa: F401
from material_point import orders
from numpy.testing import assert_allclose
from shocks import Shock

from viscopoint.interactions.planes import Interaction, rigid_wall, symmetry_plane
from viscopoint.methods.fem.cells import corner_values, modes_of, smallest_length, volume, volume_gradient
from viscopoint.methods.fem.cells.hexahedron_modes import Hexahedron
from viscopoint.methods.fem.cells.ring import Ring
from viscopoint.methods.mpm.volumes import VOLUMES as MPM_VOLUMES
from viscopoint.methods.tlmpm.volumes import VOLUMES
from viscopoint.model.method import Method

pytestmark = pytest.mark.usefixtures("one_thread")
MODULUS = ELASTIC.bulk + 4 / 3 * ELASTIC.shear
SOUND = float(np.sqrt(MODULUS / DENSITY))
Motion = Callable[[Array], Array]
Ends = tuple[Interaction, ...]


class Column(NamedTuple):
    """A laterally confined elastic column."""

    method: Any
    levels: Callable[[], Array]  # speed along z of each plane of nodes, or of points a cell apart, from the foot up
    area: float  # mm^2


def elements(name: str, cells: int, ends: Ends, speed: Motion, viscosity: tuple[float, float]) -> Column:
    half = 0.5 * LENGTH / cells
    body = bricks.brick((2 * half, 2 * half, LENGTH), (1, 1, cells))
    sides = [symmetry_plane(axis, place) for axis in (0, 1) for place in (-half, half)]
    velocity = bricks.upward(speed)(body.position)
    method = bricks.fem(body, bricks.ELEMENTS[name], ELASTIC, (*ends, *sides), velocity, viscosity=viscosity)
    return Column(method, lambda: bricks.layers(method, method.nodes.velocity[:, 2]), bricks.area(method))


def disc_elements(name: str, cells: int, ends: Ends, speed: Motion, viscosity: tuple[float, float]) -> Column:
    radius = LENGTH / cells
    body = rings.section(radius, LENGTH, 1, cells)
    velocity = bricks.upward(speed)(body.position)
    boundaries = (*ends, symmetry_plane(0, radius))
    method = rings.fem(body, bricks.ELEMENTS[name], ELASTIC, boundaries, velocity, safety=0.5, viscosity=viscosity)
    on_axis = np.flatnonzero(body.position[:, 0] == 0.0)
    on_axis = on_axis[np.argsort(body.position[on_axis, 2])]
    return Column(method, lambda: method.nodes.velocity[on_axis, 2], np.pi * radius**2)


def reference_points(name: str, cells: int, ends: Ends, speed: Motion, viscosity: tuple[float, float]) -> Column:
    cell = LENGTH / cells
    sides = [symmetry_plane(axis, place) for axis in (0, 1) for place in (0.0, cell)]
    motion = lagrangian.upward(speed)
    method = lagrangian.brick(
        (1, 1, cells), ELASTIC, (*ends, *sides), motion, cell=cell, volume=name, viscosity=viscosity, safety=0.5
    )
    return Column(method, lambda: lagrangian.levels(method, method.nodes.velocity[:, 2]), cell**2)


def points(name: str, cells: int, ends: Ends, speed: Motion, viscosity: tuple[float, float]) -> Column:
    method = columns.column(cells, ELASTIC, ends, speed, viscosity=viscosity, volume=name)
    return Column(method, lambda: columns.layers(method.points.velocity[:, 2])[::2], columns.area(method))


LAGRANGIAN = {
    **{f"fem-{name}": (elements, name) for name in bricks.ELEMENTS},
    **{f"rings-{name}": (disc_elements, name) for name in bricks.ELEMENTS},
    **{f"tlmpm-{name}": (reference_points, name) for name in VOLUMES},
}
EVERY = LAGRANGIAN | {f"mpm-{name}": (points, name) for name in MPM_VOLUMES}


def run(method: Method, time: float, watch: Callable[[], Any] = lambda: None) -> None:
    done = 0.0
    while done < time * (1 - 1e-12):
        dt = min(method.stable_step(), time - done)
        method.advance(dt)
        done += dt
        watch()


@pytest.mark.parametrize("kind", LAGRANGIAN)
def test_quadratic_viscosity_spreads_a_steady_shock_as_far_as_its_size_says(kind: str) -> None:
    """Steepness and loss of a shock of J = 0.50: the rest of the Rayleigh line and of Rankine and Hugoniot's energy."""
    cells, speed, quadratic = 120, 500.0, 15.0
    make, name = LAGRANGIAN[kind]
    column = make(name, cells, (rigid_wall(0.0, 0.0),), lambda z: np.full_like(z, -speed), (0.0, quadratic))
    shock = Shock(DENSITY, MODULUS, speed, LENGTH / cells)
    found, lost = [], []
    run(column.method, 0.5 * LENGTH / shock.front)
    lost.append(column.method.totals().viscous)
    run(column.method, 0.35 * LENGTH / shock.front, lambda: found.append(np.abs(np.diff(column.levels())).max()))
    lost.append(column.method.totals().viscous)
    # 11 cells wide: differences over a cell are too small, and what the impact left of the profile is too steep, by 1 %
    assert speed / shock.steepest(0.0, quadratic) > 10 * shock.cell
    assert_allclose(max(found) / shock.cell, shock.steepest(0.0, quadratic), rtol=0.02)
    assert_allclose(lost[1] - lost[0], shock.loss * column.area * 0.35 * LENGTH, rtol=0.015)


@pytest.mark.parametrize("kind", EVERY)
@pytest.mark.parametrize(("linear", "quadratic"), [(0.3, 0.0), (0.0, 300.0)], ids=["linear", "quadratic"])
def test_viscosity_takes_from_a_standing_wave_what_its_size_says(kind: str, linear: float, quadratic: float) -> None:
    """A wave v0 sin kx cos wt loses, where and while it is compressed, ρ h c a d² + ρ h² b |d|³ per time and volume.

    With means of sin² of 1/2 and of |sin|³ of 4/3π, that is π kh a + 64/9π (kh)² b v0/c of its energy in a period.
    """
    share = 1e-3  # v0 / c
    make, name = EVERY[kind]
    ends = (symmetry_plane(2, 0.0), symmetry_plane(2, LENGTH))

    def swung(cells: int, viscosity: tuple[float, float]) -> tuple[float, float, float]:
        column = make(name, cells, ends, lambda z: share * SOUND * np.sin(np.pi * z / LENGTH), viscosity)
        start = column.method.totals()
        run(column.method, 2 * LENGTH / SOUND)
        now = column.method.totals()
        return start.kinetic, now.viscous, now.kinetic + now.stored

    ratios = []
    for cells in (40, 80):
        kh = np.pi / cells
        energy, taken, left = swung(cells, (linear, quadratic))
        rate = np.pi * kh * linear + 64 / (9 * np.pi) * kh**2 * quadratic * share
        ratios.append(taken / (-np.expm1(-rate) * energy))
        if linear or kind in LAGRANGIAN:  # the paper's mapping of points loses a third as much as the faint term
            # it is the motion that pays; transfers by points lose 0.7 % of it less, where there is less to lose
            assert_allclose(swung(cells, (0.0, 0.0))[2] - left, taken, rtol=0.01)
    # of first order in kh, as the rate is known half a step late; what is left is of its square and of v0 / c
    assert_allclose(ratios, 1.0, rtol=0.025)
    assert_allclose(2 * ratios[1] - ratios[0], 1.0, rtol=3 * share)


# --- one step ---

SQUEEZE = np.array([[-0.31, 0.08, 0.05], [-0.06, -0.22, 0.09], [0.04, -0.07, -0.26]])


class Body(NamedTuple):
    """A body that is moved at will."""

    method: Any
    place: Array
    moved: Callable[[Array, float], Array]  # by a velocity for a step; returns the nodes' forces


def body_of(kind: str, viscosity: tuple[float, float]) -> Body:
    """Return some cells of each method, those of meshes distorted."""
    family, name = kind.split("-", 1)
    if family == "tlmpm":
        points = lagrangian.brick((1, 2, 2), volume=name, viscosity=viscosity)
        return Body(points, points.reference, lambda v, dt: lagrangian.moved(points, v, dt))
    if family == "fem":
        body = bricks.brick((2.0, 2.0, 2.0), (2, 2, 2), shake=0.2)
        method = bricks.fem(body, bricks.ELEMENTS[name], viscosity=viscosity)
    else:
        body = rings.section(2.0, 2.0, 2, 2, shake=0.2)
        method = rings.fem(body, bricks.ELEMENTS[name], viscosity=viscosity)
    return Body(method, body.position, lambda v, dt: bricks.answer(method, v, dt))


def motions(kind: str, place: Array) -> tuple[Array, Array]:
    """Return an uneven displacement, and a velocity that makes all cells shrink unevenly."""
    rng = np.random.default_rng(11)
    plane = kind.startswith("rings")
    first, then = 0.15 * rng.normal(size=(2, *place.shape))
    first, then = first + place @ SQUEEZE.T, then + 3 * place @ SQUEEZE.T
    if plane:
        for motion in (first, then):
            motion[:, 1] = 0.0
            motion[:, 0] = np.where(place[:, 0] == 0.0, 0.0, motion[:, 0])
    return first, then


def strained(kind: str, viscosity: tuple[float, float]) -> tuple[Body, Array]:
    """Return a body that was displaced unevenly, and a velocity that makes all its cells shrink."""
    body = body_of(kind, viscosity)
    first, then = motions(kind, body.place)
    body.moved(first, 1.0)
    return body, then


@pytest.mark.parametrize("kind", LAGRANGIAN)
def test_viscous_loss_is_the_work_of_the_viscous_forces(kind: str) -> None:
    """Of bodies moved alike with and without viscosity: forces differ by its own; their work, to second order."""
    errors = []
    for dt in (0.02, 0.01, 0.005):
        (damped, then), (plain, _) = (strained(kind, viscosity) for viscosity in ((0.6, 1.5), (0.0, 0.0)))
        bodies = damped, plain
        before = np.subtract(*[body.moved(then, dt) for body in bodies])
        taken = damped.method.totals().viscous
        after = np.subtract(*[body.moved(then, dt) for body in bodies])
        work = -dt * float((0.5 * (before + after) * then).sum())
        errors.append((damped.method.totals().viscous - taken) / work - 1.0)
    assert abs(errors[0]) < 0.02
    assert_allclose(orders([abs(error) for error in errors]), 2, atol=0.15)


@pytest.mark.parametrize("kind", LAGRANGIAN)
def test_all_that_the_accounts_take_is_the_work_of_the_forces(kind: str) -> None:
    """Stored, hypoelastic, viscous and hourglass energy of a body moved at will, to second order in the step."""
    errors = []
    for dt in (0.02, 0.01, 0.005):
        body, then = strained(kind, (0.6, 1.5))
        before, start = body.moved(then, dt), body.method.totals()
        after, now = body.moved(then, dt), body.method.totals()
        work = -dt * float((0.5 * (before + after) * then).sum())
        taken = (now.energy - now.kinetic) - (start.energy - start.kinetic)
        errors.append(taken / work - 1.0)
    assert abs(errors[0]) < 0.003
    assert_allclose(orders([abs(error) for error in errors]), 2, atol=0.15)


@pytest.mark.parametrize("kind", LAGRANGIAN)
def test_viscosity_sees_the_rate_of_the_volume_that_the_law_sees(kind: str) -> None:
    """q / (ρ l c) over a step is ln J after less before, to second order, however uneven the motion within a cell."""
    errors = []
    for dt in (0.04, 0.02, 0.01):
        body, then = strained(kind, (1.0, 0.0))
        state = (body.method.points if kind.startswith("tlmpm") else body.method.elements).shared
        before = state.jacobian.copy()
        body.moved(then, dt)
        after, law = state.jacobian, body.method.material
        sound = np.sqrt(law.p_wave_modulus / law.density * after)
        strain = -dt * state.viscous_pressure / (law.density / after * lengths(kind, body) * sound)
        assert strain.max() < 0.0
        errors.append(np.abs(strain / np.log(after / before) - 1.0).max())
    assert errors[0] < 0.01
    assert_allclose(orders(errors), 2, atol=0.15)


def lengths(kind: str, body: Body) -> Array:
    """Return the length that the viscosity takes of each element or point [mm]."""
    if kind.startswith("tlmpm"):  # cells of 1 mm: the distance of opposite faces of what was one
        inverse = np.linalg.inv(body.method.points.deformation.reshape(-1, 3, 3))
        return 1.0 / np.linalg.norm(inverse, axis=2).max(axis=1)
    nodes, corners = body.method.nodes.position, body.method.body.cells
    cell = Ring() if kind.startswith("rings") else Hexahedron()
    places: list[Any] = [modes_of(cell, corner_values(cell, nodes, corner)) for corner in corners]
    gradients = [volume_gradient(place) for place in places]
    volumes = [volume(*pair) for pair in zip(places, gradients, strict=True)]
    return np.array([smallest_length(*each) for each in zip(places, gradients, volumes, strict=True)])
