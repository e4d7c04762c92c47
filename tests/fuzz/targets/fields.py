"""Fields of a run folder from others: the files of snapshots, which HDF5 reads, and their index.

Bytes are edited, which checksums mostly find; and what a sound file holds, its checksums right.
"""

import contextlib
import io
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from choices import Choices, chance, one_of
from edits import edited

from viscopoint.results.output.fields import INDEX, file_of
from viscopoint.results.reader import CORRUPT
from viscopoint.results.run import Run

MODULES = (
    "viscopoint.errors", "viscopoint.results.hdf5", "viscopoint.results.vtkhdf", "viscopoint.results.output.fields",
    "viscopoint.results.reader",
)  # fmt: skip
PIECES = (b'"time": 1e400, ', b'"name": "../outside/canary.toml", ', b'"files": [{}], ', b"[" * 500)
HEAD = 30_000  # bytes at the beginning that describe the rest; most damage is done there


class Target:
    """A finished run with damaged fields."""

    def __init__(self, folder: Path, seeds: Path | None) -> None:
        assert seeds is not None, "give a finished run by --seeds"
        self.folder = folder / "run"
        shutil.copytree(seeds, self.folder)
        self.file, self.index = file_of(self.folder, 0), self.folder / INDEX
        self.whole, self.listed = self.file.read_bytes(), self.index.read_bytes()
        self.names: list[str] = []
        with h5py.File(self.file, "r") as file:
            file.visit(self.names.append)
        self.body = Run(self.folder).body
        self.check()

    def lay(self, choices: Choices) -> str:
        self.index.write_bytes(edited(choices, self.listed, PIECES) if chance(choices, 10) else self.listed)
        if chance(choices, 40):
            content, told = _restructured(choices, self.whole, self.names)
            self.file.write_bytes(content)
            return told
        head, rest = self.whole[:HEAD], self.whole[HEAD:]
        if chance(choices, 30):
            rest = edited(choices, rest, most=2)
        head = edited(choices, head)
        self.file.write_bytes(head + rest)
        return f"{len(head)} + {len(rest)} bytes"

    def check(self) -> None:
        run = Run(self.folder)
        run.body = self.body
        for number in range(min(len(run.times), 3)):
            run.profile(run.snapshot(number))


def _restructured(choices: Choices, content: bytes, names: list[str]) -> tuple[bytes, str]:
    """Change some of what a file holds, by way of HDF5, which may fail as it closes it; return it and what was done."""
    told, memory = [], io.BytesIO(content)
    with contextlib.suppress(*CORRUPT), h5py.File(memory, "r+") as file:
        for _ in range(choices.integer(1, 3)):
            name, change = one_of(choices, names), one_of(choices, CHANGES)
            told.append(f"{change.__name__} {name}")
            with contextlib.suppress(*CORRUPT):  # what is gone, or cannot be so
                change(choices, file, name)
    return memory.getvalue(), ", ".join(told)


def _remove(choices: Choices, file: Any, name: str) -> None:
    del file[name]


def _overwrite(choices: Choices, file: Any, name: str) -> None:
    if file[name].size < MOST:
        file[name][...] = one_of(choices, WILD)


def _resize(choices: Choices, file: Any, name: str) -> None:
    file[name].resize(one_of(choices, SIZES), axis=0)


def _count(choices: Choices, file: Any, name: str) -> None:
    file["VTKHDF/NumberOfPoints"][...] = one_of(choices, WILD)


def _rename_unit(choices: Choices, file: Any, name: str) -> None:
    file[name].attrs["unit"] = one_of(choices, ("MPa", np.bytes_(b"\xff\x1b[2J"), 3, [1.0, 2.0]))


def _exchange(choices: Choices, file: Any, name: str) -> None:
    shape = tuple(one_of(choices, SIZES) for _ in range(choices.integer(0, 3)))
    del file[name]
    if shape and chance(choices, 50):
        pieces = tuple(max(min(size, 100), 1) for size in shape)
        file.create_dataset(name, shape, one_of(choices, TYPES), chunks=pieces, compression=one_of(choices, (None, 1)))
    else:
        file.create_dataset(name, shape, one_of(choices, TYPES))


def _link(choices: Choices, file: Any, name: str) -> None:
    links = (file, h5py.SoftLink("/"), h5py.SoftLink(name), h5py.ExternalLink("/etc/passwd", "/"))
    del file[name]
    file[name] = one_of(choices, links)


def _nest(choices: Choices, file: Any, name: str) -> None:
    del file[name]
    file.create_group("/".join([name, *one_of(choices, ([], ["g"] * 5, ["g"] * 200))]))


WILD = (0, 1, -1, 3, 10**9, 2**62, -(2**62), np.nan, np.inf, 1e308)
MOST = 10**6  # numbers to write
SIZES = (0, 1, 2, 3, 1000, 10**6, 2**40)
TYPES = ("f8", "f4", "i8", "u1", "S5", "c16", "i2,f8", "O")
CHANGES: tuple[Callable[[Choices, Any, str], None], ...] = (
    _remove, _overwrite, _resize, _count, _rename_unit, _exchange, _link, _nest,
)  # fmt: skip
