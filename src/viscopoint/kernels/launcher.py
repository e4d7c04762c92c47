"""Hands the parts of a kernel's work to threads.

Numba's own parallel loops compile every kernel twice, take no nested NamedTuples, and drop stores through the
attribute of a NamedTuple (numba issues 5872, 7135, 10338). Here a kernel is a function of one part, compiled like any
other, and a few instructions that pass its arguments on to the threads that Numba has started anyway.
"""

import contextlib
import ctypes
from importlib import metadata
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.ufunc import parallel

TBB = ("libtbb.so.12", "libtbb.12.dylib", "tbb12.dll")
BYTES = ir.IntType(8).as_pointer()
SIZE = ir.IntType(64)
WORKER = ir.FunctionType(ir.VoidType(), [BYTES.as_pointer(), SIZE.as_pointer(), SIZE.as_pointer(), BYTES])


def _find_tbb() -> None:
    """Load TBB where it is installed: Numba does not look where pip puts it.

    Numba takes its threads then, if it has not started any yet. Those of OpenMP wait for each other at the end of each
    kernel, and beside a busy program a step on two of them takes two to three times as long as on one.
    """
    with contextlib.suppress(metadata.PackageNotFoundError, OSError):
        for file in metadata.files("tbb") or ():
            if file.name in TBB:
                ctypes.CDLL(str(file.locate()), mode=ctypes.RTLD_GLOBAL)


def start_threads() -> None:
    """Start Numba's threads; before that, code that calls them can be neither made nor loaded."""
    parallel._launch_threads()


_find_tbb()


@intrinsic
def launch(typing: Any, body: Any, first: Any, count: Any, arguments: Any) -> Any:
    """Call ``body(part, *arguments)`` for ``count`` parts from ``first`` on, on ``numba.get_num_threads()`` threads.

    ``numba_parallel_for`` hands a worker its parts as it would hand a ufunc its rows: the address of the first, here
    the part's own number, and how many there are. What a body raises is lost.
    """
    start_threads()
    called = body.get_call_type(typing, (types.intp, *arguments.types), {})

    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        compiled = body.dispatcher.overloads[called.args]
        context.add_linking_libs([compiled.library])
        packed = cgutils.alloca_once_value(builder, values[3])
        worker = _worker(context, builder.module, compiled.fndesc, called, values[3].type)
        begin = cgutils.alloca_once_value(builder, builder.inttoptr(values[1], BYTES))
        parts = cgutils.alloca_once_value(builder, values[2])
        step = cgutils.alloca_once_value(builder, ir.Constant(SIZE, 1))
        data = builder.bitcast(packed, BYTES)
        threads = builder.call(_function(builder, "get_num_threads", SIZE, []), [])
        with builder.if_else(builder.icmp_signed("==", threads, ir.Constant(SIZE, 1))) as (alone, together):
            with alone:
                builder.call(worker, [begin, parts, step, data])
            with together:
                share = _function(builder, "numba_parallel_for", ir.VoidType(), 5 * [BYTES] + 3 * [SIZE])
                pointers = [builder.bitcast(pointer, BYTES) for pointer in (worker, begin, parts, step)]
                builder.call(share, [*pointers, data, ir.Constant(SIZE, 0), ir.Constant(SIZE, 1), threads])
        return context.get_dummy_value()

    return types.none(body, types.intp, types.intp, arguments), lower


def _function(builder: Any, name: str, result: Any, arguments: Any) -> Any:
    return cgutils.get_or_insert_function(builder.module, ir.FunctionType(result, arguments), name)


def _worker(context: Any, module: Any, body: Any, signature: Any, packed: Any) -> Any:
    """Return a function that does ``counts[0]`` parts, of which the first is where ``rows[0]`` points."""
    worker = ir.Function(module, WORKER, module.get_unique_name(f"{body.mangled_name}.worker"))
    worker.linkage = "internal"
    builder = ir.IRBuilder(worker.append_basic_block())
    rows, counts, _, data = worker.args
    first = builder.ptrtoint(builder.load(rows), SIZE)
    arguments = cgutils.unpack_tuple(builder, builder.load(builder.bitcast(data, packed.as_pointer())))
    with cgutils.for_range(builder, builder.load(counts)) as loop:
        part = builder.add(first, loop.index)
        context.call_internal_no_propagate(builder, body, signature, [part, *arguments])
    builder.ret_void()
    return worker
