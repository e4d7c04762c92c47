"""The units that cases may be written in, with exact factors to g, mm and ms.

A list of what engineers write, and no more: a unit that could be read in two ways (the ton) is refused by both its
names, and one that differs from a listed unit in upper and lower case alone (mPa, Mm) by the one that may be meant.
Inch, pound and standard gravity are those of the international agreements, exact by definition.
"""

import difflib
from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple


class Unit(NamedTuple):
    """A factor to g, mm and ms, and the powers of mass, length and time."""

    factor: Fraction
    dimension: tuple[int, int, int]

    def to_the(self, power: int) -> "Unit":
        """Return the unit to a power."""
        mass, length, time = self.dimension
        return Unit(self.factor**power, (power * mass, power * length, power * time))

    def times(self, other: "Unit") -> "Unit":
        """Return the product of two units."""
        (a, b, c), (d, e, f) = self.dimension, other.dimension
        return Unit(self.factor * other.factor, (a + d, b + e, c + f))


ONE = Unit(Fraction(1), (0, 0, 0))
MASS, LENGTH, TIME = (1, 0, 0), (0, 1, 0), (0, 0, 1)
VOLUME, SPEED, FORCE, STRESS, ENERGY = (0, 3, 0), (0, 1, -1), (1, 1, -2), (1, -1, -2), (1, 2, -2)
KINDS = {
    MASS: "a mass", LENGTH: "a length", TIME: "a time", VOLUME: "a volume", SPEED: "a speed", FORCE: "a force",
    STRESS: "a stress", ENERGY: "an energy", (0, 2, 0): "an area", (1, -3, 0): "a density", (0, 0, -1): "a rate",
    (0, 1, -2): "an acceleration", (0, 0, 0): "a plain number",
}  # fmt: skip
PREFIXES = {
    "f": "1e-15", "p": "1e-12", "n": "1e-9", "u": "1e-6", "µ": "1e-6", "m": "1e-3", "c": "1e-2", "d": "1e-1", "": "1",
    "h": "1e2", "k": "1e3", "M": "1e6", "G": "1e9", "T": "1e12",
    "nano": "1e-9", "micro": "1e-6", "milli": "1e-3", "centi": "1e-2", "kilo": "1e3", "mega": "1e6", "giga": "1e9",
}  # fmt: skip
LONG = ("", "nano", "micro", "milli", "centi", "kilo", "mega", "giga")
INCH, POUND, GRAVITY = Fraction("25.4"), Fraction("453.59237"), Fraction("9.80665e-3")  # mm, g, mm/ms^2
WITH_PREFIXES = (  # symbol, the prefixes that it takes, names that take long ones, factor, dimension
    ("m", "nuµm cdk", ("meter", "metre"), "1000", LENGTH),
    ("s", "fpnuµm ", ("second", "sec"), "1000", TIME),
    ("sec", "nuµm", (), "1000", TIME),
    ("g", "uµmk ", ("gram",), "1", MASS),
    ("N", "uµmkM ", ("newton",), "1", FORCE),
    ("Pa", "hkMGT ", ("pascal",), "1e-6", STRESS),
    ("bar", "kM ", (), "0.1", STRESS),
    ("J", "mkM ", ("joule",), "1000", ENERGY),
    ("l", "m ", ("liter", "litre"), "1e6", VOLUME),
    ("L", "m ", (), "1e6", VOLUME),
)
OTHERS = {  # names of one unit, factor, dimension
    "micron microns": ("1e-3", LENGTH),
    "in inch inches": (INCH, LENGTH),
    "thou": (INCH / 1000, LENGTH),
    "ft foot feet": (12 * INCH, LENGTH),
    "min minute minutes": (60_000, TIME),
    "h hr hour hours": (3_600_000, TIME),
    "t tonne tonnes Mg": ("1e6", MASS),
    "lb lbm": (POUND, MASS),
    "slug slugs": (POUND * GRAVITY / (12 * INCH) * 1_000_000, MASS),
    "short_ton": (2000 * POUND, MASS),
    "long_ton": (2240 * POUND, MASS),
    "lbf": (POUND * GRAVITY, FORCE),
    "kip kips": (1000 * POUND * GRAVITY, FORCE),
    "kgf": (1000 * GRAVITY, FORCE),
    "dyn dyne": ("1e-5", FORCE),
    "psi": (POUND * GRAVITY / INCH**2, STRESS),
    "ksi": (1000 * POUND * GRAVITY / INCH**2, STRESS),
    "Msi": (1_000_000 * POUND * GRAVITY / INCH**2, STRESS),
    "atm": ("0.101325", STRESS),
    "cc": ("1000", VOLUME),
    "mph": (63360 * INCH / 3_600_000, SPEED),
}
AMBIGUOUS = {  # names of what is refused, and what to write
    "ton tons": "write 'tonne' (1000 kg), 'short_ton' (2000 lb) or 'long_ton' (2240 lb)",
    "pound pounds lbs": "write 'lb' for the mass, or 'lbf' for the force",
    "oz ounce ounces": "it may be a mass, a force or a volume; write it in 'g', 'N' or 'l'",
    "cal kcal Cal calorie calories BTU btu": "it has several definitions; write it in 'J'",
    "gal gallon gallons pint pints quart quarts barrel barrels bushel": "countries differ; write 'l' or 'm^3'",
    "mil mils": "write 'thou' (0.001 in) or 'mm'",
    "gm gms": "write 'g' for the gram",
    "M": "it may be a metre, a mega- or a mole per litre; write 'm' for the metre",
    "rad radian radians deg degree degrees cycle cycles turn turns rev revs rpm rps Hz kHz MHz GHz": (
        "it counts angles or cycles; write '1/s' for a rate"
    ),
}


def _named() -> Iterator[tuple[str, Unit]]:
    for symbol, prefixes, names, factor, dimension in WITH_PREFIXES:
        plain = Unit(Fraction(factor), dimension)
        shorts = [(prefix.strip() + symbol, prefix.strip()) for prefix in prefixes]
        longs = [(prefix + name + end, prefix) for name in names for prefix in LONG for end in ("", "s")]
        for name, prefix in (*shorts, *longs):
            yield name, plain._replace(factor=Fraction(PREFIXES[prefix]) * plain.factor)
    for names, (factor, dimension) in OTHERS.items():
        for name in names.split():
            yield name, Unit(Fraction(factor), dimension)


UNITS = dict(_named())
REFUSED = {name: words for names, words in AMBIGUOUS.items() for name in names.split()}


def unit_of(name: str) -> Unit:
    """Return the unit of a name; raise ``ValueError`` with what may be meant if it has none of its own."""
    if name in UNITS:
        return UNITS[name]
    if name in REFUSED:
        raise ValueError(f"has an ambiguous unit, '{name}': {REFUSED[name]}")
    alike = [known for known in UNITS if known.casefold() == name.casefold()]
    alike = alike or difflib.get_close_matches(name, UNITS, n=1)
    hint = f"; did you mean {' or '.join(map(repr, alike))}?" if alike else ""
    raise ValueError(f"has no known unit ('{name}'){hint}")
