"""What a run leaves behind: one short file per kind of output, found by itself.

A writer is made with the run's folder and the body, sees every row of the ledger and every snapshot, and is closed at
the end.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Protocol

from viscopoint.body import Body
from viscopoint.discovery import import_all
from viscopoint.ledger import Row
from viscopoint.method import Field


class Writer(Protocol):
    """Writes one kind of output."""

    def row(self, row: Row) -> None:
        """Take a row of the ledger."""
        ...

    def snapshot(self, time: float, fields: Mapping[str, Field]) -> None:
        """Take all fields at a snapshot [ms]."""
        ...

    def close(self) -> None:
        """Finish; nothing comes after."""
        ...


WRITERS: list[Callable[[Path, Body], Writer]] = []


def offer(writer: Callable[[Path, Body], Writer]) -> Callable[[Path, Body], Writer]:
    """Let every run use the decorated writer, a class or a function of the run's folder and the body at the start."""
    WRITERS.append(writer)
    return writer


import_all(__name__)
