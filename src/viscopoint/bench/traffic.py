"""Bytes that a step moves and that a method holds, counted from its arrays.

A step is a row of passes, each one kernel's loop over points, nodes or elements. An array that a pass reads counts
once, and once more if it writes it, whole: as if caches kept within a pass what is used again, and nothing from one
pass to the next. As in STREAM, that a line is fetched before it is written does not count. Left out are arrays with a
row for each slab or chunk, and what the wall does on its own few nodes.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.arrays import Rows


class Pass(NamedTuple):
    """One loop of a step: the arrays it reads and writes, by their names in the method."""

    kernel: str
    reads: str
    writes: str


_LAW = "{0}.jacobian {0}.stress {0}.history {0}.dissipated {0}.hypoelastic {0}.viscous_pressure {0}.viscous_loss"
_POINT_LAW, _ELEMENT_LAW = _LAW.format("points"), _LAW.format("elements")

# MUSL and FLIP, every point its own volume, nodes in contact (``mpm.schemes.musl``)
_MPM = (
    Pass("forget", "", "grid.momentum"),
    Pass("forget", "", "grid.change"),
    Pass(
        "scatter_momentum_and_force",
        "grid.order points.position points.stretch points.stress points.viscous_pressure points.jacobian points.volume "
        "points.mass points.velocity points.affine grid.momentum grid.change",
        "grid.momentum grid.change",
    ),
    Pass("solve", "grid.momentum grid.change", "grid.velocity grid.change"),
    Pass("forget", "", "grid.momentum"),
    Pass(
        "gather_velocity_and_remap",
        "grid.order points.position points.stretch points.mass points.velocity grid.velocity grid.change grid.momentum",
        "points.velocity points.drift points.affine grid.momentum",
    ),
    Pass("divide", "grid.momentum", "grid.velocity"),
    Pass(
        "update_points",
        f"grid.order points.position points.stretch points.velocity grid.velocity {_POINT_LAW}",
        f"points.stretch {_POINT_LAW}",
    ),
    Pass("move", "grid.order points.position points.drift", "points.position"),
    Pass("find_slabs", "points.position", "grid.slab"),
    Pass("sort_by_slab", "grid.slab", "grid.order"),
)

# velocity Verlet, every cell its dilatation (``tlmpm.method``)
_KICK = Pass("kick", "nodes.velocity nodes.force nodes.mass nodes.upright nodes.fixed", "nodes.velocity")
_TLMPM = (
    _KICK,
    Pass("meet", "nodes.upright nodes.position nodes.velocity nodes.pressed", "nodes.pressed"),
    Pass("move", "nodes.position nodes.velocity nodes.pressed nodes.upright", "nodes.position"),
    Pass(
        "carry out",
        "extension.out.start extension.out.column extension.out.value nodes.velocity",
        "lattice.velocity",
    ),
    Pass("forget force", "", "lattice.force"),
    Pass(
        "strain_points",
        "lattice.order points.reference points.position points.volume points.deformation lattice.velocity "
        f"lattice.cells lattice.force {_POINT_LAW}",
        f"points.position points.deformation lattice.force {_POINT_LAW}",
    ),
    Pass(
        "carry back",
        "extension.back.start extension.back.column extension.back.value lattice.force",
        "nodes.force",
    ),
    _KICK,
    Pass("meet", "nodes.upright nodes.velocity nodes.pressed", ""),
)

# velocity Verlet (``fem.method``)
_SET_OFF = Pass(
    "set_off",
    "nodes.position nodes.velocity nodes.force nodes.mass nodes.fixed",
    "nodes.position nodes.velocity nodes.force nodes.pressed",
)
_ARRIVE = Pass("arrive", "nodes.velocity nodes.force nodes.mass nodes.fixed nodes.pressed", "nodes.velocity")
_ANSWER_READS = (
    "slabs.order elements.alive elements.corner elements.volume nodes.position nodes.velocity nodes.force "
    f"{_ELEMENT_LAW}"
)
_ANSWER_WRITES = f"nodes.force {_ELEMENT_LAW}"
_HOURGLASS = "elements.memory elements.hourglass_work"

PASSES: dict[str, tuple[Pass, ...]] = {
    "mpm": _MPM,
    "tlmpm": _TLMPM,
    "fem, one-point": (
        _SET_OFF,
        Pass("strain_one_point", f"{_ANSWER_READS} {_HOURGLASS}", f"{_ANSWER_WRITES} {_HOURGLASS}"),
        _ARRIVE,
    ),
    "fem, selective": (_SET_OFF, Pass("strain_selective", _ANSWER_READS, _ANSWER_WRITES), _ARRIVE),
}


def bytes_per_step(method: Any, passes: Sequence[Pass]) -> int:
    """Return how many bytes a step moves."""
    arrays = arrays_of(method)
    return sum(arrays[name].nbytes for one in passes for name in f"{one.reads} {one.writes}".split())


def bytes_held(method: Any) -> int:
    """Return how many bytes all arrays of a method have; an array under two names counts once."""
    return sum({array.ctypes.data: array.nbytes for array in arrays_of(method).values()}.values())


def arrays_of(method: Any) -> dict[str, Rows]:
    """Return all arrays of a method by dotted names, such as "points.stress"."""
    return dict(_named("", vars(method)))


def _named(prefix: str, values: Mapping[str, Any]) -> list[tuple[str, Rows]]:
    found: list[tuple[str, Rows]] = []
    for name, value in values.items():
        if isinstance(value, np.ndarray):
            found.append((prefix + name, value))
        elif isinstance(value, tuple):  # a NamedTuple: no plain tuple holds arrays
            found += _named(f"{prefix}{name}.", dict(zip(getattr(value, "_fields", ()), value, strict=False)))
    return found
