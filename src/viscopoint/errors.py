"""What can go wrong, each with the exit code that the command line gives it."""

import difflib
from collections.abc import Iterable
from typing import NamedTuple

from viscopoint.messages import message, one_line

LONGEST_WORD = 100  # characters; of a longer one, nobody means one of ours
MOST_FAULTS = 100  # of a case that a message tells; a file made to have more would take long to explain


class ViscopointError(Exception):
    """A failure with a message for the person who started the work."""

    exit_code = 1

    def __str__(self) -> str:
        return message(super().__str__())


class Fault(NamedTuple):
    """One thing wrong with a case."""

    key: str  # such as "rod.radius"
    message: str  # the value, what is wrong with it and what is allowed

    def __str__(self) -> str:
        return one_line(f"{self.key}: {self.message}" if self.key else self.message)


class InputError(ViscopointError):
    """The input is wrong; nothing was written."""

    exit_code = 2


class CaseError(InputError):
    """A case has faults; all of them are listed, or the first ``MOST_FAULTS``."""

    def __init__(self, source: str, faults: list[Fault], more: int = 0) -> None:
        self.source, self.faults = source, faults
        rest = [f"  and {more} more"] if more else []
        lines = [f"{source} has {_count(len(faults) + more)}:", *(f"  {fault}" for fault in faults), *rest]
        super().__init__("\n".join(lines))


class OutputError(ViscopointError):
    """Results could not be written."""

    exit_code = 3


class ViscopointWarning(UserWarning):
    """What whoever started the work should know of, although it goes on."""


class ResultWarning(ViscopointWarning):
    """A result is less than it seems; the run's summary says so too."""


def nearest(word: str, allowed: Iterable[str]) -> str:
    """Return what is allowed instead of ``word``, the nearest first if one is near."""
    names = sorted(allowed)
    close = difflib.get_close_matches(word[:LONGEST_WORD], names, n=1, cutoff=0.5)
    hint = f"did you mean '{close[0]}'? " if close else ""
    return f"{hint}allowed: {', '.join(names)}"


def _count(faults: int) -> str:
    return "1 fault" if faults == 1 else f"{faults} faults"
