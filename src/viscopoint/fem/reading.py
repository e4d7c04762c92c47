"""Reads a rod's mesh from a file.

By PyVista (VTK), because it is well kept, reads the formats that meshers and other codes write for ParaView, and is
what many will look at results with. Meshio reads more formats, but has had no release since 2024. PyVista is large, so
it is an extra of the package.
"""

from pathlib import Path
from typing import Any

import numpy as np

from viscopoint.arrays import Array, Indices
from viscopoint.body import Body, Surface
from viscopoint.errors import InputError
from viscopoint.fem.mesh import node_volumes, scaled_jacobians

FORMATS = (".vtu", ".vtk", ".vtkhdf", ".hdf", ".exo", ".e", ".ex2", ".cgns")
HEXAHEDRON, VOXEL = 12, 11  # VTK's cell types
FLAT = 10  # cell types below this one have no volume: vertices, lines, triangles, quadrilaterals, pixels
SOUND = 1e-6  # a scaled Jacobian below this is none
SAME = 1e-3  # relative: how well a mesh must agree with the [rod] table
ON_SURFACE = 1e-3  # of the radius: nodes this close to the mantle show it
LEVEL = 1e-6  # of the length: nodes this close in height are one layer


def read_rod(path: Path, unit: float, radius: float, length: float) -> Body:
    """Return the rod of a mesh file whose coordinates are in ``unit`` [mm].

    Raises:
        InputError: the file cannot be read, holds other elements than sound hexahedra, or not this rod.
    """
    position, cells = _hexahedra(_read(path), path)
    position = position * unit
    _check_elements(position, cells, path)
    _check_rod(position, radius, length, path)
    return Body(position, node_volumes(position, cells), rod_surface(position), cells)


def rod_surface(position: Array) -> Surface:
    """Return which nodes of an upright rod show its surface: those of the mantle by height, and those of both ends."""
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
        swell=np.ones(widest),
        tail=np.column_stack([ends[0], ends[0]]),
        foot=np.column_stack([ends[1], ends[1]]),
        reach=0.0,
    )


def _read(path: Path) -> Any:
    """Return the file's grid as PyVista gives it."""
    if not path.is_file():
        raise InputError(f"mesh file {path}: is not there")
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"mesh file {path}: unknown format '{path.suffix}'; allowed: {', '.join(FORMATS)}")
    try:
        import pyvista
    except ImportError:
        raise InputError(f"mesh file {path}: reading it takes PyVista; pip install 'viscopoint[mesh]'") from None
    try:
        with pyvista.vtk_verbosity("off"):
            grid: Any = pyvista.read(path)
            if isinstance(grid, pyvista.MultiBlock):
                grid = grid.combine()
            return grid.cast_to_unstructured_grid()
    except Exception as error:  # VTK's readers raise errors of many kinds for what they cannot make sense of
        raise InputError(f"mesh file {path}: cannot be read ({error})") from None


def _hexahedra(grid: Any, path: Path) -> tuple[Array, Indices]:
    types = np.asarray(grid.celltypes)
    others = sorted({int(kind) for kind in types if kind >= FLAT and kind not in (HEXAHEDRON, VOXEL)})
    if others:
        import pyvista

        names = ", ".join(pyvista.CellType(kind).name.lower().replace("_", " ") for kind in others)
        raise InputError(f"mesh file {path}: holds {names} elements; only hexahedra of eight nodes are supported")
    by_type = grid.cells_dict
    found = [by_type[kind] for kind in (HEXAHEDRON,) if kind in by_type]
    if VOXEL in by_type:
        found.append(by_type[VOXEL][:, [0, 1, 3, 2, 4, 5, 7, 6]])
    if not found:
        raise InputError(f"mesh file {path}: holds no hexahedra")
    return np.asarray(grid.points, np.float64), np.concatenate(found).astype(np.int64)


def _check_elements(position: Array, cells: Indices, path: Path) -> None:
    if not np.isfinite(position).all():
        raise InputError(f"mesh file {path}: coordinates are not all finite")
    alone = len(position) - len(np.unique(cells))
    if alone:
        raise InputError(f"mesh file {path}: {alone} isolated nodes, which belong to no hexahedron; remove them")
    shape = scaled_jacobians(position, cells)
    bad = np.flatnonzero(~(shape > SOUND))
    if len(bad):
        worst = int(shape.argmin())
        x, y, z = position[cells[worst]].mean(axis=0)
        raise InputError(
            f"mesh file {path}: {len(bad)} of {len(cells)} elements are inverted or degenerate; the worst is element "
            f"{worst} at ({x:.4g}, {y:.4g}, {z:.4g}) mm with a scaled Jacobian of {shape[worst]:.3g}"
        )
    pieces = _pieces(len(position), cells)
    if pieces > 1:
        raise InputError(f"mesh file {path}: {pieces} pieces that share no node; merge the nodes at the same place")


def _pieces(count: int, cells: Indices) -> int:
    """Return how many parts of the mesh are not connected."""
    label = np.arange(count)
    while True:
        least = label[cells].min(axis=1)
        after = label.copy()
        np.minimum.at(after, cells.ravel(), np.repeat(least, cells.shape[1]))
        after = after[after]
        if (after == label).all():
            return len(np.unique(label))
        label = after


def _check_rod(position: Array, radius: float, length: float, path: Path) -> None:
    foot, tail = position[:, 2].min(), position[:, 2].max()
    widest = np.hypot(position[:, 0], position[:, 1]).max()
    if abs(foot) > SAME * length or abs(tail - length) > SAME * length or abs(widest - radius) > SAME * radius:
        raise InputError(
            f"mesh file {path}: reaches from z = {foot:.6g} mm to {tail:.6g} mm and {widest:.6g} mm from the z axis, "
            f"but the rod stands on z = 0 with rod.length {length:g} mm and rod.radius {radius:g} mm; is "
            "method.mesh_unit right?"
        )
