"""What can go wrong, each with the exit code that the command line gives it."""

import difflib
from collections.abc import Iterable
from typing import NamedTuple


class ViscopointError(Exception):
    """A failure with a message for the person who started the work."""

    exit_code = 1


class Fault(NamedTuple):
    """One thing wrong with a case."""

    key: str  # such as "rod.radius"
    message: str  # the value, what is wrong with it and what is allowed

    def __str__(self) -> str:
        return f"{self.key}: {self.message}" if self.key else self.message


class InputError(ViscopointError):
    """The input is wrong; nothing was written."""

    exit_code = 2


class CaseError(InputError):
    """A case has faults; all of them are listed."""

    def __init__(self, source: str, faults: list[Fault]) -> None:
        self.source, self.faults = source, faults
        super().__init__("\n".join([f"{source} has {_count(faults)}:", *(f"  {fault}" for fault in faults)]))


class OutputError(ViscopointError):
    """Results could not be written."""

    exit_code = 3


def nearest(word: str, allowed: Iterable[str]) -> str:
    """Return what is allowed instead of ``word``, the nearest first if one is near."""
    names = sorted(allowed)
    close = difflib.get_close_matches(word, names, n=1, cutoff=0.5)
    hint = f"did you mean '{close[0]}'? " if close else ""
    return f"{hint}allowed: {', '.join(names)}"


def _count(faults: list[Fault]) -> str:
    return "1 fault" if len(faults) == 1 else f"{len(faults)} faults"
