"""Reads run folders: the one way to a finished run, from the command line, the API and the figures alike."""

import csv
import functools
import math
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, ValidationError

from viscopoint.arguments import checked
from viscopoint.case.case import LONGEST_FILE, Case
from viscopoint.case.units import parse
from viscopoint.errors import InputError, nearest
from viscopoint.model import memory
from viscopoint.model.body import Body
from viscopoint.model.energy_balance import UNITS
from viscopoint.model.measurements import profile
from viscopoint.model.method import Field
from viscopoint.results import vtkhdf
from viscopoint.results.folder import CASE, PROVENANCE, SUMMARY, is_folder
from viscopoint.results.older_formats import fields as older_fields
from viscopoint.results.older_formats import words as older
from viscopoint.results.output import fields as field_files
from viscopoint.results.output import history as history_file
from viscopoint.results.provenance import READABLE
from viscopoint.results.safe_read import contents, kept, table
from viscopoint.results.summary import Summary

if TYPE_CHECKING:
    import pandas

# what h5py raises on damaged files
CORRUPT = (
    OSError, LookupError, TypeError, ValueError, RuntimeError, AttributeError, OverflowError, MemoryError,
)  # fmt: skip
LARGEST_PROVENANCE, LARGEST_SUMMARY, LARGEST_HISTORY = 1_000_000, 16_000_000, 4_000_000_000  # bytes
LARGEST_FIELDS = 2**50  # bytes; of these, what is asked for is read alone
ALWAYS = ("position", "displacement", "velocity", "lost", "stress", "pressure", "von_mises")  # fields of any method
AXES = ("x", "y", "z")
COLUMNS = {3: AXES, 6: ("xx", "yy", "zz", "xy", "yz", "zx")}  # of fields, by how many they have
NEAR = 1e-6  # of the last time: a time given in words and a snapshot's that differ by less are the same


@dataclass(frozen=True)
class Snapshot:
    """All fields at one time."""

    time: float  # ms
    fields: dict[str, Field]

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return the values of a field, such as ``snapshot["velocity"]``, one row per point."""
        return self.fields[name].values

    def scalar(self, name: str) -> tuple[NDArray[Any], str]:
        """Return one number per point or element, and its unit: of a component, or of a field's magnitude.

        ``name`` is that of a field, with a component such as "velocity_z" or "stress_xx". Of a vector without one it
        is the length; a tensor has none.

        Raises:
            InputError: there is no such field or component.
        """
        field, _, component = name.rpartition("_")
        if name in self.fields:
            values, unit = self.fields[name].values, self.fields[name].unit
            if values.ndim == 1:
                return values, unit
            if values.shape[1] == len(AXES):
                return np.linalg.norm(values, axis=1), unit
        elif field in self.fields and component in (names := COLUMNS.get(self[field].shape[-1], ())):
            return self[field][:, names.index(component)], self.fields[field].unit
        raise InputError(f"field '{name}': {nearest(name, self._scalars())}")

    def _scalars(self) -> list[str]:
        """Return the names that ``scalar`` knows."""
        found: list[str] = []
        for name, field in self.fields.items():
            width = field.values.shape[1] if field.values.ndim > 1 else 1
            found += [name] * (width in (1, len(AXES)))
            found += [f"{name}_{component}" for component in COLUMNS.get(width, ())]
        return found


class Origin(BaseModel):
    """What is used of ``provenance.json``: of these types, or the folder is none of ours."""

    model_config = ConfigDict(strict=True)

    viscopoint: str | None = None
    commit: str | None = None
    sources: str | None = None
    case: str | None = None
    ended: str | None = None
    resumed: list[str] = []
    resumed_with: list[str] = []


class Reader:
    """A run folder, finished or not, and all that can be read from it."""

    @checked
    def __init__(self, folder: str | Path) -> None:
        """Open a run folder; raise ``InputError`` if it is none or from another version."""
        self.folder = Path(folder)
        if not is_folder(self.folder):
            raise InputError(f"run folder {folder}: there is no such folder")
        self.provenance = self._json(PROVENANCE, LARGEST_PROVENANCE)
        if self.provenance.get("format") not in READABLE:
            found, known = self.provenance.get("format"), " and ".join(map(str, READABLE))
            raise InputError(f"run folder {folder}: format {found}, but this version reads formats {known}")
        try:
            Origin.model_validate(self.provenance)
        except ValidationError as error:
            wrong = error.errors()[0]["loc"][0]
            raise InputError(f"run folder {folder}: {PROVENANCE} is not that of a run: see {wrong}") from None
        self.summary = self._json(SUMMARY, LARGEST_SUMMARY)
        self.is_older = older.is_older(self.provenance)
        try:
            if self.is_older:
                snapshots = [older.quantities(dict(row), None) for row in self.summary.get("snapshots", [])]
                self.summary |= {"snapshots": snapshots}
            self.results = Summary.model_validate(self.summary)
            self.rows = self.results.rows()
        except (ValidationError, TypeError, ValueError):
            raise InputError(f"run folder {folder}: {SUMMARY} is not the summary of a run") from None

    def __repr__(self) -> str:
        return f"Run({str(self.folder)!r}, {self.status})"

    @property
    def place(self) -> str:
        """Where the run is, in words."""
        return f"run folder {self.folder}"

    @property
    def status(self) -> str:
        """How the run ended: "complete", "complete with losses", "stopped" (by a guard), "interrupted"; or "running".

        With losses: points left the box or elements were deleted; lengths that need them are not numbers.
        """
        return str(self.summary["status"])

    @functools.cached_property
    def case(self) -> Case:
        """The case with every default spelt out."""
        return Case.load(self._file(CASE, LONGEST_FILE), mend=older.tables if self.is_older else None)

    @functools.cached_property
    def body(self) -> Body:
        """The rod's points at the start, as the case gives them; ``InputError`` if they would not fit here."""
        memory.check(self.case.method.need(self.case.rod), memory.machine())
        today = self.case.method.body(self.case.rod)
        if not (older.has_other_nodes(self.provenance) and len(today.cells)):
            return today
        first = self._fields(0, ("position", "displacement"))
        return older.body(today, first["position"].values - first["displacement"].values)

    @functools.cached_property
    def columns(self) -> dict[str, NDArray[np.float64]]:
        """The history, one entry per row of each column, by name."""
        try:
            columns = history_file.read(self._file(history_file.NAME, LARGEST_HISTORY))
        except (OSError, ValueError, csv.Error) as error:
            raise self._unreadable(history_file.NAME, error) from None
        time = columns.get("time", np.empty(0))
        if self.is_older:
            columns = older.quantities(columns, np.full(len(time), np.nan))
        whole = not set(UNITS) - set(columns) and len(time) > 0 and bool((np.diff(time) > 0.0).all())
        if not whole or (self.rows and not time[-1] >= self.rows[-1].time):
            raise self._unreadable(history_file.NAME, "a part of it is missing")
        return columns

    @functools.cached_property
    def history(self) -> "pandas.DataFrame":
        """The history, one line per row, columns by name; ``history.attrs["units"]`` has their units."""
        import pandas

        table = pandas.DataFrame(self.columns)
        table.attrs["units"] = dict(UNITS)
        return table

    @functools.cached_property
    def times(self) -> NDArray[np.float64]:
        """The times of the snapshots [ms]."""
        name = older_fields.NAME if self.is_older else field_files.INDEX
        try:
            return older_fields.times(self._file(name)) if self.is_older else field_files.times(self.folder)
        except FileNotFoundError:
            raise self._lacks(name) from None
        except CORRUPT as error:
            raise self._unreadable(name, error) from None

    def _fields(self, number: int, only: Collection[str] | None) -> dict[str, Field]:
        """Return the fields of a snapshot, as far as they are there."""
        path = field_files.file_of(self.folder, number)
        name = older_fields.NAME if self.is_older else f"{field_files.FOLDER}/{path.name}"
        try:
            if self.is_older:
                return older_fields.read(self._file(name), number, only)
            return vtkhdf.read(kept(path.parent, path.name, LARGEST_FIELDS), only)
        except FileNotFoundError:
            raise self._lacks(name) from None
        except CORRUPT as error:
            raise self._unreadable(name, error) from None

    @checked
    def snapshot(self, time: str | int, only: Collection[str] | None = None) -> Snapshot:
        """Return the fields at a time such as "20 us", or those of a snapshot by its number (-1: the last).

        Args:
            time: which snapshot.
            only: names of the fields to read, by default all; those that the run does not have are left out.

        Raises:
            InputError: the run has no such snapshot.
        """
        number = self._number(time) if isinstance(time, str) else self._counted(time)
        fields = self._fields(number, only)
        missing = [name for name in ALWAYS if name not in fields and (only is None or name in only)]
        if missing:
            raise self._unreadable(field_files.FOLDER, f"a snapshot has no {missing[0]}")
        if any(len(field.values) != len(self.body.position) for field in fields.values() if field.on == "points"):
            raise self._unreadable(field_files.FOLDER, f"points of a snapshot are not those of {CASE}")
        return Snapshot(float(self.times[number]), fields)

    @checked
    def profile(self, snapshot: Snapshot) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the outline, height and radius of each layer of material from the foot up [mm]."""
        position = np.where(snapshot["lost"][:, None] > 0, np.nan, snapshot["position"])
        return profile(self.body.surface, position)

    def _counted(self, number: int) -> int:
        try:
            return range(len(self.times))[number]
        except (IndexError, TypeError):
            count = len(self.times)
            raise InputError(
                f'{self.place}: no snapshot {number!r}; give a number below {count}, or a time such as "20 us"'
            ) from None

    def _number(self, text: str) -> int:
        try:
            time = parse(text, "ms")
        except ValueError as error:
            raise InputError(f'snapshot "{text}" {error}; write a time such as "20 us"') from None
        apart = np.abs(self.times - time)
        number = int(apart.argmin())
        shown = [f"{instant * 1e3:g} us" for instant in self.times]
        if apart[number] <= NEAR * self.times[-1] or math.isclose(time, parse(shown[number], "ms"), rel_tol=1e-12):
            return number
        there = ", ".join(shown)
        raise InputError(f'{self.place}: no snapshot at "{text}"; there are {there}')

    def _file(self, name: str, most: int = LARGEST_FIELDS) -> Path:
        try:
            return kept(self.folder, name, most)
        except (FileNotFoundError, NotADirectoryError):
            raise self._lacks(name) from None
        except (OSError, ValueError) as error:
            raise self._unreadable(name, error) from None

    def _lacks(self, name: str) -> InputError:
        return InputError(f"run folder {self.folder}: has no {name}; it is not the folder of a run, or not whole")

    def _unreadable(self, name: str, error: Exception | str) -> InputError:
        return InputError(f"run folder {self.folder}: {name} cannot be read ({error})")

    def _json(self, name: str, most: int) -> dict[str, Any]:
        path = self._file(name, most)
        try:
            return table(contents(path, most))
        except (OSError, ValueError) as error:
            raise self._unreadable(name, error) from None
