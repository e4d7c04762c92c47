"""The state of the package's sources, as far as it can change compiled code or a result."""

import functools
import hashlib
from collections.abc import Iterator
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType

# These only read run folders, or time what others compute: neither compiled code nor results depend on them.
READERS = ("command_line", "figures", "comparison", "reproduction", "report", "bench")

# Kernels are made of these. Only those of ``kernels`` put code together from texts; elsewhere a text is a message.
NUMERICS = ("kernels", "materials", "model", "interactions", "methods")


@functools.cache
def numerics() -> str:
    """Return a hash of what compiled code is made of: Python's code of the numerics, without lines and messages."""
    package = Path(__file__).parents[1]
    result = hashlib.sha256()
    for folder in NUMERICS:
        for source in sorted((package / folder).rglob("*.py")):
            name = str(source.relative_to(package))
            code = SourceFileLoader(name, str(source)).get_code(name)
            assert code is not None
            result.update(name.encode())
            for part in _said(code, texts=folder == "kernels"):
                result.update(part)
    return result.hexdigest()[:16]


def _said(code: CodeType, texts: bool) -> Iterator[bytes]:
    """Yield all that code does, with what its texts say or without."""
    yield code.co_code
    yield repr((code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars, code.co_flags)).encode()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _said(constant, texts)
        elif texts or not isinstance(constant, str):
            yield repr(sorted(constant) if isinstance(constant, frozenset) else constant).encode()


@functools.cache
def digest() -> str:
    """Return a hash of the sources that compute and write results."""
    package = Path(__file__).parents[1]
    result = hashlib.sha256()
    for source in sorted(package.rglob("*.py")):
        place = source.relative_to(package)
        if place.parts[0] not in READERS:
            result.update(str(place).encode())
            result.update(source.read_bytes())
    return result.hexdigest()[:16]
