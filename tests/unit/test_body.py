import numpy as np
import pytest

from viscopoint.methods.mpm.fills import Fill
from viscopoint.methods.mpm.fills.lattice import rod_lattice
from viscopoint.methods.mpm.fills.rings import rod_rings
from viscopoint.methods.mpm.fills.trimmed import rod_trimmed
from viscopoint.model.measurements import measure, profile


def test_the_paper_s_lattice_has_21172_points():
    body = rod_lattice(3.8, 25.4, 0.38)
    assert len(body.position) == 21_172 == 316 * 67
    assert body.surface.ring.shape[0] == 67
    assert body.position[:, 2].min() == pytest.approx(0.19)
    assert np.hypot(body.position[:, 0], body.position[:, 1]).max() <= 3.8
    assert np.abs(body.position[:, :2]).min() == pytest.approx(0.19)  # points at half spacings from the axis
    assert body.volume.sum() / 25.46 == pytest.approx(45.63, abs=0.005)  # mm^2, against 45.36 of the circle
    assert len(rod_lattice(3.8, 25.4, 0.19).position) == 169_376


def test_an_undeformed_rod_measures_its_lattice():
    body = rod_lattice(3.8, 25.4, 0.38)
    gauges = measure(body.surface, body.position)
    assert gauges.length == pytest.approx(67 * 0.38)
    assert gauges.impact_face_radius == gauges.greatest_radius == pytest.approx(3.8)


def test_gauges_follow_a_homogeneous_stretch():
    body = rod_lattice(3.0, 10.0, 0.5)
    gauges = measure(body.surface, body.position * [1.2, 1.2, 0.7])
    assert gauges.length == pytest.approx(10.0 * 0.7)
    assert gauges.greatest_radius == pytest.approx(3.0 * 1.2)


@pytest.mark.parametrize("fill", [rod_lattice, rod_rings, rod_trimmed])
def test_radius_is_read_at_the_surface_where_the_stretch_is_uneven(fill: Fill):
    body = fill(3.0, 10.0, 0.5)
    start = np.hypot(body.position[:, 0], body.position[:, 1])

    def measured(now: np.ndarray) -> float:
        position = body.position * np.column_stack([now / start, now / start, np.ones_like(now)])
        return measure(body.surface, position).greatest_radius

    assert measured(0.5 + 0.9 * start) == pytest.approx(0.5 + 0.9 * 3.0)
    # a straight line through points within a spacing of the surface misses a parabola by its curvature times at most
    # half that distance squared
    assert measured(start + 0.1 * start**2) == pytest.approx(3.0 + 0.1 * 9.0, abs=0.2 * 0.5**2 / 2 * 2**2)


def test_a_layer_that_lost_most_of_its_points_still_has_a_radius():
    body = rod_lattice(3.0, 10.0, 0.5)
    noise = 0.02 * np.random.default_rng(1).standard_normal(len(body.position))
    position = 1.1 * body.position * (1.0 + noise / 3.0)[:, None]
    for layer, left in enumerate(range(1, 5)):
        position[body.surface.ring[layer, left:]] = np.nan
    _, radius = profile(body.surface, position)
    # a point or two off by five standard deviations; a line through them would be off by more than ten times as much
    assert radius == pytest.approx(np.full(20, 3.3), abs=5 * 0.02 * 1.1)


def test_a_point_that_flies_off_is_not_the_surface():
    body = rod_lattice(3.0, 10.0, 0.5)
    for one in (0, 7):
        position = body.position.copy()
        position[body.surface.ring[3, one]] *= [3.0, 3.0, 1.0]
        assert profile(body.surface, position)[1] == pytest.approx(np.full(20, 3.0), rel=1e-12)


def test_profile_gives_radius_and_height_of_each_layer_without_the_lost():
    body = rod_lattice(3.0, 10.0, 0.5)
    position = body.position.copy()
    swell = 1.0 + 0.1 * position[:, 2]
    position[:, :2] *= swell[:, None]
    position[body.surface.ring[3, 0]] = np.nan
    height, radius = profile(body.surface, position)
    assert height == pytest.approx((np.arange(20) + 0.5) * 0.5)
    assert radius == pytest.approx(3.0 * (1.0 + 0.1 * height))


@pytest.mark.parametrize(
    ("length", "spacing", "layers"), [(10.0, 0.5, 20), (10.0, 0.49, 20), (0.76, 0.5, 2), (1.0, 0.1, 10)]
)
def test_layers_are_those_whose_centre_is_in_the_rod(length: float, spacing: float, layers: int):
    body = rod_lattice(1.0, length, spacing)
    assert body.surface.ring.shape[0] == layers
    assert measure(body.surface, body.position).length == pytest.approx(layers * spacing)


@pytest.mark.parametrize(
    ("radius", "length", "spacing"), [(3.8, 25.4, 0.38), (3.8, 25.4, 0.41), (1.0, 0.8, 0.5), (1.0, 3.0, 1.0)]
)
def test_rings_have_the_cylinder_s_volume_centroid_and_moments(radius: float, length: float, spacing: float):
    body = rod_rings(radius, length, spacing)
    x, y, z = body.position.T
    area = np.pi * radius**2
    volume = body.volume
    assert np.ptp(volume) == 0.0
    assert volume.sum() == pytest.approx(area * length, rel=1e-13)
    assert np.average(body.position, axis=0) == pytest.approx([0.0, 0.0, length / 2], abs=1e-13 * length)
    # at the radius that halves each ring's area; at its mean radius the moment would be 1 - 1 / (2 n²) of this
    assert volume @ (x**2 + y**2) == pytest.approx(area * radius**2 / 2 * length, rel=1e-12)
    for square in (x**2, y**2):  # three points or more around each ring: alike in all directions
        assert volume @ square == pytest.approx(area * radius**2 / 4 * length, rel=1e-12)
    assert volume @ (x * y) == pytest.approx(0.0, abs=1e-12 * area * radius**2)
    # layers are dz thick, which takes dz² / 12 off the second moment along the axis
    layers = body.surface.ring.shape[0]
    assert volume @ (z - length / 2) ** 2 == pytest.approx(area * length**3 / 12 * (1 - 1 / layers**2), rel=1e-12)


@pytest.mark.parametrize(("fill", "layers"), [(rod_rings, 67), (rod_trimmed, 66)])  # an even number if trimmed
def test_fills_of_the_cylinder_s_volume_measure_radius_and_length_exactly(fill: Fill, layers: int):
    body = fill(3.8, 25.4, 0.38)
    gauges = measure(body.surface, body.position)
    assert gauges.length == pytest.approx(25.4, rel=1e-14)
    assert gauges.impact_face_radius == gauges.greatest_radius == pytest.approx(3.8, rel=1e-14)
    assert gauges.widest_point < 3.8
    assert body.surface.ring.shape[0] == layers
    stretched = measure(body.surface, body.position * [1.2, 1.2, 0.7])
    assert stretched.length == pytest.approx(25.4 * 0.7)
    assert stretched.greatest_radius == pytest.approx(3.8 * 1.2)


def test_rings_show_the_outer_two():
    body = rod_rings(3.8, 25.4, 0.38)
    assert body.surface.ring.shape == (67, 3 * (19 + 17))
    assert len(body.position) == 67 * 3 * 10**2


def test_points_of_rings_are_about_a_spacing_apart():
    body = rod_rings(3.8, 25.4, 0.38)
    layer = body.position[body.position[:, 2] < 0.2, :2]
    apart = np.linalg.norm(layer[:, None] - layer[None], axis=2) + np.eye(len(layer)) * 1e3
    # around a ring 2 π r / (3 (2i + 1)): 1.05 d far out, 1.5 d in the innermost; rings are 0.87 d apart at least
    assert apart.min() / 0.38 > 0.85
    assert apart.min(axis=1).max() / 0.38 < 1.25


@pytest.mark.parametrize(("radius", "length", "spacing"), [(3.8, 25.4, 0.38), (3.8, 25.4, 0.41), (2.0, 10.0, 0.5)])
def test_trimmed_lattice_has_the_cylinder_s_volume_centroid_and_second_moments(
    radius: float, length: float, spacing: float
):
    body = rod_trimmed(radius, length, spacing)
    x, y, z = body.position.T
    area, volume = np.pi * radius**2, body.volume
    height = 2 * z.min()
    assert volume.sum() == pytest.approx(area * length, rel=1e-12)
    assert volume @ body.position / volume.sum() == pytest.approx([0.0, 0.0, length / 2], abs=1e-9 * length)
    whole = np.isclose(volume, spacing**2 * height, rtol=1e-9)
    assert whole[np.hypot(np.abs(x) + spacing / 2, np.abs(y) + spacing / 2) < radius].all()
    for square in (x**2, y**2):
        # each box has d²/12 about its own centroid, which is in no point; a part of a box has less, but for convex ones
        # not less than nothing
        lacks = area * radius**2 / 4 * length - volume @ square
        assert volume[whole].sum() * spacing**2 / 12 < lacks < area * length * spacing**2 / 12
    assert volume @ (x * y) == pytest.approx(0.0, abs=1e-12 * area * radius**2)
