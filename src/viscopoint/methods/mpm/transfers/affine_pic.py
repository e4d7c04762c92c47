"""Transfers whose points carry a velocity gradient: v_p = Σ N v_i, (mv)_i = Σ N m_p (v_p + C_p (x_i - x_p)).

**Affine PIC** (Jiang, Schroeder, Selle, Teran & Stomakhin 2015; 2017 for the proofs) keeps a moment,

    B_p = Σ N v_i ⊗ (x_i - x_p),    C_p = B_p D_p⁻¹,    D_p = Σ N (x_i - x_p) ⊗ (x_i - x_p),

with a diagonal D_p: its angular momentum around itself, so that Σ m_p (x_p × v_p + ε:B_p) is conserved to rounding,
wherever points move. The price: B_p D_p⁻¹ changes as D_p does while they move through cells. Boxes (GIMP) have a D that
varies little; trilinear D is s (1 - s) cells², zero on the planes of nodes. N D⁻¹ (x_i - x_p) is finite even there, but
it is all that a node of nearly no mass hears of. So the momentum by which points are strained is mapped with a D of at
least ``LEAST``; no account depends on it.

**Taylor PIC** (Nakamura, Matsumura & Mizutani 2023; in particle-in-cell plasma codes, Edwards & Bridson 2012) keeps the
gradient itself, C_p = Σ v_i ⊗ ∇N, so that a uniform one lasts while points move through cells. Angular momentum changes
by Σ m_p ε:(C_p D_p - B_p). With trilinear shape functions C_p = B_p D_p⁻¹ where it was found: TPIC is APIC until the
point moves and D_p changes. But a point beside a node of nearly no mass takes a gradient from it that has no bound, and
carries it on; cases are refused that combination. Boxes (GIMP) have no slope where they have no weight. (Strain by the
gradient of the step before would cure it, but strain that lags behind velocity feeds short waves: by 1 % each step at a
fifth of the critical one.)
"""

from typing import Any, NamedTuple, Self

from viscopoint.kernels.jit import generic, implements, inline
from viscopoint.kernels.tensors import Matrix, Sym
from viscopoint.methods.mpm.affine import (
    affine_energy,
    inertia,
    moment,
    scatter_affine,
    scatter_force,
    store_matrix,
    stored_matrix,
)
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.stencil import Stencil, gradient, interpolate
from viscopoint.methods.mpm.transfers import TRANSFERS, g2p, p2g, p2g_with_force, store_velocity

LEAST = 1.0 / 6.0  # cells²: the mean of trilinear D over a cell


class Affine(NamedTuple):
    """What points carry of the motion around them goes back to the nodes."""

    affine = True

    @classmethod
    def chosen(cls, pic: float) -> Self:
        return cls()

    @property
    def dissipates(self) -> str:
        name = type(self).__name__.upper()
        return (
            f"{name} forgets what cells cannot hold, its own loss (method.transfer; guards.energy_error may allow it)"
        )


@TRANSFERS.register("apic")
class Apic(Affine):
    """Points keep B_p [mm^2/ms]."""


@TRANSFERS.register("tpic")
class Tpic(Affine):
    """Points keep C_p [1/ms]."""


@generic
def slope(transfer: Any, points: Points, p: int, grid: Grid, at: Stencil, least: float) -> Matrix:
    """Return C_p per cell, with a D of at least ``least`` cells²."""
    raise NotImplementedError


@implements(slope, Apic)
def of_moment(transfer: Apic, points: Points, p: int, grid: Grid, at: Stencil, least: float) -> Matrix:
    b = stored_matrix(points.affine, p, grid.per_cell)
    x, y, z = 1.0 / max(inertia(at.wx), least), 1.0 / max(inertia(at.wy), least), 1.0 / max(inertia(at.wz), least)
    return Matrix(b.xx * x, b.xy * y, b.xz * z, b.yx * x, b.yy * y, b.yz * z, b.zx * x, b.zy * y, b.zz * z)


@implements(slope, Tpic)
def of_gradient(transfer: Tpic, points: Points, p: int, grid: Grid, at: Stencil, least: float) -> Matrix:
    return stored_matrix(points.affine, p, grid.cell)


@inline
def momentum(transfer: Any, points: Points, p: int, grid: Grid, at: Stencil) -> None:
    """Map the momentum by which points are strained."""
    v = points.velocity[p]
    scatter_affine(grid, at, points.mass[p], (v[0], v[1], v[2]), slope(transfer, points, p, grid, at, LEAST))


@inline
def momentum_and_force(transfer: Any, points: Points, p: int, grid: Grid, at: Stencil, pull: Sym) -> None:
    """Map momentum and force."""
    v = points.velocity[p]
    scatter_affine(grid, at, points.mass[p], (v[0], v[1], v[2]), slope(transfer, points, p, grid, at, 0.0))
    scatter_force(grid, at, pull)


@implements(g2p, Apic)
def take_moment(transfer: Apic, points: Points, p: int, grid: Grid, at: Stencil) -> None:
    moves = interpolate(grid.velocity, grid, at)
    store_velocity(points, p, moves, moves)
    store_matrix(points.affine, p, grid.cell, moment(grid.velocity, grid, at))
    points.affine_energy[p] = affine_energy(at, slope(transfer, points, p, grid, at, 0.0))


@implements(g2p, Tpic)
def take_gradient(transfer: Tpic, points: Points, p: int, grid: Grid, at: Stencil) -> None:
    moves = interpolate(grid.velocity, grid, at)
    store_velocity(points, p, moves, moves)
    C = gradient(grid.velocity, grid, at, 1.0)
    store_matrix(points.affine, p, grid.per_cell, C)
    points.affine_energy[p] = affine_energy(at, C)


for _transfer in (Apic, Tpic):
    implements(p2g, _transfer)(momentum)
    implements(p2g_with_force, _transfer)(momentum_and_force)
