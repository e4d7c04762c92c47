"""Planes that act on bodies: rigid walls, planes of symmetry, and pistons of prescribed motion.

Each says how far it lets nodes move, as rows of one system (``interactions.rows``); what acts on nodes of a mesh or of
a total Lagrangian grid is ``interactions.on_nodes``, what acts on a grid that lives for one step is the grid's.
"""

from typing import NamedTuple, Protocol

Triple = tuple[float, float, float]


class Plane(NamedTuple):
    """What kernels know of a plane; the body is on the side to which the normal points."""

    point: Triple  # mm
    normal: Triple  # a unit vector
    speed: float  # along the normal, mm/ms
    friction: float  # Coulomb coefficient
    two_sided: bool  # nothing leaves it


class Interaction(Protocol):
    """What acts on a body from outside."""

    @property
    def plane(self) -> Plane:
        """What kernels know of it."""
        ...

    @property
    def holds(self) -> bool:
        """Whether it acts, from the start and for good, on the nodes that stand on it, and on no others."""
        ...


class RigidPlane(NamedTuple):
    """A rigid wall: it pushes, rubs (Coulomb) and separates freely."""

    point: Triple  # mm
    normal: Triple  # a unit vector, into the body
    friction: float = 0.0  # Coulomb coefficient

    @property
    def plane(self) -> Plane:
        return Plane(self.point, self.normal, 0.0, self.friction, False)

    @property
    def holds(self) -> bool:
        return False


class SymmetryPlane(NamedTuple):
    """A plane that nothing crosses or leaves, free to slide on: rollers, or a mirror."""

    point: Triple  # mm
    normal: Triple  # a unit vector

    @property
    def plane(self) -> Plane:
        return Plane(self.point, self.normal, 0.0, 0.0, True)

    @property
    def holds(self) -> bool:
        return True


class MovingPlane(NamedTuple):
    """A plane that takes the material on it along at a prescribed speed, free to slide on: a piston that grips."""

    point: Triple  # at the start, mm
    normal: Triple  # a unit vector
    speed: float  # along the normal, mm/ms

    @property
    def plane(self) -> Plane:
        return Plane(self.point, self.normal, self.speed, 0.0, True)

    @property
    def holds(self) -> bool:
        return True


def rigid_wall(height: float, friction: float = 0.0) -> RigidPlane:
    """Return a horizontal wall below the body."""
    return RigidPlane((0.0, 0.0, height), (0.0, 0.0, 1.0), friction)


def symmetry_plane(axis: int, position: float) -> SymmetryPlane:
    """Return a plane of symmetry normal to an axis (0, 1, 2 for x, y, z)."""
    along = [0.0, 0.0, 0.0]
    along[axis] = 1.0
    x, y, z = (position * part for part in along)
    return SymmetryPlane((x, y, z), (along[0], along[1], along[2]))
