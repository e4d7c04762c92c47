"""What a benchmark found, and its file."""

import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import BaseModel, ConfigDict, ValidationError

from viscopoint.errors import InputError, OutputError
from viscopoint.results.folder import write_text

FORMAT = 1
LARGEST_FILE = 10_000_000  # bytes


class Entry(BaseModel):
    """Named figures; nothing more, nothing less."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Spread(Entry):
    """Several measurements of one thing."""

    median: float
    least: float
    most: float
    repeats: int

    @classmethod
    def of(cls, values: Sequence[float]) -> Self:
        """Return median, least and most of some values."""
        return cls(median=statistics.median(values), least=min(values), most=max(values), repeats=len(values))

    def overlaps(self, other: "Spread") -> bool:
        """Return whether some value could be in both."""
        return self.least <= other.most and other.least <= self.most


class Triad(Entry):
    """The bandwidth of the memory."""

    threads: int
    array_bytes: int  # of each of the three arrays
    gigabytes_per_second: Spread


class Measured(Entry):
    """What was measured, as in ``work.Work``, and its number of parts, points or elements."""

    method: str
    variant: str
    law: str
    size: str
    parts: int

    @property
    def name(self) -> str:
        """Return how it is called on the terminal."""
        return f"{self.method} {self.variant} {self.law} {self.size}"


class Pace(Measured):
    """How fast a method steps on some threads."""

    threads: int
    million_steps_per_second: Spread  # of one part
    bytes_per_step: int  # moved, counted from the layout
    bandwidth_share: float  # of the triad's on as many threads
    thread_scaling: float  # over the fewest threads
    size_scaling: float  # over the smallest problem on as many threads


class Memory(Measured):
    """What a model takes."""

    bytes_held: int  # of all arrays of the method
    peak_growth: int | None  # of a process that built it and took some steps, bytes; not measured of all


class Startup(Entry):
    """How long a command takes that does next to nothing."""

    command: str
    cache: Literal["empty", "filled"]  # of compiled kernels
    seconds: Spread


class Record(Entry):
    """One run of the benchmark."""

    kind: Literal["viscopoint bench"] = "viscopoint bench"
    format: Literal[1] = FORMAT
    machine: dict[str, Any]
    started: str
    repeats: int
    triad: list[Triad]
    pace: list[Pace]
    memory: list[Memory]
    startup: list[Startup]


def read(path: Path) -> Record:
    """Read a record; raise ``InputError`` if the file holds none."""
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE)
        return Record.model_validate_json(content)
    except (OSError, ValueError) as error:
        if isinstance(error, ValidationError):
            first = error.errors()[0]
            why = f"{'.'.join(map(str, first['loc'])) or 'the file'}: {first['msg']}"
        else:
            why = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{path}: not a file that `viscopoint bench --out` wrote ({why})") from None


def check_free(path: Path, force: bool) -> None:
    """Raise ``InputError`` if a record may not be put here; with ``force``, an earlier one is no hindrance."""
    if path.exists():
        if not force:
            raise InputError(f"--out {path}: already there; --force replaces it")
        read(path)
    trial = path.with_name(f".{path.name}.try")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        trial.touch()
        trial.unlink()
    except OSError as error:
        raise InputError(f"--out {path}: cannot be made or written ({error.strerror})") from None


def write(record: Record, path: Path) -> None:
    """Write a record whole or not at all."""
    try:
        write_text(path, record.model_dump_json(indent=1) + "\n")
    except OSError as error:
        raise OutputError(f"--out {path}: cannot be written ({error.strerror})") from None
