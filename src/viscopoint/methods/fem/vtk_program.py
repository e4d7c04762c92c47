"""A program that reads a mesh file by PyVista (VTK) and leaves its cells as NumPy arrays; ``reading`` runs it.

In a process of its own, because VTK's readers write to the terminal, and files that were cut short make them crash, or
take memory and time without end: this process has limits. It imports nothing of the package, so that it starts quickly.
"""

import contextlib
import math
import sys
import warnings
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyvista

HEXAHEDRON, VOXEL = 12, 11  # VTK's cell types
VOXEL_CORNERS = [0, 1, 3, 2, 4, 5, 7, 6]  # of a voxel, in the order of a hexahedron's
EXODUS = (".e", ".exo", ".ex2", ".exii", ".g", ".gen")  # of these PyVista knows some, and .g as another format
TOO_MANY, ELSEWHERE = 3, 4  # exit codes: more cells than there may be; data in other files
# What a file may take, beside what PyVista takes itself. Compressed files of meshes grow to ten times their size.
SECONDS, BYTES_PER_SECOND = 2, 2e6
ROOM, MEMORY_PER_BYTE = 2**30, 100


class TooManyError(Exception):
    """The file says that it holds more cells than there may be."""


def limit(size: int) -> None:
    """Let this process take no more of the machine than reading a file of some size [bytes] does."""
    try:
        import resource
    except ImportError:  # not a Unix: there, time alone is limited
        return
    used = resource.getrusage(resource.RUSAGE_SELF)
    seconds = math.ceil(used.ru_utime + used.ru_stime + SECONDS + size / BYTES_PER_SECOND)
    memory = _mapped() + ROOM + MEMORY_PER_BYTE * size
    for kind, most in (
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_FSIZE, ROOM + MEMORY_PER_BYTE * size),
        (resource.RLIMIT_CORE, 0),
    ):
        _, hard = resource.getrlimit(kind)
        least = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(kind, (least, hard))


def _mapped() -> int:
    """Return how many bytes of addresses this process has."""
    with contextlib.suppress(OSError, ValueError):
        import resource

        return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    return 2**33  # there is no /proc


def refers_elsewhere(source: str) -> bool:
    """Return whether a file is HDF5 and has links to other files, or keeps its data in them."""
    if not h5py.is_hdf5(source):
        return False
    with h5py.File(source, "r") as file:
        return _group_refers_elsewhere(file)


def _group_refers_elsewhere(group: h5py.Group) -> bool:
    seen, todo = set(), [group]
    while todo:
        inside = todo.pop()
        if inside.id in seen:
            continue
        seen.add(inside.id)
        for name in inside:
            if isinstance(inside.get(name, getlink=True), h5py.ExternalLink):
                return True
            entry = inside.get(name)
            if isinstance(entry, h5py.Group):
                todo.append(entry)
            elif isinstance(entry, h5py.Dataset) and (entry.external or entry.is_virtual):
                return True
    return False


def cells(grid: Any) -> np.ndarray:
    """Return the corners ``[e, 8]`` of hexahedra and voxels, in the file's order."""
    kinds = np.asarray(grid.celltypes)
    offsets = grid.cell_offsets if hasattr(grid, "cell_offsets") else grid.offset  # its name before PyVista 0.49
    solid = np.flatnonzero(np.isin(kinds, (HEXAHEDRON, VOXEL)))
    corner = np.asarray(grid.cell_connectivity)[np.asarray(offsets)[solid, None] + np.arange(8)]
    voxel = kinds[solid] == VOXEL
    corner[voxel] = corner[voxel][:, VOXEL_CORNERS]
    return corner


def convert(source: str, target: str, most: int) -> None:
    """Read ``source``, of at most so many cells, and write ``target``, an .npz file."""
    warnings.filterwarnings("error", "The VTK reader")  # PyVista returns what little was read
    exodus = Path(source).suffix.lower() in EXODUS
    grid: Any = pyvista.read(source, force_ext=".ex2" if exodus else None)
    if isinstance(grid, pyvista.MultiBlock):
        _bound(sum(block.n_cells for block in grid.recursive_iterator(skip_none=True)), most)
        grid = grid.combine(merge_points=True)  # blocks of Exodus files have their own copies of shared nodes
    _bound(grid.n_cells, most)
    if not isinstance(grid, pyvista.UnstructuredGrid):
        grid = grid.cast_to_unstructured_grid()
    kinds = [pyvista.CellType(int(kind)) for kind in np.unique(grid.celltypes)]
    np.savez(
        target,
        position=np.asarray(grid.points, np.float64),
        corner=cells(grid).astype(np.int64),
        kinds=np.array([kind.value for kind in kinds], int),
        names=np.array([kind.name.lower().replace("_", " ") for kind in kinds], str),
    )


def _bound(count: int, most: int) -> None:
    if count > most:
        raise TooManyError(count)


def main(source: str, target: str, most: str) -> int:
    """Read a mesh within limits; return the exit code."""
    limit(Path(source).stat().st_size)
    if refers_elsewhere(source):
        return ELSEWHERE
    try:
        convert(source, target, int(most))
    except TooManyError:
        return TOO_MANY
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
