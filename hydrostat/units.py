"""Units at the door: text such as "12 mm" becomes SI, and SI becomes text again without loss."""

import re
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from functools import cache
from typing import Any

from hydrostat.errors import InputError


@dataclass(frozen=True)
class Dimension:
    """A physical dimension that a user may write as text.

    Attributes:
        name: as it stands in error messages.
        si: the unit used inside hydrostat.
        unit: the unit that hydrostat writes to files.
        example: shown to a user whose text was refused.
    """

    name: str
    si: str
    unit: str
    example: str


LENGTH = Dimension("a length", "m", "mm", "12 mm")
PRESSURE = Dimension("a pressure", "Pa", "kPa", "30 kPa")
DENSITY = Dimension("a density", "kg/m^3", "kg/m^3", "40 kg/m^3")
STIFFNESS = Dimension("a stiffness", "N/m", "N/mm", "4 N/mm")

_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?)\s*([A-Za-zµμ][A-Za-zµμ0-9*/^. ]{0,30})?\s*")


def parse_quantity(text: object, dimension: Dimension) -> float:
    """Value in SI of a text with its unit.

    Raises:
        InputError: no text, no number, no unit, an unknown unit, or a unit of another dimension.
    """
    if not isinstance(text, str):
        raise InputError(f'{text!r} has no unit; write {dimension.name} as text, for example "{dimension.example}"')
    match = _QUANTITY.fullmatch(text)
    if not match:
        raise InputError(f'"{text}" is not {dimension.name}; write for example "{dimension.example}"')
    number, unit = match.groups()
    if unit is None:
        raise InputError(f'"{text}" has no unit; write for example "{dimension.example}"')
    return float(_decimal(number) * unit_factor(unit.strip(), dimension))


def format_quantity(value: float, dimension: Dimension) -> str:
    """Text in the dimension's usual unit that `parse_quantity` reads back to the very same value."""
    return f"{plain(scale_down(value, dimension.unit, dimension))} {dimension.unit}"


def scale_up(number: object, unit: str, dimension: Dimension) -> float:
    """SI value of a bare number that stands in `unit`."""
    return float(_decimal(str(number)) * unit_factor(unit, dimension))


def scale_down(value: float, unit: str, dimension: Dimension) -> Decimal:
    """The decimal number which, in `unit`, is exactly the SI value."""
    return Decimal(repr(float(value))) / unit_factor(unit, dimension)


def plain(number: Decimal) -> str:
    """A decimal number without exponent and without trailing zeros."""
    text = format(number, "f")
    return text.rstrip("0").rstrip(".") if "." in text else text


@cache
def unit_factor(unit: str, dimension: Dimension) -> Decimal:
    """How many SI units one `unit` is.

    Raises:
        InputError: the unit is unknown or measures something else.
    """
    import pint

    registry = _registry()
    try:
        factor = registry.Quantity(Decimal(1), unit).to(dimension.si).magnitude
    except pint.DimensionalityError:
        raise InputError(
            f'"{unit}" does not measure {dimension.name}; write for example "{dimension.example}"'
        ) from None
    except (pint.errors.PintError, AttributeError, ValueError, TypeError, ArithmeticError, AssertionError):
        raise InputError(
            f'unknown unit "{unit}"; write {dimension.name} for example as "{dimension.example}"'
        ) from None
    return Decimal(f"{factor:.20g}").normalize()


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(non_int_type=Decimal)


def _decimal(text: str) -> Decimal:
    try:
        number = Decimal(text)
    except InvalidOperation:
        raise InputError(f'"{text}" is not a number') from None
    if not number.is_finite():
        raise InputError(f"{text} is not a finite number")
    return number
