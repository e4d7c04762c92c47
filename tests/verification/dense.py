"""The transfers as matrices: S [p, n] interpolates from nodes to points, and each formula is one line."""

from typing import Any, NamedTuple

import numpy as np
from columns import Array

from viscopoint.kernels.arrays import Indices
from viscopoint.methods.mpm.method import MaterialPointMethod
from viscopoint.methods.mpm.shapes import stencil


class Dense(NamedTuple):
    """Weights, slopes [1/mm] and places of all nodes of a small method, as it stands."""

    weights: Array  # [p, n], S
    slopes: Array  # [p, n, 3]
    reach: Array  # [p, n, 3], x_i - x_p, mm
    mass: Array  # [p]
    lumped: Array  # [n]

    def averaged(self, values: Array) -> Array:
        """Return S⁺ of points' values."""
        return self.weights.T @ (self.mass[:, None] * values) / self.lumped[:, None]

    def moments(self, velocity: Array) -> Array:
        """Return B = Σ N v_i ⊗ (x_i - x_p)."""
        return np.einsum("pn,na,pnb->pab", self.weights, velocity, self.reach)

    def gradients(self, velocity: Array) -> Array:
        """Return C = Σ v_i ⊗ ∇N."""
        return np.einsum("na,pnb->pab", velocity, self.slopes)

    def inertia(self) -> Array:
        """Return D = Σ N (x_i - x_p) ⊗ (x_i - x_p)."""
        return np.einsum("pn,pna,pnb->pab", self.weights, self.reach, self.reach)

    def affine(self, gradient: Array) -> Array:
        """Return Σ N m_p C_p (x_i - x_p) / m_i."""
        return np.einsum("pn,p,pab,pnb->na", self.weights, self.mass, gradient, self.reach) / self.lumped[:, None]


def dense(method: MaterialPointMethod) -> Dense:
    """Return the matrices of a method of few points."""
    points, grid, rows = method.points, method.grid, []
    for place in points.position:
        axes = [_axis(method.shape, (x - x0) / grid.cell) for x, x0 in zip(place, grid[:3], strict=True)]
        rows.append(axes)
    nodes = sorted({(i, j, k) for axes in rows for i in axes[0][0] for j in axes[1][0] for k in axes[2][0]})
    column = {node: n for n, node in enumerate(nodes)}
    weights, slopes = np.zeros((len(rows), len(nodes))), np.zeros((len(rows), len(nodes), 3))
    for p, (x, y, z) in enumerate(rows):
        for i, wx, dx in zip(*x, strict=True):
            for j, wy, dy in zip(*y, strict=True):
                for k, wz, dz in zip(*z, strict=True):
                    n = column[i, j, k]
                    weights[p, n] = wx * wy * wz
                    slopes[p, n] = np.array([dx * wy * wz, wx * dy * wz, wx * wy * dz]) / grid.cell
    kept = weights.sum(axis=0) > 0.0
    places = np.array(grid[:3]) + grid.cell * np.array(nodes)[kept]
    weights = weights[:, kept]
    reach = places[None] - points.position[:, None]
    return Dense(weights, slopes[:, kept], reach, points.mass, points.mass @ weights)


def _axis(shape: Any, place: float) -> tuple[Indices, Array, Array]:
    first, weights, slopes = stencil(shape, place)
    return int(first) + np.arange(len(weights)), np.array(weights), np.array(slopes)


def whirl(tensors: Array) -> Array:
    """Return ε:T, the axial vector of each tensor T = v ⊗ r, that is r x v."""
    return np.stack(
        [
            tensors[..., 2, 1] - tensors[..., 1, 2],
            tensors[..., 0, 2] - tensors[..., 2, 0],
            tensors[..., 1, 0] - tensors[..., 0, 1],
        ],
        axis=-1,
    )


def orbital(method: MaterialPointMethod) -> Array:
    """Return Σ x_p x m_p v_p."""
    points = method.points
    return np.cross(points.position, points.mass[:, None] * points.velocity).sum(axis=0)
