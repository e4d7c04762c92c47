"""When to do something, as a case says: a list of times, ``{ every = "1 us" }`` or, by steps, ``{ every = 10 }``."""

import math
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from viscopoint.case.units import Duration, duration
from viscopoint.model.schedule import Schedule

MOST_TIMES = 10_000
FORMS = 'write a list of times, { every = "1 us" }, or { every = 10 } for each tenth step'


class _Read:
    """Reads and writes a schedule."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(
            self.read,
            handler.generate_schema(_Times),
            serialization=core_schema.plain_serializer_function_ser_schema(self.written),
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        every = {"anyOf": [{"type": "string", "examples": ["1 us"]}, {"type": "integer", "minimum": 1}]}
        table = {"type": "object", "properties": {"every": every}, "required": ["every"], "additionalProperties": False}
        return {"anyOf": [{"type": "array", "items": {"type": "string", "examples": ["20 us"]}}, table]}

    def read(self, value: Any, times: Any) -> Schedule:
        """Return the schedule that a case's value is; a fault in a list is that of its entry."""
        if isinstance(value, Schedule):
            return value
        if not isinstance(value, Mapping):
            return Schedule(tuple(sorted(times(value))))
        if set(value) != {"every"}:
            raise PydanticCustomError("word", "is no schedule; {forms}", {"forms": FORMS})
        every = value["every"]
        if isinstance(every, int) and not isinstance(every, bool):
            if every < 1:
                raise PydanticCustomError("word", "is no schedule: every so many steps, 1 or more")
            return Schedule(steps=every)
        interval = duration(every)
        if not interval > 0.0:
            raise PydanticCustomError(
                "word", "is no schedule: an interval is greater than zero; { every = 1 } is each step"
            )
        return Schedule(every=interval)

    def written(self, schedule: Schedule) -> Any:
        """Return what a case would write."""
        if schedule.steps:
            return {"every": schedule.steps}
        if math.isfinite(schedule.every):
            return {"every": f"{schedule.every!r} ms"}
        return [f"{time!r} ms" for time in schedule.times]


def _not_too_many(times: Any) -> Any:
    """Refuse a list too long before its entries are looked at, each with a fault of its own."""
    if isinstance(times, list | tuple) and len(times) > MOST_TIMES:
        raise PydanticCustomError("too_long", "has too many entries")
    return times


_Times = Annotated[tuple[Duration, ...], Field(strict=False, max_length=MOST_TIMES), BeforeValidator(_not_too_many)]
Times = Annotated[Schedule, _Read()]
