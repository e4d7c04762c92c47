"""Mesh files: what ``method.mesh`` names, read by VTK in a process of its own.

To start PyVista anew for each input takes half a second. So it is imported once, and each input gets a fork of this
process, under the same limits as the program that reads meshes otherwise.
"""

import os
import signal
import tempfile
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads do not live on in a fork

import numpy as np
import pyvista
from choices import Choices, one_of
from edits import edited
from vtkmodules.vtkIOExodus import vtkExodusIIWriter
from watch import EscapedError

from viscopoint.methods.fem import reading, vtk_program
from viscopoint.methods.fem.rod import rod_mesh

MODULES = ("viscopoint.methods.fem.reading", "viscopoint.methods.fem.mesh", "viscopoint.errors", "viscopoint.messages")
ESCAPED = 99  # exit code
RADIUS, LENGTH, SIZE = 2.0, 4.0, 2.0  # mm; of few elements, so that edits meet what matters
PIECES = (
    b"CELLS 99999999 999999999\n", b"POINTS 2000000000 double\n", b"DIMENSIONS 60000 60000 60000\n", b"12\n", b"42\n",
    b"-1 ", b'NumberOfCells="1152921504606846976"', b'NumberOfPoints="-1"', b'format="appended" offset="-8"',
    b"4294967295 ", b'<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]>',
    b'<Piece Source="../outside/canary.toml"/>', b"FIELD x 1000000\n",
)  # fmt: skip


class Target:
    """A file by one of the writers of VTK, damaged."""

    def __init__(self, folder: Path, seeds: Path | None) -> None:
        self.folder, self.name = folder, ""
        self.seeds = _seeds(folder)
        self.temporary = folder / "temporary"
        self.temporary.mkdir()
        tempfile.tempdir = str(self.temporary)
        reading._converted = _forked  # pyright: ignore[reportPrivateUsage]
        for name in self.seeds:  # all that is imported late
            body = reading.read_rod(folder / name, 1.0, RADIUS, LENGTH)
            assert body.volume.sum() > 0.0, name

    def lay(self, choices: Choices) -> str:
        self.name = one_of(choices, list(self.seeds))
        content = edited(choices, self.seeds[self.name], PIECES, most=3)
        (self.folder / self.name).write_bytes(content)
        return f"{self.name}: {content[:30_000]!r}"

    def check(self) -> None:
        try:
            body = reading.read_rod(self.folder / self.name, 1.0, RADIUS, LENGTH)
        finally:
            assert not any(self.temporary.iterdir())
        assert np.isfinite(body.position).all()
        assert (body.volume > 0.0).all()
        assert body.cells.max() < len(body.position)


def _seeds(folder: Path) -> dict[str, bytes]:
    rod = rod_mesh(RADIUS, LENGTH, SIZE)
    grid = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: rod.cells}, rod.position)
    edge = RADIUS * np.sqrt(0.5)
    box = pyvista.ImageData(dimensions=(3, 3, 3), origin=(-edge, -edge, 0.0), spacing=(edge, edge, LENGTH / 2))
    grid.save(folder / "text.vtu", binary=False)
    grid.save(folder / "binary.vtu")
    spare = np.vstack([rod.position, np.zeros((3, 3))])
    pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: rod.cells}, spare).save(folder / "spare.vtu", binary=False)
    grid.save(folder / "text.vtk", binary=False)
    grid.save(folder / "binary.vtk")
    grid.save(folder / "rod.vtkhdf")
    box.save(folder / "image.vtk", binary=False)
    box.cast_to_structured_grid().save(folder / "structured.vtk", binary=False)
    writer = vtkExodusIIWriter()
    writer.SetFileName(str(folder / "rod.exo"))
    writer.SetInputData(pyvista.MultiBlock([grid]))
    writer.Write()
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def _forked(source: Path, found: Path) -> int:
    """Do what the program does in a fork of this process; return its exit code, or minus the signal that ended it."""
    child = os.fork()
    if child:
        try:
            code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        except BaseException:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            raise
        if code == ESCAPED:
            raise EscapedError("what reads the mesh")
        return code
    code = 1
    try:
        os.chdir(found.parent)
        quiet = os.open(os.devnull, os.O_RDWR)
        for number in (0, 1, 2):
            os.dup2(quiet, number)
        code = vtk_program.main(str(source), str(found), str(reading.MOST_CELLS))
    except EscapedError:
        code = ESCAPED
    finally:
        os._exit(code)
