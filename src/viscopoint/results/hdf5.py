"""HDF5 files, changed as a whole or not at all (``transaction``), and trusted with nothing.

HDF5 would read any file of this machine for whoever wrote one that came by mail, and take memory and time without end:
by links and datasets that lie elsewhere, groups within groups, sizes that no data stands behind, and pieces that grow
to more than they are said to hold. A file is used only if it has none of them.
"""

import contextlib
import math
import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
from h5py import h5d, h5g, h5i, h5l, h5o, h5t, h5z  # pyright: ignore[reportAttributeAccessIssue]  (compiled)
from numpy.typing import NDArray

from viscopoint.results.transaction import change, reading

LAYOUT = ("v110", "v110")  # the first with checksums of all that is not data
FILTERS: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True, "fletcher32": True}
KNOWN_FILTERS = {h5z.FILTER_DEFLATE, h5z.FILTER_SHUFFLE, h5z.FILTER_FLETCHER32}
CHECKSUM = 4  # bytes of it with each piece
EXPANSION = 1100  # gzip makes nothing smaller than by 1032
HARMLESS = 2**26  # bytes: a piece that cannot become larger need not be looked into
NUMBERS = (h5t.INTEGER, h5t.FLOAT)
MOST_NAMES, DEEPEST = 1000, 3  # in a file; groups within groups


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


def rows(dataset: Any, start: int, stop: int) -> NDArray[Any]:
    """Read rows of a dataset; raise ``ValueError`` if they are not what they are said to be."""
    check_pieces(dataset, start, stop)
    return dataset[start:stop]


def check_pieces(dataset: Any, start: int, stop: int) -> None:
    """Raise ``ValueError`` if a compressed piece with some of these rows grows to more than its size."""
    if dataset.compression is None:
        return
    length, *width = dataset.chunks
    if tuple(width) != dataset.shape[1:]:
        raise ValueError(f"{dataset.name} is in pieces of another shape")
    most = math.prod(dataset.chunks) * dataset.dtype.itemsize + CHECKSUM
    for row in range(start // length * length, min(stop, len(dataset)), length):
        place = (row, *(0 for _ in width))
        if dataset.id.get_chunk_info_by_coord(place).size > 2 * most:
            raise ValueError(f"{dataset.name} has a piece too large")
        _, piece = dataset.id.read_direct_chunk(place)
        if len(piece) * EXPANSION > max(most, HARMLESS) and not _unpacks_to(piece, most):
            raise ValueError(f"{dataset.name} has a piece that grows, or is damaged")


def _unpacks_to(piece: bytes, most: int) -> bool:
    """Return whether gzip finds so many bytes in a piece at most."""
    try:
        return len(zlib.decompressobj().decompress(piece, most + 1)) <= most
    except zlib.error:
        return False


def _check(file: Any, size: int) -> None:
    """Raise ``ValueError`` unless a file of some bytes itself holds all that it offers."""
    groups, names = [(file.id, 0)], 0
    while groups:
        group, depth = groups.pop()
        names += group.get_num_objs()
        if names > MOST_NAMES or depth > DEEPEST:
            raise ValueError("it holds more groups than any of ours")
        for name in group:
            if group.links.get_info(name).type != h5l.TYPE_HARD:
                raise ValueError(f"{name!r} lies elsewhere")
            entry = h5o.open(group, name)
            if isinstance(entry, h5g.GroupID):
                groups.append((entry, depth + 1))
            elif isinstance(entry, h5d.DatasetID):
                _check_dataset(entry, size)


def _check_dataset(dataset: Any, size: int) -> None:
    created = dataset.get_create_plist()
    name, layout = h5i.get_name(dataset), created.get_layout()
    filters = [created.get_filter(number)[0] for number in range(created.get_nfilters())]
    if layout == h5d.VIRTUAL or created.get_external_count():
        raise ValueError(f"{name!r} lies elsewhere")
    if dataset.get_type().get_class() not in NUMBERS:
        raise ValueError(f"{name!r} holds no numbers")
    if len(filters) > len(set(filters)) or not KNOWN_FILTERS.issuperset(filters):
        raise ValueError(f"{name!r} is compressed as none of ours")
    pieces = created.get_chunk() if layout == h5d.CHUNKED else ()
    if max(math.prod(dataset.shape), math.prod(pieces)) * dataset.dtype.itemsize > EXPANSION * size:
        raise ValueError(f"{name!r} holds more than can be in the file")
