"""The contact radius is the greatest of what is on the wall, also where the side has rolled onto it."""

import numpy as np
import pytest

import viscopoint as vp
from viscopoint.methods.fem.rod import rod_mesh
from viscopoint.methods.fem.section import section_mesh
from viscopoint.methods.mpm.fills.meridian import half_rings
from viscopoint.model.body import EXACT, Body
from viscopoint.model.measurements import measure

RADIUS, LENGTH, SIZE = 3.8, 19.0, 0.38
NEAR = EXACT * RADIUS
ROLLED = {
    "impact.friction": 0.5, "impact.gap": "0 mm", "method.geometry": "axisymmetric",
    "time.end": "20 us", "time.snapshots": [],
}  # fmt: skip


def rolled(body: Body) -> np.ndarray:
    """Return places of a rod whose three lowest layers of side stand on the wall, ever further out; the next is up."""
    position = body.position.copy()
    level = np.round(position[:, 2] / SIZE).astype(int)
    side = np.isclose(np.hypot(position[:, 0], position[:, 1]), body.surface.start[0])
    position[:, :2] *= np.where(side, 1.0 + 0.05 * np.minimum(level, 4), 1.0)[:, None]
    position[:, 2] = np.where(side & (level <= 3), 0.0, position[:, 2])
    position[:, 2] = np.where(side & (level == 4), 0.2, position[:, 2])
    return position


@pytest.mark.parametrize("mesh", [rod_mesh, section_mesh])
def test_a_side_that_rolled_onto_the_wall_is_in_contact(mesh: object):
    body: Body = mesh(RADIUS, LENGTH, SIZE)  # pyright: ignore[reportCallIssue]
    found = measure(body.surface, rolled(body))
    # level 3 on the wall at 1.15 R, level 4 at 1.2 R and 0.2 mm above: the outline passes NEAR on the straight line
    assert found.contact_radius == pytest.approx(RADIUS * (1.15 + 0.05 * NEAR / 0.2), rel=1e-9)
    assert found.impact_face_radius == pytest.approx(RADIUS, rel=1e-9)
    assert found.greatest_radius == pytest.approx(1.2 * RADIUS, rel=1e-9)


def test_a_rim_that_curls_up_is_not_in_contact():
    body = section_mesh(RADIUS, LENGTH, SIZE)
    position = body.position.copy()
    position[:, 2] += 0.1 * np.maximum(position[:, 0] - 5 * SIZE, 0.0)  # flat up to 1.9 mm, then a slope of a tenth
    found = measure(body.surface, position)
    assert found.contact_radius == pytest.approx(5 * SIZE + NEAR / 0.1, rel=1e-9)
    assert found.impact_face_radius == pytest.approx(RADIUS, rel=1e-9)


def test_an_uneven_rim_of_which_some_nodes_alone_are_on_the_wall_hides_no_contact():
    body = rod_mesh(RADIUS, LENGTH, SIZE)
    position, rim = body.position.copy(), body.surface.ring[0]
    position[position[:, 2] < 0.5 * SIZE, 2] = 2.0 * NEAR  # the face is off the wall
    position[rim, 2] = np.where(
        np.arange(len(rim)) % 4 == 0, 0.0, 6.0 * NEAR
    )  # so is the rim, but for each fourth node
    face = np.setdiff1d(body.surface.impact_face[:, 0], rim)
    within = np.hypot(position[face, 0], position[face, 1]).max()
    # the outline rises from 2 NEAR there to 4.5 NEAR at the rim, and passes the lowest of its points by NEAR on the way
    expected = within + (RADIUS - within) / 2.5
    assert measure(body.surface, position).contact_radius == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("mesh", [rod_mesh, section_mesh, half_rings])
def test_an_undeformed_rod_would_touch_with_its_whole_face(mesh: object):
    body: Body = mesh(RADIUS, LENGTH, SIZE)  # pyright: ignore[reportCallIssue]
    assert measure(body.surface, body.position + [0.0, 0.0, 2.0]).contact_radius == pytest.approx(RADIUS, rel=1e-12)


@pytest.mark.parametrize("friction", [0.5, 10.0])
def test_with_friction_the_contact_reaches_as_far_as_nodes_on_the_wall(friction: float):
    case = vp.Case.load("paper", method="fem").with_(ROLLED | {"impact.friction": friction, "method.size": "0.38 mm"})
    run = vp.run(case, figures=False)
    body, snapshot, end = run.body, run.snapshot(-1), run.rows[-1]
    side = snapshot["position"][body.surface.ring[:, 0]]
    on_wall = side[:, 2] == 0.0
    assert on_wall.sum() >= 2  # the side has rolled
    outermost = side[on_wall, 0].max()
    beyond = side[np.flatnonzero(on_wall).max() + 1, 0]
    assert outermost <= end.contact_radius < beyond
    assert end.contact_radius > 1.1 * end.impact_face_radius


def test_elements_with_and_without_hourglass_modes_agree_on_the_contact_radius_under_friction():
    def contact(element: str) -> float:
        case = vp.Case.load("paper", method="fem").with_(ROLLED)
        return (
            vp.run(case.with_({"method.size": "0.19 mm", "method.element": element}), figures=False)
            .rows[-1]
            .contact_radius
        )

    # the side comes down a layer at a time: the contact line is known to one of them
    assert contact("selective") == pytest.approx(contact("one-point"), abs=0.19)
