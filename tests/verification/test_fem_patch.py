"""What an element must do exactly: uniform strain, rigid motion, its volume, its hourglass modes.

The meshes' inner nodes are moved at random by up to a fifth of an element.
"""

from typing import Any

import numpy as np
import pytest
from bricks import (
    ELASTIC,
    SELECTIVE,
    STIFF,
    VISCOUS,
    Array,
    answer,
    assert_strained_as_a_material_point,
    brick,
    each_element,
    fem,
    outside,
)
from columns import one_thread  # noqa: F401
from conserved import EPS, RELAXING
from material_point import at_rest, moved, square
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from viscopoint.kernels.vectors import Vec
from viscopoint.materials import step_factors
from viscopoint.methods.fem.cells import corner_forces, volume, volume_gradient
from viscopoint.methods.fem.cells.hexahedron_modes import ETA, XI, ZETA, Modes, modes
from viscopoint.methods.fem.elements import Element
from viscopoint.methods.fem.elements.one_point import OnePoint
from viscopoint.methods.fem.hourglass import StiffnessControl, ViscousControl
from viscopoint.methods.fem.mesh import FACES
from viscopoint.methods.fem.method import FiniteElementMethod
from viscopoint.model.body import Body

pytestmark = pytest.mark.usefixtures("one_thread")
ROUNDING = 100 * EPS  # a few dozen operations on numbers of the size of the result
MODULUS = ELASTIC.p_wave_modulus
HOURGLASS = {"eta_zeta": ETA * ZETA, "zeta_xi": ZETA * XI, "xi_eta": XI * ETA, "all": XI * ETA * ZETA}
each_mode = pytest.mark.parametrize("mode", HOURGLASS.values(), ids=HOURGLASS.keys())


def distorted() -> Body:
    return brick((4.0, 3.0, 5.0), (4, 3, 5), shake=0.2)


def gradients(count: int) -> Array:
    """Return changes of shape and orientation of a fifth each step."""
    return np.random.default_rng(1).uniform(-0.2, 0.2, (count, 3, 3))


def tensors(method: FiniteElementMethod) -> Array:
    """Return the stresses of all points as 3 x 3 arrays."""
    return method.elements.material.stress.reshape(-1, 6)[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)


# --- uniform strain ---


@each_element
def test_patch_of_distorted_elements_has_the_stress_of_a_material_point(element: Element) -> None:
    method, dt, state = fem(distorted(), element, RELAXING), 0.01, at_rest(RELAXING)
    inner = ~outside(method.body.position)
    for number, gradient in enumerate(gradients(4), start=1):
        force = answer(method, method.nodes.position @ gradient.T / dt + [3.0, -2.0, 5.0], dt)
        state = moved(RELAXING, step_factors(RELAXING, dt), state, gradient)
        # on areas of about 1 mm^2 of eight elements
        assert_strained_as_a_material_point(method, state, force, inner, number * ROUNDING, size=10.0)
    assert_allclose(method.elements.material.dissipated, state.dissipated, rtol=10 * ROUNDING)
    assert_allclose(method.elements.hourglass_work, 0.0, atol=ROUNDING)


@each_element
def test_inner_nodes_follow_the_linear_motion_of_the_surface(element: Element) -> None:
    method = fem(distorted(), element, RELAXING)
    outer, start = outside(method.body.position), method.body.position.copy()
    gradient, steps, dt = 40 * gradients(1)[0], 100, 5e-4  # a strain of 8 % each 0.01 ms
    motion = start @ gradient.T
    method.nodes.velocity[:] = motion
    state, deformation = at_rest(RELAXING), np.eye(3)
    for _ in range(steps):
        method.nodes.force[outer] = 0.0
        method.nodes.velocity[outer] = motion[outer]
        method.advance(dt)
        change = dt * gradient @ np.linalg.inv(deformation)
        state, deformation = moved(RELAXING, step_factors(RELAXING, dt), state, change), deformation + dt * gradient
    assert np.abs(deformation - np.eye(3)).max() > 0.3
    # a rounding of stress over an element accelerates its nodes by that strain times (c/h)^2, c dt/h < 1 per step
    rounding = steps * ROUNDING
    assert_allclose(method.nodes.position, start @ deformation.T, rtol=0, atol=5 * rounding)
    assert_allclose(method.nodes.velocity[~outer], motion[~outer], rtol=0, atol=rounding * 858.0)
    found = tensors(method)
    assert_allclose(found, np.broadcast_to(square(state.stress), found.shape), rtol=0, atol=rounding * MODULUS)


# --- rigid motion ---


def prestressed(element: Element) -> FiniteElementMethod:
    method = fem(distorted(), element)
    answer(method, method.nodes.position @ gradients(1)[0].T, 1.0)
    if element is STIFF:
        method.elements.hourglass_force[:, :3] = np.random.default_rng(2).normal(
            size=(len(method.elements.hourglass_force), 3)
        )
    return method


@each_element
def test_stress_turns_with_a_rigid_body_through_many_turns(element: Element) -> None:
    method, steps = prestressed(element), 100
    springs, stored = method.elements.hourglass_force.copy(), method.totals().stored
    stress = tensors(method)
    turn = Rotation.from_rotvec(1.2 * np.array([2.0, -1.0, 2.0]) / 3.0)  # 69 degrees a step, 19 turns in all
    for _ in range(steps):
        place = method.nodes.position
        answer(method, turn.apply(place) - place, 1.0)
    whole = (turn**steps).as_matrix()
    found = tensors(method)
    assert np.abs(stress).max() > 10.0  # MPa
    rounding = steps * ROUNDING
    assert_allclose(found, whole @ stress @ whole.T, rtol=0, atol=rounding * MODULUS)
    assert_allclose(np.linalg.eigvalsh(found), np.linalg.eigvalsh(stress), rtol=0, atol=rounding * MODULUS)
    assert_allclose(method.elements.hourglass_work, 0.0, atol=rounding * 10.0)
    assert_allclose(method.totals().stored, stored, rtol=rounding)
    if element is STIFF:  # forces of about 1 N on the modes turn with the element
        turned = springs[:, :3] @ whole.T
        assert_allclose(method.elements.hourglass_force[:, :3], turned, rtol=0, atol=rounding * MODULUS)


@each_element
def test_free_flight_changes_nothing(element: Element) -> None:
    velocity, steps = (13.0, -17.0, 11.0), 200
    method = fem(distorted(), element, velocity=velocity)
    start, dt = method.nodes.position.copy(), 4e-4
    for _ in range(steps):
        method.advance(dt)
    flight = steps * dt * np.array(velocity)
    assert np.abs(flight).min() > 0.8  # of an element
    assert_allclose(method.nodes.velocity, np.broadcast_to(velocity, start.shape), rtol=0, atol=steps * ROUNDING * 858)
    assert_allclose(method.nodes.position, start + flight, rtol=0, atol=steps * ROUNDING * 5.0)
    assert_allclose(method.elements.material.stress, 0.0, atol=steps * ROUNDING * MODULUS)


# --- geometry ---


def at_corners(on: Modes) -> Array:
    return np.array(corner_forces(on)).reshape(8, 3)


def hexahedron() -> Array:
    """Return a cube of 2 mm, every corner moved at random by up to 0.4 mm."""
    return np.column_stack([XI, ETA, ZETA]) + np.random.default_rng(5).uniform(-0.4, 0.4, (8, 3))


def enclosed(corner: Array) -> float:
    """Return the volume by the divergence theorem: a bilinear face bounds the mean of its two foldings."""
    total = 0.0
    for a, b, c, d in FACES:
        for i, j, k in ((a, b, c), (a, c, d), (a, b, d), (b, c, d)):
            total += float(corner[i] @ np.cross(corner[j], corner[k])) / 12.0
    return total


def test_volume_is_that_within_the_bilinear_faces() -> None:
    corner = hexahedron()
    place = modes(corner, range(8))
    assert_allclose(volume(place, volume_gradient(place)), enclosed(corner), rtol=ROUNDING)
    assert abs(enclosed(corner) - 8 * np.linalg.det([[v.x, v.y, v.z] for v in place[:3]])) > 0.01  # not of edges alone


def test_volume_gradient_is_the_change_of_volume() -> None:
    corner = hexahedron()
    gradient = volume_gradient(modes(corner, range(8)))
    # ∂V/∂x_n = Σ ∂V/∂x_m s_m(n) / 8, as forces on modes come to the corners
    found = at_corners(Modes(*gradient, all=Vec(0.0, 0.0, 0.0)))
    for n in range(8):
        for axis in range(3):
            other = corner.copy()
            other[n, axis] += 0.5
            change = (enclosed(other) - enclosed(corner)) / 0.5  # exact: V is linear in each coordinate
            assert_allclose(found[n, axis], change, rtol=0, atol=ROUNDING)


def test_modes_and_their_mean_give_the_corner_values_back() -> None:
    values = hexahedron()
    found = 8.0 * at_corners(modes(values, range(8)))  # an eighth goes to each corner
    assert_allclose(found + values.mean(axis=0), values, rtol=0, atol=ROUNDING)


def test_modes_are_those_of_the_trilinear_field() -> None:
    signs = [XI, ETA, ZETA, *HOURGLASS.values()]
    for number, sign in enumerate(signs):
        found = modes(np.outer(sign, [3.0, 5.0, 7.0]), range(8))
        expected = np.zeros((7, 3))
        expected[number] = 3.0, 5.0, 7.0
        assert_allclose([[v.x, v.y, v.z] for v in found], expected, rtol=0, atol=ROUNDING)


# --- hourglass modes ---


def single(element: Element, corner: Array | None = None) -> FiniteElementMethod:
    """Return one element, a cube of 2 mm if nothing else."""
    body = brick((2.0, 2.0, 2.0), (1, 1, 1), foot=-1.0)
    cell = np.arange(8)[None]
    corner = np.column_stack([XI, ETA, ZETA]) if corner is None else corner
    return fem(body._replace(position=corner, cells=cell), element)


def control_alone(control: Any, coefficient: float, steps: list[Array], dt: float) -> tuple[list[Array], Array]:
    """Return the forces after each step, and all work, of the control only: what it adds to the element without."""
    methods = [single(OnePoint(control(c)), hexahedron()) for c in (coefficient, 0.0)]
    forces, works = [], []
    for velocity in steps:
        with_it, without = (answer(method, velocity, dt) for method in methods)
        forces.append(with_it - without)
        works.append(float(methods[0].elements.hourglass_work[0]))
    return forces, np.array(works)


@each_mode
def test_viscous_control_resists_each_hourglass_mode_by_its_formula(mode: Array) -> None:
    method, speed, dt = single(VISCOUS), np.array([0.3, -0.2, 0.5]), 1e-9
    force = answer(method, np.outer(mode, speed), dt)
    # the force on the mode is the sum of signed corner forces, h = -16 Q rho c (V / l) q', with l = 2 mm, V = l^3
    expected = -16 * 0.1 * ELASTIC.density * np.sqrt(MODULUS / ELASTIC.density) * 4.0 * speed
    assert_allclose(mode @ force, expected, rtol=10 * dt)  # the element changes by v dt / l
    assert_allclose(force, np.outer(mode, expected) / 8, rtol=0, atol=10 * dt)
    assert_allclose(method.elements.material.stress, 0.0, atol=MODULUS * dt)


@each_mode
def test_stiffness_control_holds_each_hourglass_mode_by_its_formula(mode: Array) -> None:
    method, by = single(STIFF), 1e-8 * np.array([3.0, -2.0, 5.0])
    forces = [answer(method, np.outer(mode, by), 1.0) for _ in range(2)]
    expected = -0.05 * MODULUS * 8.0 / 4.0 * by  # h' = -coefficient M (V / l^2) q'
    assert_allclose(mode @ forces[0], expected, rtol=1e-7)
    assert_allclose(mode @ forces[1], 2 * expected, rtol=1e-7)
    assert_allclose(method.totals().hourglass, 0.5 * 4 * -expected @ by, rtol=1e-7)  # a spring's, at 2 q


@pytest.mark.parametrize("control", [ViscousControl, StiffnessControl])
def test_hourglass_forces_do_no_work_on_any_linear_motion(control: Any) -> None:
    step, dt = np.random.default_rng(3).normal(size=(8, 3)), 0.01
    (force,), _ = control_alone(control, 0.1, [step], dt)
    scale = np.abs(force).max()
    assert_allclose(force.sum(axis=0), 0.0, atol=ROUNDING * scale)
    assert_allclose(force.T @ (hexahedron() + dt * step), 0.0, atol=10 * ROUNDING * scale)


@pytest.mark.parametrize("control", [ViscousControl, StiffnessControl])
def test_work_of_hourglass_control_is_what_its_forces_take_from_the_nodes(control: Any) -> None:
    """A force acts on half a step before and half a step after, also where the nodes then turn back.

    Forces belong to the ends of steps and slips to their middles: what is left is of the order of a step's strain.
    """
    rng = np.random.default_rng(3)
    steps = [rng.normal(size=(8, 3)) for _ in range(2)]
    left = []
    for dt in (0.02, 0.01):
        forces, works = control_alone(control, 0.1, steps, dt)
        first = -0.5 * dt * float((forces[0] * steps[0]).sum())
        second = -0.5 * dt * float(((forces[0] + forces[1]) * steps[1]).sum())
        left.append([works[0] / first - 1.0, (works[1] - works[0] - second) / first])
    assert_allclose(left[0][0] / left[1][0], 2.0, rtol=0.1)
    assert np.abs(left).max() < 0.02


# u = w s(xi, eta, zeta) e_x on a cube of edge 2a, with K (div u)^2 taken by its mean, which is nil:
#   U = G a w^2 times  8/3 (2/3 + 1/2),  8/3 (1/2 + 1/2),  8/9 (2/3 + 1/2 + 1/2)
STRAIN_ENERGY = {"eta_zeta": 8 / 3, "zeta_xi": 28 / 9, "xi_eta": 28 / 9, "all": 40 / 27}


@pytest.mark.parametrize("name", STRAIN_ENERGY)
def test_selective_element_has_the_strain_energy_of_each_hourglass_mode(name: str) -> None:
    method, w, mode = single(SELECTIVE), 1e-6, HOURGLASS[name]
    force = answer(method, np.outer(mode, [w, 0.0, 0.0]), 1.0)
    expected = STRAIN_ENERGY[name] * 140.0 * 1.0 * w**2
    strain = 10 * w  # what is not linear
    assert_allclose(method.totals().stored, expected, rtol=strain)
    assert_allclose(mode @ force, [-2 * expected / w, 0.0, 0.0], rtol=strain, atol=strain * 2 * expected / w)
