"""HDF5 files from others, trusted with nothing.

HDF5 would read any file of this machine for whoever wrote one that came by mail, and take memory and time without end:
by links and datasets that lie elsewhere, groups within groups, sizes that no data stands behind, and pieces that grow
to more than they are said to hold. A file is used only if it has none of them.
"""

import contextlib
import io
import math
import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
from h5py import h5d, h5g, h5i, h5l, h5o, h5t, h5z  # pyright: ignore[reportAttributeAccessIssue]  (compiled)
from numpy.typing import NDArray

LAYOUT = ("v110", "v110")  # the first with checksums of all that is not data
FILTERS: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True, "fletcher32": True}
KNOWN_FILTERS = {h5z.FILTER_DEFLATE, h5z.FILTER_SHUFFLE, h5z.FILTER_FLETCHER32}
CHECKSUM = 4  # bytes of it with each piece
EXPANSION = 1100  # gzip makes nothing smaller than by 1032
HARMLESS = 2**26  # bytes: a piece that cannot become larger need not be looked into
NUMBERS = (h5t.INTEGER, h5t.FLOAT)
MOST_NAMES, DEEPEST = 1000, 3  # in a file; groups within groups


class _Patient(io.FileIO):
    """A file to write, for HDF5, which does not survive an error: it is told nothing of it."""

    error: OSError | None = None

    def write(self, data: Any) -> int:
        view = rest = memoryview(data).cast("B")
        try:
            while rest and self.error is None:
                rest = rest[super().write(rest) :]
        except OSError as error:
            self.error = error
        return len(view)

    def truncate(self, size: int | None = None) -> int:
        try:
            return super().truncate(size) if self.error is None else self.tell()
        except OSError as error:
            self.error = error
            return self.tell()

    def readinto(self, buffer: Any) -> int:
        view = memoryview(buffer).cast("B")
        got = super().readinto(view) or 0
        view[got:] = bytes(len(view) - got)  # never written
        return len(view)


@contextlib.contextmanager
def written(path: Path) -> Iterator[Any]:
    """Make a file and open it to write; afterwards it is on the disk.

    Raises:
        OSError: it could not be written.
    """
    with _Patient(path, "w+") as raw:
        with h5py.File(raw, "w", libver=LAYOUT) as file:
            yield file
        if raw.error is not None:
            raise raw.error
        os.fsync(raw.fileno())


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Open a file to read it; h5py's types say of no name in it what it is.

    Raises:
        OSError: it is no HDF5.
        ValueError: it holds what is not its own.
    """
    with path.open("rb", buffering=0) as raw, h5py.File(raw, "r") as file:
        _check(file, os.fstat(raw.fileno()).st_size)
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
