"""Watches one fuzzed input: it is taken or refused with a message, within seconds, and writes nothing elsewhere."""

import faulthandler
import os
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from viscopoint.errors import InputError
from viscopoint.messages import unseen

HANG = 5.0  # seconds an input may take
STUCK = 60.0  # seconds after which the process is given up: no signal gets through
LONGEST = 100_000  # characters of a message
WRITES = {
    "os.mkdir", "os.remove", "os.rename", "os.rmdir", "os.link", "os.symlink", "os.truncate", "os.chmod", "os.chown",
    "os.utime", "shutil.rmtree", "shutil.move", "shutil.copyfile",
}  # fmt: skip
CALLS = {
    "os.system", "os.exec", "os.posix_spawn", "os.spawn", "subprocess.Popen", "socket.connect", "socket.getaddrinfo",
    "pickle.find_class", "ctypes.dlopen", "urllib.Request",
}  # fmt: skip
AT_FOLDER = {"os.mkdir", "os.remove", "os.rmdir"}  # whose last argument is an open folder, or -1
CHANGING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


class HungError(BaseException):
    """Raised into what takes too long; no ``except Exception`` stops it."""


class EscapedError(BaseException):
    """Raised where something would be written outside, or started."""


class Watch:
    """Runs inputs and keeps count; ``defects`` has one entry for each kind of failure at one place."""

    def __init__(self, inside: Path) -> None:
        self.inside = os.path.realpath(inside)
        self.on = False
        self.counts = {"inputs": 0, "taken": 0, "refused": 0, "tracebacks": 0, "hangs": 0, "escapes": 0, "messages": 0}
        self.defects: dict[str, dict[str, Any]] = {}
        self.slowest, self.input = 0.0, ""
        sys.addaudithook(self._audit)
        signal.signal(signal.SIGALRM, self._alarm)
        sys.unraisablehook = self._unraisable

    def run(self, check: Callable[[], None], described: str) -> None:
        """Run one input; nothing that goes wrong with it leaves this."""
        self.counts["inputs"] += 1
        self.input = described
        began, hung = time.monotonic(), False
        try:
            with self._watching():
                check()
            self.counts["taken"] += 1
        except InputError as error:
            self.counts["refused"] += 1
            if wrong := wrong_with(str(error)):
                self._found("messages", wrong, f"{wrong}: {str(error)[:300]!r}")
        except HungError:
            hung = True
            self._found("hangs", _place(), "took too long")
        except EscapedError as error:
            self._found("escapes", _place(), str(error))
        except Exception as error:
            self._found("tracebacks", f"{type(error).__name__} at {_place()}", traceback.format_exc()[-3000:])
        took = time.monotonic() - began
        self.slowest = max(self.slowest, took)
        if took > HANG and not hung:
            self._found("hangs", "slow", f"took {took:.1f} s")

    @contextmanager
    def _watching(self) -> Iterator[None]:
        faulthandler.dump_traceback_later(STUCK, exit=True)
        signal.setitimer(signal.ITIMER_REAL, HANG)
        self.on = True
        try:
            yield
        finally:
            self.on = False
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            faulthandler.cancel_dump_traceback_later()

    def _found(self, kind: str, place: str, told: str) -> None:
        self.counts[kind] += 1
        key = f"{kind}: {place}"
        if key not in self.defects:
            self.defects[key] = {"told": told, "input": self.input, "times": 0}
        self.defects[key]["times"] += 1

    def _unraisable(self, failed: Any) -> None:
        """Count what Python would print and go on from, as a user would see it."""
        self._found("tracebacks", f"ignored {failed.exc_value!r:.60}", f"{failed.exc_value!r:.300}")

    def _alarm(self, *_: Any) -> None:
        raise HungError

    def _audit(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.on:
            return
        if event == "open":
            path, mode, flags = arguments
            writes = bool((flags or 0) & CHANGING) or (
                isinstance(mode, str) and any(letter in mode for letter in "wax+")
            )
            if writes and not isinstance(path, int):
                self._must_be_inside(event, path)
        elif event in WRITES:
            within = f"/proc/self/fd/{arguments[-1]}" if event in AT_FOLDER and arguments[-1] >= 0 else ""
            for path in arguments[:2]:
                if isinstance(path, str | bytes | os.PathLike):
                    self._must_be_inside(event, os.path.join(within, os.fsdecode(path)))  # noqa: PTH118
        elif event in CALLS:
            raise EscapedError(f"{event} {arguments!r:.300}")

    def _must_be_inside(self, event: str, path: Any) -> None:
        real = os.path.realpath(os.fsdecode(path))
        if real not in (self.inside, os.devnull) and not real.startswith(self.inside + os.sep):
            raise EscapedError(f"{event} {real}")


def wrong_with(message: str) -> str | None:
    """Say what is wrong with a message to a user."""
    if not message.strip():
        return "an empty message"
    if len(message) > LONGEST:
        return "a message too long"
    if letter := unseen(message.replace("\n", "")):
        return f"a message with U+{ord(letter):04X}"
    return "a message with a traceback" if "Traceback" in message else None


def _place() -> str:
    """Return where in our own code the exception that is being handled came from."""
    frames = traceback.extract_tb(sys.exc_info()[2])
    own = [frame for frame in frames if "viscopoint" in frame.filename and "tests" not in Path(frame.filename).parts]
    frame = (own or frames)[-1]
    return f"{Path(frame.filename).name}:{frame.name}:{frame.lineno}"


def tree(folder: Path) -> dict[str, tuple[int, int, int]]:
    """Return what is in a folder: kind, size and time of change of each entry, by its path."""
    found = {}
    for path in sorted(folder.rglob("*")):
        status = path.lstat()
        found[str(path.relative_to(folder))] = (status.st_mode, status.st_size, status.st_mtime_ns)
    return found
