import numpy as np
import pytest

from viscopoint.body import rod_lattice
from viscopoint.gauges import measure, profile


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
    assert gauges.foot_radius == gauges.greatest_radius == pytest.approx(3.8)


def test_gauges_follow_a_homogeneous_stretch():
    body = rod_lattice(3.0, 10.0, 0.5)
    gauges = measure(body.surface, body.position * [1.2, 1.2, 0.7])
    assert gauges.length == pytest.approx(10.0 * 0.7)
    assert gauges.greatest_radius == pytest.approx(3.0 * 1.2)


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
