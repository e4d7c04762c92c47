import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from viscopoint.materials.linear_viscoelastic import mean_decay, mean_square_gain

# mean_square_gain changes from series to closed form at 1/2
SAMPLES = [*np.logspace(-12, 6, 721), *np.linspace(0.3, 0.8, 101), np.nextafter(0.5, 0), 0.5, np.nextafter(0.5, 1)]
TOLERANCE = 1e-13  # the closed form loses at most a factor of 3 * 2 x / x^3 = 24 (x = 1/2) over rounding


def exact_mean_decay(x: mpf) -> mpf:
    return (1 - mp.exp(-x)) / x


def exact_mean_square_gain(x: mpf) -> mpf:
    return (x - 2 * (1 - mp.exp(-x)) + (1 - mp.exp(-2 * x)) / 2) / x**3


@pytest.mark.parametrize(
    ("factor", "exact"), [(mean_decay, exact_mean_decay), (mean_square_gain, exact_mean_square_gain)]
)
def test_maxwell_factors_hold_to_rounding_from_slow_to_fast_decay(
    factor: Callable[..., Any], exact: Callable[..., Any]
) -> None:
    with mp.workdps(50):
        for x in map(float, SAMPLES):
            assert abs(factor(x) / exact(mpf(x)) - 1) < TOLERANCE, x


def test_maxwell_factors_reach_the_limit_of_no_decay() -> None:
    assert mean_decay(0.0) == 1.0
    assert mean_square_gain(0.0) == pytest.approx(1 / 3, rel=1e-15)  # the mean of s^2 over 0..x, over x^2


def test_square_gain_is_the_mean_square_of_the_strained_arm() -> None:
    # so that the closed form above, from which the code was written too, is not taken on trust
    for x in (0.01, 0.5, 3.0, 40.0):
        with mp.workdps(30):
            mean = mp.quad(lambda s: (1 - mp.exp(-s)) ** 2, [0, x / 4, x / 2, x]) / mpf(x) ** 3
        assert math.isclose(mean_square_gain(x), mean, rel_tol=TOLERANCE)
