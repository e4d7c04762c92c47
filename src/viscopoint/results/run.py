"""A run, as who made or opened it has it."""

import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

from viscopoint.arguments import checked
from viscopoint.errors import InputError
from viscopoint.results.folder import FIGURES
from viscopoint.results.reader import Reader


def importing_pyvista() -> Any:
    """Import PyVista, which draws without a screen where there is none; raise ``InputError`` if it is missing."""
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    try:
        import pyvista
    except ImportError:
        raise InputError("this takes PyVista; pip install 'viscopoint[mesh]'") from None
    return pyvista


class Run(Reader):
    """A run folder, finished or not, that can draw its figures."""

    @checked
    def to_pyvista(self, time: str | int = -1) -> Any:
        """Return a snapshot (see ``snapshot``) as a grid of PyVista's, with all fields; it takes the extra ``mesh``."""
        pv = importing_pyvista()
        fields = dict(self.snapshot(time).fields)
        position, cells = fields.pop("position").values, self.body.cells
        kind = {0: pv.CellType.VERTEX, 4: pv.CellType.QUAD, 8: pv.CellType.HEXAHEDRON}[
            cells.shape[1] * bool(len(cells))
        ]
        corners = cells if len(cells) else np.arange(len(position))[:, None]
        grid = pv.UnstructuredGrid({kind: corners}, position)
        for name, field in fields.items():
            (grid.cell_data if field.on == "cells" else grid.point_data)[name] = field.values
        return grid

    @checked
    def animate(
        self, file: str | Path, field: str = "velocity_z", *, seconds: float = 6.0, size: tuple[int, ...] = (720, 720)
    ) -> Path:
        """Draw all snapshots, coloured by a field (see ``Snapshot.scalar``), into a film: ``.mp4`` or ``.gif``.

        Args:
            file: what to write. An MP4 takes the extra ``film``; where that is missing, a GIF is written in its place.
            field: by which points or elements are coloured.
            seconds: how long the film lasts.
            size: width and height of the pictures in pixels.

        Returns:
            The file that was written.

        Raises:
            InputError: there is no such field, PyVista is missing, or the file is none of these kinds.
            OutputError: the file could not be written.
        """
        from viscopoint.figures.animation import animate  # and with it PyVista

        return animate(self, Path(file), field, seconds, size)

    @checked
    def draw(self, folder: str | Path | None = None) -> list[Path]:
        """Draw all figures into a folder, by default that of the run, and return their files."""
        from viscopoint.figures import draw_all  # and with it Matplotlib, for whoever draws

        if folder is not None:
            return draw_all(self, Path(folder))
        figures = self.folder / FIGURES
        if any(path.is_symlink() for path in (figures, *figures.glob("*"))):
            raise InputError(f"run folder {self.folder}: {FIGURES} has links, so figures would be drawn elsewhere")
        return draw_all(self, figures)
