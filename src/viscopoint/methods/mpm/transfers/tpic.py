"""Taylor PIC (Nakamura, Matsumura & Mizutani 2023; in particle-in-cell plasma codes, Edwards & Bridson 2012).

    v_p = Σ N v_i,    C_p = Σ v_i ⊗ ∇N,    (mv)_i = Σ N m_p (v_p + C_p (x_i - x_p))

What a point keeps is the velocity gradient, so that a uniform one lasts while points move through cells. Angular
momentum changes by Σ m_p ε:(C_p D_p - B_p) with APIC's B_p and D_p. With trilinear shape functions C_p = B_p D_p⁻¹
where it was found: TPIC is APIC until the point moves and D_p changes. But a point beside a node of nearly no mass
takes a gradient from it that has no bound, and carries it on; cases are refused that combination. Boxes (GIMP) have no
slope where they have no weight. (Strain by the gradient of the step before would cure it, but strain that lags behind
velocity feeds short waves: by 1 % each step at a fifth of the critical one.)
"""

from typing import NamedTuple

from viscopoint.kernels.jit import implements
from viscopoint.kernels.tensors import Sym
from viscopoint.methods.mpm.affine import affine_energy, spread_affine, spread_force, store_matrix, stored_matrix
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.support import Support, gradient, sampled
from viscopoint.methods.mpm.transfers import TRANSFERS, give, give_with_force, store_velocity, take


@TRANSFERS.register("tpic")
class Tpic(NamedTuple):
    """Points keep C_p [1/ms]."""

    @classmethod
    def chosen(cls, pic: float) -> "Tpic":
        return cls()

    @property
    def affine(self) -> bool:
        return True

    @property
    def dissipates(self) -> str:
        return "TPIC forgets what cells cannot hold, its own loss (method.transfer; guards.energy_error may allow it)"


@implements(give, Tpic)
def momentum(transfer: Tpic, points: Points, p: int, grid: Grid, at: Support) -> None:
    v = points.velocity[p]
    spread_affine(grid, at, points.mass[p], (v[0], v[1], v[2]), stored_matrix(points.affine, p, grid.cell))


@implements(give_with_force, Tpic)
def momentum_and_force(transfer: Tpic, points: Points, p: int, grid: Grid, at: Support, pull: Sym) -> None:
    v = points.velocity[p]
    spread_affine(grid, at, points.mass[p], (v[0], v[1], v[2]), stored_matrix(points.affine, p, grid.cell))
    spread_force(grid, at, pull)


@implements(take, Tpic)
def seen(transfer: Tpic, points: Points, p: int, grid: Grid, at: Support) -> None:
    moves = sampled(grid.velocity, grid, at)
    store_velocity(points, p, moves, moves)
    C = gradient(grid.velocity, grid, at, 1.0)
    store_matrix(points.affine, p, grid.per_cell, C)
    points.affine_energy[p] = affine_energy(at, C)
