"""The run folder: made, filled while the run goes on, and completed at its end."""

import contextlib
import json
import os
import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from viscopoint.errors import InputError

CASE, PROVENANCE, SUMMARY, FIGURES = "case.toml", "provenance.json", "summary.json", "figures"


def check_free(folder: Path, force: bool, needed: Iterable[Path] = ()) -> None:
    """Raise ``InputError`` if a run may not be put here; with ``force``, an earlier run is no hindrance.

    Unless it holds a file that is ``needed``: it would be removed before it is read.
    """
    with _place_faults(folder):
        if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
            return
        if not (folder / PROVENANCE).is_file():
            raise InputError(f"output folder {folder}: already there, and no run folder; choose another place")
        if not force:
            raise InputError(f"output folder {folder}: already there; --force replaces it, --out chooses another place")
        for file in needed:
            if file.resolve().is_relative_to(folder.resolve()):
                raise InputError(f"output folder {folder}: holds {file}, which the case needs; choose another place")


def create(folder: Path, force: bool) -> None:
    """Make an empty folder for a run; with ``force``, in place of an earlier run.

    Raises:
        InputError: there is something already, or the place cannot be written.
    """
    check_free(folder, force)
    with _place_faults(folder):
        if folder.exists():
            shutil.rmtree(folder)
        folder.mkdir(parents=True)
        (folder / ".try").touch()
        (folder / ".try").unlink()


@contextlib.contextmanager
def _place_faults(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(f"output folder {folder}: cannot be made or written ({error.strerror})") from None


def is_file(path: Path) -> bool:
    """Return whether there is such a file; a name that cannot be one is none."""
    try:
        return path.is_file()
    except (OSError, ValueError):  # too long, or with a null character
        return False


def write_text(path: Path, text: str) -> None:
    """Write a file whole or not at all."""
    part = path.with_name(f".{path.name}.part")
    try:
        with part.open("w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        raise


def write_json(path: Path, data: dict[str, Any]) -> None:
    """Write JSON whole or not at all."""
    write_text(path, json.dumps(data, indent=2, ensure_ascii=False) + "\n")
