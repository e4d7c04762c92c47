"""Where compiled kernels are kept: in folders that nobody else can have written to.

Files of compiled code are pickles: who reads one runs whatever its author wanted.
"""

import atexit
import contextlib
import functools
import hashlib
import json
import os
import shutil
import stat
import tempfile
import time
import warnings
from pathlib import Path

import platformdirs

from viscopoint.errors import InputError, ViscopointWarning
from viscopoint.kernels.promise import promise
from viscopoint.kernels.sources import numerics
from viscopoint.messages import one_line

VARIABLE = "VISCOPOINT_CACHE"
UNUSED = 30 * 24 * 3600.0  # s after which compiled code of other sources is removed
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


@functools.cache
def cache_folder() -> Path:
    """Return the folder of compiled kernels, named after a hash of the numerics and of what else changes their code.

    So code of other sources, or of other settings of the compiler, is never run stale. It is in the folder that the
    environment variable ``VISCOPOINT_CACHE`` names, else in the user's cache folder. One that cannot be written, or
    that others could have written to, is told and not used; without any, there is a private one among temporary files
    until the process ends.
    """
    given, usual = os.environ.get(VARIABLE), platformdirs.user_cache_path("viscopoint")
    refused: list[str] = []
    for parent in (*([Path(given)] if given else []), usual):
        try:
            folder = _opened(parent)
        except OSError as error:
            refused.append(f"{parent} ({error.strerror or error})")
        except _UnsafeError as error:
            refused.append(f"{parent} ({error})")
        else:
            if refused:
                _warn(refused, f"{usual} is used instead")
            return folder
    private = _private()
    _warn(refused, f"compiled code is kept in {private} until the end of the process, and then compiled again")
    return private


class _UnsafeError(Exception):
    """Somebody else could have put code there."""


def _warn(refused: list[str], instead: str) -> None:
    told = one_line(f"cache folder {' and '.join(refused)}: not used; {instead}; {VARIABLE} can name another folder")
    warnings.warn(told, ViscopointWarning, stacklevel=2)


def _name() -> str:
    state = json.dumps([numerics(), promise()], sort_keys=True)
    return f"kernels-{hashlib.sha256(state.encode()).hexdigest()[:16]}"


def _opened(parent: Path) -> Path:
    """Return our folder in a parent, made if missing; raise ``OSError`` or ``_UnsafeError`` if it cannot serve."""
    folder = Path(os.path.realpath(parent), _name())  # links may be led elsewhere after we have looked
    _check_way(folder.parent)
    if not os.path.lexists(folder):
        _remove_unused(folder.parent)
        _make(folder)
        _check_way(folder.parent)  # somebody may have been faster
    _check_inside(folder)
    with tempfile.TemporaryFile(dir=folder):
        os.utime(folder)  # used today
    return folder


def _make(folder: Path) -> None:
    """Make a folder, and those above it that are missing, for us alone."""
    missing = [place for place in (folder, *folder.parents) if not place.exists()]
    for place in reversed(missing):
        place.mkdir(mode=0o700, exist_ok=True)


def _check_way(parent: Path) -> None:
    """Raise ``_UnsafeError`` if somebody but us and root could exchange a folder on the way."""
    for place in (parent, *parent.parents):
        with contextlib.suppress(FileNotFoundError):
            status = place.stat()
            sticky = stat.S_ISDIR(status.st_mode) and status.st_mode & stat.S_ISVTX
            _check(place, status, owners=(0,), mode=0 if sticky else OTHERS_WRITE)


def _check_inside(folder: Path) -> None:
    """Raise ``_UnsafeError`` if our folder, or something in it, is not ours alone."""
    _check(folder, folder.lstat())
    for place, folders, files in os.walk(folder):
        for name in (*folders, *files):
            with contextlib.suppress(FileNotFoundError):  # another process put its file into place
                _check(Path(place, name), Path(place, name).lstat())


def _check(place: Path, status: os.stat_result, owners: tuple[int, ...] = (), mode: int = OTHERS_WRITE) -> None:
    if not hasattr(os, "geteuid"):  # a system of other rights
        return
    if stat.S_ISLNK(status.st_mode):
        raise _UnsafeError(f"{place} is a link")
    if status.st_uid not in (os.geteuid(), *owners):
        raise _UnsafeError(f"{place} belongs to user {status.st_uid}")
    if status.st_mode & mode:
        raise _UnsafeError(f"others can write to {place}; chmod go-w mends that")


def _private() -> Path:
    """Return a new folder that goes with this process; those that it starts use it too.

    Raises:
        InputError: others could exchange it, even there.
    """
    try:
        _check_way(Path(os.path.realpath(tempfile.gettempdir())))
    except _UnsafeError as error:
        told = f"no folder for compiled code is safe: {error}; {VARIABLE} can name one that is yours alone"
        raise InputError(told) from None
    folder, maker = Path(tempfile.mkdtemp(prefix="viscopoint-")), os.getpid()

    def remove() -> None:
        if os.getpid() == maker:  # and no copy of it
            shutil.rmtree(folder, ignore_errors=True)

    atexit.register(remove)
    os.environ[VARIABLE] = str(folder)
    return folder


def _remove_unused(parent: Path) -> None:
    """Remove the kernels of states of the sources that nobody ran for long."""
    for folder in parent.glob("kernels-" + 16 * "[0-9a-f]"):
        with contextlib.suppress(OSError):
            if time.time() - folder.stat().st_mtime > UNUSED:
                shutil.rmtree(folder)
