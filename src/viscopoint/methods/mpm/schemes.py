"""The order of a time step: when stress is updated (Zhang, Chen & Liu 2016, ch. 3; Bardenhagen 2002).

A scheme is a function of the method and the step, offered under the name that a case uses. Every mapping of a step
uses the weights of its beginning; the points move last.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

from viscopoint.methods.mpm.grid import accelerate, average, forget
from viscopoint.methods.mpm.mapping import (
    gather_velocity,
    gather_velocity_and_remap,
    move,
    scatter_momentum,
    scatter_momentum_and_force,
)

if TYPE_CHECKING:
    from viscopoint.methods.mpm.method import MaterialPointMethod

Scheme = Callable[["MaterialPointMethod", float], None]
SCHEMES: dict[str, Scheme] = {}


def offer(name: str) -> Callable[[Scheme], Scheme]:
    """Let cases choose the decorated scheme by ``name``."""

    def register(scheme: Scheme) -> Scheme:
        SCHEMES[name] = scheme
        return scheme

    return register


@offer("musl")
def musl(mpm: "MaterialPointMethod", dt: float) -> None:
    """Update stress last, from the re-mapped momentum of the accelerated points: the paper's."""
    points, shape, transfer = mpm.points, mpm.shape, mpm.transfer
    grid = mpm.fresh_grid()
    scatter_momentum_and_force(points, grid, shape, mpm.pressed(), transfer)  # m_i, (mv)_i, f_i
    accelerate(grid, dt)  # v_i = ((mv)_i + f_i dt) / m_i
    mpm.contact(grid)  # v_n >= 0 on the wall
    forget(grid.momentum)
    gather_velocity_and_remap(points, grid, shape, transfer)  # v_p, then (mv)_i of the accelerated points
    average(grid)  # v_i
    mpm.hold(grid)
    mpm.update_stress(grid, dt)  # L_p, J_p, sigma_p
    move(points, grid, dt)  # x_p


@offer("usl")
def usl(mpm: "MaterialPointMethod", dt: float) -> None:
    """Update stress last, from the accelerated nodes themselves (Sulsky, Chen & Schreyer 1994)."""
    points, shape, transfer = mpm.points, mpm.shape, mpm.transfer
    grid = mpm.fresh_grid()
    scatter_momentum_and_force(points, grid, shape, mpm.pressed(), transfer)  # m_i, (mv)_i, f_i
    accelerate(grid, dt)  # v_i = ((mv)_i + f_i dt) / m_i
    mpm.contact(grid)  # v_n >= 0 on the wall
    gather_velocity(points, grid, shape, transfer)  # v_p
    mpm.update_stress(grid, dt)  # L_p, J_p, sigma_p
    move(points, grid, dt)  # x_p


@offer("usf")
def usf(mpm: "MaterialPointMethod", dt: float) -> None:
    """Update stress first, from the mapped momentum; the new stress accelerates."""
    points, shape, transfer = mpm.points, mpm.shape, mpm.transfer
    grid = mpm.fresh_grid()
    scatter_momentum(points, grid, shape, transfer)  # m_i, (mv)_i
    average(grid)  # v_i
    mpm.hold(grid)
    mpm.update_stress(grid, dt)  # L_p, J_p, sigma_p
    mpm.fresh_grid()
    scatter_momentum_and_force(points, grid, shape, mpm.pressed(), transfer)  # m_i, (mv)_i, f_i
    accelerate(grid, dt)  # v_i = ((mv)_i + f_i dt) / m_i
    mpm.contact(grid)  # v_n >= 0 on the wall
    gather_velocity(points, grid, shape, transfer)  # v_p
    move(points, grid, dt)  # x_p
