"""Schema of robot.toml: its tables, keys and units, as pydantic models."""

from collections.abc import Callable
from decimal import Decimal
from typing import Annotated

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Strict,
    Tag,
)

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.geometry import Inner
from hydrostat.robot.cable_side import Face
from hydrostat.robot.checks import check_name
from hydrostat.robot.contact import ObstacleShape
from hydrostat.robot.element_kind import ElementKind, Plane, Volume
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
    elements: ElementKind | None = None
    plane: Plane | None = None
    inner: Inner | None = None
    drawing_part: Annotated[int, Field(ge=1)] | None = None
    part: list[PartTable] = []


class PinTable(TomlTable):
    """[[pin]]."""

    at: Coordinates | None = None
    radius: Number = Decimal(0)
    box: Annotated[list[Coordinates], Field(min_length=2, max_length=2)] | None = None
    stiffness: Stiffness | None = None
    drive: Text | None = None


class DriveTable(TomlTable):
    """[[drive]]."""

    name: Name
    at: Coordinates | None = None
    axis: Coordinates | None = None
    slide: Coordinates | None = None
    min: Text | None = None
    max: Text | None = None


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
    reverse: bool | None = None


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
    pressure: Pressure | None = None


class RodTable(TomlTable):
    """[[rod]]."""

    name: Name
    points: Annotated[list[Coordinates], Field(max_length=1000)]
    diameter: Length | None = None
    young: Pressure | None = None
    axial_stiffness: Force | None = None
    bending_stiffness: Annotated[float, BeforeValidator(_quantity(units.BENDING))] | None = None


class RobotTable(TomlTable):
    """All tables of robot.toml."""

    format: Annotated[int, BeforeValidator(_format)]
    name: Name
    length_unit: Text = "mm"
    gravity: Gravity | None = None
    face: Face | None = None
    body: BodyTable
    pin: list[PinTable] = []
    drive: list[DriveTable] = []
    winch: list[WinchTable] = []
    cable: list[CableTable] = []
    marker: list[MarkerTable] = []
    pose: list[PoseTable] = []
    contact: ContactTable | None = None
    obstacle: list[ObstacleTable] = []
    load: list[LoadTable] = []
    rod: list[RodTable] = []
