"""Changes to a large file that happen as a whole or not at all, whenever the process is killed or the disk fills up.

New data goes behind the file's end, where nobody looks yet. What is to change before it is kept in memory and, once all
is there, written to a journal beside the file: from then on the change has happened, and whoever opens the file next
sees it, by applying the journal again if need be. So a change costs its own size, however long the file is.
"""

import contextlib
import hashlib
import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from viscopoint.results.folder import sync, whole

PAGE = 4096  # bytes
MAGIC = b"viscopoint journal\n"
NUMBER = np.dtype("<u8")
HEAD = 3  # numbers before those of the pages: sizes before and after the change, how many pages


class Overlay(io.RawIOBase):
    """A file as it will be: pages of it that changed are in memory. HDF5 reads and writes it through h5py."""

    def __init__(self, file: BinaryIO) -> None:
        self.file = file
        self.end = self.size = file.seek(0, os.SEEK_END)  # before the change; at present
        self.pages: dict[int, bytearray] = {}  # by their number
        self.place = 0
        self.error: OSError | None = None  # HDF5 does not survive one: it is told nothing, and the change is given up

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self.place, os.SEEK_END: self.size}[whence]
        self.place = base + offset
        return self.place

    def tell(self) -> int:
        return self.place

    def readinto(self, buffer: Any) -> int:
        view = memoryview(buffer).cast("B")
        count = max(min(len(view), self.size - self.place), 0)
        self.file.seek(self.place)
        got = self.file.readinto(view[:count])  # pyright: ignore[reportAttributeAccessIssue]  (a raw file)
        view[got:count] = bytes(count - got)  # given up there, or not yet written
        for number in _pages(self.place, count):
            if number in self.pages:
                _copy(memoryview(self.pages[number]), number * PAGE, view[:count], self.place)
        self.place += count
        return count

    def write(self, data: Any) -> int:
        view = memoryview(data).cast("B")
        count = len(view)
        inside = max(min(count, self.end - self.place), 0)
        for number in _pages(self.place, inside):
            _copy(view[:inside], self.place, memoryview(self._page(number)), number * PAGE)
        if inside < count and self.error is None:
            try:
                self.file.seek(self.place + inside)
                _write_all(self.file, view[inside:])
            except OSError as error:
                self.error = error
        self.place += count
        self.size = max(self.size, self.place)
        return count

    def truncate(self, size: int | None = None) -> int:
        self.size = self.place if size is None else size
        return self.size

    def _page(self, number: int) -> bytearray:
        if number not in self.pages:
            self.file.seek(number * PAGE)
            self.pages[number] = bytearray(self.file.read(min(PAGE, self.end - number * PAGE)))
        return self.pages[number]


@contextlib.contextmanager
def change(path: Path) -> Iterator[Overlay]:
    """Yield a file to change, made if it is not there; the change happens as the block ends, or not at all.

    Raises:
        OSError: it could not be written; it is as it was.
    """
    complete(path)
    with path.open("r+b" if path.exists() else "x+b", buffering=0) as file:
        overlay = Overlay(file)
        try:
            yield overlay
            if overlay.error is not None:
                raise overlay.error
            file.truncate(max(overlay.size, overlay.end))
            os.fsync(file.fileno())
            _write_journal(_journal(path), overlay)
        except BaseException:
            with contextlib.suppress(OSError):
                file.truncate(overlay.end)
            raise
        _apply(file, overlay)
    _journal(path).unlink()


@contextlib.contextmanager
def reading(path: Path) -> Iterator[BinaryIO]:
    """Yield a file to read, as it is after the last change that happened."""
    with path.open("rb", buffering=0) as file:
        overlay = Overlay(file)
        yield overlay if _read_journal(_journal(path), overlay) else file  # pyright: ignore[reportReturnType]


def complete(path: Path) -> None:
    """Apply a change that happened but was not yet applied when the process was killed."""
    if not path.exists():
        return
    with path.open("r+b", buffering=0) as file:
        overlay = Overlay(file)
        if _read_journal(_journal(path), overlay):
            _apply(file, overlay)
    _journal(path).unlink(missing_ok=True)


def _apply(file: BinaryIO, overlay: Overlay) -> None:
    for number, page in overlay.pages.items():
        file.seek(number * PAGE)
        _write_all(file, memoryview(page))
    file.truncate(overlay.size)
    os.fsync(file.fileno())


def _journal(path: Path) -> Path:
    return path.with_name(f".{path.name}.journal")


def _write_journal(path: Path, overlay: Overlay) -> None:
    pages = {number: page for number, page in overlay.pages.items() if number * PAGE < overlay.size}
    numbers = np.array([overlay.end, overlay.size, len(pages), *pages], NUMBER).tobytes()
    content = b"".join([numbers, *(bytes(page).ljust(PAGE, b"\0") for page in pages.values())])
    with whole(path) as part, part.open("wb") as file:
        file.write(MAGIC + hashlib.sha256(content).digest() + content)
        sync(file)


def _read_journal(path: Path, overlay: Overlay) -> bool:
    """Take over the pages of a journal, if there is a whole one."""
    present = overlay.end
    if path.is_symlink() or not path.is_file() or path.stat().st_size > 2 * present + 2 * PAGE:
        return False
    data = path.read_bytes()
    head = len(MAGIC) + hashlib.sha256().digest_size
    content = memoryview(data)[head:]
    if data[:head] != MAGIC + hashlib.sha256(content).digest() or len(content) < HEAD * NUMBER.itemsize:
        return False
    end, size, count = (int(number) for number in np.frombuffer(content, NUMBER, HEAD))
    begin = (HEAD + count) * NUMBER.itemsize
    if len(content) != begin + count * PAGE or size > present:
        return False
    numbers = np.frombuffer(content, NUMBER, count, HEAD * NUMBER.itemsize).tolist()
    if any(number * PAGE >= min(end, size) for number in numbers):
        return False
    overlay.size = size
    for place, number in enumerate(numbers):
        page = content[begin + place * PAGE :][: min(PAGE, end - number * PAGE)]
        overlay.pages[number] = bytearray(page)
    return True


def _pages(place: int, count: int) -> range:
    return range(place // PAGE, -(-(place + count) // PAGE)) if count else range(0)


def _copy(source: memoryview, from_place: int, target: memoryview, to_place: int) -> None:
    """Copy what two pieces of a file, that begin at these places, have in common."""
    begin = max(from_place, to_place)
    end = min(from_place + len(source), to_place + len(target))
    if begin < end:
        target[begin - to_place : end - to_place] = source[begin - from_place : end - from_place]


def _write_all(file: BinaryIO, view: memoryview) -> None:
    while len(view):
        view = view[file.write(view) :]
