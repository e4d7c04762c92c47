"""The order of a time step: when stress is updated (Zhang, Chen & Liu 2016, ch. 3; Bardenhagen 2002).

A scheme is a list of what is done in each stage of a step (``integrators.central_differences``): before constraints act
on the nodes' velocity, right after, and last. Every mapping of a step uses the weights of its beginning; the points
move last.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from viscopoint.discovery import Registry
from viscopoint.methods.mpm import mapping
from viscopoint.methods.mpm.grid import accelerate, average, zero

Act = Callable[[Any, float], None]  # of a ``MaterialPointMethod`` and the step


class Scheme(NamedTuple):
    """What is done in each stage."""

    kick: tuple[Act, ...]
    drift: tuple[Act, ...]
    strain: tuple[Act, ...]


def scatter(mpm: Any, dt: float) -> None:
    """Map m_i, (mv)_i and f_i, and find v_i = ((mv)_i + f_i dt) / m_i."""
    zero(mpm.grid.momentum)
    zero(mpm.grid.force)
    averaged = mpm.volume.of_pressure(mpm.points, mpm.grid)
    mapping.scatter_momentum_and_force(mpm.points, mpm.grid, mpm.shape, averaged, mpm.transfer)
    accelerate(mpm.grid, dt)


def gather(mpm: Any, dt: float) -> None:
    """Find v_p."""
    mapping.gather_velocity(mpm.points, mpm.grid, mpm.shape, mpm.transfer)


def gather_and_remap(mpm: Any, dt: float) -> None:
    """Find v_p, then v_i = (mv)_i / m_i of the accelerated points, with the constraints applied."""
    zero(mpm.grid.momentum)
    mapping.gather_velocity_and_remap(mpm.points, mpm.grid, mpm.shape, mpm.transfer)
    average(mpm.grid)
    mpm.constrain_velocity()


def map_velocity(mpm: Any, dt: float) -> None:
    """Map m_i and (mv)_i, and find v_i = (mv)_i / m_i, with the constraints applied."""
    zero(mpm.grid.momentum)
    zero(mpm.grid.force)
    mapping.scatter_momentum(mpm.points, mpm.grid, mpm.shape, mpm.transfer)
    average(mpm.grid)
    mpm.constrain_velocity()


def update_stress(mpm: Any, dt: float) -> None:
    """Find L_p, J_p, sigma_p."""
    mpm.update_stress(dt)


def move(mpm: Any, dt: float) -> None:
    """Find x_p."""
    mapping.move(mpm.points, mpm.grid, dt)


SCHEMES: Registry[Scheme] = Registry(
    # stress last, from the re-mapped momentum of the accelerated points: the paper's
    musl=Scheme(kick=(scatter,), drift=(gather_and_remap,), strain=(update_stress, move)),
    # stress last, from the accelerated nodes themselves (Sulsky, Chen & Schreyer 1994)
    usl=Scheme(kick=(scatter,), drift=(gather,), strain=(update_stress, move)),
    # stress first, from the mapped momentum; the new stress accelerates
    usf=Scheme(kick=(map_velocity, update_stress, scatter), drift=(gather,), strain=(move,)),
)
