"""Checks what is handed to the Python API, so that a slip gets a message and not an error from deep inside."""

import functools
import inspect
import types
import typing
from collections.abc import Callable, Collection, Mapping
from numbers import Integral, Real
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin

from viscopoint.errors import InputError
from viscopoint.messages import clipped, one_line

F = TypeVar("F", bound=Callable[..., Any])
WORDS = {
    str: "text",
    Path: "a path",
    bool: "True or False",
    int: "a whole number",
    float: "a number",
    type(None): "None",
}
LONGEST = 60  # characters of a value that a message shows


def checked(function: F) -> F:
    """Let a function raise ``InputError`` for an argument that is not of the type that it is annotated with."""
    signature = inspect.signature(function)

    @functools.wraps(function)
    def check(*words: Any, **named: Any) -> Any:
        hints = typing.get_type_hints(function)
        try:
            arguments = signature.bind(*words, **named).arguments
        except TypeError as error:
            raise TypeError(f"{function.__qualname__}: {error}") from None
        for name, value in arguments.items():
            if name in hints and not _fits(value, hints[name]):
                shown = clipped(one_line(repr(value)), LONGEST)
                raise InputError(f"{_place(function, words)}, {name}: {shown} is not {_told(hints[name])}")
        return function(*words, **named)

    return typing.cast(F, check)


def _place(function: Callable[..., Any], words: tuple[Any, ...]) -> str:
    """Return the name of what was called; of a method, by the class that the caller knows."""
    owner, dot, name = function.__qualname__.rpartition(".")
    if words and owner in (base.__name__ for base in type(words[0]).__mro__):
        owner = type(words[0]).__name__
    return f"{owner}{dot}{name}".removesuffix(".__init__")


def _fits(value: Any, hint: Any) -> bool:
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (typing.Union, types.UnionType):
        return any(_fits(value, choice) for choice in inner)
    if hint is Any:
        return True
    if origin is Callable:
        return callable(value)
    if origin is not None and issubclass(origin, Mapping):
        return isinstance(value, Mapping) and all(isinstance(key, str) for key in value)
    if origin is not None and issubclass(origin, Collection):
        return _is_list(value) and all(_fits(entry, inner[0]) for entry in value)
    if hint in (int, float):  # NumPy's numbers are numbers too
        return isinstance(value, Integral if hint is int else Real) and not isinstance(value, bool)
    return isinstance(value, hint)


def _is_list(value: Any) -> bool:
    return isinstance(value, Collection) and not isinstance(value, str | bytes | Mapping)


def _told(hint: Any) -> str:
    """Say what may be given."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (typing.Union, types.UnionType):
        return " or ".join(_told(choice) for choice in inner)
    if origin is Callable:
        return "a function"
    if origin is not None and issubclass(origin, Mapping):
        return "a table with text as keys"
    if origin is not None and issubclass(origin, Collection):
        return f"a list of ({_told(inner[0])})"
    return WORDS.get(hint, f"a {getattr(hint, '__name__', hint)}")
