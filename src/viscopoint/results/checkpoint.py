"""Checkpoints: all that a run needs to go on as if nothing had happened, whole or not there.

A file in the safetensors format, which holds arrays and text and can hold nothing that is executed: the method's state,
and as text the progress of the run. A checksum over both tells whether it is what was written.
"""

import contextlib
import hashlib
import shutil
import time as clock
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save_file

from viscopoint.case.units import parse
from viscopoint.errors import InputError
from viscopoint.kernels.arrays import AnyArray
from viscopoint.results.folder import Held, sync, whole

FOLDER = "checkpoints"
BUFFERS = 4 * 2**20  # bytes that safetensors takes to write a file, rather more
KEPT = 2  # the last one may be damaged
LARGEST_TEXT = 64 * 2**20  # bytes of progress: rows of 10,000 snapshots take 5 MB
DAMAGE = (OSError, ValueError, KeyError, TypeError, AttributeError, MemoryError, SafetensorError)
STEPS = "critical"  # of the state, what is infinite where there is nothing
NEVER, SIMULATED = "never", "simulated"


Number = Annotated[float, Field(allow_inf_nan=False)]
NotNegative = Annotated[Number, Field(ge=0)]
Count = Annotated[int, Field(ge=0, lt=2**62)]


class Progress(BaseModel):
    """How far a run has come, beside the method's state; rows are those of the history."""

    model_config = ConfigDict(strict=True, extra="forbid", ser_json_inf_nan="constants")

    sources: str  # what computed it
    case: str  # hash of the run folder's case file and mesh
    time: NotNegative  # ms
    step: Count
    time_step: NotNegative  # ms
    busy: NotNegative  # s
    errors: tuple[NotNegative, NotNegative, NotNegative]  # greatest so far, see ``Simulation``
    start: list[Number]  # the account at the start, see ``EnergyBalance``
    internal: NotNegative  # energy, the greatest so far, mJ
    before: list[float]  # lengths may be not a number
    rows: Annotated[list[list[float]], Field(min_length=1)]  # at the snapshots
    marks: list[tuple[Count, Count]]  # of the outputs, see ``output.Writer``


class Checkpoint(NamedTuple):
    """What a file holds."""

    progress: Progress
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


class Keeper:
    """Writes the checkpoints of a run when they are due."""

    def __init__(self, held: Held, every: Every, sources: str, case: str) -> None:
        self.held, self.every = held, every
        self.sources, self.case = sources, case
        self.written = clock.monotonic(), 0.0  # when the last one was, on the clock and in the run

    def due(self, time: float) -> bool:
        """Return whether it is time for one, at a time of the run [ms]."""
        return clock.monotonic() - self.written[0] >= self.every.wall or time - self.written[1] >= self.every.simulated

    def write(self, state: Mapping[str, AnyArray], **progress: Any) -> None:
        """Write a checkpoint and forget all but the last two; ``progress`` has the fields of ``Progress``."""
        self.held.check()
        words = Progress(sources=self.sources, case=self.case, **progress)
        save(_file(self.held.folder, words.step), words, state)
        for old in _newest_first(self.held.folder)[KEPT:]:
            old.unlink()
        self.written = clock.monotonic(), words.time


def save(file: Path, progress: Progress, state: Mapping[str, AnyArray]) -> None:
    """Write a checkpoint whole or not at all."""
    file.parent.mkdir(exist_ok=True)
    text = progress.model_dump_json()
    with whole(file) as part:
        bytearray(BUFFERS)  # who finds no memory for these ends the process; here it is told
        try:
            save_file(dict(state), part, {"progress": text, "checksum": _checksum(text, state)})
        except SafetensorError as error:  # a full disk, among others
            raise OSError(str(error)) from None
        with part.open("rb+") as written:
            sync(written)


def load(file: Path, like: Mapping[str, AnyArray]) -> Checkpoint:
    """Read a checkpoint whose state has the names, types and shapes of ``like``.

    Raises:
        ValueError: it is none, or damaged, or of something else.
    """
    try:
        if file.stat().st_size > sum(values.nbytes for values in like.values()) + LARGEST_TEXT:
            raise ValueError("too large")
        with safe_open(file, framework="np", backend="pread") as opened:
            words = opened.metadata() or {}
            text, checksum = words["progress"], words["checksum"]
            if set(opened.keys()) != set(like):
                raise ValueError("other arrays than those of the case")
            state = {name: opened.get_tensor(name) for name in like}
        for name, values in state.items():
            if values.dtype != like[name].dtype or values.shape != like[name].shape:
                raise ValueError(f"{name} is not that of the case")
            if name != STEPS and not np.isfinite(values).all():
                raise ValueError(f"{name} is not finite")
        if checksum != _checksum(text, state):
            raise ValueError("checksum is wrong")
        return Checkpoint(Progress.model_validate_json(text), state)
    except (*DAMAGE, ValidationError) as error:
        raise ValueError(f"{file.name}: {error}") from None


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
