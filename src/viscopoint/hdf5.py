"""HDF5 files, changed as a whole or not at all (``transaction``), and trusted with nothing.

HDF5 would read any file of this machine for whoever wrote one that came by mail, and take memory without end: by links
and datasets that lie elsewhere, and by sizes that no data stands behind. A file is used only if it has none of them.
"""

import contextlib
import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
from h5py import h5d, h5i, h5l, h5o, h5t  # pyright: ignore[reportAttributeAccessIssue]  (compiled)

from viscopoint.transaction import change, reading

LAYOUT = ("v110", "v110")  # the first with checksums of all that is not data
EXPANSION = 1100  # gzip makes nothing smaller than by 1032
NUMBERS = (h5t.INTEGER, h5t.FLOAT)


@contextlib.contextmanager
def changed(path: Path) -> Iterator[Any]:
    """Open a file to change it, made if it is not there; h5py's types say of no name in it what it is.

    Raises:
        OSError: it could not be written, or is no HDF5; it is as it was.
        ValueError: it holds what is not its own.
    """
    with change(path) as overlay, h5py.File(overlay, "r+" if overlay.size else "w", libver=LAYOUT) as file:
        _check(file, overlay.size)
        yield file


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Open a file to read it; raises as ``changed`` does."""
    with reading(path) as raw, h5py.File(raw, "r") as file:
        _check(file, raw.seek(0, os.SEEK_END))
        yield file


def _check(file: Any, size: int) -> None:
    """Raise ``ValueError`` unless a file of some bytes itself holds all that it offers."""
    links: list[tuple[bytes, int]] = []
    file.id.links.visit(lambda name, link: links.append((name, link.type)), info=True)
    for name, kind in links:
        if kind != h5l.TYPE_HARD:
            raise ValueError(f"{name!r} lies elsewhere")
        entry = h5o.open(file.id, name)
        if isinstance(entry, h5d.DatasetID):
            _check_dataset(entry, size)


def _check_dataset(dataset: Any, size: int) -> None:
    created = dataset.get_create_plist()
    layout = created.get_layout()
    if layout == h5d.VIRTUAL or created.get_external_count():
        raise ValueError(f"{h5i.get_name(dataset)!r} lies elsewhere")
    if dataset.get_type().get_class() not in NUMBERS:
        raise ValueError(f"{h5i.get_name(dataset)!r} holds no numbers")
    parts = created.get_chunk() if layout == h5d.CHUNKED else ()
    if max(math.prod(dataset.shape), math.prod(parts)) * dataset.dtype.itemsize > EXPANSION * size:
        raise ValueError(f"{h5i.get_name(dataset)!r} holds more than can be in the file")
