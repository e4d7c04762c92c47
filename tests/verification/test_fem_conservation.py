"""What a step of finite elements must keep: momentum, energy, freedom after contact; and that no bit depends on the
threads. See ``conserved``.
"""

from typing import Any

import conserved
import numpy as np
import pytest
from bricks import DISPERSION, ELASTIC, ELEMENTS, ON_WALL, brick, column, each_element, fem, layers, upward
from columns import COURANT, advance, one_thread, order  # noqa: F401
from conserved import RELAXING, ROUNDING, missing, missing_after, steps, stirred, trembling
from numpy.testing import assert_allclose, assert_array_equal

from viscopoint.interactions.planes import rigid_wall, symmetry_plane
from viscopoint.kernels.arrays import Real
from viscopoint.methods.fem.elements import Element
from viscopoint.methods.fem.method import FiniteElementMethod
from viscopoint.methods.fem.rod import rod_mesh
from viscopoint.model.body import Body

pytestmark = pytest.mark.usefixtures("one_thread")
PULSE = (0.06, 1.5)  # bulk viscosity as in impacts
ROD = rod_mesh(2.0, 6.0, 1.0)


def impact(
    element: Element, friction: float = 0.1, body: Body = ROD, law: Any = RELAXING, real: Real = np.float64
) -> FiniteElementMethod:
    return fem(body, element, law, (rigid_wall(0.0, friction),), (20.0, 5.0, -100.0), viscosity=PULSE, real=real)


# --- momentum ---


@each_element
def test_linear_and_angular_momentum_are_kept_without_a_wall(element: Element) -> None:
    """Angular momentum too, to rounding: forces are those of a symmetric stress where the nodes are, kicks are at rest.

    The hourglass controls push the modes less what the mean gradient explains, and so have no moment either.
    """
    method = fem(ROD, element, RELAXING, (), stirred(ROD.position), viscosity=PULSE)
    conserved.assert_free_flight_keeps_both_momenta(method)


@each_element
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_wall_impulse_is_the_change_of_momentum(element: Element, friction: float) -> None:
    conserved.assert_wall_impulse_is_the_change_of_momentum(impact(element, friction), friction)


@each_element
def test_quarter_between_mirrors_moves_as_the_whole(element: Element) -> None:
    velocity, size, foot = (0.0, 0.0, -50.0), (4.0, 4.0, 3.0), 0.01
    whole = fem(brick(size, (4, 4, 3), foot=foot), element, RELAXING, ON_WALL, velocity)
    quarter = brick((2.0, 2.0, 3.0), (2, 2, 3), foot=foot)
    quarter = quarter._replace(position=quarter.position + [1.0, 1.0, 0.0])
    part = fem(quarter, element, RELAXING, (*ON_WALL, symmetry_plane(0, 0.0), symmetry_plane(1, 0.0)), velocity)
    start, dt = part.totals(), part.stable_step() / 2
    for _ in range(80):
        whole.advance(dt)
        part.advance(dt)
    one, four = part.totals(), whole.totals()
    for name in ("kinetic", "stored", "dissipated", "contact"):
        assert_allclose(4 * getattr(one, name), getattr(four, name), rtol=1e-9)  # 80 steps of roundings, amplified
    assert_allclose(one.momentum - start.momentum, one.impulse, rtol=0, atol=80 * ROUNDING * start.mass * 50.0)
    assert np.abs(one.impulse[:2]).max() > 1e-3 * one.impulse[2]  # the mirrors push
    assert one.friction == 0.0  # and do no work


# --- contact ---


@each_element
def test_contact_is_made_exactly_when_the_foot_has_crossed_the_gap(element: Element) -> None:
    gap, speed, height = 0.0823, 40.0, -0.7
    body = brick((2.0, 2.0, 3.0), (2, 2, 3), foot=height + gap)
    method = fem(body, element, ELASTIC, (rigid_wall(height, 0.2),), (0.0, 0.0, -speed))
    foot = body.surface.ring[0]
    push, dt = conserved.assert_contact_is_made_when_the_gap_is_crossed(method, foot, height, gap, speed)
    mass = method.nodes.mass[foot].sum()
    # what stops the foot, and half a step of the force of elements that are strained by less than v dt / h
    assert mass * speed <= push < mass * speed + 0.5 * dt * 4.0 * method.material.p_wave_modulus * speed * dt


@each_element
def test_nodes_stand_on_the_wall_to_the_last_bit_and_none_passes_it(element: Element) -> None:
    # nodes come from far, compared with the height, which leaves their last bits to rounding
    body, height, pressed = brick((2.0, 2.0, 2.0), (2, 2, 2), foot=0.03), 1 / 3000, 0
    velocity = np.random.default_rng(6).normal(size=body.position.shape) * 20.0 - [0.0, 0.0, 50.0]
    method = fem(body, element, RELAXING, (rigid_wall(height, 0.1),), velocity)
    for _ in range(100):
        steps(method, 1)
        assert_array_equal(method.nodes.position[method.nodes.in_contact > 0, 2], height)
        assert method.nodes.position[:, 2].min() >= height
        pressed += int(method.nodes.in_contact.sum())
    assert pressed > 10


@each_element
@pytest.mark.parametrize("cells", [50, 100])
def test_elastic_column_rebounds_without_adhesion_or_gain(element: Element, cells: int) -> None:
    method = column(cells, element, ELASTIC, velocity=upward(lambda z: np.full_like(z, -1e-3)))
    # its tail comes and goes with h
    (most, left), _ = conserved.assert_rebounds_without_adhesion(method, cells, DISPERSION, late=0.5)
    assert most < 1.0
    # the half element at the foot stops, which is all that is lost; the energy of the front's shortest waves swings by
    # (w dt)^2 / 4 < C^2 in leapfrog steps, and they are in about as much of the column
    assert_allclose(left, 1 - 0.5 / cells, rtol=0, atol=COURANT**2 * 0.5 / cells)
    assert layers(method, method.nodes.position[:, 2])[0] > 0.0


@each_element
def test_contact_takes_just_the_energy_of_the_foot_that_stops(element: Element) -> None:
    cells, speed = 50, 1.0
    method = column(cells, element, RELAXING, velocity=upward(lambda z: np.full_like(z, -speed)))
    start = method.totals().kinetic
    advance(method, 0.02)
    assert_allclose(method.totals().contact, start / (2 * cells), rtol=1e-12)
    assert method.totals().friction == 0.0


@each_element
def test_sliding_block_feels_coulomb_friction(element: Element) -> None:
    friction, speed = 0.2, 20.0
    walls = (rigid_wall(0.0, friction), symmetry_plane(1, -1.0), symmetry_plane(1, 1.0))
    method = fem(brick((4.0, 2.0, 3.0), (4, 2, 3)), element, ELASTIC, walls, (speed, 0.0, -1.0))
    conserved.assert_slides_by_coulomb(method, friction, speed)


@each_element
def test_slow_block_sticks_and_no_more(element: Element) -> None:
    slide, speed, dt = 0.1, 10.0, 1e-9
    method = fem(brick((3.0, 3.0, 3.0), (3, 3, 3)), element, ELASTIC, (rigid_wall(0.0, 0.5),), (slide, 0.0, -speed))
    start = method.totals()
    method.advance(dt)
    foot = ELASTIC.density * 9.0 / 2  # half an element's height of it
    # and half a step of the force of elements strained by v dt / h: less by c^2 dt^2 / h^2
    assert_allclose(method.totals().impulse, [-foot * slide, 0.0, foot * speed], rtol=1e-10, atol=1e-14)
    assert_allclose(
        [method.totals().contact, method.totals().friction], foot / 2 * np.square([speed, slide]), rtol=1e-8
    )
    assert abs(missing(start, method.totals())) < 1e-10


# --- energy ---


def shaken(element: Element, law: Any, safety: float, viscosity: tuple[float, float] = (0.0, 0.0)) -> float:
    """Return what is missing of a block's energy after some vibration."""
    body = brick((4.0, 3.0, 5.0), (4, 3, 5), shake=0.15)
    return missing_after(fem(body, element, law, (), trembling(body.position), safety, viscosity))


@each_element
@pytest.mark.parametrize("law", [ELASTIC, RELAXING], ids=["elastic", "viscoelastic"])
@pytest.mark.parametrize("viscosity", [(0.0, 0.0), (0.6, 1.5)], ids=["plain", "bulk-viscous"])
def test_energy_of_a_small_vibration_closes_to_second_order_in_the_time_step(
    element: Element, law: Any, viscosity: tuple[float, float]
) -> None:
    errors = [shaken(element, law, safety, viscosity) for safety in (0.8, 0.4, 0.2)]
    # waves of the mesh's length swing in their own phase: what they add is up to a tenth of an order
    assert_allclose(order(np.abs(errors).tolist()), 2.0, atol=0.1)
    assert abs(errors[0]) < 0.8**2 / 4  # leapfrog's swing of the shortest waves


# --- bits ---


@pytest.mark.parametrize(
    ("element", "real"),
    [
        *((element, np.float64) for element in ELEMENTS.values()),
        pytest.param(ELEMENTS["stiffness"], np.float32, marks=pytest.mark.long),
    ],
    ids=[*ELEMENTS, "single"],
)
def test_thread_count_changes_no_bit(element: Element, real: Real) -> None:
    def state() -> dict[str, Any]:
        method = steps(impact(element, body=rod_mesh(2.0, 6.0, 0.5), real=real), 40)
        return {**method.state(), "totals": np.hstack(method.totals())}

    conserved.assert_thread_count_changes_no_bit(state)


@each_element
def test_restored_run_goes_on_bit_for_bit(element: Element) -> None:
    conserved.assert_restored_run_goes_on_bit_for_bit(lambda: impact(element))
