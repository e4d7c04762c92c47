"""Memory on the stack for a block of points (or elements), from which a loop works on several of them at once.

What surrounds each point is its own, so nodes are visited point by point. What happens at the point is the same
arithmetic for all: in a loop over a block that reads and writes nothing but the workspace, where each quantity of
``BLOCK`` points stands in a row, the compiler takes as many points at once as a vector register holds. So a kernel
gathers a block, computes and scatters; the material's arithmetic takes a quarter of the time.
"""

from itertools import accumulate
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, models, overload, register_model

from viscopoint.kernels.jit import INLINED, inline
from viscopoint.kernels.packing import numbers_of
from viscopoint.kernels.tensors import Matrix, Sym, read

BLOCK = 64  # points
ROW = BLOCK + 8  # numbers from one row to the next: powers of two would share few lines of the cache
COLUMNS = 144  # numbers of a point, beside the material's history
HISTORY = COLUMNS  # where that begins
ALIGNMENT = 64  # bytes, a cache line
SIX, NINE = (0.0,) * 6, (0.0,) * 9


def columns(*sizes: int, first: int = 0) -> tuple[int, ...]:
    """Return where quantities of so many numbers each begin, the first at ``first``, and where the next one would."""
    places = tuple(accumulate(sizes, initial=first))
    assert places[-1] <= COLUMNS
    return places


class _Type(types.Type):
    def __init__(self) -> None:
        super().__init__(name="Workspace")


WORKSPACE = _Type()


@register_model(_Type)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.DoubleType().as_pointer())


@intrinsic
def workspace(context: Any, n_history: Any) -> Any:
    """Return memory for a block of points with ``COLUMNS`` numbers and ``n_history`` of history each.

    It lasts as long as the function in which this stands, which must not say so in a loop.
    """

    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        numbers = builder.add(values[0], ir.Constant(values[0].type, COLUMNS))
        memory = builder.alloca(ir.DoubleType(), builder.mul(ir.Constant(values[0].type, ROW), numbers))
        memory.align = ALIGNMENT
        return memory

    return WORKSPACE(types.int64), lower


@intrinsic
def widest_vectors(context: Any) -> Any:
    """Let loops of the kernel in which this stands use the widest vectors that there are.

    By itself the compiler keeps to half of AVX-512's width, for the sake of the clock of older processors. The long
    arithmetic of hexahedra gains 15 %; material points gain nothing.
    """

    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')  # llvmlite's own ``add`` knows it not
        return context.get_dummy_value()

    return types.none(), lower


@intrinsic
def _store(context: Any, work: Any, column: Any, i: Any, value: Any) -> Any:
    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        for n, number in enumerate(numbers_of(context, builder, signature.args[3], values[3])):
            builder.store(number, _place(builder, values, n))
        return context.get_dummy_value()

    return types.none(work, types.int64, types.int64, value), lower


@intrinsic
def _load(context: Any, work: Any, column: Any, i: Any, like: Any) -> Any:
    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind = signature.return_type
        if isinstance(kind, types.BaseTuple):
            parts = [builder.load(_place(builder, values, number)) for number in range(len(kind))]
            return context.make_tuple(builder, kind, parts)
        return builder.load(_place(builder, values, 0))

    kind = types.UniTuple(types.float64, len(like)) if isinstance(like, types.BaseTuple) else types.float64
    return kind(work, types.int64, types.int64, like), lower


def _place(builder: Any, values: Any, number: int) -> Any:
    """Return the address of a component of point i's quantity."""
    work, column, i = values[:3]
    first = builder.mul(builder.add(column, ir.Constant(column.type, number)), ir.Constant(column.type, ROW))
    return builder.gep(work, [builder.add(first, i)], inbounds=True)


def store(work: Any, column: int, i: int, value: Any) -> None:
    """Store a number, or a value made of numbers (``packing``), of the block's point i."""
    raise NotImplementedError


def load_tuple(work: Any, column: int, i: int, like: Any) -> Any:
    """Return a tuple of numbers, as long as ``like``, of the block's point i."""
    raise NotImplementedError


@overload(store, strict=False, jit_options=INLINED)
def _store_it(work: Any, column: Any, i: Any, value: Any) -> Any:
    return lambda work, column, i, value: _store(work, column, i, value)  # pyright: ignore[reportCallIssue]


@overload(load_tuple, strict=False, jit_options=INLINED)
def _load_as(work: Any, column: Any, i: Any, like: Any) -> Any:
    return lambda work, column, i, like: _load(work, column, i, like)  # pyright: ignore[reportCallIssue]


@inline
def load(work: Any, column: int, i: int) -> float:
    """Return a number of the block's point i."""
    return load_tuple(work, column, i, 0.0)


@inline
def load_sym(work: Any, column: int, i: int) -> Sym:
    """Return a symmetric tensor of the block's point i."""
    return read(load_tuple(work, column, i, SIX))


@inline
def load_matrix(work: Any, column: int, i: int) -> Matrix:
    """Return a general tensor of the block's point i."""
    return Matrix(*load_tuple(work, column, i, NINE))


@inline
def add(work: Any, column: int, i: int, amount: float) -> None:
    """Add to a number of the block's point i."""
    store(work, column, i, load(work, column, i) + amount)
