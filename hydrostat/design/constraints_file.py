"""`read_constraints`: from a TOML file to `Constraints` for one robot."""

import re
import warnings
from dataclasses import fields, replace
from decimal import Decimal
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Annotated, Any, get_type_hints

from pydantic import BeforeValidator, Field, Strict, create_model

from hydrostat import units
from hydrostat.design.constraints import RANGES, Constraints
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.design.zone import Zone
from hydrostat.errors import HydrostatWarning, InputError
from hydrostat.files import read_text
from hydrostat.robot import Robot, TablesFile
from hydrostat.toml_schema import Angle, Force, Length, Name, Number, TomlTable, Torque, parse_number, quantity_parser

Count = Annotated[int, Strict()]
Choice = Annotated[bool, Strict()]


def _part(value: object) -> object:
    """A name, or a number, which counts from 1."""
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise ValueError("neither a name nor a number that counts from 1")
    return value


Part = Annotated[int | str, BeforeValidator(_part)]


def _zone_number(value: object) -> Decimal | float:
    """A bare number in the length unit of the robot, or text such as "35 mm", which becomes meters."""
    return quantity_parser(units.LENGTH)(value) if isinstance(value, str) else parse_number(value)


ZoneNumber = Annotated[Decimal | float, BeforeValidator(_zone_number)]
Corner = Annotated[list[ZoneNumber], Field(min_length=2, max_length=3)]


class Axis(StrEnum):
    """Across a mirror."""

    X = "x"
    Y = "y"
    Z = "z"


class ZoneTable(TomlTable):
    """[[winch_zone]], [[keep_out]], [[passive_zone]]."""

    at: Corner | None = None
    radius: ZoneNumber | None = None
    box: Annotated[list[Corner], Field(min_length=2, max_length=2)] | None = None
    outline: Annotated[list[Corner], Field(min_length=3, max_length=1000)] | None = None


class BuiltTable(TomlTable):
    """[tolerances]: the fields of `BuildTolerances`."""

    sewing: Length | None = None
    friction: Annotated[list[Number], Field(min_length=2, max_length=2)] | None = None
    young: Number | None = None
    thickness: Number | None = None
    stiffness: Number | None = None
    pins: Number | None = None
    slack: Length | None = None
    spool: Number | None = None


ZONES = {"winch_zone": "winch_zones", "keep_out": "keep_out", "passive_zone": "passive_zones"}
"""Tables of the file, and the fields of `Constraints` that they make."""

RENAMED = {"turn": "max_turn", "longest": "max_length", "still": "passive_zone", "built": "tolerances"}
"""Keys of older files, which are still read, and their present names."""

_KINDS = {"mirror": Axis, "locked_winches": list[Name], "locked_cables": list[Part], bool: Choice}
_QUANTITIES = {"m": Length, "degrees": Angle, "N": Force, "N m": Torque, "": Number}


def _forms() -> dict[str, Any]:
    """Type and default of each key of the file, from the fields of `Constraints` and their ranges."""
    tables, hints = {field: table for table, field in ZONES.items()}, get_type_hints(Constraints)
    forms: dict[str, Any] = {}
    for name in (field.name for field in fields(Constraints)):
        if name in tables:
            forms[tables[name]] = (list[ZoneTable], Field(default_factory=list))
            continue
        allowed = RANGES.get(name)
        kind: Any
        if allowed is None:
            kind = _KINDS.get(name) or _KINDS.get(hints[name], hints[name])
        else:
            kind = Count if allowed.whole else _QUANTITIES[allowed.unit]
        forms[name] = (kind | None, None)
    return forms


ConstraintsTable = create_model(
    "ConstraintsTable",
    __base__=TomlTable,
    __doc__="The whole file: the fields of `Constraints`, zones as tables of one zone each.",
    **_forms(),
    tolerances=(BuiltTable | None, None),
)


def read_constraints(path: str | Path, robot: Robot) -> Constraints:
    """Constraints for a robot from a file; what it leaves out is as in `Constraints`.

    Keys are the fields of `Constraints`: quantities as text with their unit ("5 mm"), zones as tables [[winch_zone]],
    [[keep_out]] and [[passive_zone]] in the length unit of the robot's file or as text with a unit, cables by name or
    by number, counted from 1. Keys of older files are read too, with a `HydrostatWarning` that names the present ones.
    Raises InputError: one line that names the file, the line, the key, what is wrong and what is allowed.
    """
    path = Path(path)
    return _ConstraintsReader(path, read_text(path), robot).constraints()


def read_uncertainty(path: str | Path, robot: Robot) -> BuildTolerances:
    """Read the build tolerances of a robot, from the table [tolerances] of a file of constraints.

    Keys are the fields of `BuildTolerances`: lengths as text with their unit, friction as the least and the largest
    coefficient, all else as plain numbers. What is left out is as is usual for the body (`BuildTolerances.of`). Raises
    InputError as `read_constraints` does.
    """
    path = Path(path)
    return _ConstraintsReader(path, read_text(path), robot).uncertainty()


class _ConstraintsReader(TablesFile):
    """Turns the text of a file into constraints."""

    kind = "constraints"
    empty = None

    def __init__(self, file: Path, text: str, robot: Robot) -> None:
        self.old: dict[str, str] = {}  # older names of keys that are there, by their present ones
        super().__init__(file, text)
        self.robot, self.unit = robot, robot.length_unit
        if self.old:
            keys = ", ".join(f"{old} is now {key}" for key, old in self.old.items())
            warnings.warn(f"{file}: renamed keys: {keys}", HydrostatWarning, stacklevel=3)

    def form(self) -> type[TomlTable]:
        return ConstraintsTable

    def written_key(self, key: str) -> str:
        """The key with the older name that the file has for it."""
        return re.sub(r"^\w+", lambda name: self.old.get(name[0], name[0]), key)

    def _data(self) -> dict[str, Any]:
        """File as tomllib reads it, with the present names of keys."""
        data = super()._data()
        for old in [key for key in data if key in RENAMED]:
            if RENAMED[old] in data:
                self.fail(old, f"is now {RENAMED[old]}, which is there too. Remove one.")
            self.old[RENAMED[old]] = old
            data[RENAMED[old]] = data.pop(old)
        return data

    def constraints(self) -> Constraints:
        """The constraints that the text describes, which fit the robot."""
        given: dict[str, Any] = {
            key: _plain(value) for key, value in self.table if value is not None and key not in {*ZONES, "tolerances"}
        }
        for table, field in ZONES.items():
            given[field] = self.records(table, self._zone)
        given["locked_winches"] = tuple(self.table.locked_winches or ())
        given["locked_cables"] = tuple(
            self.at(f"locked_cables[{place}]", partial(cable_name, name, self.robot))
            for place, name in enumerate(self.table.locked_cables or ())
        )
        return self.at("", lambda: _fitting(given, self.robot))

    def uncertainty(self) -> BuildTolerances:
        """The tolerances that the text describes, those usual for the body where it says nothing."""
        given = {key: value for key, value in self.table.tolerances or () if value is not None}
        numbers = {
            key: tuple(map(float, value)) if isinstance(value, list) else float(value) for key, value in given.items()
        }
        return self.at("tolerances", lambda: _usual_but(numbers, self.robot))

    def _zone(self, entry: Any) -> Zone:
        zone = Zone(
            at=None if entry.at is None else self._corner(entry.at),
            radius=None if entry.radius is None else self._corner([entry.radius])[0],
            box=None if entry.box is None else (self._corner(entry.box[0]), self._corner(entry.box[1])),
            outline=tuple(map(self._corner, entry.outline or ())),
        )
        dim = self.robot.body.mesh.dim
        if zone.dim != dim:
            raise InputError(f"wrong dimension of its points ({zone.dim}). Body: {dim}.")
        return zone

    def _corner(self, given: list[Decimal | float]) -> tuple[float, ...]:
        """Numbers of a zone [m]."""
        return tuple(self.point([value])[0] if isinstance(value, Decimal) else value for value in given)


def cable_name(given: str | int, robot: Robot) -> str:
    """The name of a cable, given that, or its number from 1 if no cable has such a name (InputError: there is none)."""
    names, text = [cable.name for cable in robot.cables], str(given)
    if text not in names and text.isascii() and text.isdigit() and 1 <= int(text[:9]) <= len(names):
        return names[int(text[:9]) - 1]
    return robot.cable(text).name


def _plain(value: Any) -> Any:
    """The value of a key as `Constraints` holds it."""
    return float(value) if isinstance(value, Decimal) else str(value) if isinstance(value, Axis) else value


def _usual_but(given: dict[str, Any], robot: Robot) -> BuildTolerances:
    """The usual tolerances of a body, but for some, whose complaints begin with the key."""
    try:
        return replace(BuildTolerances.of(robot.body), **given)
    except InputError as error:
        raise InputError(str(error).removeprefix("uncertainty: ")) from None


def _fitting(given: dict[str, Any], robot: Robot) -> Constraints:
    """Constraints that fit a robot, whose complaints begin with the key."""
    try:
        constraints = Constraints(**given)
        constraints.check(robot)
    except InputError as error:
        message = str(error).removeprefix("constraints: ")
        for table, field in ZONES.items():  # as the file calls it
            message = message.replace(f"{field}[", f"{table}[")
        raise InputError(message) from None
    return constraints
