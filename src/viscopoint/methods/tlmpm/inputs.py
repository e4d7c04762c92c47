"""The ``[method]`` table of the total Lagrangian material point method."""

from typing import Any, Literal, Self

import numpy as np
from pydantic import Field

from viscopoint.case.rules import rule
from viscopoint.case.tables import Impact, MethodInput, Rod, Time, one_of
from viscopoint.case.units import Length
from viscopoint.kernels.arrays import PRECISIONS
from viscopoint.materials import Material
from viscopoint.methods.mpm.fills import EXACT_FILL, FILLS
from viscopoint.methods.mpm.geometry import GEOMETRIES
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.tlmpm.filling import rod_meridian, with_tracers
from viscopoint.methods.tlmpm.lattice import LATTICES, cell_by_cell
from viscopoint.methods.tlmpm.method import Discretisation, TotalLagrangianMethod
from viscopoint.methods.tlmpm.volumes import VOLUMES
from viscopoint.model.body import Body, reordered
from viscopoint.model.memory import Need

NODAL = ("trilinear", "gimp")  # of the shape functions those that see nothing of the body beyond its plane of nodes
USUAL_CELL = 2.0  # spacings
BYTES_PER_POINT = 900  # with grid and one snapshot being written: a generous count


class TotalLagrangianInput(MethodInput):
    """``name = "tlmpm"``."""

    finer = EXACT_FILL

    name: Literal["tlmpm"]
    geometry: one_of(GEOMETRIES) = "3d"  # pyright: ignore[reportInvalidTypeForm]
    spacing: Length
    cell: Length = Field(default_factory=lambda known: USUAL_CELL * known["spacing"])
    layers: int = Field(default=1, ge=1, le=100)  # of points in a cell's height
    fill: one_of(FILLS) = "trimmed"  # pyright: ignore[reportInvalidTypeForm]
    shape: one_of(NODAL) = "trilinear"  # pyright: ignore[reportInvalidTypeForm]
    volume: one_of(VOLUMES) = "cell-mean"  # pyright: ignore[reportInvalidTypeForm]
    safety: float = Field(default=0.9, gt=0, le=1)

    def resolution(self) -> float:
        return self.spacing

    @classmethod
    def at_resolution(cls, distance: float) -> dict[str, Any]:
        return {"name": "tlmpm", "spacing": f"{distance!r} mm"}

    def completed(self, rod: Rod, impact: Impact, time: Time) -> Self:
        return self

    def need(self, rod: Rod) -> Need:
        points = GEOMETRIES[self.geometry].points(rod.radius, rod.length, self.spacing)
        return Need("method.spacing", f"{self.spacing:g} mm gives {points:.1e} points", points * BYTES_PER_POINT)

    def body(self, rod: Rod) -> Body:
        """Return the rod's points, and those of no volume on its surface, cell by cell as kernels visit them."""
        if self.geometry == "axisymmetric":
            body = rod_meridian(rod.radius, rod.length, self.spacing, round(self.cell / self.spacing))
        else:
            filled = FILLS[self.fill](rod.radius, rod.length, self.spacing)
            faces = filled.surface.impact_face, filled.surface.rear_face
            low, high = (filled.position[face[0, 0], 2] for face in faces)
            body = with_tracers(filled, float(low + high), self.spacing)
        return reordered(body, cell_by_cell(body.position, self.edges(body, rod)))

    def edges(self, body: Body, rod: Rod) -> tuple[float, float, float]:
        """Return the edges of the cells [mm]."""
        layer = np.unique(body.position[body.volume > 0.0, 2])
        height = self.layers * float(layer[1] - layer[0])
        across = self.cell if self.geometry == "3d" else rod.radius / max(round(rod.radius / self.cell), 1)
        return across, across, height

    def build(self, rod: Rod, impact: Impact, material: Material) -> TotalLagrangianMethod:
        """Return the rod as material points on their way to the wall."""
        body = self.body(rod)
        choices = Discretisation(
            cell=self.edges(body, rod),
            shape=SHAPES[self.shape].fitted(self.spacing / self.cell),
            volume=VOLUMES[self.volume],
            time_step_factor=self.safety,
            viscosity=self.bulk_viscosity.build(),
            lattice=LATTICES[self.geometry],
            real=PRECISIONS[self.precision],
        )
        motion = (0.0, 0.0, -impact.speed)
        return TotalLagrangianMethod(body, material, (impact.boundary(),), choices, motion)


@rule("method.cell", "method.spacing", "method.name")
def cell_of_whole_spacings(cell: float, spacing: float, name: str) -> str | None:
    ratio = cell / spacing
    if name != "tlmpm" or (round(ratio) >= 2 and abs(ratio - round(ratio)) < 1e-6):
        return None
    told = f"{cell:g} mm is {ratio:.4g} times method.spacing, {spacing:g} mm"
    return f"{told}; points that fill cells evenly need a whole number of them, 2 or more"


@rule("method.fill", "method.geometry", "method.name")
def a_rectangle_needs_no_trimming(fill: str, geometry: str, name: str) -> str | None:
    if name != "tlmpm" or geometry == "3d" or fill == "trimmed":
        return None
    return f'"{fill}" fills a circle; with method.geometry = "axisymmetric" boxes fit the rod: leave "trimmed"'


@rule("method.cell", "rod.radius", "method.geometry", "method.name")
def cell_in_the_rod(cell: float, radius: float, geometry: str, name: str) -> str | None:
    if name != "tlmpm" or geometry != "3d" or 1.4 * cell <= radius or cell > radius:
        return None
    return (
        f"{cell:g} mm leaves no whole cells in the rod: rod.radius is {radius:g} mm; take at most {radius / 1.4:.3g} mm"
    )


@rule("method.spacing", "method.layers", "rod.length", "method.name")
def two_cells_in_length(spacing: float, layers: int, length: float, name: str) -> str | None:
    if name != "tlmpm" or 2 * layers * spacing <= length:
        return None
    return f"{spacing:g} mm, {layers} to a cell, leaves no two cells in rod.length, {length:g} mm"
