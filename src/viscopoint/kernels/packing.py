"""Values as the numbers that they are made of: nested tuples, NamedTuples, and the small classes of ``values``."""

from collections.abc import Iterator
from typing import Any, get_type_hints

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from viscopoint.kernels.values import ATTRIBUTES, KINDS


def flat(value: Any) -> Any:
    """Return the numbers of a value as a tuple."""
    raise NotImplementedError


def shaped(shape: Any, numbers: tuple[float, ...]) -> Any:
    """Return the value of a class, a NamedTuple with annotations, that these numbers make."""
    raise NotImplementedError


def size(kind: Any) -> int:
    """Return how many numbers a value of one of Numba's types has."""
    return sum(map(size, _parts(kind))) if _parts(kind) is not None else 1


def numbers_of(context: Any, builder: Any, kind: Any, value: Any) -> Iterator[Any]:
    """Yield the numbers of a value, in double."""
    if isinstance(kind, types.BaseTuple):
        parts = cgutils.unpack_tuple(builder, value)
    elif _parts(kind) is None:
        yield context.cast(builder, value, kind, types.float64)
        return
    else:
        struct = cgutils.create_struct_proxy(kind)(context, builder, value=value)
        parts = [getattr(struct, name) for name in kind.names]
    for part, inner in zip(parts, _parts(kind), strict=True):
        yield from numbers_of(context, builder, inner, part)


def value_of(context: Any, builder: Any, kind: Any, numbers: Iterator[Any]) -> Any:
    """Return the value that the next numbers make."""
    if _parts(kind) is None:
        return next(numbers)
    parts = [value_of(context, builder, part, numbers) for part in _parts(kind)]
    if isinstance(kind, types.BaseTuple):
        return context.make_tuple(builder, kind, parts)
    struct = cgutils.create_struct_proxy(kind)(context, builder)
    for name, part in zip(kind.names, parts, strict=True):
        setattr(struct, name, part)
    return struct._getvalue()


def _parts(kind: Any) -> Any:
    """Return Numba's types of a value's parts; None of a number."""
    if isinstance(kind, types.BaseTuple):
        return kind.types  # pyright: ignore[reportAttributeAccessIssue]
    return [types.float64] * len(kind.names) if kind in KINDS.values() else None


def _kind_of(shape: Any) -> Any:
    """Return Numba's type of a class's values."""
    if shape in KINDS:
        return KINDS[shape]
    return types.BaseTuple.from_types([_kind_of(part) for part in get_type_hints(shape).values()], shape)


@intrinsic
def _flat(context: Any, value: Any) -> Any:
    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        numbers = list(numbers_of(context, builder, signature.args[0], values[0]))
        return context.make_tuple(builder, signature.return_type, numbers)

    return types.UniTuple(types.float64, size(value))(value), lower


@intrinsic
def _shaped(context: Any, shape: Any, numbers: Any) -> Any:
    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        numbers = iter(cgutils.unpack_tuple(builder, values[1]))
        return value_of(context, builder, signature.return_type, numbers)

    return _kind_of(shape.instance_class)(shape, numbers), lower


@overload(flat, **ATTRIBUTES)
def _flat_one(value: Any) -> Any:
    return lambda value: _flat(value)  # pyright: ignore[reportCallIssue]  (an intrinsic)


@overload(shaped, **ATTRIBUTES)
def _shaped_one(shape: Any, numbers: Any) -> Any:
    return lambda shape, numbers: _shaped(shape, numbers)  # pyright: ignore[reportCallIssue]
