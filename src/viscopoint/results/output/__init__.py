"""What a run leaves behind: one short file per kind of output, found by itself.

A writer is made with the run's folder and the body, begins, sees every history row and every snapshot, and is
closed at the end. A checkpoint asks it for a mark, where it has come to; one made with a mark looks whether all up to
there is in the folder, and as it begins forgets what an earlier process wrote after it.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple, Protocol

from viscopoint.discovery import Registry, import_all
from viscopoint.model.body import Body
from viscopoint.model.energy_balance import Row
from viscopoint.model.method import Field


class Mark(NamedTuple):
    """Where an output had come to as a checkpoint was written."""

    place: int  # as it counts: bytes, snapshots
    check: int  # CRC-32 of all up to there
    snapshots: int  # that it had seen


class Writer(Protocol):
    """Writes one kind of output.

    To make one changes nothing in the folder yet; it raises ``ValueError`` if what is there does not go with the mark.
    """

    def begin(self) -> None:
        """Forget what was written after the mark, or all without one."""
        ...

    def row(self, row: Row) -> None:
        """Take a history row."""
        ...

    def snapshot(self, time: float, fields: Mapping[str, Field]) -> None:
        """Take all fields at a snapshot [ms]."""
        ...

    def mark(self) -> tuple[int, int]:
        """Return where the output has come to, which is on the disk for good, and the CRC-32 of all up to there."""
        ...

    def close(self) -> None:
        """Finish; nothing comes after."""
        ...


Make = Callable[[Path, Body, Mark | None], Writer]
WRITERS: Registry[Make] = Registry()  # classes or functions of folder, body at the start, and mark to go on from

import_all(__name__)
