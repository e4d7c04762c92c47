"""A program that reads a mesh file by PyVista (VTK) and leaves its cells as NumPy arrays; ``reading`` runs it.

In a process of its own, because VTK's readers write to the terminal, and files that were cut short make them crash.
It imports nothing of the package, so that it starts quickly.
"""

import sys
import warnings
from typing import Any

import numpy as np
import pyvista

HEXAHEDRON, VOXEL = 12, 11  # VTK's cell types
VOXEL_CORNERS = [0, 1, 3, 2, 4, 5, 7, 6]  # of a voxel, in the order of a hexahedron's


def cells(grid: Any) -> np.ndarray:
    """Return the corners ``[e, 8]`` of hexahedra and voxels, in the file's order."""
    kinds = np.asarray(grid.celltypes)
    offsets = grid.cell_offsets if hasattr(grid, "cell_offsets") else grid.offset  # its name before PyVista 0.49
    solid = np.flatnonzero(np.isin(kinds, (HEXAHEDRON, VOXEL)))
    corner = np.asarray(grid.cell_connectivity)[np.asarray(offsets)[solid, None] + np.arange(8)]
    voxel = kinds[solid] == VOXEL
    corner[voxel] = corner[voxel][:, VOXEL_CORNERS]
    return corner


def main(source: str, target: str) -> None:
    """Read ``source`` and write ``target``, an .npz file."""
    warnings.filterwarnings("error", "The VTK reader")  # PyVista returns what little was read
    grid: Any = pyvista.read(source)
    if isinstance(grid, pyvista.MultiBlock):
        grid = grid.combine(merge_points=True)  # blocks of Exodus files have their own copies of shared nodes
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


if __name__ == "__main__":
    main(*sys.argv[1:])
