"""What space the grid spans: all three dimensions, or the half plane of a body that is round about the z axis.

**Axisymmetric** bodies stand in the half plane x = r >= 0, y = 0, where every point is a ring: its volume is 2 pi r
times that of its box in the half plane, exactly if it stands in the box's middle. Nodes are rings too. So masses,
energies and what points and the wall give to each other along z are those of the whole body; across, whatever happens
on one side happens on the other, so that momentum and impulse are zero.

What turns about the axis is strained by moving away from it. With the weights N of one plane

    L = [[dv_r/dr, 0, dv_r/dz], [0, v_r/r, 0], [dv_z/dr, 0, dv_z/dz]],    v_r/r = Σ N v_ri / r_p,
    f_ri = -Σ V_p (σ_rr dN/dr + σ_rz dN/dz + σ_tt N / r_p)

at the point itself. V_p / r_p is 2 pi times the area of the box, so that both are what the box has on the average: its
∫ v_r dr dz over ∫ r dr dz. A uniform strain is one wherever points stand.

**On the axis** v_r is odd and v_z even: v_r = 0 at its nodes, whatever points around them map there, which is no force
(the mirror image maps as much the other way). Shape functions that reach beyond the axis find no nodes there: what they
would need goes on in a straight line, v_-1 = 2 v_0 - v_1, as at walls (see ``shapes.splines``). Of v_r that is the
mirror image itself; of v_z it keeps linear fields, one weight for both components, and leaves a slope at the axis that
is of first order in the cell, as elements have.
"""

from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Array

ON_AXIS = 1e-9  # cells; nodes closer to the axis stand on it


class Box(NamedTuple):
    """The region in which points live; outside they are retired."""

    low: tuple[float, float, float]  # mm
    high: tuple[float, float, float]  # mm


class Solid:
    """Three dimensions."""

    extends = (1, 1, 1)  # along x, y, z: whether the grid has more than one plane of nodes
    resultant = (1.0, 1.0, 1.0)  # whether what happens to a part of the body adds up to something for the whole

    def within(self, box: Box, cell: float) -> Box:
        """Return the box of a case as the grid has it."""
        return box

    def points(self, radius: float, length: float, spacing: float) -> float:
        """Return about how many points a rod has."""
        return np.pi * radius**2 * length / spacing**3

    def free(self, position: Array, cell: float) -> Array:
        """Return 1 where nodes [n, 3] may move, 0 where symmetry forbids it."""
        return np.ones_like(position)

    def room(self, low: Array, cell: tuple[float, float, float]) -> Array:
        """Return the volume of cells that begin at x = ``low`` [mm^3]."""
        return np.full(len(low), np.prod(cell), dtype=np.float64)

    def mirror(self, grid: Any, *fields: Array) -> None:
        """Take from the nodes' fields [n, 4] what symmetry forbids."""


class Axisymmetric(Solid):
    """The half plane x = r >= 0, y = 0."""

    extends = (1, 0, 1)
    resultant = (0.0, 0.0, 1.0)

    def within(self, box: Box, cell: float) -> Box:
        return box._replace(low=(0.0, 0.0, box.low[2]), high=(box.high[0], cell, box.high[2]))

    def points(self, radius: float, length: float, spacing: float) -> float:
        return radius * length / spacing**2

    def free(self, position: Array, cell: float) -> Array:
        free = np.ones_like(position)
        free[np.abs(position[:, 0]) < ON_AXIS * cell, 0] = 0.0
        free[:, 1] = 0.0
        return free

    def room(self, low: Array, cell: tuple[float, float, float]) -> Array:
        return 2.0 * np.pi * (low + 0.5 * cell[0]) * cell[0] * cell[2]

    def mirror(self, grid: Any, *fields: Array) -> None:
        axis = round(-grid.x0 * grid.per_cell) - grid.i0
        if axis >= 0:
            for field in fields:
                field.reshape(-1, int(grid.nx), 4)[:, axis : axis + 1, 0] = 0.0


GEOMETRIES: dict[str, Solid] = {"3d": Solid(), "axisymmetric": Axisymmetric()}
