"""The state of the package's sources, as far as it can change compiled code or a result."""

import functools
import hashlib
import secrets
from collections.abc import Iterator
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType

# These only read run folders, or time what others compute: neither compiled code nor results depend on them.
READERS = ("command_line", "figures", "comparison", "reproduction", "report", "bench")

# Kernels are made of these. Only those of ``kernels`` put code together from texts; elsewhere a text of more than one
# word is a message or a docstring.
NUMERICS = ("kernels", "materials", "model", "interactions", "methods", "bench/triad.py")
PACKAGE = Path(__file__).parents[1]


def _written() -> dict[Path, int]:
    """Return when each file of the package was written [ns]."""
    return {source: source.stat().st_mtime_ns for source in sorted(PACKAGE.rglob("*.py"))}


_IMPORTED = _written()  # as Python took them in


def _edited() -> bytes:
    """Return nothing, or what no other process has, if a file was edited since this process began: it runs the old."""
    return b"" if _written() == _IMPORTED else secrets.token_bytes(8)


@functools.cache
def numerics() -> str:
    """Return a hash of what compiled code is made of: Python's code of the numerics, without lines and messages."""
    result = hashlib.sha256(_edited())
    for part in NUMERICS:
        place = PACKAGE / part
        for source in [place] if place.is_file() else sorted(place.rglob("*.py")):
            name = str(source.relative_to(PACKAGE))
            code = SourceFileLoader(name, str(source)).get_code(name)
            assert code is not None
            result.update(name.encode())
            for said in _said(code, texts=part == "kernels"):
                result.update(said)
    return result.hexdigest()[:16]


def _said(code: CodeType, texts: bool) -> Iterator[bytes]:
    """Yield all that code does, with what its texts say or without."""
    yield code.co_code
    yield repr((code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars, code.co_flags)).encode()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _said(constant, texts)
        elif not isinstance(constant, str) or texts or constant.isidentifier():
            yield repr(sorted(constant) if isinstance(constant, frozenset) else constant).encode()
        else:
            yield b"a text"


@functools.cache
def digest() -> str:
    """Return a hash of the sources that compute and write results."""
    result = hashlib.sha256(_edited())
    for source in sorted(PACKAGE.rglob("*.py")):
        place = source.relative_to(PACKAGE)
        if place.parts[0] not in READERS:
            result.update(str(place).encode())
            result.update(source.read_bytes())
    return result.hexdigest()[:16]
