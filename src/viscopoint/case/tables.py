"""The tables of a case that every method shares, and what all tables have in common."""

import math
from abc import abstractmethod
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

from viscopoint.case.rules import rule
from viscopoint.case.schedules import MOST_TIMES, Times
from viscopoint.case.units import Duration, Gap, Length, Speed
from viscopoint.errors import nearest
from viscopoint.interactions.planes import RigidPlane, SymmetryPlane, rigid_wall
from viscopoint.kernels.arrays import PRECISIONS
from viscopoint.messages import one_line, unseen
from viscopoint.model.schedule import Schedule
from viscopoint.model.viscosity import BulkViscosity

if TYPE_CHECKING:
    from viscopoint.model.body import Body
    from viscopoint.model.memory import Need

MOST_ROWS = 10_000  # of history, if the case does not say how many


class Table(BaseModel):
    """A table of a case: no unknown keys, no conversion of one type into another, nothing infinite."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class MaterialInput(Table):
    """The ``[material]`` table; each material derives its own, with ``law: Literal["its-name"]``."""

    @abstractmethod
    def build(self) -> Any:
        """Return the material's parameters."""


def one_of(names: Iterable[str]) -> Any:
    """Return the type of a word that must be one of the names."""
    known_names = sorted(names)

    def known(name: str) -> str:
        if name not in known_names:
            raise PydanticCustomError("word", "is not known; {allowed}", {"allowed": nearest(name, known_names)})
        return name

    return Annotated[str, AfterValidator(known), Field(json_schema_extra={"enum": [*known_names]})]


def _shows(title: str) -> str:
    if letter := unseen(title):
        raise PydanticCustomError(
            "word", "has {letter} in it, which does not show; write one line of text", {"letter": one_line(letter)}
        )
    return title


Title = Annotated[str, Field(max_length=200), AfterValidator(_shows)]


class BulkViscosityInput(Table):
    """q = rho l |d| (linear c + quadratic l |d|) in compression."""

    linear: float = Field(default=0.06, ge=0, le=1)
    quadratic: float = Field(default=1.5, ge=0, le=10)

    def build(self) -> BulkViscosity:
        """Return the coefficients."""
        return BulkViscosity(self.linear, self.quadratic)


class MethodInput(Table):
    """The ``[method]`` table; each method derives its own, with ``name: Literal["its-name"]``."""

    bulk_viscosity: BulkViscosityInput = BulkViscosityInput()
    precision: one_of(PRECISIONS) = "double"  # pyright: ignore[reportInvalidTypeForm]

    @abstractmethod
    def resolution(self) -> float:
        """Return the distance of points or nodes, by which methods are compared [mm]."""

    @classmethod
    @abstractmethod
    def at_resolution(cls, distance: float) -> dict[str, Any]:
        """Return the table of this method, as a case has it, for a distance of points or nodes [mm]."""

    finer: ClassVar[str]  # what to change where the body's mass is not the rod's

    @abstractmethod
    def completed(self, rod: "Rod", impact: "Impact", time: "Time") -> Self:
        """Return the table with what it leaves to be derived from other tables."""

    def files(self) -> tuple[Path, ...]:
        """Return the files that the table refers to."""
        return ()

    def kept_in(self, folder: Path) -> Self:
        """Copy files that the table refers to into a run folder; return the table that refers to the copies."""
        return self

    @abstractmethod
    def need(self, rod: "Rod") -> "Need":
        """Return how much memory a run takes, by an estimate that is rather too high."""

    @abstractmethod
    def body(self, rod: "Rod") -> "Body":
        """Return the rod's points, and cells if the method has any."""

    @abstractmethod
    def build(self, rod: "Rod", impact: "Impact", material: Any) -> Any:
        """Return the rod of a material on its way to the wall: a ``model.method.Method``."""


class Rod(Table):
    """A cylinder that stands on z = 0."""

    radius: Length
    length: Length

    @property
    def volume(self) -> float:
        """Return π R² L [mm^3]."""
        return math.pi * self.radius**2 * self.length


def _names_the_wall(wall: Any) -> Any:
    """Say what to take for what "symmetry" promised, and was not: two rods that meet part again."""
    if wall == "symmetry":
        told = (
            'is not known; allowed: "rigid", or "no-separation", which holds the impact face on the wall for good, '
            'free to slide. For a symmetric test, rod on equal rod, take "rigid" without friction at half the closing '
            "speed"
        )
        raise PydanticCustomError("word", told)  # pyright: ignore[reportArgumentType]
    return wall


class Impact(Table):
    """The rod flies at ``speed`` towards -z; the wall is ``gap`` below its foot."""

    speed: Speed
    gap: Gap = 0.0
    friction: float = Field(default=0.0, ge=0, le=10)
    wall: Annotated[Literal["rigid", "no-separation"], BeforeValidator(_names_the_wall)] = "rigid"

    def boundary(self) -> RigidPlane | SymmetryPlane:
        """Return what the rod hits: an anvil that it can leave, or rollers that hold its impact face for good."""
        height = 0.0 - self.gap  # not the negative zero
        if self.wall == "rigid":
            return rigid_wall(height, self.friction)
        return SymmetryPlane((0.0, 0.0, height), (0.0, 0.0, 1.0))


@rule("impact.wall", "impact.gap", "impact.friction")
def no_separation_from_the_start(wall: str, gap: float, friction: float) -> str | None:
    if wall == "rigid" or (gap == 0.0 and friction == 0.0):
        return None
    given = f"not {gap:g} mm and {friction:g}"
    told = (
        '"no-separation" holds the impact face from the start, free to slide: impact.gap and impact.friction must be 0'
    )
    return f"{told}, {given}"


class Time(Table):
    """When to end and when to keep all fields; the start and the end are always kept."""

    end: Duration
    snapshots: Times = Schedule()


@rule("time.snapshots", "time.end")
def snapshots_before_the_end(snapshots: Schedule, end: float) -> str | None:
    late = [f"{instant * 1e3:.12g} us" for instant in snapshots.times if instant > end * (1 + 1e-12)]
    if late:
        return f"{', '.join(late[:5])}: after time.end, {end * 1e3:g} us"
    count = end / snapshots.every
    return f"{count:.3g} snapshots; no more than {MOST_TIMES:,} are kept" if count > MOST_TIMES else None


class Guards(Table):
    """When to stop a run that has gone wrong."""

    energy_error: float = Field(default=0.05, gt=0)  # numerical remainder over initial kinetic energy
    smallest_step: float = Field(default=1e-3, gt=0, lt=1)  # stable step over the first one
    mass_error: float = Field(default=0.05, gt=0)  # computed mass less the rod's, over the rod's; refused at the start
    lost_share: float = Field(default=0.01, ge=0)  # mass, or initial energy, that left the box or was deleted
    hourglass_share: float = Field(default=0.1, gt=0)  # taken by hourglass control over the internal energy


class Output(Table):
    """What is written, and how often.

    A row of history is measured each step, unless the run takes more than ``MOST_ROWS`` steps: then about as many rows.
    """

    history: Times | None = None

    def completed(self, time: Time) -> "Output":
        """Return the table with its schedule spelt out."""
        usual = {"history": Schedule(every=time.end / MOST_ROWS)}
        return self if self.history is not None else self.model_copy(update=usual)
