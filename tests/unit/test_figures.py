import numpy as np

from viscopoint.figures import discs


def test_few_points_are_all_drawn_the_far_ones_first():
    seen = np.random.default_rng(0).uniform(size=(1000, 3))
    shown, apart = discs.foremost(seen, 0.1)
    assert apart == 0.1
    assert sorted(shown) == list(range(1000))
    assert (np.diff(seen[shown, 2]) <= 0.0).all()


def test_of_many_points_the_foremost_are_drawn_by_discs_without_gaps():
    side, layers, apart = (
        240,
        3,
        0.01,
    )  # 57,600 points in each of three layers, turned so that no lattice fits the squares
    x, y = (grid.ravel() * apart for grid in np.meshgrid(np.arange(side), np.arange(side)))
    turned = np.column_stack([np.cos(0.3) * x - np.sin(0.3) * y, np.sin(0.3) * x + np.cos(0.3) * y])
    seen = np.concatenate([np.column_stack([turned, np.full(len(x), depth)]) for depth in range(layers)])
    shown, wider = discs.foremost(seen, apart)
    assert len(shown) < 1.1 * discs.MOST
    assert (seen[shown, 2] == 0.0).all()
    hidden = turned[::97, None] - seen[shown][None, :, :2]
    assert np.sqrt((hidden**2).sum(axis=2).min(axis=1)).max() < 0.5 * discs.COVER * wider
