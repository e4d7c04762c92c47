"""The tables of a case that every method shares, and what all tables have in common."""

import os
from abc import abstractmethod
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from viscopoint.rules import rule
from viscopoint.units import Duration, Gap, Instant, Length, Speed


class Table(BaseModel):
    """A table of a case: no unknown keys, no conversion of one type into another, nothing infinite."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class Material(Table):
    """The ``[material]`` table; each law derives its own, with ``law: Literal["its-name"]``."""

    @abstractmethod
    def build(self) -> Any:
        """Return the law's parameters."""


class Rod(Table):
    """A cylinder that stands on z = 0."""

    radius: Length
    length: Length


class Impact(Table):
    """The rod flies at ``speed`` towards -z; the wall is ``gap`` below its foot."""

    speed: Speed
    gap: Gap = 0.0
    friction: float = Field(default=0.0, ge=0, le=10)


class Time(Table):
    """When to end and when to keep all fields; the start and the end are always kept."""

    end: Duration
    snapshots: Annotated[tuple[Duration, ...], Field(strict=False, max_length=10_000)] = ()


@rule("time.snapshots", "time.end")
def snapshots_before_the_end(snapshots: tuple[float, ...], end: float) -> str | None:
    late = [f"{instant * 1e3:.12g} us" for instant in snapshots if instant > end * (1 + 1e-12)]
    return f"{', '.join(late[:5])}: after time.end, {end * 1e3:g} us" if late else None


class Guards(Table):
    """When to stop a run that has gone wrong."""

    energy_error: float = Field(default=0.05, gt=0)  # numerical remainder over initial kinetic energy
    smallest_step: float = Field(default=1e-3, gt=0, lt=1)  # stable step over the first one


class Output(Table):
    """How often to write a line of history (0: every step)."""

    history_interval: Instant = 0.0


def machine_memory() -> float:
    """Return the machine's memory in bytes."""
    return float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
