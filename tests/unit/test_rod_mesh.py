import math

import numpy as np
import pytest

from viscopoint.methods.fem.forms import quality
from viscopoint.methods.fem.mesh import jacobians, outer_faces, slabs
from viscopoint.methods.fem.rod import heights, rod_elements, rod_mesh
from viscopoint.model.body import Body
from viscopoint.model.measurements import measure, profile

RADIUS, LENGTH = 3.8, 12.7  # mm; half the paper's rod
FINENESS = [1.0, 1.3, 1.7, 2.0, 2.5, 3.1, 4.0, 5.0, 6.3, 8.0, 10.0, 12.7, 16.0, 20.0]  # radius over size


@pytest.mark.parametrize("fineness", FINENESS)
def test_nodes_of_the_mantle_stand_around_the_circle_at_equal_angles(fineness: float):
    body = rod_mesh(RADIUS, LENGTH, RADIUS / fineness)
    ring = body.position[body.surface.ring]
    step = 2 * math.pi / ring.shape[1]
    outside = RADIUS * math.sqrt(step / math.sin(step))  # a polygon of the circle's area
    assert np.abs(np.hypot(ring[..., 0], ring[..., 1]) - outside).max() < 8 * np.spacing(RADIUS)
    angles = np.unwrap(np.arctan2(ring[..., 1], ring[..., 0]), axis=1)
    assert np.allclose(np.diff(angles, axis=1), 2 * np.pi / ring.shape[1], rtol=1e-12)
    assert np.hypot(body.position[:, 0], body.position[:, 1]).max() <= outside * (1 + 1e-15)
    assert len(np.unique(body.surface.ring)) == body.surface.ring.size


@pytest.mark.parametrize("fineness", FINENESS)
def test_elements_are_near_cubes_at_every_fineness(fineness: float):
    body = rod_mesh(RADIUS, LENGTH, RADIUS / fineness)
    found = quality(body.position, body.cells)
    assert found.least_jacobian > 0.7
    assert found.greatest_aspect < 3.0
    assert jacobians(body.position[body.cells], 0.0, 0.0, 0.0).min() > 0.0


@pytest.mark.parametrize("fineness", [1.0, 2.5, 10.0])
@pytest.mark.parametrize("grading", [0.5, 1.0, 3.0])
def test_elements_are_as_many_as_said_beforehand(fineness: float, grading: float):
    body = rod_mesh(RADIUS, LENGTH, RADIUS / fineness, grading)
    assert len(body.cells) == rod_elements(RADIUS, LENGTH, RADIUS / fineness, grading)
    assert len(np.unique(np.sort(body.cells, axis=1), axis=0)) == len(body.cells)
    assert np.array_equal(np.unique(body.cells), np.arange(len(body.position)))


def test_the_paper_s_rod_has_22512_elements():
    body = rod_mesh(3.8, 25.4, 0.38)
    assert (len(body.cells), len(body.position)) == (22_512, 24_548)


@pytest.mark.parametrize("fineness", FINENESS)
def test_the_mesh_has_the_cylinder_s_volume_at_every_fineness(fineness: float):
    volume = float(rod_mesh(RADIUS, LENGTH, RADIUS / fineness).volume.sum())
    assert volume == pytest.approx(math.pi * RADIUS**2 * LENGTH, rel=1e-13)


@pytest.mark.parametrize("grading", [0.2, 1.0, 4.0])
def test_layers_grow_geometrically_and_none_is_thicker_than_asked(grading: float):
    planes = heights(LENGTH, 0.5, grading)
    thickness = np.diff(planes)
    assert (planes[0], planes[-1]) == pytest.approx((0.0, LENGTH))
    assert thickness[1:] / thickness[:-1] == pytest.approx(grading ** (1 / (len(thickness) - 1)))
    assert thickness[-1] / thickness[0] == pytest.approx(grading)
    assert thickness[0] <= 0.5 * (1 + 1e-12)
    assert thickness[0] > 0.5 * (1 - 2.0 / len(thickness))  # no more layers than it takes


def test_an_undeformed_mesh_measures_the_rod():
    body = rod_mesh(RADIUS, LENGTH, 0.9, grading=2.0)
    gauges = measure(body.surface, body.position)
    assert (gauges.length, gauges.impact_face_radius, gauges.greatest_radius) == pytest.approx((LENGTH, RADIUS, RADIUS))
    height, radius = profile(body.surface, body.position)
    assert height == pytest.approx(heights(LENGTH, 0.9, 2.0))  # from foot to tail
    assert radius == pytest.approx(RADIUS)


def test_outer_faces_close_the_body_and_are_counted_from_outside():
    body = rod_mesh(RADIUS, LENGTH, 1.9)
    corner = body.position[outer_faces(body.cells)]
    area = 0.5 * np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    assert np.abs(area.sum(axis=0)).max() < 1e-12 * np.abs(area).sum()
    # divergence theorem: all faces of this mesh are plane
    assert np.einsum("fd,fd->", corner.mean(axis=1), area) / 3 == pytest.approx(body.volume.sum())


# --- slabs ---


def two_rods() -> Body:
    one, other = rod_mesh(2.0, 6.0, 1.0), rod_mesh(3.0, 9.0, 1.0)
    position = np.concatenate([one.position, other.position + [20.0, 0.0, 1.5]])
    return one._replace(position=position, cells=np.concatenate([one.cells, other.cells + len(one.position)]))


BODIES = {"coarse": rod_mesh(RADIUS, LENGTH, 1.9), "fine": rod_mesh(RADIUS, LENGTH, 0.6), "two rods": two_rods()}


@pytest.mark.parametrize("shuffled", [False, True])
@pytest.mark.parametrize("name", BODIES)
def test_slabs_of_one_colour_share_no_node_and_hold_every_element_once(name: str, shuffled: bool):
    position, cells = BODIES[name].position, BODIES[name].cells
    if shuffled:
        dice = np.random.default_rng(1)
        renamed = dice.permutation(len(position))  # nodes too
        position, cells = position[np.argsort(renamed)], dice.permutation(renamed[cells])
    order, start = slabs(position, cells)
    assert np.array_equal(np.sort(order), np.arange(len(cells)))
    assert (start[0], start[-1]) == (0, len(cells))
    assert (np.diff(start) > 0).all()
    for colour in (0, 1):
        owner = np.full(len(position), -1)
        for slab in range(colour, len(start) - 1, 2):
            nodes = np.unique(cells[order[start[slab] : start[slab + 1]]])
            assert (owner[nodes] == -1).all()
            owner[nodes] = slab
