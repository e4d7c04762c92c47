"""What a material is handed and hands back, whichever method carries it."""

import itertools
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from solids import sheared, solid
from viscopoint.case.case import Case
from viscopoint.errors import InputError
from viscopoint.kernels.arrays import AnyArray, Array
from viscopoint.kernels.cache_folder import cache_folder
from viscopoint.kernels.jit import implements
from viscopoint.kernels.kinematics import deformed
from viscopoint.kernels.logarithm import log
from viscopoint.kernels.tensors import Matrix, Sym, determinant, spherical
from viscopoint.materials import History, HistoryField, Increment, Material, Response, p_wave_modulus
from viscopoint.materials.block import MaterialBlock
from viscopoint.materials.elastic import Elastic
from viscopoint.materials.plastic import Plastic, shear_over_step
from viscopoint.methods import moving
from viscopoint.methods.fem.method import FiniteElementMethod
from viscopoint.methods.mpm.method import MaterialPointMethod
from viscopoint.methods.tlmpm.method import TotalLagrangianMethod

EPS = np.finfo(float).eps
WIDE = {f"method.box.{axis}": ["-20 mm", "40 mm"] for axis in "xyz"}  # no point leaves it
TINY = {
    "mpm": WIDE | {"method.cell": "2 mm", "method.spacing": "1.4 mm", "impact.gap": "20 mm"},
    "tlmpm": {"method.spacing": "1.2 mm"},
    "fem": {"method.size": "2 mm"},
    "fem-selective": {"method.size": "2 mm", "method.element": "selective"},
    "fem-ring": {"method.size": "2 mm", "method.geometry": "axisymmetric"},
}
each_method = pytest.mark.parametrize("name", TINY)


def body_of(material: Material, name: str) -> Any:
    """Return a tiny rod of a material, moved by a method."""
    case = Case.load("paper", TINY[name], method=name.partition("-")[0]).resolved()
    return case.method.build(case.rod, case.impact, material)


# --- a material that is handed F, and remembers it ---

COLD, STRAINED = 293.0, (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)


class Witness(NamedTuple):
    """An elastic solid that keeps what it is told of F, and what it was born with."""

    density: float
    bulk: float
    shear: float

    needs_deformation = True

    @property
    def p_wave_modulus(self) -> float:
        return p_wave_modulus(self.bulk, self.shear)

    @property
    def history_fields(self) -> tuple[HistoryField, ...]:
        return (
            HistoryField("seen", "1", 9),
            HistoryField("temperature", "K", initial=COLD),
            HistoryField("growth", "mm", 6, STRAINED),
        )


def watched(material: Witness, factors: float, increment: Increment, stress: Sym, history: History) -> Response:
    f = increment.deformation
    seen = (f.xx, f.xy, f.xz, f.yx, f.yy, f.yz, f.zx, f.zy, f.zz)
    stress = sheared(material, increment, stress) + spherical(material.bulk * log(increment.jacobian))
    return Response(stress, seen + history[9:], 0.0, p_wave_modulus(material.bulk, material.shear))


solid(Witness, watched)
WITNESS = Witness(1e-3, 550.0, 140.0)


@each_method
def test_history_begins_with_the_values_that_its_fields_name_and_is_shown_with_their_units(name: str) -> None:
    method = body_of(WITNESS, name)
    history = (method.points if "mpm" in name else method.elements).material.history
    expected = [*np.eye(3).ravel(), *[0.0] * 9, COLD, *STRAINED]
    assert_array_equal(history, np.tile(expected, (len(history), 1)))
    fields = method.snapshot()
    shown = {"deformation_gradient": "1", "seen": "1", "temperature": "K", "growth": "mm"}
    assert {key: fields[key].unit for key in shown} == shown
    assert {fields[key].on for key in shown} == {"cells" if name.startswith("fem") else "points"}
    rows = len(fields["temperature"].values)
    assert_allclose(fields["temperature"].values, np.full(rows, COLD), rtol=4 * EPS)  # of elements' points the mean
    assert_allclose(fields["growth"].values, np.tile(STRAINED, (rows, 1)), rtol=4 * EPS)
    assert_allclose(fields["deformation_gradient"].values, np.tile(np.eye(3).ravel(), (rows, 1)), rtol=4 * EPS)


def motions(name: str) -> list[Array]:
    """Return F at the start and after some steps, which strain by a few per cent and turn; rings keep their axis."""
    rng = np.random.default_rng(3)
    found = [np.eye(3)]
    for _ in range(4):
        gradient = rng.uniform(-0.1, 0.1, (3, 3))
        if name == "fem-ring":
            gradient = np.diag([gradient[0, 0], gradient[0, 0], gradient[2, 2]])
        found.append((np.eye(3) + gradient) @ found[-1])
    return found


@each_method
def test_a_material_that_asks_for_it_is_handed_the_deformation_gradient(name: str) -> None:
    """All methods take a step's motion as uniform in time, and F from its gradient at mid-step, (I - G/2)⁻¹ (I + G/2).

    If the nodes' motion is affine that is the exact F to rounding, whatever the step: F_1 - F_0 = G (F_0 + F_1) / 2.
    """
    method, dt = body_of(WITNESS, name), 1e-3
    drive = {"mpm": drive_grid, "tlmpm": drive_nodes}.get(name, drive_nodes)
    reference = (method.body.position if name != "tlmpm" else method.reference).copy()
    steps = motions(name)
    for before, after in itertools.pairwise(steps):
        drive(method, reference, before, after, dt)
        history = (method.points if "mpm" in name else method.elements).material.history
        assert_array_equal(history[:, :9], history[:, 9:18])  # what is kept is what was handed
        # positions and velocities are sums of some numbers of up to 30 mm, differences of them over 2 mm
        assert_allclose(history[:, :9], np.tile(after.ravel(), (len(history), 1)), rtol=0, atol=200 * EPS)
        volume = (method.points if "mpm" in name else method.elements).shared.jacobian
        assert_allclose(volume, np.linalg.det(after), rtol=200 * EPS)
    assert np.abs(steps[-1] - np.eye(3)).max() > 0.05


def drive_grid(method: MaterialPointMethod, reference: Array, before: Array, after: Array, dt: float) -> None:
    """Strain points by nodes that move with the material, and move them with it."""
    grid = method.grid
    k, j, i = np.unravel_index(np.arange(len(grid.velocity)), (int(grid.nz), int(grid.ny), int(grid.nx)))
    origin = np.array([grid.x0 + grid.i0 * grid.cell, grid.y0 + grid.j0 * grid.cell, grid.z0 + grid.k0 * grid.cell])
    place = origin + grid.cell * np.column_stack([i, j, k])
    grid.velocity[:, :3] = place @ (after @ np.linalg.inv(before) - np.eye(3)).T / dt
    method.update_stress(dt)
    method.points.position[:] = reference @ after.T
    method._sort()


def drive_nodes(
    method: FiniteElementMethod | TotalLagrangianMethod, reference: Array, before: Array, after: Array, dt: float
) -> None:
    """Move nodes, and strain what is between them."""
    method.nodes.velocity[:] = reference @ (after - before).T / dt
    method.nodes.position[:] = reference @ after.T
    method.nodes.force[:] = 0.0
    method.strain(dt)


def test_the_deformation_gradient_has_the_volume_that_points_share() -> None:
    rng = np.random.default_rng(4)
    before, gradient = np.eye(3) + rng.uniform(-0.2, 0.2, (3, 3)), rng.uniform(-0.2, 0.2, (3, 3))
    own = np.linalg.solve(np.eye(3) - gradient / 2, (np.eye(3) + gradient / 2) @ before)
    jacobian = 1.3 * float(np.linalg.det(own))
    found = deformed(Matrix(*before.ravel()), Matrix(*gradient.ravel()), jacobian)
    assert determinant(found) == pytest.approx(jacobian, rel=20 * EPS)
    assert_allclose(np.reshape(found, (3, 3)), 1.3 ** (1 / 3) * own, rtol=0, atol=20 * EPS)  # and its own shape


# --- a material within another ---


class Soft(NamedTuple):
    """An elastic solid of a user, as a base for our plasticity: like ``Elastic`` in all but its name."""

    density: float
    bulk: float
    shear: float

    @property
    def p_wave_modulus(self) -> float:
        return p_wave_modulus(self.bulk, self.shear)

    @property
    def history_fields(self) -> tuple[HistoryField, ...]:
        return ()


def soft_stress(material: Soft, factors: float, increment: Increment, stress: Sym, history: History) -> Response:
    stress = sheared(material, increment, stress) + spherical(material.bulk * log(increment.jacobian))
    return Response(stress, history, 0.0, p_wave_modulus(material.bulk, material.shear))


solid(Soft, soft_stress)


@implements(shear_over_step, Soft)
def soft_shear(base: Soft, factors: Any) -> float:
    return base.shear


def strained(material: Any) -> tuple[AnyArray, ...]:
    """Return stresses, histories, losses and energies of a few elements after steps beyond yielding."""
    method = body_of(material, "fem")
    reference = method.body.position.copy()
    for before, after in itertools.pairwise(motions("fem")):
        drive_nodes(method, reference, before, after, 1e-3)
    points, totals = method.elements.material, method.totals()
    return points.stress, points.history, points.dissipated, np.array([totals.stored, totals.hypoelastic])


def test_a_material_of_users_serves_as_a_part_of_ours_and_is_not_kept_on_the_disk() -> None:
    moduli = (1e-3, 550.0, 140.0)
    mine, ours = Plastic(Soft(*moduli), 20.0, 15.0), Plastic(Elastic(*moduli), 20.0, 15.0)
    assert MaterialBlock(mine).history_fields == (HistoryField("plastic_strain"),)
    for some, other in zip(strained(mine), strained(ours), strict=True):
        # the same arithmetic by another name; compilers may fuse it otherwise, and the hardening's error grows by steps
        assert_allclose(some, other, rtol=100 * EPS, atol=100 * EPS)
        assert np.abs(other).max() > 0.01
    names = {file.name for file in cache_folder().glob("*.code")}
    assert any("update_Plastic_Elastic" in name for name in names)
    assert not any("Soft" in name or "Witness" in name for name in names)


@implements(shear_over_step, Witness)
def witnessed_shear(base: Witness, factors: Any) -> float:
    return base.shear


def test_a_part_that_asks_for_the_deformation_gradient_is_handed_it() -> None:
    alone, part = strained(WITNESS), strained(Plastic(WITNESS, 1e9, 0.0))  # which never yields
    seen = alone[1][:, 9:18]
    assert np.abs(seen - np.eye(3).ravel()).max() > 0.01
    fields = MaterialBlock(Plastic(WITNESS, 1e9, 0.0)).history_fields
    place = sum(field.components for field in itertools.takewhile(lambda field: field.name != "seen", fields))
    assert_allclose(part[1][:, place : place + 9], seen, rtol=0, atol=100 * EPS)


class Bare(NamedTuple):
    """A solid of which nobody says how it works."""

    density: float

    p_wave_modulus = 1.0
    history_fields = ()


def test_a_material_that_lacks_an_operation_is_told_so() -> None:
    with pytest.raises(TypeError, match=r"Bare has no step_factors: decorate a function with @implements"):
        MaterialBlock(Bare(1e-3))


def test_snapshots_show_the_fields_whose_names_are_taken_and_no_others() -> None:
    elastic = Elastic(1e-3, 550.0, 140.0)
    assert set().union(*(body_of(elastic, name).snapshot() for name in TINY)) == moving.FIELDS


@pytest.mark.parametrize("name", ["stress", "own"])
def test_a_history_field_of_a_name_that_is_taken_is_refused(name: str) -> None:
    block: Any = SimpleNamespace(material=WITNESS, history_fields=(HistoryField("own"), HistoryField(name)))
    with pytest.raises(InputError, match=f"history field '{name}': another field has this name"):
        moving._check_names(block)
