"""Quantities, names and coordinates in tables of TOML files, as types of pydantic that check them."""

import re
from collections.abc import Callable
from decimal import Decimal
from typing import Annotated, NamedTuple

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, Strict

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.given import check_name
from hydrostat.units import quote

SLOW = "2 Hz"  # frequency of viscosity = "material"
MAX_NUMBER = 10**12  # no number of robot.toml is larger, whether bare or in SI


def quantity_parser(dimension: units.Dimension) -> Callable[[object], float]:
    """Return the function that reads text with a unit, in SI (ValueError: it is none)."""

    def parse(text: object) -> float:
        try:
            value = units.parse_quantity(text, dimension)
        except InputError as error:
            raise ValueError(str(error)) from None
        if abs(value) > MAX_NUMBER:
            raise ValueError(f"{quote(text)} is too large")
        return value

    return parse


def parse_number(value: object) -> Decimal:
    """Bare number; tomllib hands over int or Decimal."""
    if isinstance(value, bool) or not isinstance(value, int | Decimal):
        hint = "; write it without quotes and unit" if isinstance(value, str) and value[:1].isdigit() else ""
        raise ValueError(f"{quote(value)} is not a number{hint}")
    if isinstance(value, Decimal) and not value.is_finite():
        raise ValueError(f"{quote(value)} is not a finite number")
    if abs(value) > MAX_NUMBER:
        raise ValueError(f"{quote(value)} is too large; write a number between -1e12 and 1e12")
    return Decimal(value)


def _name(value: object) -> object:
    try:
        return check_name(value) if isinstance(value, str) else value
    except InputError as error:
        raise ValueError(str(error)) from None


Length = Annotated[float, BeforeValidator(quantity_parser(units.LENGTH))]
Pressure = Annotated[float, BeforeValidator(quantity_parser(units.PRESSURE))]
Mass = Annotated[float, BeforeValidator(quantity_parser(units.MASS))]
Density = Annotated[float, BeforeValidator(quantity_parser(units.DENSITY))]
Stiffness = Annotated[float, BeforeValidator(quantity_parser(units.STIFFNESS))]
Acceleration = Annotated[float, BeforeValidator(quantity_parser(units.ACCELERATION))]
Viscosity = Annotated[float, BeforeValidator(quantity_parser(units.VISCOSITY))]
Time = Annotated[float, BeforeValidator(quantity_parser(units.TIME))]
Force = Annotated[float, BeforeValidator(quantity_parser(units.FORCE))]
Torque = Annotated[float, BeforeValidator(quantity_parser(units.TORQUE))]
BendingStiffness = Annotated[float, BeforeValidator(quantity_parser(units.BENDING))]
Angle = Annotated[float, BeforeValidator(quantity_parser(units.ANGLE))]
TrueOrFalse = Annotated[bool, Strict()]
Number = Annotated[Decimal, BeforeValidator(parse_number)]
Coordinates = Annotated[list[Number], Field(min_length=2, max_length=3)]
Text = Annotated[str, Field(min_length=1, max_length=200)]
Name = Annotated[str, BeforeValidator(_name)]
Components = Annotated[list[Acceleration], Field(min_length=2, max_length=3)]
Pair = Annotated[list[Annotated[int, Strict()]], Field(min_length=2, max_length=2)]


class LossFrequency(NamedTuple):
    """Frequency at which a named material has its loss factor [Hz]."""

    frequency: float


def _named_viscosity(value: object) -> float | LossFrequency:
    """Viscosity, or "material", or "material at 7 Hz"."""
    material = re.fullmatch(r"material(?: at (.*))?", value) if isinstance(value, str) else None
    if material is None:
        return quantity_parser(units.VISCOSITY)(value)
    return LossFrequency(quantity_parser(units.FREQUENCY)(material[1] or SLOW))


NamedViscosity = Annotated[float | LossFrequency, BeforeValidator(_named_viscosity)]


class TomlTable(BaseModel):
    """Table of the file; an unknown key is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True)
