"""Schema of robot.toml: its tables, keys and units, as pydantic models, with readable error messages."""

from collections.abc import Callable
from decimal import Decimal
from difflib import get_close_matches
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Strict,
    Tag,
    ValidationError,
)

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.geometry import Inner
from hydrostat.robot.body import Volume
from hydrostat.robot.checks import check_name
from hydrostat.robot.contact import ObstacleShape
from hydrostat.robot.face import Face
from hydrostat.robot.gravity import DIRECTIONS
from hydrostat.robot.materials import MOST_BRANCHES
from hydrostat.robot.part import PartShape
from hydrostat.robot.winch import Mount
from hydrostat.units import quote

LARGEST = 10**12  # no number of robot.toml is larger, whether bare or in SI


def _quantity(dimension: units.Dimension) -> Callable[[object], float]:
    def parse(text: object) -> float:
        try:
            value = units.parse_quantity(text, dimension)
        except InputError as error:
            raise ValueError(str(error)) from None
        if abs(value) > LARGEST:
            raise ValueError(f"{quote(text)} is too large")
        return value

    return parse


def _number(value: object) -> Decimal:
    """Bare number; tomllib hands over int or Decimal."""
    if isinstance(value, bool) or not isinstance(value, int | Decimal):
        raise ValueError(f"{quote(value)} is not a number")
    if isinstance(value, Decimal) and not value.is_finite():
        raise ValueError(f"{quote(value)} is not a finite number")
    if abs(value) > LARGEST:
        raise ValueError(f"{quote(value)} is too large; write a number between -1e12 and 1e12")
    return Decimal(value)


def _name(value: object) -> object:
    try:
        return check_name(value) if isinstance(value, str) else value
    except InputError as error:
        raise ValueError(str(error)) from None


def _direction(value: str) -> str:
    if value not in DIRECTIONS:
        raise ValueError(
            f"{quote(value)} is no direction; allowed are: {', '.join(DIRECTIONS)}; "
            'or an acceleration for each axis: ["0 m/s^2", "-9.81 m/s^2"]'
        )
    return value


def _format(value: object) -> object:
    if type(value) is not int or value != 1:
        raise ValueError(f"{quote(value)} is not known; this version reads format = 1")
    return value


Length = Annotated[float, BeforeValidator(_quantity(units.LENGTH))]
Pressure = Annotated[float, BeforeValidator(_quantity(units.PRESSURE))]
Mass = Annotated[float, BeforeValidator(_quantity(units.MASS))]
Density = Annotated[float, BeforeValidator(_quantity(units.DENSITY))]
Stiffness = Annotated[float, BeforeValidator(_quantity(units.STIFFNESS))]
Acceleration = Annotated[float, BeforeValidator(_quantity(units.ACCELERATION))]
Viscosity = Annotated[float, BeforeValidator(_quantity(units.VISCOSITY))]
Time = Annotated[float, BeforeValidator(_quantity(units.TIME))]
Force = Annotated[float, BeforeValidator(_quantity(units.FORCE))]
Torque = Annotated[float, BeforeValidator(_quantity(units.TORQUE))]
Angle = Annotated[float, BeforeValidator(_quantity(units.ANGLE))]
Number = Annotated[Decimal, BeforeValidator(_number)]
Coordinates = Annotated[list[Number], Field(min_length=2, max_length=3)]
Text = Annotated[str, Field(min_length=1, max_length=200)]
Name = Annotated[str, BeforeValidator(_name)]
Direction = Annotated[str, AfterValidator(_direction)]
Components = Annotated[list[Acceleration], Field(min_length=2, max_length=3)]
Pair = Annotated[list[Annotated[int, Strict()]], Field(min_length=2, max_length=2)]


class TomlTable(BaseModel):
    """Table of the file; an unknown key is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class RelaxationTable(TomlTable):
    """Maxwell branch."""

    modulus: Pressure
    time: Time


Branches = Annotated[list[RelaxationTable], Field(max_length=MOST_BRANCHES)]


class NamedMaterialTable(TomlTable):
    """Material by name, with its viscosity."""

    name: Text
    viscosity: Viscosity | None = None
    relaxation: Branches | None = None


class MaterialTable(TomlTable):
    """Material by its numbers."""

    young: Pressure
    poisson: Number
    density: Density
    viscosity: Viscosity | None = None
    relaxation: Branches | None = None


def _material_tag(value: object) -> str:
    if not isinstance(value, dict):
        return "<name>"
    return "<named>" if "name" in value else "<numbers>"


def _gravity_tag(value: object) -> str:
    return "<direction>" if isinstance(value, str) else "<components>"


Gravity = Annotated[
    Annotated[Direction, Tag("<direction>")] | Annotated[Components, Tag("<components>")], Discriminator(_gravity_tag)
]


AnyMaterial = Annotated[
    Annotated[Text, Tag("<name>")]
    | Annotated[NamedMaterialTable, Tag("<named>")]
    | Annotated[MaterialTable, Tag("<numbers>")],
    Discriminator(_material_tag),
]


class PartTable(TomlTable):
    """[[body.part]]."""

    name: Name
    shape: PartShape
    at: Coordinates | None = None
    to: Coordinates | None = None
    radius: Number | None = None
    points: Annotated[list[Coordinates], Field(max_length=1000)] = []
    file: Text | None = None
    material: AnyMaterial | None = None
    rigid: bool = False
    density: Density | None = None


class BodyTable(TomlTable):
    """[body]."""

    outline: Text | None = None
    surface: Text | None = None
    mesh: Text | None = None
    size: Length | None = None
    element_size: Length | None = None
    thickness: Length | None = None
    material: AnyMaterial
    volume: Volume | None = None
    inner: Inner | None = None
    part: list[PartTable] = []


class PinTable(TomlTable):
    """[[pin]]."""

    at: Coordinates | None = None
    radius: Number = Decimal(0)
    box: Annotated[list[Coordinates], Field(min_length=2, max_length=2)] | None = None
    stiffness: Stiffness | None = None


class WinchTable(TomlTable):
    """[[winch]]."""

    name: Name
    at: Coordinates
    spool_radius: Length | None = None
    travel: Length | None = None
    release: Length | None = None
    mount: Mount | None = None


class CableTable(TomlTable):
    """[[cable]]."""

    name: Name | None = None
    winch: Text
    points: Annotated[list[Coordinates], Field(max_length=1000)]
    stiffness: Stiffness | None = None
    smoothing: Length | None = None
    slack: Length | None = None
    sheathed: list[Pair] | None = None
    friction: Number | None = None
    spool_radius: Length | None = None


class MarkerTable(TomlTable):
    """[[marker]]."""

    name: Name
    at: Coordinates


class PoseTable(TomlTable):
    """[[pose]]."""

    name: Name
    targets: dict[str, Coordinates]


class ContactTable(TomlTable):
    """[contact]."""

    distance: Length | None = None
    friction: Number | None = None


class KeyframeTable(TomlTable):
    """Entry of path of [[obstacle]]."""

    time: Time
    at: Coordinates


class ObstacleTable(TomlTable):
    """[[obstacle]]."""

    name: Name
    shape: ObstacleShape
    at: Coordinates
    to: Coordinates | None = None
    radius: Number | None = None
    normal: Coordinates | None = None
    friction: Number | None = None
    mass: Mass | None = None
    path: list[KeyframeTable] = []
    file: Text | None = None


class LoadTable(TomlTable):
    """[[load]]."""

    name: Name
    at: Coordinates | None = None
    marker: Text | None = None
    force: Annotated[list[Force], Field(min_length=2, max_length=3)] | None = None
    mass: Mass | None = None


class RobotTable(TomlTable):
    """All tables of robot.toml."""

    format: Annotated[int, BeforeValidator(_format)]
    name: Name
    length_unit: Text = "mm"
    gravity: Gravity | None = None
    face: Face | None = None
    body: BodyTable
    pin: list[PinTable] = []
    winch: list[WinchTable] = []
    cable: list[CableTable] = []
    marker: list[MarkerTable] = []
    pose: list[PoseTable] = []
    contact: ContactTable | None = None
    obstacle: list[ObstacleTable] = []
    load: list[LoadTable] = []


_NAMED = "a material with a name has its own; remove this key, or the name"
_VISCOUS = 'material = { name = "polyester fibre", viscosity = "40 Pa s" }'
REFUSED = {
    "body.gravity": "gravity stands at the top of the file, before [body]; move it there",
    "body.face": "where the cables of a flat robot run stands at the top of the file, before [body]; move it there",
    "body.viscosity": "it belongs to the material; write " + _VISCOUS,
    "body.relaxation": "it belongs to the material; write " + _VISCOUS,
    **dict.fromkeys(("body.material.young", "body.material.poisson", "body.material.density"), _NAMED),
    "part": "parts belong to the body; begin each with [[body.part]]",
}
"""Known keys where they may not stand, and why."""

_EXAMPLES = {
    "format": "format = 1",
    "body": "[body]",
    "name": 'name = "left"',
    "gravity": 'gravity = ["0 m/s^2", "-9.81 m/s^2"]',
    "material": 'material = "polyester fibre"',
    "young": 'young = "30 kPa"',
    "poisson": "poisson = 0.3",
    "density": 'density = "40 kg/m^3"',
    "relaxation": 'relaxation = [{ modulus = "10 kPa", time = "2 s" }]',
    "modulus": 'modulus = "10 kPa"',
    "time": 'time = "2 s"',
    "force": 'force = ["0 N", "-1 N"]',
    "at": "at = [0, 0]",
    "box": "box = [[0, 0], [10, 20]]",
    "winch": 'winch = "left"',
    "points": "points = [[0, 0], [10, 20]]",
    "sheathed": "sheathed = [[0, 1]]",
    "targets": "targets = { tip = [40, 90] }",
    "outline": "outline = [[0, 0], [10, 0], [10, 20]]",
    "locked_cables": "locked_cables = [1, 2]",
    "locked_winches": 'locked_winches = ["left"]',
}


_SENTENCES = {
    "missing": "the key {key} is missing; write {example}",
    "enum": "{value} is not known; allowed are: {expected}",
    "string_type": '{value} is not text; write it in quotes: "..."',
    "string_too_short": "must not be empty",
    "string_too_long": "{value} is too long; at most {max_length} characters are allowed",
    "bool_type": "{value} is neither true nor false",
    "int_type": "{value} is not a whole number; write for example {example}",
    "list_type": "{value} is not a list; write for example {example}",
    "too_short": "has {actual_length} entries, at least {min_length} are needed",
    "too_long": "has more than {max_length} entries",
}
"""Our sentence for each of pydantic's kinds of errors."""


def first_complaint(error: ValidationError, form: type[TomlTable] = RobotTable) -> tuple[str, str]:
    """Return the key, such as cable[1].points[0], and the error; unknown keys first, as they explain missing ones."""
    errors = error.errors()
    worst: Any = next((entry for entry in errors if entry["type"] == "extra_forbidden"), errors[0])
    location = tuple(step for step in worst["loc"] if not str(step).startswith("<"))
    return _dotted_path(location), _message(worst, location, form)


def allowed_keys(key: str, form: type[TomlTable] = RobotTable) -> list[str]:
    """Keys that the table at a key such as cable[1], in any of its forms, may have; none if it is no table."""
    tables = [form]
    for step in filter(None, key.split(".")):
        name = step.partition("[")[0]
        fields = [table.model_fields[name] for table in tables if name in table.model_fields]
        tables = [inner for field in fields for inner in _tables(field.annotation)]
    return list(dict.fromkeys(name for table in tables for name in table.model_fields))


def _message(error: Any, location: tuple[Any, ...], form: type[TomlTable]) -> str:
    names = [step for step in location if isinstance(step, str)]
    key, kind = names[-1] if names else "", error["type"]
    if kind == "extra_forbidden":
        return REFUSED.get(".".join(names)) or _unknown(key, _dotted_path(location[:-1]), form)
    if kind == "list_type" and len(location) == 1 and allowed_keys(key, form):
        return f"begin each with [[{key}]], in two pairs of brackets"
    if kind in ("model_type", "dict_type"):
        if len(location) == 1:
            return f"must be one table, begun with [{key}] in one pair of brackets"
        hint = f"; write for example {_EXAMPLES[key]}" if key == "targets" else ""
        return f"{quote(error['input'])} is not a table{hint}"
    if kind not in _SENTENCES:
        return error["msg"].removeprefix("Value error, ")
    limits = {name: str(limit).replace("'", "") for name, limit in error.get("ctx", {}).items()}
    example = _EXAMPLES.get(key) or (f"{key} = 4" if kind == "int_type" else "[0, 0]")
    return _SENTENCES[kind].format(key=quote(key), value=quote(error["input"]), example=example, **limits)


def _unknown(key: str, table: str, form: type[TomlTable]) -> str:
    allowed = allowed_keys(table, form)
    similar = get_close_matches(key[:60], allowed, n=1)
    hint = f", did you mean {similar[0]}?" if similar else ";"
    return f"unknown key {quote(key)}{hint} allowed here are: {', '.join(allowed)}"


def _dotted_path(location: tuple[Any, ...]) -> str:
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in location)
    return text.removeprefix(".")


def _tables(annotation: Any) -> list[type[TomlTable]]:
    if isinstance(annotation, type) and issubclass(annotation, TomlTable):
        return [annotation]
    return [table for part in getattr(annotation, "__args__", ()) for table in _tables(part)]
