"""Small classes of floats as values inside kernels, so that they live in registers.

``register_struct`` lets kernels construct a frozen dataclass and read its fields; ``register_float4`` does the same for
one of four fields, in one vector register, of which an operation handles all at once.
"""

import inspect
from collections.abc import Callable
from dataclasses import fields
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import (
    intrinsic,
    lower_builtin,
    make_attribute_wrapper,
    models,
    overload,
    overload_attribute,
    register_model,
    type_callable,
    typeof_impl,
)

from viscopoint.kernels.jit import INLINED

FLOAT4 = ir.VectorType(ir.DoubleType(), 4)
KINDS: dict[type, Any] = {}  # Numba's types of the classes
ATTRIBUTES: Any = {"strict": False, "jit_options": INLINED}


def register_struct(value: type) -> type:
    """Let kernels hold a class as a struct; return its Numba type."""
    names = [field.name for field in fields(value)]
    kind = _declared(value)

    @register_model(kind)
    class Model(models.StructModel):
        def __init__(self, manager: Any, kind: Any) -> None:
            super().__init__(manager, kind, [(name, types.float64) for name in names])

    for name in names:
        make_attribute_wrapper(kind, name, name)

    @lower_builtin(value, *[types.Any] * len(names))
    def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        made = cgutils.create_struct_proxy(signature.return_type)(context, builder)
        for name, given, given_kind in zip(names, values, signature.args, strict=True):
            setattr(made, name, context.cast(builder, given, given_kind, types.float64))
        return made._getvalue()

    return kind


def register_float4(value: type) -> type:
    """Let kernels hold a class of four fields in one vector register; return its Numba type."""
    kind = _declared(value)

    @register_model(kind)
    class Model(models.PrimitiveModel):
        def __init__(self, manager: Any, kind: Any) -> None:
            super().__init__(manager, kind, FLOAT4)

    @lower_builtin(value, types.Any, types.Any, types.Any, types.Any)
    def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        packed = ir.Constant(FLOAT4, ir.Undefined)
        for number, (given, given_kind) in enumerate(zip(values, signature.args, strict=True)):
            packed = builder.insert_element(
                packed, context.cast(builder, given, given_kind, types.float64), _at(number)
            )
        return packed

    for number, field in enumerate(fields(value)):
        _register_component(kind, field.name, number)
    return kind


def inside_kernels(symbol: Any, implementation: Callable[..., Any], *kinds: type) -> None:
    """Let kernels use ``implementation`` where ``symbol``, an operator or function, meets arguments of these types."""
    if len(kinds) == 2:

        @overload(symbol, **ATTRIBUTES)
        def two(a: Any, b: Any) -> Any:
            return implementation if all(map(isinstance, (a, b), kinds)) else None

    else:

        @overload(symbol, **ATTRIBUTES)
        def three(a: Any, b: Any, c: Any) -> Any:
            return implementation if all(map(isinstance, (a, b, c), kinds)) else None


def summed() -> Any:
    """Return a function of two values in a vector register that adds them."""

    @intrinsic
    def add(context: Any, a: Any, b: Any) -> Any:
        def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return builder.fadd(*values)

        return a(a, b), lower

    return lambda a, b: add(a, b)  # pyright: ignore[reportCallIssue]  (an intrinsic)


def scaled() -> Any:
    """Return a function of a number and a value in a vector register."""

    @intrinsic
    def scale(context: Any, factor: Any, vector: Any) -> Any:
        def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            number = context.cast(builder, values[0], signature.args[0], types.float64)
            first = builder.insert_element(ir.Constant(FLOAT4, ir.Undefined), number, _at(0))
            return builder.fmul(_broadcast(builder, first), values[1])

        return vector(factor, vector), lower

    return lambda a, b: scale(a, b)  # pyright: ignore[reportCallIssue]


def fma(a: float, b: Any, c: Any) -> Any:
    """Return a b + c of numbers, vectors b and c, or rows of nodes; inside kernels each number is rounded once.

    Where the compiler chose what to fuse, a kernel that had just been compiled gave other last bits than the same one
    loaded from the disk, which has been through other passes.
    """
    return a * b + c


@intrinsic
def _fma(context: Any, a: Any, b: Any, c: Any) -> Any:
    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return _fma_call(builder, *values)

    return types.float64(types.float64, types.float64, types.float64), lower


def _fma_numbers(a: float, b: float, c: float) -> float:
    return _fma(a, b, c)  # pyright: ignore[reportCallIssue]  (an intrinsic)


inside_kernels(fma, _fma_numbers, types.Number, types.Number, types.Number)


def accumulated() -> Any:
    """Return a function of a weight, a value and a sum, both in a vector register, that is weight value + sum."""

    @intrinsic
    def accumulate(context: Any, weight: Any, vector: Any, total: Any) -> Any:
        def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            number = context.cast(builder, values[0], signature.args[0], types.float64)
            first = builder.insert_element(ir.Constant(FLOAT4, ir.Undefined), number, _at(0))
            return _fma_call(builder, _broadcast(builder, first), values[1], values[2])

        return total(weight, vector, total), lower

    return lambda a, b, c: accumulate(a, b, c)  # pyright: ignore[reportCallIssue]


def _fma_call(builder: Any, a: Any, b: Any, c: Any) -> Any:
    name = "llvm.fma.v4f64" if isinstance(a.type, ir.VectorType) else "llvm.fma.f64"
    kind = ir.FunctionType(a.type, [a.type] * 3)
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), [a, b, c])


def fetched(value: type) -> Any:
    """Return a function of rows ``[n, 4]`` and n that reads a whole register."""

    @intrinsic
    def fetch(context: Any, rows: Any, number: Any) -> Any:
        kind = KINDS[value]

        def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return builder.load(_place(context, builder, signature, values), align=8)

        return kind(rows, number), lower

    return lambda rows, n: fetch(rows, n)  # pyright: ignore[reportCallIssue]


def stored() -> Any:
    """Return a function of rows ``[n, 4]``, n and a register that writes it."""

    @intrinsic
    def store(context: Any, rows: Any, number: Any, vector: Any) -> Any:
        def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            builder.store(values[2], _place(context, builder, signature, values), align=8)
            return context.get_dummy_value()

        return types.none(rows, number, vector), lower

    return lambda rows, n, v: store(rows, n, v)  # pyright: ignore[reportCallIssue]


def _place(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """Return the address of a row of four numbers."""
    rows = context.make_array(signature.args[0])(context, builder, values[0])
    first = builder.mul(values[1], ir.Constant(values[1].type, 4))
    return builder.bitcast(builder.gep(rows.data, [first]), FLOAT4.as_pointer())


def _declared(value: type) -> type:
    """Make Numba's type of a class and let kernels call the class."""

    class ValueType(types.Type):
        names = tuple(field.name for field in fields(value))

        def __init__(self) -> None:
            super().__init__(name=value.__name__)

    kind = KINDS[value] = ValueType()

    @typeof_impl.register(value)
    def type_of(instance: Any, context: Any) -> Any:
        return kind

    @type_callable(value)
    def type_constructor(context: Any) -> Any:
        def typed(*given: Any) -> Any:
            return kind

        typed.__signature__ = inspect.signature(value)  # pyright: ignore[reportFunctionMemberAccess]  (Numba reads it)
        return typed

    return ValueType


def _register_component(kind: type, name: str, number: int) -> None:
    @intrinsic
    def extract(context: Any, vector: Any) -> Any:
        def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return builder.extract_element(values[0], _at(number))

        return types.float64(vector), lower

    @overload_attribute(kind, name, **ATTRIBUTES)
    def component(vector: Any) -> Any:
        return lambda vector: extract(vector)  # pyright: ignore[reportCallIssue]  (an intrinsic)


def _at(number: int) -> ir.Constant:
    return ir.Constant(ir.IntType(32), number)


def _broadcast(builder: Any, vector: Any) -> Any:
    mask = ir.Constant(ir.VectorType(ir.IntType(32), 4), [0] * 4)
    return builder.shuffle_vector(vector, ir.Constant(FLOAT4, ir.Undefined), mask)


def pick(values: tuple[float, ...], n: int) -> float:
    """Return the n-th of some numbers. In a loop that is not unrolled Numba would compare n with each place."""
    return values[n]


@intrinsic
def _pick(context: Any, values: Any, n: Any) -> Any:
    def lower(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        parts = cgutils.unpack_tuple(builder, given[0])
        memory = cgutils.alloca_once(builder, ir.DoubleType(), size=ir.Constant(ir.IntType(64), len(parts)))
        for number, part in enumerate(parts):
            builder.store(part, builder.gep(memory, [_at(number)], inbounds=True))
        return builder.load(builder.gep(memory, [given[1]], inbounds=True))

    return types.float64(values, types.int64), lower


@overload(pick, **ATTRIBUTES)
def _pick_one(values: Any, n: Any) -> Any:
    return lambda values, n: _pick(values, n)  # pyright: ignore[reportCallIssue]  (an intrinsic)


def replaced(values: tuple[float, ...], n: int, value: float) -> tuple[float, ...]:
    """Return the numbers with the n-th replaced."""
    return (*values[:n], value, *values[n + 1 :])


@overload(replaced, **ATTRIBUTES)
def _replace_one(values: Any, n: Any, value: Any) -> Any:
    return lambda values, n, value: tuple_setitem(values, n, value)  # pyright: ignore[reportCallIssue]
