from collections.abc import Iterable
from decimal import Decimal

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.units import (
    ACCELERATION,
    DENSITY,
    LENGTH,
    PRESSURE,
    STIFFNESS,
    TIME,
    VISCOSITY,
    Dimension,
    format_quantity,
    parse_quantity,
    plain,
    quote,
    scale_down,
    scale_up,
)

UNITS = ["mm", "cm", "m", "in", "ft", "um", "km", "yard"]


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("12 mm", LENGTH, 0.012),
        ("12mm", LENGTH, 0.012),
        (" 1.5\tcm ", LENGTH, 0.015),
        (".5 in", LENGTH, 0.0127),
        ("-2. m", LENGTH, -2.0),
        ("+1e-3 km", LENGTH, 1.0),
        ("2 µm", LENGTH, 2e-6),
        ("3 meters", LENGTH, 3.0),
        ("0.1 mm", LENGTH, 1e-4),
        ("30 kPa", PRESSURE, 30e3),
        ("1 N/mm^2", PRESSURE, 1e6),
        ("1 N/mm**2", PRESSURE, 1e6),
        ("1 psi", PRESSURE, pytest.approx(6894.757293168, rel=1e-12)),
        ("40 kg/m^3", DENSITY, 40.0),
        ("40 kg/m³", DENSITY, 40.0),
        ("0.04 g / cm^3", DENSITY, 40.0),
        ("4 N/mm", STIFFNESS, 4000.0),
        ("4 kN m^-1", STIFFNESS, 4000.0),
        ("-0.0 mm", LENGTH, 0.0),
        ("-9.81 m/s^2", ACCELERATION, -9.81),
        ("9.81 m/s²", ACCELERATION, 9.81),
        ("9.81 N/kg", ACCELERATION, 9.81),
        ("981 cm / s / s", ACCELERATION, 9.81),
        ("40 Pa s", VISCOSITY, 40.0),
        ("0.04 kPa s", VISCOSITY, 40.0),
        ("40Pa.s", VISCOSITY, 40.0),
        ("40 Pa·s", VISCOSITY, 40.0),
        ("40 Pa*s", VISCOSITY, 40.0),
        ("40. Pa . s", VISCOSITY, 40.0),
        ("5 mPa s", VISCOSITY, 0.005),
        ("3 P", VISCOSITY, 0.3),
        ("2 s", TIME, 2.0),
        ("30 ms", TIME, 0.03),
        ("1.5 min", TIME, 90.0),
    ],
)
def test_parse(text: str, dimension: Dimension, value: float) -> None:
    """Oracle: SI by hand, to the last bit where the decimal number has one."""
    assert parse_quantity(text, dimension) == value


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (12, '12 has no unit; write a length as text: "12 mm"'),
        (None, "None has no unit"),
        ("12", '"12" has no unit; write for example "12 mm"'),
        ("", '"" is not a length'),
        ("mm", '"mm" is not a length'),
        ("1,5 mm", '"1,5 mm" is not a length'),
        ("1 2 mm", '"1 2 mm" is not a length'),
        ("nan mm", '"nan mm" is not a length'),
        ("1e9999 mm", 'unknown unit "e9999 mm"'),
        ("1e999 mm", '"1e999 mm" is too large'),
        ("12 kPa", '"kPa" does not measure a length'),
        ("12 mm^2", "does not measure a length"),
        ("12 zorks", 'unknown unit "zorks"; write a length for example as "12 mm"'),
        ("12 m\nm", "does not measure a length|unknown unit"),
        ("12 mm.", 'unknown unit "mm."'),
        ("12 mm..mm", 'unknown unit "mm..mm"'),
        ("12 Pa.s", "does not measure a length"),
        ("12 mm; import os", "unknown unit"),
        ("12 m**9**9**9", "unknown unit"),
        ("12 __class__", '"12 __class__" is not a length'),
        ("1" * 10**6 + " mm", r'"1{57}..." is not a length'),
        (" " * 10**6, "is not a length"),
    ],
)
def test_refused(text: object, message: str) -> None:
    """Oracle: one line with the value and what is allowed, at once, however long the text."""
    with pytest.raises(InputError, match=message) as caught:
        parse_quantity(text, LENGTH)
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 200


@settings(max_examples=300, deadline=None)
@given(value=st.floats(allow_nan=False, allow_infinity=False, min_value=-1e30, max_value=1e30))
def test_text_keeps_every_bit(value: float) -> None:
    """Oracle: the float itself."""
    for dimension in (LENGTH, PRESSURE, DENSITY, STIFFNESS, ACCELERATION, VISCOSITY, TIME):
        assert parse_quantity(format_quantity(value, dimension), dimension) == value


@settings(max_examples=300, deadline=None)
@given(value=st.floats(allow_nan=False, allow_infinity=False), unit=st.sampled_from(UNITS))
@example(value=4.006779345652634e16, unit="in")  # its repr lies half-way between two floats
def test_numbers_keep_every_bit(value: float, unit: str) -> None:
    """Oracle: the float itself."""
    number = scale_down(value, unit, LENGTH)
    assert scale_up(Decimal(plain(number)), unit, LENGTH) == value


@settings(max_examples=300, deadline=None)
@given(number=st.decimals(-(10**6), 10**6, places=6), unit=st.sampled_from(UNITS))
def test_numbers_come_back_as_typed(number: Decimal, unit: str) -> None:
    """Oracle: the decimal number itself: what a person typed in inches is not drowned in digits."""
    assert scale_down(scale_up(number, unit, LENGTH), unit, LENGTH) == number


@pytest.mark.parametrize(
    ("number", "text"),
    [("12.50", "12.5"), ("100", "100"), ("1E+3", "1000"), ("-0.0", "0"), ("0E+9", "0"), ("1E-20", "1e-20")],
)
def test_plain(number: str, text: str) -> None:
    """Oracle: by hand."""
    assert plain(Decimal(number)) == text


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        ("a", '"a"'),
        ("a\nb\x00", '"a\\nb\\x00"'),
        ("x" * 100, '"' + "x" * 57 + '..."'),
        (5, "5"),
        (10**400, "a huge number"),
        (-(10**4000), "a huge number"),
        (True, "true"),
        ([1], "a list"),
        ({}, "a table"),
        (Decimal("NaN"), "NaN"),
    ],
)
def test_quote(value: object, shown: str) -> None:
    """Oracle: by hand."""
    assert quote(value) == shown


@pytest.mark.parametrize(("unit", "dimension"), units.COMMON)
def test_the_common_units_are_those_of_pint(
    unit: str, dimension: units.Dimension, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = units.COMMON[unit, dimension]
    monkeypatch.setattr(units, "COMMON", {})
    written = {"Nm": "N m", "Nmm": "N mm"}.get(unit, unit)  # pint asks for the space
    assert units.unit_factor.__wrapped__(written, dimension) == known


@pytest.mark.parametrize(
    ("words", "listed"), [([], ""), (["a"], "a"), (["a", "b"], "a and b"), (iter("abcd"), "a, b, c and d")]
)
def test_words_in_a_row(words: Iterable[str], listed: str) -> None:
    """Oracle: by hand."""
    assert units.list_words(words) == listed
