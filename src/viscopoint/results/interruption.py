"""Ctrl-C and the system's request to end (SIGTERM): noted, so that a run ends where it can be gone on with.

A signal that is ignored when the process starts stays so: shells begin thus what is to go on in the background.
"""

import contextlib
import os
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any, NoReturn

SIGNALS = (signal.SIGINT, signal.SIGTERM)
SHOW_CURSOR = "\x1b[?25h"  # which a progress bar hides


class Stop:
    """Whether a run was asked to end, and by which signal."""

    asked = ""  # such as "SIGINT"

    def obey(self) -> None:
        """Raise what the signal would have raised, if there was one."""
        if self.asked:
            raise_for(self.asked)


@contextlib.contextmanager
def noted(tell: Callable[[str], None] | None = None) -> Iterator[Stop]:
    """Yield what notes the first signal, and tells of it; a second one does what it did before.

    Outside of the main thread signals go elsewhere.
    """
    stop = Stop()
    before: dict[int, Any] = {}

    def note(number: int, frame: FrameType | None) -> None:
        stop.asked = signal.Signals(number).name
        _put_back(before)
        if tell:
            tell("interrupted: finishing the step (once more: at once)")

    if threading.current_thread() is threading.main_thread():
        before |= _handled(note, *SIGNALS)
    try:
        yield stop
    finally:
        _put_back(before)


def raise_for(name: str) -> NoReturn:
    """Raise what a signal such as "SIGINT" raises."""
    raise Terminated if name == "SIGTERM" else KeyboardInterrupt


class Terminated(KeyboardInterrupt):
    """The system asked the process to end."""


@contextlib.contextmanager
def raising() -> Iterator[None]:
    """Let SIGTERM raise ``Terminated``, as Ctrl-C raises ``KeyboardInterrupt``."""

    def end(number: int, frame: FrameType | None) -> None:
        raise Terminated

    before = _handled(end, signal.SIGTERM)
    try:
        yield
    finally:
        _put_back(before)


@contextlib.contextmanager
def ending_at_once() -> Iterator[None]:
    """Let a signal end the process there and then: whatever we write is whole or not there at every instant."""

    def end(number: int, frame: FrameType | None) -> None:
        if os.isatty(2):
            os.write(2, SHOW_CURSOR.encode())
        os.write(2, b"viscopoint: interrupted\n")
        os._exit(128 + number)

    before = _handled(end, *SIGNALS)
    try:
        yield
    finally:
        _put_back(before)


def exit_code(name: str) -> int:
    """Return what a process that a signal ended exits with, such as 130 for "SIGINT"."""
    return 128 + signal.Signals[name]


def _handled(handler: Callable[[int, FrameType | None], None], *numbers: int) -> dict[int, Any]:
    """Let signals call a handler, and return what they did before."""
    heard = [number for number in numbers if signal.getsignal(number) != signal.SIG_IGN]
    return {number: signal.signal(number, handler) for number in heard}


def _put_back(before: dict[int, Any]) -> None:
    for number, handler in before.items():
        signal.signal(number, handler)
