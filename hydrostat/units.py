"""Units at the door: text such as "12 mm" becomes SI and back without loss; counts with their nouns."""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Context, Decimal
from functools import cache
from typing import Any

from hydrostat.errors import InputError

MM = 1e-3
"""One millimeter [m]."""

MILLIMETERS = 1e3
"""Millimeters in a meter."""


@dataclass(frozen=True)
class Dimension:
    """Physical dimension that a user may write as text.

    Attributes:
        name: name used in error messages.
        si: SI unit used inside hydrostat.
        unit: unit that hydrostat writes to files.
        example: example shown to a user whose text was refused.
    """

    name: str
    si: str
    unit: str
    example: str


LENGTH = Dimension("a length", "m", "mm", "12 mm")
PRESSURE = Dimension("a pressure", "Pa", "kPa", "30 kPa")
DENSITY = Dimension("a density", "kg/m^3", "kg/m^3", "40 kg/m^3")
STIFFNESS = Dimension("a stiffness", "N/m", "N/mm", "4 N/mm")
ACCELERATION = Dimension("an acceleration", "m/s^2", "m/s^2", "9.81 m/s^2")
FREQUENCY = Dimension("a frequency", "Hz", "Hz", "2 Hz")
VISCOSITY = Dimension("a viscosity", "Pa*s", "Pa s", "40 Pa s")
MASS = Dimension("a mass", "kg", "g", "58 g")
TIME = Dimension("a time", "s", "s", "2 s")
FORCE = Dimension("a force", "N", "N", "20 N")
SPEED = Dimension("a speed", "m/s", "mm/s", "50 mm/s")
TORQUE = Dimension("a torque", "N*m", "N m", "0.1 N m")
BENDING = Dimension("a bending or torsional stiffness", "N*m^2", "N mm^2", "2500 N mm^2")
ANGLE = Dimension("an angle", "deg", "deg", "75 deg")

COMMON = {
    (unit, dimension): Decimal(factor).normalize()
    for dimension, factors in {
        LENGTH: {"m": "1", "cm": "0.01", "mm": "0.001"},
        PRESSURE: {"Pa": "1", "kPa": "1000", "MPa": "1000000", "GPa": "1000000000"},
        DENSITY: {"kg/m^3": "1"},
        STIFFNESS: {"N/m": "1", "N/mm": "1000"},
        ACCELERATION: {"m/s^2": "1", "mm/s^2": "0.001"},
        FREQUENCY: {"Hz": "1"},
        VISCOSITY: {"Pa s": "1"},
        MASS: {"kg": "1", "g": "0.001"},
        TIME: {"s": "1", "ms": "0.001"},
        FORCE: {"N": "1"},
        SPEED: {"m/s": "1", "mm/s": "0.001"},
        BENDING: {"N m^2": "1", "N mm^2": "0.000001"},
        TORQUE: {"N m": "1", "N mm": "0.001", "Nm": "1", "Nmm": "0.001"},
        ANGLE: {"deg": "1"},
    }.items()
    for unit, factor in factors.items()
}
"""Factors from the most common units to SI units; any other unit loads pint, which takes 0.35 s."""

_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?)\s*([^\W\d_].*?)?\s*", re.DOTALL)
_SYMBOL = r"[^\W\d_]+(?:\s*(?:\^|\*\*)\s*-?\d|[²³])?"
_UNIT = re.compile(rf"{_SYMBOL}(?:\s*[*/ .·]\s*{_SYMBOL}){{0,3}}")
_DOT = re.compile("[.·]")
_MAX_LETTERS = 60
"""Characters of a quantity, and of a value shown in an error."""


def parse_quantity(text: object, dimension: Dimension) -> float:
    """Value in SI of a text with its unit.

    Raises:
        InputError: no text, no number, no unit, an unknown unit, or a unit of another dimension.
    """
    if not isinstance(text, str):
        raise InputError(f'{quote(text)} has no unit; write {dimension.name} as text: "{dimension.example}"')
    match = _QUANTITY.fullmatch(text) if len(text) <= _MAX_LETTERS else None
    if not match:
        raise InputError(f'{quote(text)} is not {dimension.name}; write for example "{dimension.example}"')
    number, unit = match.groups()
    if unit is None:
        raise InputError(f'{quote(text)} has no unit; write for example "{dimension.example}"')
    value = _si(Decimal(number), unit_factor(unit, dimension))
    if not math.isfinite(value):
        raise InputError(f"{quote(text)} is too large")
    return value


def format_quantity(value: float, dimension: Dimension) -> str:
    """Text in the dimension's usual unit that `parse_quantity` reads back to the very same value."""
    return f"{plain(scale_down(value, dimension.unit, dimension))} {dimension.unit}"


def scale_up(number: Decimal, unit: str, dimension: Dimension) -> float:
    """SI value of a bare number in `unit`."""
    return _si(number, unit_factor(unit, dimension))


def scale_down(value: float, unit: str, dimension: Dimension) -> Decimal:
    """Shortest decimal number that `scale_up` reads back from `unit` to the very same value."""
    factor = unit_factor(unit, dimension)
    exact = Decimal(float(value)) / factor
    for digits in range(15, 19):
        number = Context(prec=digits).plus(exact)
        if _si(number, factor) == value:
            return number
    return exact


def plain(number: Decimal) -> str:
    """Decimal number without trailing zeros, zero without a sign, with an exponent only if it would be very long."""
    if not number:
        return "0"
    if not -12 <= number.adjusted() <= 24:
        return format(number.normalize(), "e")
    text = format(number, "f")
    return text.rstrip("0").rstrip(".") if "." in text else text


def quote(value: object) -> str:
    """User's value as an error shows it: on one line, and cut when long."""
    if isinstance(value, list):
        return "a list"
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int) and value.bit_length() > 200:
        return "a huge number"
    text = str(value)
    if len(text) > _MAX_LETTERS:
        text = text[: _MAX_LETTERS - 3] + "..."
    return f'"{printable(text)}"' if isinstance(value, str) else printable(text)


def printable(text: str) -> str:
    """Text on one line: control characters as their escapes."""
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in text)


@cache
def unit_factor(unit: str, dimension: Dimension) -> Decimal:
    """Return the number of SI units in one `unit`.

    Raises:
        InputError: the unit is unknown or measures something else.
    """
    if (unit, dimension) in COMMON:
        return COMMON[unit, dimension]
    import pint

    if not _UNIT.fullmatch(unit):
        raise _unknown(unit, dimension)
    try:
        factor = _registry().Quantity(Decimal(1), _DOT.sub("*", unit)).to(dimension.si).magnitude
    except pint.DimensionalityError:
        raise InputError(
            f'{quote(unit)} does not measure {dimension.name}; write for example "{dimension.example}"'
        ) from None
    except (pint.errors.PintError, AttributeError, ValueError, TypeError, ArithmeticError, AssertionError):
        raise _unknown(unit, dimension) from None
    return Decimal(f"{factor:.20g}").normalize()


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(non_int_type=Decimal)  # pyright: ignore[reportArgumentType]


def _unknown(unit: str, dimension: Dimension) -> InputError:
    return InputError(f'unknown unit {quote(unit)}; write {dimension.name} for example as "{dimension.example}"')


def _si(number: Decimal, factor: Decimal) -> float:
    return float(number * factor) + 0.0  # no -0.0


def plural(number: int, noun: str) -> str:
    """Number with its noun: "1 winch", "2 winches"."""
    plural = noun + ("es" if noun.endswith("ch") else "s")
    return f"{number} {noun if number == 1 else plural}"


def list_words(words: Iterable[str]) -> str:
    """Words in a row: "a"; "a and b"; "a, b and c"; empty without any."""
    *first, last = [*words] or [""]
    return f"{', '.join(first)} and {last}" if first else last
