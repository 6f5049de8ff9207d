"""The form of robot.toml: its tables, keys and units, as pydantic models."""

from collections.abc import Callable
from decimal import Decimal
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.robot.winch import Mount


def _quantity(dimension: units.Dimension) -> Callable[[object], float]:
    def parse(text: object) -> float:
        try:
            return units.parse_quantity(text, dimension)
        except InputError as error:
            raise ValueError(str(error)) from None

    return parse


def _number(value: object) -> Decimal:
    """A bare number; tomllib hands over int or Decimal."""
    if isinstance(value, bool) or not isinstance(value, int | Decimal):
        raise ValueError(f"{value!r} is not a number")
    number = Decimal(value)
    if not number.is_finite() or abs(number) > 10**12:
        raise ValueError(f"{value} is out of range")
    return number


Length = Annotated[float, BeforeValidator(_quantity(units.LENGTH))]
Pressure = Annotated[float, BeforeValidator(_quantity(units.PRESSURE))]
Density = Annotated[float, BeforeValidator(_quantity(units.DENSITY))]
Stiffness = Annotated[float, BeforeValidator(_quantity(units.STIFFNESS))]
Number = Annotated[Decimal, BeforeValidator(_number)]
Coordinates = Annotated[list[Number], Field(min_length=2, max_length=3)]
Text = Annotated[str, Field(min_length=1, max_length=200)]


class Table(BaseModel):
    """A table of the file; a key that it does not know is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class MaterialTable(Table):
    """A material by its numbers."""

    young: Pressure
    poisson: Number
    density: Density


class BodyTable(Table):
    """[body]."""

    outline: Text | None = None
    mesh: Text | None = None
    size: Length | None = None
    element_size: Length | None = None
    thickness: Length | None = None
    material: Text | MaterialTable


class PinTable(Table):
    """[[pin]]."""

    at: Coordinates | None = None
    radius: Number = Decimal(0)
    box: Annotated[list[Coordinates], Field(min_length=2, max_length=2)] | None = None
    stiffness: Stiffness | None = None


class WinchTable(Table):
    """[[winch]]."""

    name: Text
    at: Coordinates
    spool_radius: Length | None = None
    travel: Length | None = None
    release: Length | None = None
    mount: Mount | None = None


class CableTable(Table):
    """[[cable]]."""

    winch: Text
    points: Annotated[list[Coordinates], Field(max_length=1000)]
    stiffness: Stiffness | None = None
    smoothing: Length | None = None
    slack: Length | None = None
    sheathed: list[tuple[int, int]] | None = None


class MarkerTable(Table):
    """[[marker]]."""

    name: Text
    at: Coordinates


class PoseTable(Table):
    """[[pose]]."""

    name: Text
    targets: dict[str, Coordinates]


class RobotTable(Table):
    """The whole file."""

    format: Literal[1]
    name: Text
    length_unit: Text = "mm"
    body: BodyTable
    pin: list[PinTable] = []
    winch: list[WinchTable] = []
    cable: list[CableTable] = []
    marker: list[MarkerTable] = []
    pose: list[PoseTable] = []


def allowed_keys(location: tuple[Any, ...]) -> list[str]:
    """Keys that the table at a place of the file may have."""
    table: Any = RobotTable
    for step in location:
        if not isinstance(step, str) or step not in getattr(table, "model_fields", {}):
            continue
        candidates = _models(table.model_fields[step].annotation)
        table = candidates[0] if candidates else table
    return list(table.model_fields)


def _models(annotation: Any) -> list[type[Table]]:
    if isinstance(annotation, type) and issubclass(annotation, Table):
        return [annotation]
    return [model for part in getattr(annotation, "__args__", ()) for model in _models(part)]
