"""What stands around the body: the rigid anvil, and planes of symmetry."""

import math
from typing import Any, NamedTuple

from viscopoint.kernels.jit import generic, implements

TALLY = 5  # what a boundary does: impulse x, y, z [N ms]; work of the normal and of the tangential impulse [mJ]


class RigidWall(NamedTuple):
    """An infinite rigid plane z = height below the body: it pushes, rubs (Coulomb) and lets go without adhesion."""

    height: float  # mm
    friction: float  # Coulomb coefficient


class Symmetry(NamedTuple):
    """A plane normal to an axis that nothing crosses or leaves, free to slide on: rollers, or a mirror."""

    axis: int  # 0, 1, 2 for x, y, z
    position: float  # mm


@generic
def held(boundary: Any, vx: float, vy: float, vz: float) -> tuple[float, float, float]:
    """Return the velocity that a boundary leaves to what touches it and would move at (vx, vy, vz)."""
    raise NotImplementedError


@implements(held, RigidWall)
def pushed(wall: RigidWall, vx: float, vy: float, vz: float) -> tuple[float, float, float]:
    if vz >= 0.0:
        return vx, vy, vz
    sliding = math.sqrt(vx * vx + vy * vy)
    # Coulomb: the tangential impulse is at most friction times the normal one, -vz, and only stops
    kept = max(0.0, 1.0 + wall.friction * vz / sliding) if sliding > 0.0 else 1.0
    return kept * vx, kept * vy, 0.0


@implements(held, Symmetry)
def mirrored(plane: Symmetry, vx: float, vy: float, vz: float) -> tuple[float, float, float]:
    return (
        0.0 if plane.axis == 0 else vx,
        0.0 if plane.axis == 1 else vy,
        0.0 if plane.axis == 2 else vz,
    )
