"""Schema of robot.toml: its tables, keys and units, as pydantic models."""

from decimal import Decimal
from typing import Annotated

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
)

from hydrostat.geometry import Inner
from hydrostat.robot.cable_side import CableSide
from hydrostat.robot.contact import ObstacleShape
from hydrostat.robot.element_kind import ElementKind, Plane, Volume
from hydrostat.robot.gravity import DIRECTIONS
from hydrostat.robot.material_schema import AnyMaterial
from hydrostat.robot.region import PartShape
from hydrostat.robot.sensor import SensorKind
from hydrostat.robot.sheet import SheetSide
from hydrostat.robot.winch import Mount
from hydrostat.toml_schema import (
    BendingStiffness,
    Components,
    Coordinates,
    Density,
    Force,
    Length,
    Mass,
    Name,
    Number,
    Pair,
    Pressure,
    Stiffness,
    Text,
    Time,
    TomlTable,
    Torque,
    TrueOrFalse,
)
from hydrostat.units import quote


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


Direction = Annotated[str, AfterValidator(_direction)]


def _text_tag(value: object) -> str:
    return "<text>" if isinstance(value, str) else "<number>"


def _gravity_tag(value: object) -> str:
    return "<direction>" if isinstance(value, str) else "<components>"


TextOrNumber = Annotated[Annotated[Text, Tag("<text>")] | Annotated[Number, Tag("<number>")], Discriminator(_text_tag)]
Gravity = Annotated[
    Annotated[Direction, Tag("<direction>")] | Annotated[Components, Tag("<components>")], Discriminator(_gravity_tag)
]


def _label(value: object) -> object:
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


class RegionTable(TomlTable):
    """Region by its shape."""

    name: Name
    shape: PartShape | None = None
    at: Coordinates | None = None
    to: Coordinates | None = None
    radius: Number | None = None
    points: Annotated[list[Coordinates], Field(max_length=1000)] = Field([])
    file: Text | None = None


class PartTable(RegionTable):
    """[[body.part]]."""

    label: Annotated[str, BeforeValidator(_label)] | None = None
    material: AnyMaterial | None = None
    rigid: TrueOrFalse = False
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
    grading: Text | None = None
    part: list[PartTable] = Field([])


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
    min: TextOrNumber | None = None
    max: TextOrNumber | None = None


class WinchTable(TomlTable):
    """[[winch]]."""

    name: Name
    at: Coordinates
    spool_radius: Length | None = None
    travel: Length | None = None
    release: Length | None = None
    mount: Mount | None = None
    body: TrueOrFalse | None = None


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
    reverse: TrueOrFalse | None = None


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
    path: list[KeyframeTable] = Field([])
    file: Text | None = None


class LoadKeyframeTable(TomlTable):
    """Entry of path of [[load]]."""

    time: Time
    share: Number


class LoadTable(TomlTable):
    """[[load]]."""

    name: Name
    at: Coordinates | None = None
    marker: Text | None = None
    force: Annotated[list[Force], Field(min_length=2, max_length=3)] | None = None
    mass: Mass | None = None
    pressure: Pressure | None = None
    moment: Torque | Annotated[list[Torque], Field(min_length=3, max_length=3)] | None = None
    path: list[LoadKeyframeTable] = Field([])
    drive: Text | None = None


class RodTable(TomlTable):
    """[[rod]]."""

    name: Name
    points: Annotated[list[Coordinates], Field(max_length=1000)]
    diameter: Length | None = None
    young: Pressure | None = None
    axial_stiffness: Force | None = None
    bending_stiffness: BendingStiffness | None = None
    torsional_stiffness: BendingStiffness | None = None


class SheetTable(RegionTable):
    """[[sheet]]."""

    material: AnyMaterial
    thickness: Length
    on: SheetSide | None = None
    wrinkles: TrueOrFalse | None = None


class SensorTable(TomlTable):
    """[[sensor]]."""

    name: Name
    kind: SensorKind
    points: Annotated[list[Coordinates], Field(max_length=1000)] = Field([])
    at: Coordinates | None = None
    normal: Coordinates | None = None
    radius: Number | None = None
    noise: TextOrNumber | None = None


class RobotTable(TomlTable):
    """All tables of robot.toml."""

    format: Annotated[int, BeforeValidator(_format)]
    name: Name
    length_unit: Text = "mm"
    gravity: Gravity | None = None
    face: CableSide | None = None
    motor: Name = "auto"
    max_tension: Force | None = None
    max_torque: Torque | None = None
    body: BodyTable
    pin: list[PinTable] = Field([])
    drive: list[DriveTable] = Field([])
    winch: list[WinchTable] = Field([])
    cable: list[CableTable] = Field([])
    marker: list[MarkerTable] = Field([])
    pose: list[PoseTable] = Field([])
    contact: ContactTable | None = None
    obstacle: list[ObstacleTable] = Field([])
    load: list[LoadTable] = Field([])
    rod: list[RodTable] = Field([])
    sheet: list[SheetTable] = Field([])
    sensor: list[SensorTable] = Field([])
