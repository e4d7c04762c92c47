"""How axisymmetric bodies look: their half section, turned around the axis, in the manner of faces or discs."""

from typing import Any

import numpy as np
from matplotlib.colors import Normalize

from viscopoint.figures import discs, faces
from viscopoint.figures.revolve import NONE, Revolved, halves, mantle, surface_points, turned
from viscopoint.kernels.arrays import Array, Indices
from viscopoint.model.method import Field
from viscopoint.results.reader import Reader, Snapshot


def outside(run: Reader, snapshot: Snapshot) -> tuple[Snapshot, Indices]:
    """Return the body's surface all around, and which of its points or faces to draw."""
    if len(run.body.cells):
        whole = mantle(run.body, run.body.cells[snapshot["deleted"] == 0])
        return _turned(whole, snapshot), whole.faces
    whole = surface_points(run.body)
    return _turned(whole, snapshot), np.arange(len(whole.points))


def cut_open(run: Reader, snapshot: Snapshot) -> tuple[Snapshot, Indices]:
    """Return the section on both sides of the axis, and which of its points or faces to draw."""
    cells, count = run.body.cells, len(run.body.position)
    if len(cells):
        both = halves(cells[snapshot["deleted"] == 0], count)
        return _turned(both, snapshot), both.faces
    return _turned(halves(NONE, count), snapshot), np.arange(2 * count)


def paint_outside(
    axis: Any, run: Reader, snapshot: Snapshot, shown: Indices, seen: Array, colours: Normalize
) -> None:  # fmt: skip
    """Draw what ``outside`` returned. Facets are no elements, and so have no edges."""
    if len(run.body.cells):
        faces.draw(axis, snapshot, shown, seen, colours, faces.SEAM)
    else:
        discs.paint(axis, run, snapshot, shown, seen, colours)


def _turned(body: Revolved, snapshot: Snapshot) -> Snapshot:
    fields = {
        name: Field(turned(snapshot[name][body.points], body.angle), snapshot.fields[name].unit)
        for name in ("position", "velocity")
    }
    return Snapshot(snapshot.time, fields | {"lost": Field(snapshot["lost"][body.points], "1")})
