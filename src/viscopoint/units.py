"""Quantities with units: what a case writes as "0.5 mm" and the package holds as a float in g, mm, ms.

In these units stress comes out in MPa, force in N, energy in mJ and speed in m/s (= mm/ms).
"""

import functools
import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

if TYPE_CHECKING:
    import pint

_NUMBER = re.compile(
    r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|[+-]?(?:inf|infinity|nan))\s*(.*)", re.I | re.S | re.A
)
_FACTOR = r"(?:1|[A-Za-zµμ]+(?:(?:\^|\*\*)-?\d)?)"
_UNIT = re.compile(rf"{_FACTOR}(?:\s*[*/ ]\s*{_FACTOR})*")
_LONGEST = 100  # characters; a quantity is never longer
# What most cases are written in: to know these factors, pint need not be loaded, which takes 0.2 s.
USUAL = {
    ("um", "mm"): 1e-3, ("mm", "mm"): 1.0, ("cm", "mm"): 10.0, ("m", "mm"): 1e3,
    ("us", "ms"): 1e-3, ("ms", "ms"): 1.0, ("s", "ms"): 1e3, ("1/ms", "1/ms"): 1.0, ("1/s", "1/ms"): 1e-3,
    ("m/s", "m/s"): 1.0, ("kPa", "MPa"): 1e-3, ("MPa", "MPa"): 1.0, ("GPa", "MPa"): 1e3,
    ("g/cm^3", "g/mm^3"): 1e-3, ("g/mm^3", "g/mm^3"): 1.0,
}  # fmt: skip
_LARGEST = 1e15  # of a unit; beyond it, or below its inverse, products overflow and nothing physical is left


@functools.cache
def _registry() -> "pint.UnitRegistry":
    import pint

    return pint.UnitRegistry()


def parse(text: str, unit: str) -> float:
    """Convert a quantity such as "20 us" to a float in ``unit``.

    Raises:
        ValueError: the text is no number with a unit of the right dimension; the message says what is wrong with it.
    """
    match = _NUMBER.fullmatch(text) if len(text) <= _LONGEST else None
    if match is None:
        raise ValueError("is not a number with a unit")
    number, symbol = float(match[1]), match[2].strip()
    if not math.isfinite(number):
        raise ValueError("is not finite")
    if not symbol:
        raise ValueError("has no unit")
    if not _UNIT.fullmatch(symbol):
        raise ValueError(f"has no known unit ('{symbol}')")
    factor = USUAL.get((symbol, unit))
    value = converted(number, symbol, unit) if factor is None else number * factor
    if value and not 1 / _LARGEST <= abs(value) <= _LARGEST:
        raise ValueError(f"is out of range, {1 / _LARGEST:g} to {_LARGEST:g} {unit}")
    return value


def converted(number: float, symbol: str, unit: str) -> float:
    """Return a number of one unit in another, by pint; raise ``ValueError`` as ``parse`` does."""
    import pint

    units = _registry()
    try:
        given = units.parse_units(symbol)
        return float(units.Quantity(number, given).to(unit).magnitude)
    except pint.DimensionalityError as error:
        raise ValueError(f"has the wrong dimension, {error.dim1 or 'none'}") from None
    except Exception:  # pint's parser raises errors of many kinds for what is not a unit
        raise ValueError(f"has no known unit ('{symbol}')") from None


@dataclass(frozen=True)
class Quantity:
    """A float in ``unit`` (of g, mm, ms or equal to it) that a case writes as a string such as ``example``."""

    name: str
    unit: str
    example: str

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(
            self.read,
            handler(source),
            serialization=core_schema.plain_serializer_function_ser_schema(self.text),
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        description = f"{self.name} with its unit"
        return {"type": "string", "description": description, "examples": [self.example]}

    def read(self, value: Any) -> float:
        """Parse a case's value, with an error that shows an example."""
        wrong = "is a bare number without a unit" if isinstance(value, int | float) else "is not a string"
        if isinstance(value, str):
            try:
                return parse(value, self.unit)
            except ValueError as error:
                wrong = str(error)
        raise PydanticCustomError(
            "quantity", "{wrong}; write a {name} such as {example}",
            {"wrong": wrong, "name": self.name, "example": f'"{self.example}"'},
        )  # fmt: skip

    def text(self, value: float) -> str:
        """Write a value as a case would."""
        return f"{value!r} {self.unit}"


_LENGTH = Quantity("length", "mm", "0.5 mm")
_TIME = Quantity("time", "ms", "20 us")
_MODULUS = Quantity("modulus", "MPa", "550 MPa")

Coordinate = Annotated[float, _LENGTH]
Length = Annotated[float, Field(gt=0), _LENGTH]
Gap = Annotated[float, Field(ge=0), _LENGTH]
Speed = Annotated[float, Field(gt=0), Quantity("speed", "m/s", "150 m/s")]
Duration = Annotated[float, Field(gt=0), _TIME]
Instant = Annotated[float, Field(ge=0), _TIME]
Density = Annotated[float, Field(gt=0), Quantity("density", "g/mm^3", "1.0 g/cm^3")]
Modulus = Annotated[float, Field(ge=0), _MODULUS]
PositiveModulus = Annotated[float, Field(gt=0), _MODULUS]
Decay = Annotated[float, Field(ge=0), Quantity("decay constant", "1/ms", "650 1/ms")]
