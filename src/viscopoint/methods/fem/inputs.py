"""The ``[method]`` table of the finite element method."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, NamedTuple, Self

from pydantic import Field

from viscopoint.case.rules import rule
from viscopoint.case.tables import Impact, MethodInput, Rod, Table, Time, one_of
from viscopoint.case.units import Length
from viscopoint.kernels.arrays import PRECISIONS
from viscopoint.materials import Material
from viscopoint.methods.fem.elements import ELEMENTS, Element
from viscopoint.methods.fem.hourglass import HOURGLASS, StiffnessControl, ViscousControl
from viscopoint.methods.fem.method import Discretisation, FiniteElementMethod
from viscopoint.methods.fem.reading import read_rod, unreadable
from viscopoint.methods.fem.rod import rod_elements, rod_mesh
from viscopoint.methods.fem.section import section_elements, section_mesh
from viscopoint.model import memory
from viscopoint.model.body import Body
from viscopoint.model.memory import Need

CONTROLLED = ("one-point",)  # elements that have hourglass modes to control


class Mesh(NamedTuple):
    """How the rod is meshed: functions of its radius and length, of size and grading."""

    body: Callable[[float, float, float, float], Body]
    elements: Callable[[float, float, float, float], int]  # how many
    corners: int  # of an element


MESHES = {"3d": Mesh(rod_mesh, rod_elements, 8), "axisymmetric": Mesh(section_mesh, section_elements, 4)}
# of an element with nodes and one snapshot being written, and of each of its integration points: generous counts
BYTES_PER_ELEMENT, BYTES_PER_INTEGRATION_POINT = 1400, 250
FEWER = "take a mesh of fewer elements"


class HourglassInput(Table):
    """Control of the one-point element's hourglass modes (Flanagan & Belytschko 1981); others have none to control."""

    form: one_of(HOURGLASS) = "stiffness"  # pyright: ignore[reportInvalidTypeForm]
    coefficient: float | None = Field(default=None, ge=0, le=1)

    def build(self) -> ViscousControl | StiffnessControl:
        """Return the control, with its usual coefficient if none is given."""
        control = HOURGLASS[self.form]
        return control() if self.coefficient is None else control(self.coefficient)


class FEMInput(MethodInput):
    """``name = "fem"``."""

    finer = "a mesh with more nodes around the circumference (method.mesh)"

    name: Literal["fem"]
    size: Length | None = None
    grading: float = Field(default=1.0, ge=0.01, le=100)
    mesh: str | None = Field(default=None, max_length=1000)
    mesh_unit: Length = 1.0
    geometry: Literal["3d", "axisymmetric"] = "3d"
    element: one_of(ELEMENTS) = "one-point"  # pyright: ignore[reportInvalidTypeForm]
    hourglass: HourglassInput = HourglassInput()
    safety: float = Field(default=0.95, gt=0, le=1)
    delete_below: float = Field(default=0.0, ge=0, lt=1)

    def resolution(self) -> float:
        return self.size or 0.0

    @classmethod
    def at_resolution(cls, distance: float) -> dict[str, Any]:
        return {"name": "fem", "size": f"{distance!r} mm"}

    def completed(self, rod: Rod, impact: Impact, time: Time) -> Self:
        """Return the table with the hourglass coefficient spelt out."""
        if self.element not in CONTROLLED:
            return self
        control = self.hourglass.model_copy(update={"coefficient": self.hourglass.build().coefficient})
        return self.model_copy(update={"hourglass": control})

    def files(self) -> tuple[Path, ...]:
        return (Path(self.mesh),) if self.mesh is not None else ()

    def kept_in(self, folder: Path) -> Self:
        """Copy the mesh file into a run folder and return the table that refers to the copy."""
        if self.mesh is None:
            return self
        name = f"mesh{Path(self.mesh).suffix.lower()}"
        shutil.copyfile(self.mesh, folder / name)
        return self.model_copy(update={"mesh": name})

    def need(self, rod: Rod) -> Need:
        if self.size is None:  # those of a file are counted once they are read
            return Need("method.mesh", str(self.mesh), 0.0, FEWER)
        elements = MESHES[self.geometry].elements(rod.radius, rod.length, self.size, self.grading)
        return Need("method.size", f"{self.size:g} mm gives {elements:.1e} elements", self._bytes(elements))

    def _need_of(self, mesh: Body) -> Need:
        elements = len(mesh.cells)
        return Need("method.mesh", f"{self.mesh} has {elements:.1e} elements", self._bytes(elements), FEWER)

    def _bytes(self, elements: int) -> float:
        points = MESHES[self.geometry].corners if self._element().full else 1
        return float(elements) * (BYTES_PER_ELEMENT + points * BYTES_PER_INTEGRATION_POINT)

    def _element(self) -> Element:
        return ELEMENTS[self.element].controlled(self.hourglass.build())

    def body(self, rod: Rod) -> Body:
        """Return the rod's mesh; raise ``InputError`` if that of a file will not do."""
        if self.mesh is not None:
            return read_rod(Path(self.mesh), self.mesh_unit, rod.radius, rod.length)
        assert self.size is not None
        return MESHES[self.geometry].body(rod.radius, rod.length, self.size, self.grading)

    def build(self, rod: Rod, impact: Impact, material: Material) -> FiniteElementMethod:
        """Return the rod as finite elements on their way to the wall."""
        choices = Discretisation(
            element=self._element(),
            time_step_factor=self.safety,
            viscosity=self.bulk_viscosity.build(),
            delete_below=self.delete_below,
            real=PRECISIONS[self.precision],
        )
        body, motion = self.body(rod), (0.0, 0.0, -impact.speed)
        if self.mesh is not None:
            memory.check(self._need_of(body), memory.free())
        return FiniteElementMethod(body, material, (impact.boundary(),), choices, motion)


@rule("method.size", "method.mesh")
def size_or_mesh(size: float | None, mesh: str | None) -> str | None:
    if size is None and mesh is None:
        return 'is missing; write an element size such as "0.38 mm", or name a file with method.mesh'
    if size is not None and mesh is not None:
        told = "cannot be given with method.mesh, whose elements have their own"
        return f'{told}; write one of the two, as in method = {{ name = "fem", mesh = "{mesh}" }}'
    return None


@rule("method.mesh")
def mesh_is_a_file(mesh: str | None) -> str | None:
    return None if mesh is None else unreadable(Path(mesh))


@rule("method.grading", "method.mesh")
def grading_of_the_rod_s_own_mesh(grading: float, mesh: str | None) -> str | None:
    return (
        f"{grading:g} has no effect on method.mesh, whose elements are as they are" if mesh and grading != 1 else None
    )


@rule("method.geometry", "method.mesh")
def geometry_of_a_mesh(geometry: str, mesh: str | None) -> str | None:
    if mesh is None or geometry == "3d":
        return None
    return f'"{geometry}" cannot be given with method.mesh, whose elements are hexahedra; allowed with it: "3d"'


@rule("method.mesh_unit", "method.mesh")
def unit_of_a_mesh(unit: float, mesh: str | None) -> str | None:
    return f"{unit:g} mm has no effect without method.mesh" if mesh is None and unit != 1.0 else None


@rule("method.size", "method.grading", "rod.radius")
def uppermost_layer_within_radius(size: float | None, grading: float, radius: float) -> str | None:
    if size is None or size > radius or size * grading <= radius:
        return None
    return f"{size:g} mm, graded by {grading:g}, makes layers thicker than rod.radius, {radius:g} mm"


@rule("method.size", "rod.radius")
def size_within_radius(size: float | None, radius: float) -> str | None:
    if size is None or size <= radius:
        return None
    return f"{size:g} mm is larger than the rod: rod.radius is {radius:g} mm"


@rule("method.size", "rod.length")
def size_within_length(size: float | None, length: float) -> str | None:
    if size is None or 2.0 * size <= length:
        return None
    return f"{size:g} mm leaves no two layers of elements in rod.length, {length:g} mm"


@rule("method.hourglass.coefficient", "method.hourglass.form", "method.safety", "method.element")
def damper_is_stable(coefficient: float | None, form: str, safety: float, element: str) -> str | None:
    most = 0.125 / safety  # 16 coefficient c/l times the step, safety l/c, must not pass 2
    if element not in CONTROLLED or form != "viscous" or coefficient is None or coefficient <= most:
        return None
    return f"{coefficient:g} is unstable at method.safety {safety:g}: the viscous form takes at most {most:.3g}"
