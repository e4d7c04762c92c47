import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from viscopoint.units import USUAL, converted, parse


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("0.5 mm", "mm", 0.5),
        ("650 1/ms", "1/ms", 650.0),
        ("0.65 1/us", "1/ms", 650.0),
        ("1.0 g/cm^3", "g/mm^3", 1e-3),
        ("1000 kg/m**3", "g/mm^3", 1e-3),
        ("20 us", "ms", 0.02),
        ("20 µs", "ms", 0.02),
        ("550 MPa", "MPa", 550.0),
        ("550 N/mm^2", "MPa", 550.0),
        ("150 m/s", "m/s", 150.0),
        ("1e-1m", "mm", 100.0),
    ],
)
def test_quantities_convert_to_g_mm_ms(text: str, unit: str, value: float):
    assert parse(text, unit) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(("symbol", "unit"), USUAL)
def test_usual_units_are_to_the_last_bit_what_pint_makes_of_them(symbol: str, unit: str):
    for number in (1.0, 3.0, 0.38, 25.4, 1e-9, 123456.7):
        assert parse(f"{number!r} {symbol}", unit) == converted(number, symbol, unit)


def test_internal_units_are_consistent():
    # in g, mm, ms a force in N is g mm/ms^2, a pressure in MPa is g/(mm ms^2), an energy in mJ is g mm^2/ms^2
    assert parse("1 g*mm/ms^2", "N") == pytest.approx(1.0)
    assert parse("1 g/mm/ms^2", "MPa") == pytest.approx(1.0)
    assert parse("1 g*mm^2/ms^2", "mJ") == pytest.approx(1.0)


@given(st.text(max_size=40))
def test_any_text_is_a_quantity_or_a_value_error(text: str):
    with contextlib.suppress(ValueError):
        assert isinstance(parse(text, "mm"), float)


@pytest.mark.parametrize(
    "text", ["1 mm^9^9^9", "1 " + "m*" * 60 + "m", "1 __import__", "1 mm;", "9" * 200 + " mm", "1 9**9"]
)
def test_hostile_units_are_refused(text: str):
    with pytest.raises(ValueError, match=r"unit|number"):
        parse(text, "mm")
