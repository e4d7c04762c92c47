"""Puts what pydantic found wrong into words that name the key, the value and what is allowed."""

import contextlib
import json
import re
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from viscopoint.case.units import Quantity
from viscopoint.errors import Fault, nearest
from viscopoint.messages import clipped, one_line

_CONFIG = ConfigDict(strict=True, allow_inf_nan=False)
RENAMED = {"output.history_interval": 'output.history, as in history = { every = "0.01 us" }'}  # keys of older cases
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_BOUNDS = {
    "greater_than": ("gt", "must be greater than"),
    "greater_than_equal": ("ge", "must not be less than"),
    "less_than": ("lt", "must be less than"),
    "less_than_equal": ("le", "must not be greater than"),
}


_KINDS = {
    "tuple_type": "must be a list in brackets",
    "dict_type": "must be a table",
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "float_type": "must be a number without quotes or unit",
    "float_parsing": "must be a number without quotes or unit",
    "finite_number": "must be finite",
    "string_type": "must be text in quotes",
    "too_long": "has too many entries",
}


def explain(detail: Mapping[str, Any], case: type[BaseModel], tables: Mapping[str, Any]) -> Fault:
    """Turn one of pydantic's errors on ``case``, read from ``tables``, into a fault."""
    kind, context = detail["type"], detail.get("ctx", {})
    key, table, field = _where(detail["loc"], case)
    given = _shown(_at(tables, key, detail.get("input")))
    if kind == "extra_forbidden" and key in RENAMED:
        return Fault(key, f"is now {RENAMED[key]}")
    if kind == "extra_forbidden":
        return Fault(key, f"unknown key; {nearest(key.rpartition('.')[2], table.model_fields)}")
    if kind == "missing":
        return Fault(key, f"is missing{_example(key, field)}")
    if kind in ("quantity", "word"):
        return Fault(key, f"{given} {detail['msg']}")
    if kind in _BOUNDS:
        bound, words = _BOUNDS[kind]
        return Fault(key, f"{given} {words} {context[bound]:g}")
    if kind in _KINDS:
        return Fault(key, f"{given} {_KINDS[kind]}")
    if kind == "literal_error":
        return Fault(key, f"{given} is not known; allowed: {context['expected']}")
    if kind == "union_tag_invalid":
        tags = [tag.strip(" '") for tag in context["expected_tags"].split(",")]
        choice = context["discriminator"].strip("'")
        return Fault(
            f"{key}.{choice}", f"'{clipped(context['tag'], 60)}' is not known; {nearest(context['tag'], tags)}"
        )
    if kind == "union_tag_not_found":
        return Fault(f"{key}.{context['discriminator'].strip(chr(39))}", "is missing")
    return Fault(key, f"{given}: {detail['msg'][:1].lower()}{detail['msg'][1:]}")


def valid_values(table: type[BaseModel], given: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return the values, by dotted key, of the keys that are right each for itself."""
    values: dict[str, Any] = {}
    for name, field in table.model_fields.items():
        tables = list(_tables(field.annotation))
        value = given[name] if name in given else _default(field, values, prefix)
        if name not in given and not tables and value is not PydanticUndefined:
            values[prefix + name] = value  # a default is in our units already
            continue
        for inner in tables:
            if _fits(inner, value):
                values |= valid_values(inner, value, f"{prefix}{name}.")
        if not tables:
            with contextlib.suppress(ValidationError):
                kind: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
                values[prefix + name] = TypeAdapter(kind, config=_CONFIG).validate_python(value)
    return values


def _default(field: FieldInfo, values: Mapping[str, Any], prefix: str) -> Any:
    """Return a key's default, which others may give; ``PydanticUndefined`` if it has none, or they are wrong."""
    known = {key.removeprefix(prefix): value for key, value in values.items()}
    try:
        return field.get_default(call_default_factory=True, validated_data=known)
    except KeyError:
        return PydanticUndefined


def _fits(table: type[BaseModel], value: Any) -> bool:
    """Return whether a union would take this table for the value."""
    fixed = {name: get_args(field.annotation)[0] for name, field in table.model_fields.items() if _is_word(field)}
    return isinstance(value, Mapping) and all(value.get(name) == word for name, word in fixed.items())


def _is_word(field: FieldInfo) -> bool:
    return get_origin(field.annotation) is Literal and len(get_args(field.annotation)) == 1


def _at(tables: Any, key: str, otherwise: Any) -> Any:
    """Return what the tables hold at a dotted key, as it was written."""
    for step in key.replace("[", ".").replace("]", "").split("."):
        try:
            tables = tables[int(step)] if isinstance(tables, list | tuple) else tables[step]
        except (KeyError, IndexError, TypeError, ValueError):
            return otherwise
    return tables


def _shown(value: Any) -> str:
    """Return a value as a message shows it: short, and on one line."""
    try:
        text = f'"{value}"' if isinstance(value, str) else repr(value)
    except RecursionError:
        text = "a value nested too deeply"
    except ValueError:  # Python writes no integer of more than 4300 digits
        text = "a value with an integer too large"
    text = one_line(text[:61].replace("\n", " "))
    return text if len(text) <= 60 else f"{text[:57]}..."


def _where(place: tuple[int | str, ...], case: type[BaseModel]) -> tuple[str, type[BaseModel], FieldInfo | None]:
    """Return the dotted key of an error, the innermost table it lies in and the field, if it is one."""
    key, table = "", case
    field: FieldInfo | None = None
    choices: list[type[BaseModel]] = []
    for step in place:
        chosen = [choice for choice in choices if _answers_to(choice, step)]
        if chosen:  # not a key, but which of several tables pydantic took
            table, choices, field = chosen[0], [], None
            continue
        name = step if _BARE.fullmatch(str(step)) else json.dumps(step)
        key += f"[{step}]" if isinstance(step, int) else f".{name}" if key else str(name)
        field = table.model_fields.get(str(step))
        choices = list(_tables(field.annotation)) if field else []
        if len(choices) == 1:
            table = choices[0]
    return key, table, field


def _answers_to(table: type[BaseModel], tag: int | str) -> bool:
    return any(get_args(field.annotation) == (tag,) for field in table.model_fields.values())


def _tables(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and get_origin(annotation) is None and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _tables(part)


def _example(key: str, field: FieldInfo | None) -> str:
    quantities = [part for part in field.metadata if isinstance(part, Quantity)] if field else []
    if field and any(_tables(field.annotation)):
        return f"; write a table [{key}], such as `viscopoint new` shows"
    return f'; write a {quantities[0].name} such as "{quantities[0].example}"' if quantities else ""
