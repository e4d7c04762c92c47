"""Compiled code on the disk: one file for each kernel and each combination of types it was compiled for.

Numba's own files of code go stale by the line numbers and the text of the file in which a kernel stands, and two
processes that compile one kernel at once can list one file for both. Here the folder says what the code was made of
(``cache_folder``) and the file's name what it is: it is never stale, and whoever writes it writes the same.
"""

import contextlib
import hashlib
import os
import pickle
import secrets
from pathlib import Path
from typing import Any

from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from viscopoint.kernels import outside
from viscopoint.kernels.cache_folder import cache_folder
from viscopoint.kernels.launcher import start_threads

DAMAGED = (OSError, EOFError, ValueError, KeyError, IndexError, AttributeError, TypeError, pickle.UnpicklingError)


class Cache(NullCache):
    """The files of one kernel; a full disk is no hindrance."""

    def __init__(self, function: Any, with_outside: bool = False) -> None:
        """Take the files of a function; ``with_outside`` says that it runs code from outside the package."""
        self._name = f"{function.__module__}.{function.__qualname__}"
        self._outside = with_outside or outside.is_outside(function)

    @property
    def cache_path(self) -> str:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The folder, for Numba's statistics."""
        return str(cache_folder())

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return compiled code, if it is there and made of the package's sources alone."""
        file = self._file(sig)
        if file is None or not file.exists():
            return None
        target_context.refresh()
        start_threads()  # whose functions the code calls
        try:
            return CompileResult._rebuild(target_context, *pickle.loads(file.read_bytes()))
        except DAMAGED:
            return None

    def save_overload(self, sig: Any, cres: Any) -> None:
        """Keep compiled code, if it is made of the package's sources alone."""
        file = self._file(sig)
        if file is None:
            return
        part = file.with_suffix(f".{secrets.token_hex(4)}.part")
        with contextlib.suppress(OSError):
            try:
                with os.fdopen(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600), "wb") as stream:
                    stream.write(dumps(cres._reduce()))
                part.replace(file)
            finally:
                part.unlink(missing_ok=True)

    def _file(self, sig: Any) -> Path | None:
        """Return where the code for some types is kept; None if other sources than the package's are part of it."""
        kinds = sig if isinstance(sig, tuple) else sig.args
        if self._outside or outside.takes_part(kinds):
            return None
        key = hashlib.sha256("; ".join(map(words, kinds)).encode()).hexdigest()[:16]
        return cache_folder() / f"{self._name}-{key}.code"


def words(kind: Any) -> str:
    """Return the name of one of Numba's types; classes, which may share names, by their modules too."""
    subject = getattr(kind, "instance_class", None)
    own = f"{subject.__module__}.{subject.__qualname__}{getattr(subject, '_fields', '')}" if subject else str(kind)
    parts = getattr(kind, "types", ())
    return f"{own}({', '.join(map(words, parts))})" if isinstance(parts, tuple) else own
