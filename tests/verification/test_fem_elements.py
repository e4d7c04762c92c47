"""Elements under what is hard for them: bending of what hardly changes volume, long steps, being crushed."""

from functools import cache

import numpy as np
import pytest
import rings
from bricks import (
    ELASTIC,
    ELEMENTS,
    SELECTIVE,
    Array,
    answer,
    brick,
    column,
    each_element,
    fem,
    fitted,
    highest,
    upward,
)
from columns import COURANT, DENSITY, LENGTH, one_thread  # noqa: F401
from conserved import EPS, missing
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import root_scalar

from viscopoint.interactions.planes import symmetry_plane
from viscopoint.materials.elastic import Elastic
from viscopoint.materials.linear_viscoelastic import LinearViscoelastic
from viscopoint.methods.fem.elements import Element
from viscopoint.methods.fem.method import Discretisation, FiniteElementMethod
from viscopoint.methods.fem.rod import rod_mesh
from viscopoint.model.body import Body
from viscopoint.model.viscosity import BulkViscosity

pytestmark = pytest.mark.usefixtures("one_thread")
SHEAR, THICK, SPAN = 100.0, 1.0, 6.0  # MPa, mm, mm
WAVE = np.pi / SPAN  # k, 1/mm
SLOW = 1e-5  # mm/ms
STRAIN = SLOW / 858.293


class Plate:
    """The flexural wave of a plate in plane strain, standing between mirrors: Rayleigh and Lamb's exact solution."""

    def __init__(self, bulk: float) -> None:
        self.modulus = bulk + 4 * SHEAR / 3
        self.bending = 4 * SHEAR * (3 * bulk + SHEAR) / (3 * bulk + 4 * SHEAR)  # E / (1 - nu^2)
        beam = WAVE**2 * np.sqrt(self.bending * THICK**2 / 12 / DENSITY)  # Bernoulli's
        self.frequency = float(root_scalar(self.mismatch, bracket=(0.3 * beam, beam)).root)
        self.law = LinearViscoelastic(DENSITY, bulk, SHEAR, 0.0, 0.0)

    def decays(self, frequency: float) -> tuple[float, float]:
        """Return how the two potentials grow across the plate [1/mm]."""
        squares = [frequency**2 * DENSITY / m for m in (self.modulus, SHEAR)]
        return float(np.sqrt(WAVE**2 - squares[0])), float(np.sqrt(WAVE**2 - squares[1]))

    def mismatch(self, frequency: float) -> float:
        a, b = self.decays(frequency)
        ratio = (WAVE**2 + b**2) ** 2 / (4 * WAVE**2 * a * b)
        return float(np.tanh(b * THICK / 2) / np.tanh(a * THICK / 2) - ratio)

    def mode(self, position: Array) -> Array:
        x, _, z = position.T
        a, b = self.decays(self.frequency)
        share = -2 * WAVE * a * np.cosh(a * THICK / 2) / ((WAVE**2 + b**2) * np.cosh(b * THICK / 2))
        across = (a * np.cosh(a * x) + WAVE * share * np.cosh(b * x)) * np.cos(WAVE * z)
        along = -(WAVE * np.sinh(a * x) + b * share * np.sinh(b * x)) * np.sin(WAVE * z)
        field = np.column_stack([across, 0 * x, along])
        return field / np.abs(field).max()


@cache
def flexure(name: str, bulk: float, through: int) -> complex:
    """Return the exponent of the wave of so many cubes through the plate, in units of the exact frequency."""
    plate, side = Plate(bulk), THICK / through
    body = brick((THICK, side, SPAN), (through, 1, int(SPAN) * through))
    mode = plate.mode(body.position)
    mirrors = [
        symmetry_plane(2, 0.0),
        symmetry_plane(2, SPAN),
        symmetry_plane(1, -side / 2),
        symmetry_plane(1, side / 2),
    ]
    method = fem(body, ELEMENTS[name], plate.law, tuple(mirrors), SLOW * mode, 0.8)
    weight = method.nodes.mass[:, None] * mode
    weight /= SLOW * (weight * mode).sum()
    dt, signal, samples = method.stable_step(), [1.0], 60
    every = int(0.7 * 2 * np.pi / plate.frequency / dt / samples)
    for _ in range(samples):
        for _ in range(every):
            method.advance(dt)
        signal.append(float((method.nodes.velocity * weight).sum()))
    exact = np.array([1j * plate.frequency])
    return fitted(np.linspace(0.0, samples * every * dt, samples + 1), np.array(signal), exact) / plate.frequency


@pytest.mark.parametrize("name", ELEMENTS)
@pytest.mark.parametrize("bulk", [SHEAR, 1000 * SHEAR])
@pytest.mark.parametrize("through", [2, 4])
def test_bending_does_not_lock(name: str, bulk: float, through: int) -> None:
    """The stiffness of bending is right but for 1/n^2, with n elements through the plate, whatever K/G.

    1/n^2 of it is strain that varies through an element. One point does not feel this; the spring of the stiffness
    control puts 3/4 coefficient M / (E/(1 - nu^2)) there. Eight points put the stretch less its volume, 4G/3, and a
    shear that is not there, G. Full integration would put K + 4G/3 and G: for K = 1000 G and n = 4 a stiffness 16 times
    too large. The stiffness control, which scales with M, pays a small part of this.
    """
    plate = Plate(bulk)
    terms = {
        "viscous": (-1.0,),
        "stiffness": (-1.0, 3 / 4 * 0.05 * plate.modulus / plate.bending),
        "selective": (-1.0, 4 / 3 * SHEAR / plate.bending, SHEAR / plate.bending),
    }[name]
    beam = (WAVE * THICK) ** 2  # the beam's relative error in each of these
    found = flexure(name, bulk, through)
    assert_allclose((found.imag**2 - 1) * through**2, sum(terms), rtol=0, atol=beam * np.abs(terms).max())


@pytest.mark.parametrize("bulk", [SHEAR, 1000 * SHEAR])
@pytest.mark.parametrize("through", [2, 4])
def test_viscous_control_damps_bending_to_third_order(bulk: float, through: int) -> None:
    plate = Plate(bulk)
    sound, h = np.sqrt(plate.modulus / DENSITY), THICK / through
    # q' = h^2 / 4 of the rate of curvature: 16 Q rho c q'^2 / h over twice the energy, E t^2 / 24 (1 - nu^2)
    expected = -0.1 * sound * h**3 * WAVE**4 / (2 * plate.frequency)
    assert_allclose(flexure("viscous", bulk, through).real, expected, rtol=(WAVE * THICK) ** 2)
    for name in ("stiffness", "selective"):
        assert abs(flexure(name, bulk, through).real) < 1e-4  # what the step leaves of it: (w dt)^2, of higher order


# --- the stable step ---


def grown(method: FiniteElementMethod, share: float, steps: int) -> float:
    """Return how much faster a node moves than any did, after steps of a share of the stable one."""
    before, dt = np.abs(method.nodes.velocity).max(), share * method.stable_step()
    for _ in range(steps):
        method.advance(dt)
    return float(np.abs(method.nodes.velocity).max() / before)


@each_element
def test_column_is_stable_up_to_its_critical_step_and_not_beyond(element: Element) -> None:
    shortest = upward(lambda z: SLOW * np.cos(8 * np.pi * z / LENGTH))  # has w = 2c/h
    assert grown(column(8, element, ELASTIC, (), velocity=shortest, courant=1.0), 0.99, 200) < 1 + STRAIN * 200
    # sin(w dt / 2) = 1.01: a factor exp(2 acosh 1.01) a step, for one half of the wave
    unstable = grown(column(8, element, ELASTIC, (), velocity=shortest, courant=1.0), 1.01, 20)
    assert_allclose(unstable, np.exp(40 * np.arccosh(1.01)) / 2, rtol=40 * STRAIN * unstable)


@each_element
@pytest.mark.parametrize("shear", [0.01, 140.0])
def test_free_cube_is_stable_at_its_own_step(element: Element, shear: float) -> None:
    """A cube that is free on all sides swells with w^2 = 12 K / (rho h^2), above the 4 M / (rho h^2) of a wave.

    The step allows for K = M. Beyond what K really is it must fail, or it would be no bound.
    """
    law = LinearViscoelastic(DENSITY, 550.0, shear, 0.0, 0.0)
    slack = np.sqrt(law.p_wave_modulus / law.bulk)

    def cube(share: float) -> FiniteElementMethod:
        body = brick((1.0, 1.0, 1.0), (1, 1, 1), foot=-0.5)
        choices = Discretisation(element, share, BulkViscosity(0.0, 0.0))
        return FiniteElementMethod(body, law, (), choices, SLOW * body.position)

    assert grown(cube(1.0), 1.0, 200) < 1.001
    assert grown(cube(0.99 * slack), 1.0, 200) < 1.001
    assert_allclose(grown(cube(1.01 * slack), 1.0, 20), np.exp(40 * np.arccosh(1.01)) / 2, rtol=0.01)


@each_element
@pytest.mark.parametrize("linear", [0.06, 0.3, 1.0])
@pytest.mark.parametrize("shear", [0.0, 140.0])
def test_bulk_viscosity_is_in_the_step_of_what_swells(element: Element, linear: float, shear: float) -> None:
    """Damped by a share xi of the critical, a mode of w allows steps of 2 (sqrt(1 + xi^2) - xi) / w.

    A free cube of edge h swells with w = sqrt(12) c/h, and q = linear rho c tr D h damps it by xi = sqrt(3) linear.
    """
    law = LinearViscoelastic(DENSITY, 550.0, shear, 0.0, 0.0)
    body = brick((1.0, 1.0, 1.0), (1, 1, 1), foot=-0.5)
    choices = Discretisation(element, 1.0, BulkViscosity(linear, 1.5))
    method = FiniteElementMethod(body, law, (), choices, 1e-3 * body.position)
    start = method.totals().kinetic
    for _ in range(400):
        method.advance(method.stable_step())
    assert method.totals().kinetic <= start
    xi = np.sqrt(3.0) * linear
    at_rest = (np.sqrt(1.0 + xi**2) - xi) / np.sqrt(3.0) / method.sound
    assert_allclose(method.stable_step(), at_rest, rtol=1e-3)  # the speed left, over that of sound


@each_element
@pytest.mark.parametrize("shear", [0.055, 140.0])
@pytest.mark.parametrize("body", [brick((3.0, 3.0, 3.0), (3, 3, 3)), rod_mesh(2.0, 4.0, 0.7)], ids=["cubes", "rod"])
def test_mesh_is_stable_at_the_usual_safety(element: Element, shear: float, body: Body) -> None:
    law, safety = LinearViscoelastic(DENSITY, 550.0, shear, 0.0, 0.0), 0.95
    motion = SLOW * np.random.default_rng(8).normal(size=body.position.shape)
    method = FiniteElementMethod(body, law, (), Discretisation(element, safety, BulkViscosity(0.0, 0.0)), motion)
    start, dt = method.totals().kinetic, method.stable_step()
    for _ in range(1000):
        method.advance(dt)
    now = method.totals()
    # what leapfrog keeps of a mode is kinetic + stored (1 - (w dt / 2)^2)
    assert now.kinetic + now.stored < start / (1 - safety**2)


UNEVEN = {"cube": (brick((1.0, 1.0, 1.0), (1, 1, 1)), (0, 1, 2)), "rings": (rings.section(1.0, 2.0, 1, 2), rings.PLANE)}


@pytest.mark.parametrize(("body", "axes"), UNEVEN.values(), ids=UNEVEN.keys())
@pytest.mark.parametrize("bulk", [1.0, 550.0])
def test_step_of_a_selective_element_allows_for_its_most_squeezed_point(
    body: Body, axes: tuple[int, ...], bulk: float
) -> None:
    """That point works on more than its own volume, which makes it as much stiffer; all is free of shear stress."""
    rng = np.random.default_rng(4)
    method = fem(body, SELECTIVE, Elastic(DENSITY, bulk, 140.0), safety=1.0)
    fixed, elements = (body.position == 0.0) & (method.nodes.inverse_mass == 0.0), method.elements
    start = {name: rows.copy() for name, rows in method.state().items()}
    shares, squeezed = [], []
    while len(shares) < 200:
        place = body.position.copy()
        place[:, axes] += rng.uniform(0.0, 0.8) * rng.uniform(-1.0, 1.0, (len(place), len(axes)))
        place[fixed] = 0.0
        volumes = method.form.point_volumes(place, body.cells)
        if volumes.min() < 0.01 * volumes.max():
            continue
        method.restore(start)
        method.nodes.position[:] = place
        elements.shared.jacobian[:] = volumes.sum(axis=1) / elements.volume.reshape(volumes.shape).sum(axis=1)
        answer(method, 0.0 * place, 1.0)
        shares.append(0.5 * method.stable_step() * highest(method, axes))
        squeezed.append(volumes.max() / volumes.min())
    assert max(squeezed) > 20.0
    assert 0.7 < max(shares) < 1.0


# --- crushing ---

FLUID = LinearViscoelastic(DENSITY, 550.0, 0.0, 0.0, 0.0)  # its energy is the work done, whatever the strain
CLOSING = 6000.0  # mm/ms


def colliding(element: Element, squeezed: int, below: float) -> FiniteElementMethod:
    """Return a column of three cubes of 1 mm on rollers, one of which is about to be squeezed."""
    rollers = tuple(symmetry_plane(axis, place) for axis in (0, 1) for place in (-0.5, 0.5))
    motion = upward(lambda z: np.where(z > squeezed + 0.5, -CLOSING / 2, CLOSING / 2) + 100.0)
    body = brick((1.0, 1.0, 3.0), (1, 1, 3))
    return fem(body, element, FLUID, rollers, motion(body.position), 0.01, delete_below=below)


def share_of_step(height: float) -> float:
    """Return the stable step of a brick 1 x 1 x J over that of a cube: 1/l^2 = 2 + 1/J^2 and the sound is c sqrt(J)."""
    return float(np.sqrt(3 / (2 + 1 / height**2) / height))


@each_element
@pytest.mark.parametrize("squeezed", [1, 2])
def test_crushed_element_is_deleted_with_its_energy_and_none_of_the_momentum(element: Element, squeezed: int) -> None:
    below = 0.6
    method = colliding(element, squeezed, below)
    start, before, dt = method.totals(), method.elements.shared.jacobian.copy(), 0.0
    while method.lost() == 0:
        before, dt = method.elements.shared.jacobian.copy(), method.stable_step()
        method.advance(dt)
    elements, now = method.elements, method.totals()
    assert_array_equal(elements.shared.alive == 0, np.arange(3) == squeezed)
    ratio = float(elements.shared.jacobian[squeezed])
    assert share_of_step(ratio) < below <= share_of_step(before[squeezed])
    assert_allclose(now.eroded, FLUID.bulk * (ratio * np.log(ratio) - ratio + 1), rtol=1e-12)
    assert_allclose(now.momentum, start.momentum, rtol=0, atol=1000 * EPS * start.mass * CLOSING)
    # half a step of its force on both sides is missing
    half_kick = -FLUID.bulk * np.log(ratio) * CLOSING * dt / 2
    assert abs(missing(start, now)) * start.kinetic < 1.2 * half_kick
    for _ in range(20):
        method.advance(dt)
    later = method.totals()
    assert_allclose(later.momentum, start.momentum, rtol=0, atol=1000 * EPS * start.mass * CLOSING)
    assert later.eroded == now.eroded
    gone = np.isnan(method.positions()).any(axis=1)
    assert_array_equal(gone, method.body.position[:, 2] > (2.5 if squeezed == 2 else np.inf))  # of no other element
    assert np.isfinite(method.nodes.position).all()


@each_element
def test_inverted_element_allows_no_step_and_is_named(element: Element) -> None:
    method = fem(brick((1.0, 1.0, 3.0), (1, 1, 3)), element)
    assert method.limiting_element() == ""
    motion = upward(lambda z: np.where(z > 2.5, -1.5, 0.0))(method.body.position)
    answer(method, motion, 1.0)
    assert method.stable_step() == 0.0
    assert method.lost() == 0
    assert method.limiting_element() == "element 2, at (0, 0, 1.75) mm, is turned inside out"


@each_element
def test_inverted_element_is_deleted_if_elements_may_be(element: Element) -> None:
    method = fem(brick((1.0, 1.0, 3.0), (1, 1, 3)), element, delete_below=0.1)
    motion = upward(lambda z: np.where(z > 2.5, -1.5, 0.0))(method.body.position)
    first, force = method.stable_step(), answer(method, motion, 1.0)
    assert method.lost() == 1
    assert_allclose(force, 0.0, atol=10 * EPS * method.material.p_wave_modulus)  # the others were not strained
    assert_allclose(method.stable_step(), first, rtol=1e-12)


@each_element
def test_element_that_limits_the_step_is_named(element: Element) -> None:
    method = fem(brick((1.0, 1.0, 3.0), (1, 1, 3)), element)
    answer(method, upward(lambda z: np.where((z > 0.5) & (z < 1.5), -0.2, 0.0))(method.body.position), 1.0)
    # of the heights 0.8, 1.2 and 1 mm: sound is faster in what is stretched
    assert method.limiting_element() == "element 1, at (0, 0, 1.4) mm, limits it"
    expected = COURANT * share_of_step(1.2) / method.sound  # the edges of the cubes are 1 mm
    assert_allclose(method.stable_step(), expected, rtol=1e-12)
