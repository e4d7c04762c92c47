"""How kernels are compiled, cached and dispatched.

A few decorators cover every compiled function of the package:

- ``kernel`` (and ``serial_kernel``): a loop over points or nodes, compiled once per combination of argument types and
  kept on disk; NamedTuples go in as arguments, where Numba can hand them to threads;
- ``inline``: a small scalar function that kernels call, and that plain Python can call too;
- ``generic``: an operation (``update_stress``, ``stencil``, ...) with one implementation per NamedTuple class, chosen
  by type at compile time, so that a law or a shape function is added by writing one file.
"""

import contextlib
import functools
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import numba
import platformdirs
from filelock import FileLock
from numba.core import config
from numba.core.caching import FunctionCache
from numba.extending import overload, register_jitable

from viscopoint.sources import digest

F = TypeVar("F", bound=Callable[..., Any])

# Threads that wait for the slowest sleep. By default they spin, and where another process works on the same cores each
# of the dozen waits in a step lasts as long as the system's time slice: steps took a hundred times longer.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

# x / c as x (1 / c) is the one liberty taken with IEEE arithmetic: sums keep their order, so that results do not depend
# on the thread count, and what is fused is written down (``values.fma``). Division by zero gives inf or nan, which the
# guards report, not a branch at each "/".
OPTIONS: Any = {"fastmath": {"arcp"}, "error_model": "numpy"}
INLINED: Any = {**OPTIONS, "forceinline": True}  # tensors stay in registers
UNUSED = 30 * 24 * 3600.0  # s after which compiled code of other sources is removed
PATIENCE = 10.0  # s to wait for another process that writes compiled code; without it a kernel is compiled again


@functools.cache
def cache_folder() -> Path:
    """Return the folder of compiled kernels, named after a hash of the sources.

    Numba looks only at a kernel's own file to decide whether its cached code is stale; a law in another file
    would be run stale after an edit. A folder per state of the sources cannot be. It is in the folder that the
    environment variable ``VISCOPOINT_CACHE`` names, else in the user's cache folder; where neither can be written, in
    that of temporary files.
    """
    name = f"kernels-{digest()}"
    given = os.environ.get("VISCOPOINT_CACHE")
    usual = platformdirs.user_cache_path("viscopoint")
    for parent in (*([Path(given)] if given else []), usual, Path(tempfile.gettempdir(), f"viscopoint-{_user()}")):
        with contextlib.suppress(OSError):
            folder = parent / name
            if not folder.is_dir():
                _forget_unused(parent)
                folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                os.utime(folder)  # used today
            return folder
    return Path(tempfile.mkdtemp(prefix="viscopoint-"))


def _user() -> str:
    """Return who we are, as far as anyone can tell: what another user left in a common folder is never run."""
    return str(os.getuid()) if hasattr(os, "getuid") else "cache"


def _forget_unused(parent: Path) -> None:
    """Remove the kernels of states of the sources that nobody ran for long."""
    for folder in parent.glob("kernels-" + 16 * "[0-9a-f]"):
        with contextlib.suppress(OSError):
            if time.time() - folder.stat().st_mtime > UNUSED:
                shutil.rmtree(folder)


class _Cache(FunctionCache):
    """Numba's cache of one kernel, safe when processes write at once, and no hindrance when the disk is full.

    Numba takes the next free number for a file of code, lists it and then writes it: two processes that compile a
    kernel for different arguments at once could list one number for both.
    """

    def save_overload(self, sig: Any, data: Any) -> None:
        with contextlib.suppress(OSError), FileLock(cache_folder() / ".lock", timeout=PATIENCE):
            super().save_overload(sig, data)


@contextlib.contextmanager
def _own_cache() -> Iterator[None]:
    """Point Numba at our cache folder, only while one of our kernels is being declared."""
    settings: Any = config
    previous = settings.CACHE_DIR
    settings.CACHE_DIR = str(cache_folder())
    try:
        yield
    finally:
        settings.CACHE_DIR = previous


def kernel(function: F) -> F:
    """Compile a loop with threads over ``prange`` and keep the machine code on disk.

    An array that the loop writes must have a name of its own before the loop: Numba drops stores through the
    attribute of a NamedTuple inside ``prange`` (numba issues 5872, 7135, 10338).
    """
    return _compiled(function, parallel=True)


def serial_kernel(function: F) -> F:
    """Compile a loop too short for threads and keep the machine code on disk."""
    return _compiled(function, parallel=False)


def _compiled(function: Any, parallel: bool) -> Any:
    dispatcher: Any = numba.njit(parallel=parallel, nogil=True, **OPTIONS)(function)
    with _own_cache():
        dispatcher._cache = _Cache(function)  # what cache=True does, with a cache of our own
    return dispatcher


def inline(function: F) -> F:
    """Let kernels call a scalar function; from Python it runs as it is written."""
    return register_jitable(**INLINED)(function)


def generic(declaration: Callable[..., Any]) -> Any:
    """Declare an operation that dispatches on the class of its first argument, a NamedTuple.

    ``@implements(operation, Class)`` adds an implementation. In Python the call is looked up at run time; in a
    kernel it is resolved when the kernel is compiled and costs nothing.
    """
    table: dict[type, Callable[..., Any]] = {}

    @functools.wraps(declaration)
    def operation(subject: Any, *arguments: Any) -> Any:
        return table[type(subject)](subject, *arguments)

    @overload(operation, strict=False, jit_options=INLINED)
    def resolve(subject: Any, *arguments: Any) -> Callable[..., Any] | None:
        return table.get(getattr(subject, "instance_class", type(None)))

    operation.implementations = table  # pyright: ignore[reportAttributeAccessIssue]
    return operation


def implements(operation: Any, subject: type) -> Callable[[F], F]:
    """Register the decorated function as what ``operation`` does for ``subject``."""

    def register(function: F) -> F:
        operation.implementations[subject] = function
        return function

    return register
