"""Checkpoints: all that a run needs to go on as if nothing had happened, whole or not there.

A file in the safetensors format, which holds arrays and text and can hold nothing that is executed: the state of the
simulation, and as text how far it has come. A checksum over both tells whether it is what was written.
"""

import contextlib
import hashlib
import shutil
import time as clock
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save_file

from viscopoint.case.units import parse
from viscopoint.errors import InputError
from viscopoint.kernels.arrays import AnyArray
from viscopoint.model.callbacks import Callback
from viscopoint.model.schedule import Schedule
from viscopoint.model.simulation import Progress, Simulation
from viscopoint.results.folder import Held, sync, whole

FOLDER = "checkpoints"
BUFFERS = 4 * 2**20  # bytes that safetensors takes to write a file, rather more
KEPT = 2  # the last one may be damaged
LARGEST_HISTORY = 4 * 2**30  # bytes: seventeen million rows
DAMAGE = (OSError, ValueError, KeyError, TypeError, AttributeError, MemoryError, SafetensorError)
STEPS = "critical"  # of the state, what is infinite where there is nothing
NEVER, SIMULATED = "never", "simulated"


Number = Annotated[float, Field(allow_inf_nan=False)]
NotNegative = Annotated[Number, Field(ge=0)]
Count = Annotated[int, Field(ge=0, lt=2**62)]


class Words(BaseModel):
    """What a checkpoint says beside the simulation's state."""

    model_config = ConfigDict(strict=True, extra="forbid", ser_json_inf_nan="constants")

    sources: str  # what computed it
    case: str  # hash of the run folder's case file and mesh
    time: NotNegative  # ms
    step: Count
    time_step: NotNegative  # ms
    busy: NotNegative  # s

    @property
    def progress(self) -> Progress:
        """How far the simulation had come."""
        return Progress(self.time, self.step, self.time_step, self.busy)


class Checkpoint(NamedTuple):
    """What a file holds."""

    words: Words
    state: dict[str, AnyArray]


class Every(NamedTuple):
    """How often to write a checkpoint; infinite: never."""

    wall: float  # s
    simulated: float  # ms

    @classmethod
    def read(cls, text: str) -> "Every":
        """Read "10 s", a time on the clock, "5 us simulated", or "never"; raise ``InputError`` if it is none."""
        words = text.strip()
        if words == NEVER:
            return cls(np.inf, np.inf)
        simulated = words.endswith(SIMULATED)
        try:
            time = parse(words.removesuffix(SIMULATED), "ms")
            if time <= 0.0:
                raise ValueError("is not greater than zero")
        except ValueError as error:
            raise InputError(
                f'checkpoints every "{text}": {error}; write a time on the clock such as "10 s", one of the impact '
                f'such as "5 us {SIMULATED}", or "{NEVER}"'
            ) from None
        return cls(np.inf, time) if simulated else cls(time / 1e3, np.inf)


class Checkpointer(Callback):
    """Writes checkpoints into a run folder when they are due, and when the run is asked to end."""

    def __init__(self, held: Held, every: Every, sources: str, case: str) -> None:
        self.held, self.every, self.schedule = held, every, Schedule(every=every.simulated)
        self.sources, self.case = sources, case
        self.written = clock.monotonic()

    def due(self, simulation: Simulation) -> bool:
        now, step = simulation.time, simulation.step
        late = clock.monotonic() - self.written >= self.every.wall
        asked = late or bool(simulation.stop.asked) or self.schedule.due(simulation.time_before, now, step)
        return asked and step > 0 and not simulation.ended

    def __call__(self, simulation: Simulation) -> None:
        """Write a checkpoint and forget all but the last two."""
        self.held.check()
        words = Words(sources=self.sources, case=self.case, **simulation.progress._asdict())
        save(_file(self.held.folder, words.step), words, simulation.state())
        for old in _newest_first(self.held.folder)[KEPT:]:
            old.unlink()
        self.written = clock.monotonic()


def save(file: Path, words: Words, state: Mapping[str, AnyArray]) -> None:
    """Write a checkpoint whole or not at all."""
    file.parent.mkdir(exist_ok=True)
    text = words.model_dump_json()
    with whole(file) as part:
        bytearray(BUFFERS)  # who finds no memory for these ends the process; here it is told
        try:
            save_file(
                {name: np.ascontiguousarray(values) for name, values in state.items()},
                part,
                {"words": text, "checksum": _checksum(text, state)},
            )
        except SafetensorError as error:  # a full disk, among others
            raise OSError(str(error)) from None
        with part.open("rb+") as written:
            sync(written)


def load(file: Path, like: Mapping[str, AnyArray]) -> Checkpoint:
    """Read a checkpoint of a simulation whose state has the names, types and widths of ``like``.

    Arrays of bodies have the same lengths too; what callbacks keep grows.

    Raises:
        ValueError: it is none, or damaged, or of something else.
    """
    try:
        if file.stat().st_size > sum(values.nbytes for values in like.values()) + LARGEST_HISTORY:
            raise ValueError("too large")
        with safe_open(file, framework="np", backend="pread") as opened:
            told = opened.metadata() or {}
            text, checksum = told["words"], told["checksum"]
            if set(opened.keys()) != set(like):
                raise ValueError("other arrays than those of the case")
            state = {name: opened.get_tensor(name) for name in like}
        for name, values in state.items():
            if not _is_like(values, like[name], grows=not _of_body(name)):
                raise ValueError(f"{name} is not that of the case")
            if _of_body(name) and not name.endswith(f".{STEPS}") and not np.isfinite(values).all():
                raise ValueError(f"{name} is not finite")
        if checksum != _checksum(text, state):
            raise ValueError("checksum is wrong")
        return Checkpoint(Words.model_validate_json(text), state)
    except (*DAMAGE, ValidationError) as error:
        raise ValueError(f"{file.name}: {error}") from None


def _of_body(name: str) -> bool:
    """Return whether a simulation's state has this array of a body, whose number its name begins with."""
    return name.partition(".")[0].isdigit()


def _is_like(values: AnyArray, expected: AnyArray, grows: bool) -> bool:
    if not grows:
        return (values.dtype, values.shape) == (expected.dtype, expected.shape)
    width = (values.shape[-1:], expected.shape[-1:]) if values.ndim > 1 else ((), ())
    return (values.dtype, values.ndim, width[0]) == (expected.dtype, expected.ndim, width[1])


def newest(folder: Path, like: Mapping[str, AnyArray]) -> tuple[Checkpoint | None, list[str]]:
    """Return a run folder's last sound checkpoint, and what is wrong with those after it."""
    faults: list[str] = []
    for file in _newest_first(folder):
        try:
            return load(file, like), faults
        except ValueError as error:
            faults.append(str(error))
    return None, faults


def remove(folder: Path) -> None:
    """Remove a run folder's checkpoints: it needs them no more."""
    with contextlib.suppress(FileNotFoundError):
        shutil.rmtree(folder / FOLDER)


def remove_after(folder: Path, step: int) -> None:
    """Remove a run folder's checkpoints of later steps, which are damaged."""
    for file in _newest_first(folder):
        if file.name > _file(folder, step).name:
            file.unlink()


def hashed(files: Iterable[Path]) -> str:
    """Return the hash of what is in some files, by which a run knows its case."""
    total = hashlib.sha256()
    for file in files:
        with file.open("rb") as opened:
            total.update(hashlib.file_digest(opened, "sha256").digest())
    return total.hexdigest()


def _file(folder: Path, step: int) -> Path:
    return folder / FOLDER / f"{step:09d}.safetensors"


def _newest_first(folder: Path) -> list[Path]:
    """Return a run folder's checkpoints; there may be other files beside them."""
    found = (folder / FOLDER).glob(f"{9 * '[0-9]'}.safetensors")
    return sorted(filter(Path.is_file, found), reverse=True)


def _checksum(text: str, state: Mapping[str, AnyArray]) -> str:
    total = hashlib.sha256(text.encode())
    for name in sorted(state):
        total.update(f"{name} {state[name].dtype.str} {state[name].shape}".encode())
        total.update(np.ascontiguousarray(state[name]).data.cast("B") if state[name].size else b"")
    return total.hexdigest()
