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
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import numba
import platformdirs
from numba.core import config
from numba.extending import overload, register_jitable

from viscopoint.sources import digest

F = TypeVar("F", bound=Callable[..., Any])

# Fused multiply-add is the one liberty taken with IEEE arithmetic: sums keep their order, so that results do not
# depend on the thread count. Division by zero gives inf or nan, which the guards report, not a branch at each "/".
OPTIONS: Any = {"fastmath": {"contract", "arcp"}, "error_model": "numpy"}
INLINED: Any = {**OPTIONS, "forceinline": True}  # tensors stay in registers


@functools.cache
def cache_folder() -> Path:
    """Return the folder of compiled kernels, named after a hash of the sources.

    Numba looks only at a kernel's own file to decide whether its cached code is stale; a law in another file
    would be run stale after an edit. A folder per state of the sources cannot be.
    """
    name = f"kernels-{digest()}"
    for parent in (platformdirs.user_cache_path("viscopoint"), Path(tempfile.gettempdir(), "viscopoint")):
        with contextlib.suppress(OSError):
            (parent / name).mkdir(parents=True, exist_ok=True)
            return parent / name
    return Path(tempfile.mkdtemp(prefix="viscopoint-"))


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
    with _own_cache():
        return numba.njit(parallel=parallel, nogil=True, cache=True, **OPTIONS)(function)


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
