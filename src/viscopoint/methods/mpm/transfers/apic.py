"""Affine PIC (Jiang, Schroeder, Selle, Teran & Stomakhin 2015; 2017 for the proofs).

    v_p = Σ N v_i,    B_p = Σ N v_i ⊗ (x_i - x_p),    (mv)_i = Σ N m_p (v_p + B_p D_p⁻¹ (x_i - x_p))

with D_p = Σ N (x_i - x_p) ⊗ (x_i - x_p), which is diagonal here. What a point keeps is its angular momentum around
itself: Σ m_p (x_p × v_p + ε:B_p) is conserved to rounding, wherever points move. The price: B_p D_p⁻¹ changes as D_p
does while they move through cells. Boxes (GIMP) have a D that varies little; trilinear D is s (1 - s) cells², zero on
the planes of nodes. N D⁻¹ (x_i - x_p) is finite even there, but it is all that a node of nearly no mass hears of. So
the momentum by which points are strained is mapped with a D of at least ``LEAST``; no account depends on it.
"""

from typing import NamedTuple

from viscopoint.kernels.jit import implements, inline
from viscopoint.kernels.tensors import Matrix, Sym
from viscopoint.methods.mpm.affine import (
    affine_energy,
    inertia,
    moment,
    spread_affine,
    spread_force,
    store_matrix,
    stored_matrix,
)
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.support import Support, sampled
from viscopoint.methods.mpm.transfers import TRANSFERS, give, give_with_force, store_velocity, take

LEAST = 1.0 / 6.0  # cells²: the mean of trilinear D over a cell


@TRANSFERS.register("apic")
class Apic(NamedTuple):
    """Points keep B_p [mm^2/ms]."""

    @classmethod
    def chosen(cls, pic: float) -> "Apic":
        return cls()

    @property
    def affine(self) -> bool:
        return True

    @property
    def dissipates(self) -> str:
        return "APIC forgets what cells cannot hold, its own loss (method.transfer; guards.energy_error may allow it)"


@inline
def slope(points: Points, p: int, grid: Grid, at: Support, least: float) -> Matrix:
    """Return B D⁻¹ per cell, with a D of at least ``least`` cells²."""
    b = stored_matrix(points.affine, p, grid.per_cell)
    x, y, z = 1.0 / max(inertia(at.wx), least), 1.0 / max(inertia(at.wy), least), 1.0 / max(inertia(at.wz), least)
    return Matrix(b.xx * x, b.xy * y, b.xz * z, b.yx * x, b.yy * y, b.yz * z, b.zx * x, b.zy * y, b.zz * z)


@implements(give, Apic)
def momentum(transfer: Apic, points: Points, p: int, grid: Grid, at: Support) -> None:
    v = points.velocity[p]
    spread_affine(grid, at, points.mass[p], (v[0], v[1], v[2]), slope(points, p, grid, at, LEAST))


@implements(give_with_force, Apic)
def momentum_and_force(transfer: Apic, points: Points, p: int, grid: Grid, at: Support, pull: Sym) -> None:
    v = points.velocity[p]
    spread_affine(grid, at, points.mass[p], (v[0], v[1], v[2]), slope(points, p, grid, at, 0.0))
    spread_force(grid, at, pull)


@implements(take, Apic)
def seen(transfer: Apic, points: Points, p: int, grid: Grid, at: Support) -> None:
    moves = sampled(grid.velocity, grid, at)
    store_velocity(points, p, moves, moves)
    store_matrix(points.affine, p, grid.cell, moment(grid.velocity, grid, at))
    points.affine_energy[p] = affine_energy(at, slope(points, p, grid, at, 0.0))
