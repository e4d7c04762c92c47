"""Bytes that a step moves and that a method holds, counted from its arrays.

A step is a row of passes, each one kernel's loop over points, nodes or elements. An array that a pass reads counts
once, and once more if it writes it, whole: as if caches kept within a pass what is used again, and nothing from one
pass to the next. As in STREAM, that a line is fetched before it is written does not count. Left out are arrays with a
row for each slab or chunk, and what the wall does on its own few nodes.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from viscopoint.kernels.arrays import AnyArray


class Pass(NamedTuple):
    """One loop of a step: the arrays it reads and writes, by their names in the method."""

    kernel: str
    reads: str
    writes: str


_MATERIAL = (
    "{0}.material.stress {0}.material.history {0}.material.dissipated {0}.material.hypoelastic "
    "{0}.shared.jacobian {0}.shared.viscous_pressure {0}.shared.viscous_loss"
)
_OF_POINTS, _OF_ELEMENTS = _MATERIAL.format("points"), _MATERIAL.format("elements")

# MUSL and FLIP, every point its own volume, nodes in contact (``mpm.schemes``)
_MPM = (
    Pass("zero", "", "grid.momentum"),
    Pass("zero", "", "grid.force"),
    Pass(
        "scatter_momentum_and_force",
        "grid.order points.position points.stretch points.material.stress points.shared.viscous_pressure "
        "points.shared.jacobian points.volume points.mass points.velocity points.affine grid.momentum grid.force",
        "grid.momentum grid.force",
    ),
    Pass("divide_with_force", "grid.momentum grid.force", "grid.velocity grid.dv"),
    Pass("zero", "", "grid.momentum"),
    Pass(
        "gather_velocity_and_remap",
        "grid.order points.position points.stretch points.mass points.velocity grid.velocity grid.dv grid.momentum",
        "points.velocity points.grid_velocity points.affine grid.momentum",
    ),
    Pass("divide", "grid.momentum", "grid.velocity"),
    Pass(
        "update_points",
        f"grid.order points.position points.stretch points.velocity grid.velocity {_OF_POINTS}",
        f"points.stretch {_OF_POINTS}",
    ),
    Pass("move", "grid.order points.position points.grid_velocity", "points.position"),
    Pass("find_slabs", "points.position", "grid.slab"),
    Pass("sort_by_slab", "grid.slab", "grid.order"),
)

# central differences (``integrators``)
_KICK = Pass("kick", "nodes.velocity nodes.force nodes.mass nodes.inverse_mass nodes.normal_mass", "nodes.velocity")
_DRIFT = Pass("drift", "nodes.position nodes.velocity", "nodes.position nodes.force")
_CONTACT = Pass("detect_contact", "nodes.normal_mass nodes.position nodes.velocity", "nodes.in_contact")
_REST = Pass("update_rows", "nodes.normal_mass", "")
_TLMPM = (
    _KICK,
    _CONTACT,
    _DRIFT,
    Pass(
        "multiply out",
        "extension.out.start extension.out.column extension.out.value nodes.velocity",
        "lattice.velocity",
    ),
    Pass("zero force", "", "lattice.force"),
    Pass(
        "strain_points",
        "lattice.order points.reference points.position points.volume points.deformation lattice.velocity "
        f"lattice.cells lattice.force {_OF_POINTS}",
        f"points.position points.deformation lattice.force {_OF_POINTS}",
    ),
    Pass(
        "multiply back",
        "extension.back.start extension.back.column extension.back.value lattice.force",
        "nodes.force",
    ),
    _KICK,
    _REST,
)
_STRAIN_READS = (
    "slabs.order elements.shared.alive elements.corner elements.volume nodes.position nodes.velocity nodes.force "
    f"{_OF_ELEMENTS}"
)
_STRAIN_WRITES = f"nodes.force {_OF_ELEMENTS}"
_HOURGLASS = "elements.hourglass_force elements.hourglass_work"

PASSES: dict[str, tuple[Pass, ...]] = {
    "mpm": _MPM,
    "tlmpm": _TLMPM,
    "fem, one-point": (
        _KICK,
        _CONTACT,
        _DRIFT,
        Pass("strain_elements", f"{_STRAIN_READS} {_HOURGLASS}", f"{_STRAIN_WRITES} {_HOURGLASS}"),
        _KICK,
        _REST,
    ),
    "fem, selective": (
        _KICK,
        _CONTACT,
        _DRIFT,
        Pass("strain_elements", _STRAIN_READS, _STRAIN_WRITES),
        _KICK,
        _REST,
    ),
}


def bytes_per_step(method: Any, passes: Sequence[Pass]) -> int:
    """Return how many bytes a step moves."""
    arrays = arrays_of(method)
    return sum(arrays[name].nbytes for one in passes for name in f"{one.reads} {one.writes}".split())


def bytes_held(method: Any) -> int:
    """Return how many bytes all arrays of a method have; an array under two names counts once."""
    return sum({array.ctypes.data: array.nbytes for array in arrays_of(method).values()}.values())


def arrays_of(method: Any) -> dict[str, AnyArray]:
    """Return all arrays of a method by dotted names, such as "points.stress"."""
    return dict(_named("", vars(method)))


def _named(prefix: str, values: Mapping[str, Any]) -> list[tuple[str, AnyArray]]:
    found: list[tuple[str, AnyArray]] = []
    for name, value in values.items():
        if isinstance(value, np.ndarray):
            found.append((prefix + name, value))
        elif isinstance(value, tuple):  # a NamedTuple: no plain tuple holds arrays
            found += _named(f"{prefix}{name}.", dict(zip(getattr(value, "_fields", ()), value, strict=False)))
    return found
