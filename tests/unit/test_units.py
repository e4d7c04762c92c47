import contextlib
import itertools
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError
from scipy import constants

import viscopoint as vp
from viscopoint.case import units
from viscopoint.case.unit_names import UNITS
from viscopoint.case.units import parse


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("0.5 mm", "mm", 0.5),
        ("1e-1m", "mm", 100.0),
        ("0.15 in", "mm", 3.81),
        ("20 us", "ms", 0.02),
        ("20 µs", "ms", 0.02),  # the sign for micro
        ("20 μs", "ms", 0.02),  # the Greek letter
        ("650 1/ms", "1/ms", 650.0),
        ("650/ms", "1/ms", 650.0),
        ("650 /ms", "1/ms", 650.0),
        ("650 ms^-1", "1/ms", 650.0),
        ("650 ms⁻¹", "1/ms", 650.0),
        ("0.65 1/us", "1/ms", 650.0),
        ("1.0 g/cm^3", "g/mm^3", 1e-3),
        ("1 g/cm3", "g/mm^3", 1e-3),
        ("1 g/cm³", "g/mm^3", 1e-3),
        ("1 g/cc", "g/mm^3", 1e-3),
        ("1000 kg/m3", "g/mm^3", 1e-3),
        ("1000 kg/m**3", "g/mm^3", 1e-3),
        ("1000 kg·m^-3", "g/mm^3", 1e-3),
        ("1e-9 tonne/mm^3", "g/mm^3", 1e-3),
        ("1e-9 t/mm3", "g/mm^3", 1e-3),
        ("1e-9 N*s^2/mm^4", "g/mm^3", 1e-3),
        ("550 MPa", "MPa", 550.0),
        ("550 N/mm2", "MPa", 550.0),
        ("550 N/mm^2", "MPa", 550.0),
        ("5.5 kbar", "MPa", 550.0),
        ("5500 bar", "MPa", 550.0),
        ("150 m/s", "m/s", 150.0),
        ("150 mm/ms", "m/s", 150.0),
        ("0.15 km/s", "m/s", 150.0),
        ("540 km/h", "m/s", 150.0),
    ],
)
def test_quantities_convert_to_g_mm_ms_to_the_last_bit(text: str, unit: str, value: float):
    assert parse(text, unit) == value


@pytest.mark.parametrize(
    ("symbol", "unit", "si"),
    [
        ("in", "m", constants.inch), ("ft", "m", constants.foot), ("thou", "m", constants.mil),
        ("lb", "kg", constants.lb), ("slug", "kg", constants.slug), ("tonne", "kg", constants.metric_ton),
        ("short_ton", "kg", constants.short_ton), ("long_ton", "kg", constants.long_ton),
        ("lbf", "N", constants.lbf), ("kgf", "N", constants.kgf), ("dyn", "N", constants.dyn),
        ("psi", "Pa", constants.psi), ("ksi", "Pa", 1e3 * constants.psi), ("bar", "Pa", constants.bar),
        ("atm", "Pa", constants.atm), ("mph", "m/s", constants.mph),
        ("lb/in^3", "kg/m^3", constants.lb / constants.inch**3),
    ],
)  # fmt: skip
def test_factors_are_those_of_scipy(symbol: str, unit: str, si: float):
    assert parse(f"1 {symbol}", unit) == pytest.approx(si, rel=1e-14)


def test_internal_units_are_consistent():
    # in g, mm, ms a force in N is g mm/ms^2, a pressure in MPa is g/(mm ms^2), an energy in mJ is g mm^2/ms^2
    assert parse("1 g*mm/ms^2", "N") == 1.0
    assert parse("1 g/mm/ms^2", "MPa") == 1.0
    assert parse("1 g*mm^2/ms^2", "mJ") == 1.0
    assert parse("1 mJ/mm^3", "MPa") == 1.0


def written(value: Fraction) -> str | None:
    """Return a number's digits, if they end."""
    digits, rest = 0, value.denominator
    while rest % 10 == 0 or rest % 5 == 0 or rest % 2 == 0:
        rest //= 10 if rest % 10 == 0 else 5 if rest % 5 == 0 else 2
        digits += 1
    return f"{int(value * 10**digits)}e-{digits}" if rest == 1 else None


KINDS = {  # what a case has, in units of all systems
    "mm": ["um", "mm", "cm", "m", "in", "ft", "thou", "µm", "inches"],
    "ms": ["ns", "us", "ms", "s", "min"],
    "m/s": ["mm/ms", "mm/us", "m/s", "km/s", "ft/s", "in/ms", "mm/s", "km/h"],
    "g/mm^3": ["g/cm^3", "kg/m^3", "g/mm^3", "tonne/mm^3", "kg/l", "g/cc", "Mg/m^3", "N*s^2/mm^4", "lb/in^3"],
    "MPa": ["Pa", "kPa", "MPa", "GPa", "N/mm^2", "bar", "kN/mm2", "g/mm/ms^2", "J/cm^3", "kgf/mm^2", "psi"],
    "1/ms": ["1/s", "1/ms", "1/us", "/ns", "s^-1"],
}
PAIRS = [(unit, *pair) for unit, symbols in KINDS.items() for pair in itertools.permutations(symbols, 2)]
FACTORS = {symbol: units._unit(symbol).factor for symbols in KINDS.values() for symbol in symbols}


@given(st.sampled_from(PAIRS), st.integers(1, 10**17 - 1), st.integers(-20, 3))
@example(("g/mm^3", "g/cm^3", "kg/m^3"), 1, 0)  # these differed in the last bit
@example(("g/mm^3", "g/cm^3", "g/mm^3"), 893, -2)
@example(("MPa", "GPa", "Pa"), 117, -3)
def test_the_same_quantity_in_other_units_gives_the_same_float(pair: tuple[str, str, str], digits: int, exponent: int):
    unit, one, other = pair
    there = written(Fraction(digits) * Fraction(10) ** exponent * FACTORS[one] / FACTORS[other])
    if there is None or len(there) > 60:  # such as thirds of a metre per second; too long to be a quantity
        return
    with contextlib.suppress(ValueError):  # out of range in one is so in the other
        value = parse(f"{digits}e{exponent} {one}", unit)
        assert parse(f"{there} {other}", unit) == value


@given(st.text(max_size=40))
def test_any_text_is_a_quantity_or_a_value_error(text: str):
    with contextlib.suppress(ValueError):
        assert isinstance(parse(text, "mm"), float)


@given(st.sampled_from([*UNITS, "1", "ton", "Hz", "", "²", "⁻", "^", "**", "*", "/"]).flatmap(
    lambda one: st.lists(st.sampled_from([one, "*", "/", " ", "·", "^2", "-3", *UNITS]), max_size=8)
))  # fmt: skip
def test_any_product_of_units_is_one_or_a_value_error(parts: list[str]):
    with contextlib.suppress(ValueError):
        assert isinstance(parse("1 " + "".join(parts), "MPa"), float)


@pytest.mark.parametrize(
    "text",
    [
        "1 mm^9^9^9",
        "1 " + "m*" * 60 + "m",
        "1 __import__",
        "1 mm;",
        "9" * 200 + " mm",
        "1 9**9",
        "1e-999999999 9",
        "2 µ",
    ],
)
def test_hostile_units_are_refused(text: str):
    with pytest.raises(ValueError, match=r"unit|number"):
        parse(text, "mm")


def refused(kind: Any, text: str) -> str:
    """Return what a case is told of a quantity."""
    with pytest.raises(ValidationError) as caught:
        TypeAdapter(kind).validate_python(text)
    return caught.value.errors()[0]["msg"]


@pytest.mark.parametrize(
    ("kind", "text", "words"),
    [
        (units.Density, "8.93e-9 ton/mm^3", "write 'tonne' (1000 kg), 'short_ton' (2000 lb) or 'long_ton'"),
        (units.Density, "0.6 oz/in^3", "it may be a mass, a force or a volume"),
        (units.Density, "0.036 pound/in^3", "write 'lb' for the mass, or 'lbf' for the force"),
        (units.Density, "8 lb/gal", "countries differ"),
        (units.Density, "1 gm/cc", "write 'g' for the gram"),
        (units.Modulus, "5 lb/in^2", "the force is 'lbf'"),
        (units.Modulus, "550 mPa", "did you mean 'MPa'?"),
        (units.Modulus, "80 KSI", "did you mean 'ksi'?"),
        (units.Length, "3.8 Mm", "did you mean 'mm'?"),
        (units.Length, "3.8 M", "write 'm' for the metre"),
        (units.Length, "5 mil", "write 'thou' (0.001 in) or 'mm'"),
        (units.Length, "1 rod", "no known unit"),
        (units.Length, "3 px", "no known unit"),
        (units.Duration, "20 Ms", "did you mean 'ms'?"),
        (units.Speed, "3 rpm", "ambiguous unit, 'rpm'"),
        *((units.Decay, f"650 {unit}", "write '1/s' for a rate") for unit in ("Hz", "rad/s", "cycle/ms", "deg/us")),
    ],
)  # fmt: skip
def test_a_unit_that_may_mean_something_else_is_refused_by_what_to_write(kind: Any, text: str, words: str):
    assert words in refused(kind, text)


@pytest.mark.parametrize(
    ("kind", "text", "words"),
    [
        (units.Modulus, "550e-9 MPa", "is 5.5e-07 MPa, not plausible as a modulus: 1e-06 to 1e+07 MPa"),
        (units.Modulus, "200e9 MPa", 'did you mean "200e9 Pa"?'),
        (units.Density, "1000 g/cm^3", 'did you mean "1000 kg/m^3"?'),
        (units.Density, "8.93e-9 g/cm^3", 'did you mean "8.93e-9 tonne/mm^3"?'),
        (units.Speed, "150 km/s", 'did you mean "150 m/s"?'),
        (units.Length, "1e-11 m", "not plausible as a length"),
        (units.Length, "1000 km", "not plausible as a length"),
        (units.Duration, "20e7 h", "not plausible as a time"),
        (units.Decay, "1e-10 1/ms", "not plausible as a decay constant"),
    ],
)
def test_an_implausible_size_gets_a_question(kind: Any, text: str, words: str):
    assert words in refused(kind, text)


def test_what_is_studied_is_plausible():
    # aerogel to osmium, gels to diamond and nearly rigid solids, grains to hills, gas guns to meteoroids
    studied: tuple[tuple[Any, list[str]], ...] = (
        (units.Density, ["0.16 kg/m^3", "22.6 g/cm^3"]),
        (units.Modulus, ["0 MPa", "10 Pa", "443 GPa", "10 TPa"]),
        (units.Length, ["1 nm", "1 um", "10 km"]),
        (units.Speed, ["1 um/s", "72 km/s"]),
        (units.Decay, ["0 1/s", "1e-3 1/s", "1e12 1/s"]),
        (units.Duration, ["1 ps", "1 h"]),
        (units.Gap, ["0 mm", "1e-6 nm"]),
    )
    for kind, values in studied:
        for value in values:
            TypeAdapter(kind).validate_python(value)


def test_the_copper_bar_in_tonnes_is_that_in_grams():
    changes = {"material.density": "8.93e-9 tonne/mm^3", "material.bulk": "130000 N/mm2", "rod.radius": "0.32 cm"}
    assert vp.Case.load("copper", changes) == vp.Case.load("copper")
    with pytest.raises(vp.CaseError, match="ambiguous unit, 'ton'"):
        vp.Case.load("copper", {"material.density": "8.93e-9 ton/mm^3"})
