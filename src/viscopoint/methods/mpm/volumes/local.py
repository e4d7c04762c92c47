"""Each point's own volume and pressure: the paper's."""

from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.jit import implements
from viscopoint.kernels.tensors import Sym, read, spherical
from viscopoint.methods.mpm.grid import Grid
from viscopoint.methods.mpm.points import Points
from viscopoint.methods.mpm.volumes import VOLUMES, acting_stress, dilatation


@VOLUMES.register("local")
class Local(NamedTuple):
    """Nothing is averaged."""

    spares = 0

    @classmethod
    def of_strain(cls, points: Points, grid: Grid, shape: Any, dt: float) -> "Local":
        return cls()

    @classmethod
    def of_pressure(cls, points: Points, grid: Grid) -> "Local":
        return cls()


@implements(dilatation, Local)
def own_volume(volume: Local, points: Points, p: int, grid: Grid, swept: float, ratio: float) -> tuple[float, float]:
    return swept, ratio


@implements(acting_stress, Local)
def own_stress(volume: Local, points: Points, p: int, grid: Grid) -> Sym:
    return read(points.material.stress[p]) - spherical(np.float64(points.shared.viscous_pressure[p]))
