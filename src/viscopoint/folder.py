"""The run folder: made, filled while the run goes on, and completed at its end."""

import contextlib
import json
import os
import shutil
from pathlib import Path
from typing import Any

from viscopoint.errors import InputError
from viscopoint.ledger import UNITS, Row
from viscopoint.simulation import Outcome

CASE, PROVENANCE, SUMMARY, FIGURES = "case.toml", "provenance.json", "summary.json", "figures"
NUMBERS = ("wall_time [s]", "initial_kinetic_energy [mJ]", "energy_error [%]", "momentum_error [N ms]")  # of a summary


def create(folder: Path, force: bool) -> None:
    """Make an empty folder for a run; with ``force``, in place of an earlier run.

    Raises:
        InputError: there is something already, or the place cannot be written.
    """
    try:
        if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
            if not (folder / PROVENANCE).is_file():
                raise InputError(f"output folder {folder}: already there, and no run folder; choose another place")
            if not force:
                raise InputError(
                    f"output folder {folder}: already there; --force replaces it, --out chooses another place"
                )
            shutil.rmtree(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / ".try").touch()
        (folder / ".try").unlink()
    except OSError as error:
        raise InputError(f"output folder {folder}: cannot be made or written ({error.strerror})") from None


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


def summary(outcome: Outcome | None, initial_energy: float, points: int) -> dict[str, Any]:
    """Return the results of a run in a few numbers; those of one still running where there is no outcome."""
    if outcome is None:
        return {"status": "running", "reason": "", "points": points}
    return {
        "status": outcome.status,
        "reason": outcome.reason,
        "points": points,
        "steps": outcome.steps,
        **dict(
            zip(
                NUMBERS,
                (outcome.wall_time, initial_energy, 100 * outcome.energy_error, outcome.momentum_error),
                strict=True,
            )
        ),
        "units": UNITS,
        "snapshots": [_finite(row) for row in outcome.rows],
    }


def _finite(row: Row) -> dict[str, Any]:
    """Return a row as JSON allows it, not-a-number as null."""
    return {name: value if value == value else None for name, value in row._asdict().items()}
