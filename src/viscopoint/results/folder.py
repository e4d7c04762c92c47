"""Folders of results: made, filled, and never half replaced."""

import contextlib
import errno
import json
import os
import secrets
import shutil
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO, Any, NamedTuple

from filelock import FileLock, Timeout

from viscopoint.errors import InputError, OutputError
from viscopoint.messages import one_line

CASE, PROVENANCE, SUMMARY, FIGURES = "case.toml", "provenance.json", "summary.json", "figures"
TOKEN = 8  # bytes of chance in the name of a folder that is being made
LONG_AGO = 3600.0  # s, after which nobody makes it any more: that takes less than a second


def check_free(folder: Path, force: bool, mark: str = PROVENANCE, needed: Iterable[Path] = ()) -> None:
    """Raise ``InputError`` if results may not be put here; with ``force``, earlier ones are no hindrance.

    Unless something holds a file that is ``needed``: it would be removed before it is read. A folder holds earlier
    results if it holds the file ``mark``, that of a run by default.
    """
    with _place_faults(folder):
        if folder.exists() and folder.samefile(Path.cwd()):
            raise InputError(f"output folder {folder}: the one you are in, which cannot be made; choose another place")
        if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
            return
        if not (folder / mark).is_file():
            raise InputError(f"output folder {folder}: already there, and has no {mark}; choose another place")
        if not force:
            raise InputError(f"output folder {folder}: already there; --force replaces it, --out chooses another place")
        for file in needed:
            if file.resolve().is_relative_to(folder.resolve()):
                raise InputError(f"output folder {folder}: holds {file}, which is needed; choose another place")


def create(folder: Path, force: bool, mark: str = PROVENANCE, needed: Iterable[Path] = ()) -> None:
    """Make an empty folder for results; with ``force``, in place of earlier ones (see ``check_free``).

    Raises:
        InputError: there is something already, or the place cannot be written.
    """
    check_free(folder, force, mark, needed)
    with _place_faults(folder):
        if folder.exists():
            shutil.rmtree(folder)
        folder.mkdir(parents=True)
        (folder / ".try").touch()
        (folder / ".try").unlink()


@contextlib.contextmanager
def new(folder: Path, force: bool, needed: Iterable[Path] = ()) -> Iterator[Path]:
    """Yield an empty folder to fill, which then takes its place whole, or not at all; see ``check_free``.

    Raises:
        InputError: there is something already, or the place cannot be written, or others are at work there.
    """
    check_free(folder, force, needed=needed)
    with _place_faults(folder):
        place = folder.resolve()  # a link stays, and leads to what is new
        part = place.parent / f".{secrets.token_hex(TOKEN)}.part"
        part.mkdir(parents=True)
        _clear_remains(place.parent)
    try:
        yield part
        with _place_faults(folder):
            sync_folder(part)
            if place.is_dir() and any(place.iterdir()):
                with alone(place):
                    check_free(folder, force, needed=needed)
                    _replace(place, part)
            else:
                part.rename(place)
            sync_folder(place.parent)
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        raise


def _replace(place: Path, part: Path) -> None:
    """Put a folder in the place of another, which is removed once that has happened."""
    old = place.with_name(f".{place.name}{part.stem}.old")
    os.utime(place)  # for ``_clear_remains``: it is not long ago
    place.rename(old)
    try:
        part.rename(place)
    except BaseException:
        old.rename(place)
        raise
    shutil.rmtree(old, ignore_errors=True)


def _clear_remains(parent: Path) -> None:
    """Put away what processes that were killed left of folders they were making or replacing."""
    token = 2 * TOKEN * "[0-9a-f]"
    for remains in (*parent.glob(f".{token}.part"), *parent.glob(f".*.{token}.old")):
        with contextlib.suppress(OSError):
            if not remains.is_dir() or time.time() - remains.stat().st_mtime < LONG_AGO:
                continue
            place = parent / remains.stem[1 : -(2 * TOKEN + 1)]  # of what was being replaced
            if remains.suffix == ".old" and not place.exists():
                remains.rename(place)
            else:
                shutil.rmtree(remains)


def make(folder: Path, mark: str) -> None:
    """Make a folder for results that are completed bit by bit, or take the one there if it holds the file ``mark``.

    Raises:
        InputError: there is something else already, or the place cannot be written.
    """
    if not (folder / mark).is_file():
        create(folder, force=False, mark=mark)
        write_json(folder / mark, {})  # nothing yet


@contextlib.contextmanager
def _place_faults(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(f"output folder {folder}: cannot be made or written ({error.strerror})") from None


@contextlib.contextmanager
def disk_faults(folder: Path, advice: str = "") -> Iterator[None]:
    """Turn a full or vanished disk, or memory that ran out, into a message that ends with some advice."""
    try:
        yield
    except MemoryError as error:
        told = one_line(f": {error}" if str(error) else "")
        raise OutputError(f"output folder {folder}: memory ran out{told}; what is there stays{advice}") from error
    except OSError as error:
        wrong = error.strerror or error
        raise OutputError(
            f"output folder {folder}: cannot be written ({wrong}); what is there stays{advice}"
        ) from error


def is_file(path: Path) -> bool:
    """Return whether there is such a file; a name that cannot be one is none."""
    try:
        return path.is_file()
    except (OSError, ValueError):  # too long, or with a null character
        return False


def is_folder(path: Path) -> bool:
    """Return whether there is such a folder; a name that cannot be one is none."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


class Held(NamedTuple):
    """A folder that this process has for itself, as long as it is in its place."""

    folder: Path
    status: os.stat_result

    def check(self) -> None:
        """Raise ``OSError`` if the folder is there no more, or another in its place."""
        if not os.path.samestat(self.folder.stat(), self.status):
            raise OSError(errno.ESTALE, "the folder was moved, another one is in its place")


@contextlib.contextmanager
def alone(folder: Path, made: os.stat_result | None = None) -> Iterator[Held]:
    """Keep a folder to this process; it is the one that was ``made``, if that is given.

    Raises:
        InputError: another process is at work there, or has put another folder into its place.
    """
    busy = InputError(f"output folder {folder}: another process is at work there; wait, or take another")
    with _place_faults(folder):
        held = Held(folder, made or folder.stat())
        lock = FileLock(folder / ".lock")
        try:
            lock.acquire(timeout=0)
        except Timeout:
            raise busy from None
    try:
        if not os.path.samestat(folder.stat(), held.status):
            raise busy
        yield held
    finally:
        lock.release()


@contextlib.contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Yield where to write a file, which then takes its place whole, or not at all."""
    part = path.with_name(f".{path.name}.part")
    try:
        part.unlink(missing_ok=True)  # a link that somebody left there would lead elsewhere
        yield part
        part.replace(path)
        sync_folder(path.parent)
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        raise


def write_text(path: Path, text: str) -> None:
    """Write a file whole or not at all."""
    with whole(path) as part, part.open("w", encoding="utf-8") as file:
        file.write(text)
        sync(file)


def sync(file: IO[Any]) -> None:
    """Bring all that was written to the disk itself."""
    file.flush()
    os.fsync(file.fileno())


def sync_folder(folder: Path) -> None:
    """Bring a folder's list of files to the disk itself, where the system has a way to do it."""
    if hasattr(os, "O_DIRECTORY"):
        number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(number)
        finally:
            os.close(number)


def write_json(path: Path, data: dict[str, Any]) -> None:
    """Write JSON whole or not at all."""
    write_text(path, json.dumps(data, indent=2, ensure_ascii=False) + "\n")
