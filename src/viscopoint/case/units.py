"""Quantities with units: what a case writes as "0.5 mm" and the package holds as a float in g, mm, ms.

In these units stress comes out in MPa, force in N, energy in mJ and speed in m/s (= mm/ms). The number is converted as
it is written, by an exact factor, and rounded once: the same quantity in other units gives the same float.
"""

import contextlib
import functools
import math
import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from viscopoint.case.unit_names import KINDS, ONE, Unit, unit_of

_NUMBER = re.compile(
    r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|[+-]?(?:inf|infinity|nan))\s*(.*)", re.I | re.S | re.A
)
_NAME = r"[A-Za-zµ][A-Za-zµ_]*"
_FACTOR = rf"(?:1|({_NAME})(?:\^?(-?\d))?)"
_UNIT = re.compile(rf"{_FACTOR}(?:\s*[*/ ]\s*{_FACTOR})*")
_EACH = re.compile(rf"([*/ ]?)\s*{_FACTOR}\s*")
_SAME = str.maketrans({"μ": "µ", "·": "*", "⋅": "*", "×": "*", "²": "^2", "³": "^3", "⁴": "^4", "⁻": "^-", "¹": "1"})
_LONGEST = 100  # characters; a quantity is never longer
_LARGEST = 10**15  # of a unit; beyond it, or below its inverse, products overflow and nothing physical is left
NEAR_EXAMPLE = 1000.0  # times: within it of a kind's example, another unit may have been meant


def parse(text: str, unit: str) -> float:
    """Convert a quantity such as "20 us" to a float in ``unit``.

    Raises:
        ValueError: the text is no number with a unit of the right dimension; the message says what is wrong with it.
    """
    number, symbol = _split(text)
    given, wanted = _unit(symbol), _unit(unit)
    if given.dimension != wanted.dimension:
        raise ValueError(f"has the wrong dimension: {_dimension(symbol, given, wanted)}")
    value = Fraction(number) * given.factor / wanted.factor
    if value and not Fraction(1, _LARGEST) <= abs(value) <= _LARGEST:
        raise ValueError(f"is out of range, {1 / _LARGEST:g} to {_LARGEST:g} {unit}")
    return float(value)


def _split(text: str) -> tuple[str, str]:
    """Return the number and the unit that a text has."""
    match = _NUMBER.fullmatch(text) if len(text) <= _LONGEST else None
    if match is None:
        raise ValueError("is not a number with a unit")
    if not math.isfinite(float(match[1])):
        raise ValueError("is not finite")
    symbol = match[2].strip()
    if not symbol:
        raise ValueError("has no unit")
    return match[1] if float(match[1]) else "0", symbol  # the exponent of what is next to nothing may be huge


@functools.lru_cache(maxsize=1000)
def _unit(symbol: str) -> Unit:
    """Return the unit of a text such as "g/cm^3", read from left to right; one that begins with / is of 1."""
    plain = re.sub(r"\^-\^(?=\d)", "^-", symbol.translate(_SAME).replace("**", "^"))
    plain = re.sub(r"^\s*[*]\s*", "", re.sub(r"^\s*/", "1/", plain))
    if not _UNIT.fullmatch(plain):
        raise ValueError(f"has no known unit ('{symbol}')")
    total = ONE
    for sign, name, power in _EACH.findall(plain):
        factor = unit_of(name).to_the(int(power or 1)) if name else ONE
        total = total.times(factor.to_the(-1) if sign == "/" else factor)
    return total


def _dimension(symbol: str, given: Unit, wanted: Unit) -> str:
    """Say what a unit measures, and whether a pound or kilogram was meant as a force."""
    mass, length, time = given.dimension
    force = wanted.dimension == (mass, length + 1, time - 2)
    hint = "; the force is 'lbf' or 'kgf'" if force else ""
    return f"'{symbol}' is {KINDS.get(given.dimension, 'of another kind')}{hint}"


@dataclass(frozen=True)
class Quantity:
    """A float in ``unit`` (of g, mm, ms or equal to it) that a case writes as a string such as ``example``.

    A value beyond ``plausible`` is refused with the units of ``usual`` that may have been meant: a slip of units is off
    by a thousand or a million times.
    """

    name: str
    unit: str
    example: str
    plausible: tuple[float, float]  # absolute values; zero is left to other bounds
    usual: tuple[str, ...]

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
                return self._checked(parse(value, self.unit), value)
            except ValueError as error:
                wrong = str(error)
        raise PydanticCustomError(
            "quantity", "{wrong}; write a {name} such as {example}",
            {"wrong": wrong, "name": self.name, "example": f'"{self.example}"'},
        )  # fmt: skip

    def text(self, value: float) -> str:
        """Write a value as a case would."""
        return f"{value!r} {self.unit}"

    def shown(self, value: float) -> str:
        """Write a value for a reader, in the unit of the example."""
        unit = self.example.split(" ", 1)[1]
        return f"{value / parse(f'1 {unit}', self.unit):g} {unit}"

    def _checked(self, value: float, text: str) -> float:
        low, high = self.plausible
        if value == 0.0 or low <= abs(value) <= high:
            return value
        number, _ = _split(text)
        sizes = [(self._size(f"{number} {unit}"), unit) for unit in self.usual]
        size, unit = min(sizes)
        question = f'; did you mean "{number} {unit}"?' if size < NEAR_EXAMPLE else ""
        raise ValueError(
            f"is {value:g} {self.unit}, not plausible as a {self.name}: {low:g} to {high:g} {self.unit}{question}"
        )

    def _size(self, text: str) -> float:
        """Return how many times larger or smaller than the example a text is."""
        with contextlib.suppress(ValueError, ZeroDivisionError):
            ratio = abs(parse(text, self.unit)) / parse(self.example, self.unit)
            return max(ratio, 1 / ratio)
        return math.inf


# What is plausible is wider than anything that can be computed here makes sense for. Lengths: an atom to the height of
# the atmosphere. Speeds: slower than any explicit code can follow, to above the fastest meteoroids, 72 km/s. Times: an
# atom's vibration to days. Densities: the lightest foams, 0.16 kg/m^3, to twenty times osmium. Moduli: the softest
# gels, some Pa, to twenty times diamond; rigid or incompressible solids are modelled so. Decay: as times.
LENGTHS, TIMES = ("um", "mm", "cm", "m", "in"), ("ns", "us", "ms", "s")
_COORDINATE = Quantity("length", "mm", "0.5 mm", (0.0, math.inf), LENGTHS)
_GAP = Quantity("length", "mm", "0.5 mm", (0.0, 1e8), LENGTHS)  # as good as zero is zero
_LENGTH = Quantity("length", "mm", "0.5 mm", (1e-7, 1e8), LENGTHS)
_TIME = Quantity("time", "ms", "20 us", (1e-12, 1e9), TIMES)
_INSTANT = Quantity("time", "ms", "20 us", (0.0, 1e9), TIMES)
_SPEED = Quantity("speed", "m/s", "150 m/s", (1e-6, 1e5), ("mm/s", "m/s", "km/s", "ft/s"))
_DENSITY = Quantity(
    "density", "g/mm^3", "1.0 g/cm^3", (1e-7, 0.5), ("kg/m^3", "g/cm^3", "g/mm^3", "tonne/mm^3", "lb/in^3")
)
_MODULUS = Quantity("modulus", "MPa", "550 MPa", (1e-6, 1e7), ("Pa", "kPa", "MPa", "GPa", "psi"))
_DECAY = Quantity("decay constant", "1/ms", "650 1/ms", (1e-9, 1e12), ("1/s", "1/ms", "1/us"))

duration = _TIME.read  # of a value outside of a table's own keys

Coordinate = Annotated[float, _COORDINATE]
Length = Annotated[float, Field(gt=0), _LENGTH]
Gap = Annotated[float, Field(ge=0), _GAP]
Speed = Annotated[float, Field(gt=0), _SPEED]
Duration = Annotated[float, Field(gt=0), _TIME]
Instant = Annotated[float, Field(ge=0), _INSTANT]
Density = Annotated[float, Field(gt=0), _DENSITY]
Modulus = Annotated[float, Field(ge=0), _MODULUS]
PositiveModulus = Annotated[float, Field(gt=0), _MODULUS]
Decay = Annotated[float, Field(ge=0), _DECAY]
