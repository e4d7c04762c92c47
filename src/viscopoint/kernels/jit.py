"""How kernels are compiled, cached and dispatched.

A few decorators cover every compiled function of the package:

- ``kernel`` (and ``serial_kernel``): one part of a loop over points or nodes, compiled once per combination of argument
  types and kept on disk; threads share the parts (``launcher``);
- ``inline``: a small scalar function that kernels call, and that plain Python can call too;
- ``generic``: an operation (``update_stress``, ``stencil``, ...) with one implementation per NamedTuple class, chosen
  by type at compile time, so that a law or a shape function is added by writing one file.
"""

import functools
import os
import sys
from collections.abc import Callable
from typing import Any, TypeVar

import numba
import numba.np.ufunc.parallel
from numba.core import config
from numba.extending import overload, register_jitable

from viscopoint.errors import InputError, ViscopointError
from viscopoint.kernels import outside, pipeline
from viscopoint.kernels.cache import Cache
from viscopoint.kernels.launcher import launch

F = TypeVar("F", bound=Callable[..., Any])

PARTS = 24  # of the work, shared evenly if there are 1, 2, 3, 4, 6, 8, 12 or 24 threads

# Threads that wait for the slowest sleep. By default they spin, and where another process works on the same cores each
# of the dozen waits in a step lasts as long as the system's time slice: steps took a hundred times longer.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

# x / c as x (1 / c) is the one liberty taken with IEEE arithmetic: sums keep their order, so that results do not depend
# on the thread count, and what is fused is written down (``values.fma``). Division by zero gives inf or nan, which the
# guards report, not a branch at each "/".
OPTIONS: Any = {"fastmath": {"arcp"}, "error_model": "numpy"}
PART: Any = {  # of a kernel. Views of arrays are not counted: threads that count references wait for each other
    **OPTIONS, "_nrt": False, "no_cpython_wrapper": True, "no_cfunc_wrapper": True, "pipeline_class": pipeline.Part,
}  # fmt: skip
INLINED: Any = {**PART, "forceinline": True}  # tensors stay in registers
BODY: Any = {**PART, "pipeline_class": pipeline.Body}
WHOLE: Any = {**OPTIONS, "no_cfunc_wrapper": True, "pipeline_class": pipeline.Whole}


def kernel(parts: int = PARTS, colours: int = 1) -> Callable[[Callable[..., Any]], Any]:
    """Compile a function of one part of the work and let threads share the parts; keep the machine code on disk.

    The decorated function takes the part's number first, from 0 on; who calls it leaves that out and has all parts
    done: those of one colour at once, one colour after the other. It must not raise, nor make arrays.
    """

    def declare(function: Callable[..., Any]) -> Any:
        body = numba.njit(nogil=True, **BODY)(function)
        if colours == 1:

            def launch_all(*arguments: Any) -> None:
                launch(body, 0, parts, arguments)  # pyright: ignore[reportCallIssue]  (an intrinsic)

        else:

            def launch_all(*arguments: Any) -> None:
                for colour in range(colours):
                    launch(body, colour * parts, parts, arguments)  # pyright: ignore[reportCallIssue]

        return _cached(launch_all, function)

    return declare


def serial_kernel(function: F) -> F:
    """Compile a loop too short for threads and keep the machine code on disk."""
    return _cached(function, function)


def _cached(function: Any, named: Any) -> Any:
    dispatcher: Any = numba.njit(nogil=True, **WHOLE)(function)
    dispatcher._cache = Cache(named)  # what cache=True does, with a cache of our own
    return dispatcher


def check_ready() -> None:
    """Raise what to do if kernels cannot run in this process.

    Raises:
        InputError: Numba was told not to compile.
        ViscopointError: the process is a fork of one that computed on threads of GNU OpenMP, which would end it.
    """
    settings: Any = config
    if settings.DISABLE_JIT:
        raise InputError("NUMBA_DISABLE_JIT=1: kernels run compiled only; unset this environment variable")
    if _forked:
        raise ViscopointError(
            "this process was forked from one that has computed on threads, which GNU OpenMP does not survive; start "
            'processes by multiprocessing.get_context("spawn") or "forkserver"'
        )


def _note_fork() -> None:
    """Note in a forked child whether its parent, or one before, has started threads of GNU OpenMP."""
    global _forked
    started: Any = numba.np.ufunc.parallel._is_initialized  # pyright: ignore[reportAttributeAccessIssue]
    layer: Any = sys.modules.get("numba.np.ufunc.omppool")
    _forked = _forked or bool(started and layer and layer.openmp_vendor == "GNU")


_forked = False
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_note_fork)


def inline(function: F) -> F:
    """Let kernels call a scalar function; from Python it runs as it is written."""
    return register_jitable(**INLINED)(function)


def called(function: F) -> F:
    """Let kernels call a function that is too long to stand in each of them; from Python it runs as it is written."""
    return register_jitable(**PART)(function)


def generic(declaration: Callable[..., Any]) -> Any:
    """Declare an operation that dispatches on the class of its first argument, a NamedTuple.

    ``@implements(operation, Class)`` adds an implementation. In Python the call is looked up at run time; in a
    kernel it is resolved when the kernel is compiled and costs nothing.
    """
    table: dict[type, Callable[..., Any]] = {}

    @functools.wraps(declaration)
    def operation(subject: Any, *arguments: Any) -> Any:
        check_implemented(operation, subject)
        return table[type(subject)](subject, *arguments)

    @overload(operation, strict=False, jit_options=INLINED)
    def resolve(subject: Any, *arguments: Any) -> Callable[..., Any] | None:
        return table.get(getattr(subject, "instance_class", type(None)))

    operation.implementations = table  # pyright: ignore[reportAttributeAccessIssue]
    return operation


def check_implemented(operation: Any, subject: Any) -> None:
    """Raise ``TypeError`` if an operation knows nothing of a subject's class."""
    name, kind = operation.__name__, type(subject).__name__
    if type(subject) not in operation.implementations:
        raise TypeError(f"{kind} has no {name}: decorate a function with @implements({name}, {kind})")


def implements(operation: Any, subject: type) -> Callable[[F], F]:
    """Register the decorated function as what ``operation`` does for ``subject``."""

    def register(function: F) -> F:
        operation.implementations[subject] = function
        outside.note(operation, subject, function)
        return function

    return register
