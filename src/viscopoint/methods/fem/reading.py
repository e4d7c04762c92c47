"""Reads a rod's mesh from a file.

By PyVista (VTK), because it is well kept, reads the formats that meshers and other codes write for ParaView, and is
what many will look at results with. Meshio reads more formats, but has had no release since 2024. PyVista is large, so
it is an extra of the package.
"""

import importlib.util
import subprocess
import sys
import warnings
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from viscopoint.errors import InputError, ViscopointWarning
from viscopoint.kernels.arrays import AnyArray, Array, Indices
from viscopoint.messages import one_line
from viscopoint.methods.fem.mesh import node_volumes, point_volumes, scaled_jacobians
from viscopoint.methods.fem.rod import rim_radius
from viscopoint.model.body import EXACT, Body, Surface
from viscopoint.results.folder import is_file

TOO_MANY, ELSEWHERE, OUT_OF_TIME = 3, 4, -24  # how the program ends: its own codes, and the signal SIGXCPU
LARGEST_FILE, MOST_CELLS = 4 * 2**30, 50_000_000
SECONDS, BYTES_PER_SECOND = 120.0, 1e6  # on the clock, PyVista's start included; the program counts its own time
PROGRAM = Path(__file__).with_name("vtk_program.py")
FORMATS = (".vtu", ".vtk", ".vtkhdf", ".hdf", ".exo", ".e", ".ex2", ".exii", ".g", ".gen")
UNREADABLE = "cannot be read; is it whole, and of the format that its name says?"
WRONG = {
    TOO_MANY: f"holds more than {MOST_CELLS:,} elements",
    ELSEWHERE: "refers to other files; a mesh must be whole in one",
    OUT_OF_TIME: "takes longer to read than a mesh of its size; is it whole, and of the format that its name says?",
}
HEXAHEDRON, VOXEL = 12, 11  # VTK's cell types
FLAT = 9  # cell types up to this one have no volume: vertices, lines, triangles, quadrilaterals, pixels
SOUND = 1e-6  # a scaled Jacobian below this is none
MOST_TOLD = 4  # pieces in a message
SAME = 1e-3  # relative: how well a mesh must agree with the [rod] table
FARTHEST = 1e15  # mm, as of any length in a case; products of such are finite
FEWEST = 8  # nodes around the rod, of the coarsest mesh
FULL = 0.02  # how much less volume than the prism over its mantle's nodes a mesh may have
ON_SURFACE = 1e-3  # of the radius: nodes this close to the mantle show it
LEVEL = 1e-6  # of the length: nodes this close in height are one layer


def read_rod(path: Path, unit: float, radius: float, length: float) -> Body:
    """Return the rod of a mesh file whose coordinates are in ``unit`` [mm].

    Raises:
        InputError: the file cannot be read, holds other elements than sound hexahedra, or not this rod.
    """
    found = _read(path)
    _check_kinds(found["kinds"], found["names"], path)
    with np.errstate(over="ignore", invalid="ignore"):  # told below
        position, cells = _used(found["position"] * unit, found["corner"], path)
    _check_cells(position, cells, path)
    _check_rod(position, radius, length, path)
    _check_shapes(position, cells, path)
    _check_volume(position, cells, radius, length, path)
    position[abs(position[:, 2]) <= LEVEL * length, 2] = 0.0  # exactly, or the wall would move or miss them
    return Body(position, node_volumes(position, cells), rod_surface(position, radius), cells)


def rod_surface(position: Array, radius: float) -> Surface:
    """Return which nodes of an upright rod show its surface: those of the mantle by height, and those of both ends.

    Where a mesh has the rod's volume, nodes of the mantle stand outside its radius; they show that radius all the same.
    """
    height, from_axis = position[:, 2], np.hypot(position[:, 0], position[:, 1])
    tolerance = LEVEL * np.ptp(height)
    mantle = np.flatnonzero(from_axis > (1.0 - ON_SURFACE) * from_axis.max())
    mantle = mantle[np.argsort(height[mantle], kind="stable")]
    breaks = np.flatnonzero(np.diff(height[mantle]) > tolerance) + 1
    layers = np.split(mantle, breaks)
    widest = max(len(layer) for layer in layers)
    ends = [np.flatnonzero(abs(height - end) <= tolerance) for end in (height.max(), height.min())]
    return Surface(
        ring=np.array([np.pad(layer, (0, widest - len(layer)), constant_values=-1) for layer in layers]),
        start=np.full(widest, from_axis.max()),
        radius=radius,
        rear_face=np.column_stack([ends[0], ends[0]]),
        impact_face=np.column_stack([ends[1], ends[1]]),
        end_overhang=0.0,
        contact_height=EXACT * radius,
    )


def _read(path: Path) -> dict[str, AnyArray]:
    """Return what ``vtk_program`` finds in the file."""
    if wrong := unreadable(path):
        raise InputError(f"method.mesh: {wrong}")
    if importlib.util.find_spec("pyvista") is None:
        raise InputError(f"method.mesh: {path}: reading it takes PyVista; pip install 'viscopoint[mesh]'")
    with TemporaryDirectory(prefix="viscopoint-") as folder:
        found = Path(folder, "mesh.npz")
        code = _converted(path.absolute(), found)
        if code:
            raise InputError(f"method.mesh: {path}: {WRONG.get(code, UNREADABLE)}")
        with np.load(found, allow_pickle=False) as arrays:
            return dict(arrays)


def _converted(source: Path, found: Path) -> int:
    """Run the program; return its exit code, or the signal that ended it, below zero."""
    command = [sys.executable, "-P", str(PROGRAM), str(source), str(found), str(MOST_CELLS)]
    seconds = SECONDS + source.stat().st_size / BYTES_PER_SECOND
    quiet = subprocess.DEVNULL
    try:
        return subprocess.run(
            command, stdin=quiet, stdout=quiet, stderr=quiet, cwd=found.parent, timeout=seconds, check=False
        ).returncode
    except subprocess.TimeoutExpired:
        return OUT_OF_TIME


def unreadable(path: Path) -> str | None:
    """Say what is wrong with a file before it is opened."""
    if not is_file(path):
        return f"{path}: there is no such file"
    if path.suffix.lower() not in FORMATS:
        return f"{path}: unknown format '{path.suffix}'; allowed: {', '.join(FORMATS)}"
    if path.stat().st_size > LARGEST_FILE:
        return f"{path}: {path.stat().st_size / 2**30:.1f} GiB; allowed are {LARGEST_FILE / 2**30:.0f} GiB"
    return None


def _check_kinds(kinds: AnyArray, names: AnyArray, path: Path) -> None:
    others = names[(kinds > FLAT) & (kinds != HEXAHEDRON) & (kinds != VOXEL)]
    if len(others):
        raise InputError(
            f"method.mesh: {path}: holds elements of type {', '.join(others)}; only hexahedra of eight nodes are "
            "supported"
        )


def _used(position: Array, cells: Indices, path: Path) -> tuple[Array, Indices]:
    """Return the nodes that hexahedra have, and the hexahedra; meshers leave others, such as the centres of arcs."""
    if not len(cells):
        raise InputError(f"method.mesh: {path}: holds no hexahedra that can be read")
    if cells.min() < 0 or cells.max() >= len(position):
        raise InputError(f"method.mesh: {path}: elements have nodes beyond the {len(position)} that there are")
    there, corner = np.unique(cells, return_inverse=True)
    if len(there) == len(position):
        return position, cells
    many = f"{len(position) - len(there)} of {len(position)} nodes belong to no hexahedron and are left out"
    warnings.warn(one_line(f"method.mesh: {path}: {many}"), ViscopointWarning, stacklevel=2)
    return position[there], corner.reshape(cells.shape)


def _check_cells(position: Array, cells: Indices, path: Path) -> None:
    if not np.isfinite(position).all():
        raise InputError(f"method.mesh: {path}: coordinates are not all finite")
    if abs(position).max() > FARTHEST:
        raise InputError(f"method.mesh: {path}: coordinates reach {abs(position).max():g} mm; allowed are {FARTHEST:g}")
    piece = _pieces(len(position), cells)
    labels = np.unique(piece)
    if len(labels) > 1:
        extents = [_extent(position[piece == label]) for label in labels[:MOST_TOLD]]
        rest = f"; and {len(labels) - MOST_TOLD} more" if len(labels) > MOST_TOLD else ""
        raise InputError(
            f"method.mesh: {path}: {len(labels)} separate pieces that share no node, {'; '.join(extents)}{rest}. One "
            "body is supported: leave the rod alone in the file; pieces of one body take common nodes where they touch"
        )


def _check_shapes(position: Array, cells: Indices, path: Path) -> None:
    shape = scaled_jacobians(position, cells)
    bad = np.flatnonzero(~(shape > SOUND))
    if len(bad):
        worst = int(shape.argmin())
        x, y, z = position[cells[worst]].mean(axis=0)
        raise InputError(
            f"method.mesh: {path}: {len(bad)} of {len(cells)} elements are inverted or degenerate; the worst is "
            f"element {worst} at ({x:.4g}, {y:.4g}, {z:.4g}) mm with a scaled Jacobian of {shape[worst]:.3g}"
        )


def _check_volume(position: Array, cells: Indices, radius: float, length: float, path: Path) -> None:
    """Compare with the rod, and with the prism over the mantle's nodes: a tube, a cone or a doubled element is none.

    The mesh has either the rod's volume, or its outermost nodes at the rod's radius.
    """
    twice = len(cells) - len(np.unique(np.sort(cells, axis=1), axis=0))
    if twice:
        raise InputError(f"method.mesh: {path}: {twice} elements stand in the place of others; remove them")
    corners = max(3, int(np.median((rod_surface(position, radius).ring >= 0).sum(axis=1))))
    widest, circle = np.hypot(position[:, 0], position[:, 1]).max(), np.pi * radius**2 * length
    prism = corners / 2 * np.sin(2 * np.pi / corners) * widest**2 * length
    found = float(point_volumes(position, cells).sum())
    inscribed = widest <= (1.0 + SAME) * radius and found <= (1.0 + SAME) ** 3 * circle
    if found < (1.0 - FULL) * prism or not (inscribed or abs(found / circle - 1.0) <= 3 * SAME):
        raise InputError(
            f"method.mesh: {path}: fills {found:.6g} mm^3, but a rod of this length and radius has {circle:.6g} mm^3"
        )


def _extent(position: Array) -> str:
    low, high = position.min(axis=0), position.max(axis=0)
    return ", ".join(f"{axis} {a:.4g} to {b:.4g}" for axis, a, b in zip("xyz", low, high, strict=True)) + " mm"


def _pieces(count: int, cells: Indices) -> Indices:
    """Return of each node the least number of a node of its piece, whose nodes are connected by elements."""
    label = np.arange(count)
    while True:
        least = label[cells].min(axis=1)
        after = label.copy()
        np.minimum.at(after, cells.ravel(), np.repeat(least, cells.shape[1]))
        after = after[after]
        if (after == label).all():
            return label
        label = after


def _check_rod(position: Array, radius: float, length: float, path: Path) -> None:
    foot, tail = position[:, 2].min(), position[:, 2].max()
    widest, most = np.hypot(position[:, 0], position[:, 1]).max(), rim_radius(radius, FEWEST)
    wide = (1.0 - SAME) * radius <= widest <= (1.0 + SAME) * most
    if abs(foot) > LEVEL * length or abs(tail - length) > SAME * length or not wide:
        raise InputError(
            f"method.mesh: {path}: reaches from z = {foot:.6g} mm to {tail:.6g} mm and {widest:.6g} mm from the z "
            f"axis, but the rod stands on z = 0 with rod.length {length:g} mm and rod.radius {radius:g} mm; is "
            "method.mesh_unit right?"
        )
