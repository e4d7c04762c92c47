"""The ``[method]`` table of the material point method."""

from typing import Annotated, Any, Literal

from pydantic import Field

from viscopoint.case.rules import rule
from viscopoint.case.tables import Impact, MethodInput, Rod, Table, Time, one_of
from viscopoint.case.units import Coordinate, Length
from viscopoint.kernels.arrays import PRECISIONS
from viscopoint.materials import Material
from viscopoint.methods.mpm.contacts import CONTACTS
from viscopoint.methods.mpm.fills import EXACT_FILL, FILLS, MERIDIANS
from viscopoint.methods.mpm.geometry import GEOMETRIES, Box
from viscopoint.methods.mpm.grid import GRIDS
from viscopoint.methods.mpm.method import Discretisation, MaterialPointMethod
from viscopoint.methods.mpm.schemes import SCHEMES
from viscopoint.methods.mpm.shapes import SHAPES
from viscopoint.methods.mpm.transfers import TRANSFERS
from viscopoint.methods.mpm.volumes import VOLUMES
from viscopoint.model.body import Body
from viscopoint.model.memory import Need

MOST_CELLS = 1_000_000  # along an axis; only those around the body take memory
SLIP = 2  # cells of the default box beyond the wall
BYTES_PER_POINT, BYTES_PER_NODE = 800, 500  # with one snapshot being written, and one grid replacing another: generous


Range = Annotated[tuple[Coordinate, Coordinate], Field(strict=False)]


class BoxInput(Table):
    """Lowest and highest coordinate along each axis; points that leave the box are retired."""

    x: Range
    y: Range
    z: Range


class MPMInput(MethodInput):
    """``name = "mpm"``."""

    finer = EXACT_FILL

    name: Literal["mpm"]
    geometry: one_of(GEOMETRIES) = "3d"  # pyright: ignore[reportInvalidTypeForm]
    cell: Length
    spacing: Length
    fill: one_of(FILLS) = "trimmed"  # pyright: ignore[reportInvalidTypeForm]
    shape: one_of(SHAPES) = "quadratic"  # pyright: ignore[reportInvalidTypeForm]
    scheme: one_of(SCHEMES) = "musl"  # pyright: ignore[reportInvalidTypeForm]
    volume: one_of(VOLUMES) = "local"  # pyright: ignore[reportInvalidTypeForm]
    contact: one_of(CONTACTS) = "gated"  # pyright: ignore[reportInvalidTypeForm]
    transfer: one_of(TRANSFERS) = "flip"  # pyright: ignore[reportInvalidTypeForm]
    pic_fraction: float = Field(default=0.0, ge=0, le=1)
    safety: float = Field(default=0.2, gt=0, le=1)
    box: BoxInput | None = None

    def resolution(self) -> float:
        return self.spacing

    @classmethod
    def at_resolution(cls, distance: float) -> dict[str, Any]:
        return {"name": "mpm", "spacing": f"{distance!r} mm", "cell": f"{2.0 * distance!r} mm"}

    def completed(self, rod: Rod, impact: Impact, time: Time) -> "MPMInput":
        """Return the table with a box, by default wide enough for a mushroom and a rebound.

        No rod rebounds faster than it came, and hardly anything flies off faster. Points may slip a little way into the
        wall. Only the part of the box around the body takes memory.
        """
        if self.box is not None:
            return self
        flight, most, low = impact.speed * time.end, MOST_CELLS * self.cell, -impact.gap - SLIP * self.cell
        side, high = min(4.0 * rod.radius + flight, 0.5 * most), min(2.0 * rod.length + flight, low + most)
        box = BoxInput.model_construct(x=(-side, side), y=(-side, side), z=(low, high))
        return self.model_copy(update={"box": box})

    def need(self, rod: Rod) -> Need:
        points, nodes = (
            GEOMETRIES[self.geometry].points(rod.radius, rod.length, apart) for apart in (self.spacing, self.cell)
        )
        size = points * BYTES_PER_POINT + nodes * BYTES_PER_NODE
        return Need("method.spacing", f"{self.spacing:g} mm gives {points:.1e} points", size)

    def body(self, rod: Rod) -> Body:
        """Return the rod's points."""
        fills = FILLS if self.geometry == "3d" else MERIDIANS
        return fills[self.fill](rod.radius, rod.length, self.spacing)

    def build(self, rod: Rod, impact: Impact, material: Material) -> MaterialPointMethod:
        """Return the rod as material points on their way to the wall; the table is ``completed``."""
        box = self.box
        assert box is not None
        choices = Discretisation(
            cell=self.cell,
            box=GEOMETRIES[self.geometry].within(Box(*zip(box.x, box.y, box.z, strict=True)), self.cell),
            shape=SHAPES[self.shape].fitted(self.spacing / self.cell),
            scheme=SCHEMES[self.scheme],
            transfer=TRANSFERS[self.transfer].chosen(self.pic_fraction),
            time_step_factor=self.safety,
            viscosity=self.bulk_viscosity.build(),
            volume=VOLUMES[self.volume],
            contact=CONTACTS[self.contact],
            grid=GRIDS[self.geometry],
            real=PRECISIONS[self.precision],
        )
        motion = (0.0, 0.0, -impact.speed)
        return MaterialPointMethod(self.body(rod), material, (impact.boundary(),), choices, motion)


@rule("method.pic_fraction", "method.transfer")
def pic_is_of_flip(pic: float, transfer: str) -> str | None:
    return (
        f'{pic:g} blends PIC into "flip"; method.transfer is "{transfer}"' if pic > 0 and transfer != "flip" else None
    )


@rule("method.transfer", "method.shape", "method.scheme")
def smooth_slopes_where_needed(transfer: str, shape: str, scheme: str) -> str | None:
    if shape != "trilinear" or not (transfer == "tpic" or (scheme == "usl" and transfer != "flip")):
        return None
    told = f'"{transfer}" with method.scheme = "{scheme}" carries on what points feel of nodes of nearly no mass, which'
    return f'{told} has no bound with method.shape = "trilinear"; take "gimp", or "apic" with "musl" or "usf"'


@rule("method.spacing", "method.cell")
def spacing_within_cell(spacing: float, cell: float) -> str | None:
    return f"{spacing:g} mm is larger than method.cell, {cell:g} mm" if spacing > cell else None


@rule("method.cell", "rod.radius")
def cell_within_radius(cell: float, radius: float) -> str | None:
    return f"{cell:g} mm is larger than the rod: rod.radius is {radius:g} mm" if cell > radius else None


@rule("method.cell", "rod.length")
def cell_within_length(cell: float, length: float) -> str | None:
    return f"{cell:g} mm is larger than the rod: rod.length is {length:g} mm" if cell > length else None


@rule("method.spacing", "rod.length", "method.name")
def two_layers_in_rod(spacing: float, length: float, name: str) -> str | None:
    if name != "mpm" or 1.5 * spacing <= length:
        return None
    return f"{spacing:g} mm leaves no two layers in rod.length, {length:g} mm"


@rule("method.box.x", "method.cell")
def countable_cells_in_x(limits: tuple[float, float], cell: float) -> str | None:
    return _too_far(limits, cell)


@rule("method.box.y", "method.cell")
def countable_cells_in_y(limits: tuple[float, float], cell: float) -> str | None:
    return _too_far(limits, cell)


@rule("method.box.z", "method.cell")
def countable_cells_in_z(limits: tuple[float, float], cell: float) -> str | None:
    return _too_far(limits, cell)


def _too_far(limits: tuple[float, float], cell: float) -> str | None:
    cells = (limits[1] - limits[0]) / cell
    return f"{cells:.1e} cells of {cell:g} mm; at most {MOST_CELLS:,} are allowed" if cells > MOST_CELLS else None


@rule("method.box.x", "rod.radius", "method.geometry")
def box_around_rod_in_x(limits: tuple[float, float], radius: float, geometry: str) -> str | None:
    return _cut(limits, -radius if geometry == "3d" else 0.0, radius)


@rule("method.box.y", "rod.radius", "method.geometry")
def box_around_rod_in_y(limits: tuple[float, float], radius: float, geometry: str) -> str | None:
    return _cut(limits, -radius, radius) if geometry == "3d" else None


@rule("method.box.z", "rod.length", "impact.gap")
def box_around_rod_in_z(limits: tuple[float, float], length: float, gap: float) -> str | None:
    return _cut(limits, -gap, length)


def _cut(limits: tuple[float, float], low: float, high: float) -> str | None:
    if limits[0] <= low and limits[1] >= high:
        return None
    told = f"[{limits[0]:g} mm, {limits[1]:g} mm] cuts the rod or the wall"
    return f"{told}: it must reach from {low:g} mm to {high:g} mm"


@rule("method.box.z", "impact.gap", "method.cell")
def wall_on_a_plane_of_nodes(limits: tuple[float, float], gap: float, cell: float) -> str | None:
    planes = (-gap - limits[0]) / cell
    if planes < 0 or abs(planes - round(planes)) < 1e-6:
        return None
    told = f"starts at {limits[0]:g} mm, which puts the wall, at {-gap:g} mm (-impact.gap), between planes of the grid"
    return f"{told}; start there or a whole number of cells ({cell:g} mm) below"
