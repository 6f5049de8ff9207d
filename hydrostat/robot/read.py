"""`load_robot`: from a folder with robot.toml to a checked `Robot`."""

import re
import tomllib
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any, TypeVar

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.robot.body import Body, mesh_body, outline_body
from hydrostat.robot.cable import Cable
from hydrostat.robot.marker import Marker
from hydrostat.robot.material import Material, find_material
from hydrostat.robot.pin import Pin
from hydrostat.robot.pose import Pose
from hydrostat.robot.robot import Robot
from hydrostat.robot.winch import Winch

FILE = "robot.toml"
LARGEST_FILE = 200_000_000
"""A file of a robot may have this many bytes."""

_Record = TypeVar("_Record")


def load_robot(path: str | Path) -> Robot:
    """Robot from its folder, or from the robot.toml in it.

    Raises:
        InputError: one line that names the file, the line or key, what is wrong and what is allowed.
    """
    path = Path(path)
    file = path / FILE if path.is_dir() or path.suffix != ".toml" else path
    text = _read_bytes(file, str(file)).decode("utf-8", errors="replace")
    return _Reader(file, text).robot()


def _read_bytes(file: Path, name: str) -> bytes:
    try:
        if file.stat().st_size > LARGEST_FILE:
            raise InputError(f"{name}: larger than {LARGEST_FILE // 1_000_000} MB")
        return file.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{name}: there is no such file") from None
    except OSError as error:
        raise InputError(f"{name}: cannot be read ({error.strerror})") from None


class _Reader:
    """Turns the text of one file into records; every complaint names the file and the key."""

    def __init__(self, file: Path, text: str) -> None:
        self.file = file
        self.text = text
        self.table = self._parse()
        self.unit = self.table.length_unit

    def robot(self) -> Robot:
        """The robot that the text describes."""
        table = self.table
        self._at("length_unit", lambda: units.unit_factor(self.unit, units.LENGTH))
        parts = {
            "pins": self._records("pin", self._pin),
            "winches": self._records("winch", self._winch),
            "cables": self._records("cable", self._cable),
            "markers": self._records("marker", self._marker),
        }
        poses: dict[str, Pose] = {}
        for index, entry in enumerate(table.pose):
            if entry.name in poses:
                self._fail(f"pose[{index}].name", f'there are two of the name "{entry.name}"; names must be unique')
            poses[entry.name] = self._at(f"pose[{index}]", lambda entry=entry: self._pose(entry))
        body = self._body()
        try:
            return Robot(name=table.name, body=body, poses=poses, length_unit=self.unit, **parts)
        except InputError as error:
            key, colon, rest = str(error).partition(":")
            if colon and re.match(r"^\w+(\[|\.|$)", key):
                self._fail(key, rest.strip())
            raise InputError(f"{self.file}: {error}") from None

    def _parse(self) -> Any:
        from pydantic import ValidationError

        from hydrostat.robot.schema import RobotTable

        if not self.text.strip():
            raise InputError(f'{self.file}: the file is empty; begin with format = 1, or run "hydrostat new"')
        try:
            data = tomllib.loads(self.text, parse_float=Decimal)
        except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
            raise InputError(f"{self.file}: not TOML: {error}") from None
        try:
            return RobotTable.model_validate(data)
        except ValidationError as error:
            raise self._schema_error(error.errors()[0]) from None

    def _schema_error(self, error: Any) -> InputError:
        from hydrostat.robot.schema import allowed_keys

        location = tuple(
            step for step in error["loc"] if not str(step).startswith(("MaterialTable", "function-", "constrained-"))
        )
        key = location[-1] if location else ""
        if error["type"] == "extra_forbidden":
            message = f'unknown key "{key}"; allowed here are: {", ".join(allowed_keys(location[:-1]))}'
        elif error["type"] == "missing":
            message = f'the key "{key}" is missing'
        elif error["type"] == "literal_error" and key == "format":
            message = f"format = {error['input']!r} is not known; this version reads format = 1"
        else:
            message = error["msg"].removeprefix("Value error, ")
        return InputError(f"{self._where(_dotted(location))}: {message}")

    def _records(self, key: str, make: Callable[[Any], _Record]) -> tuple[_Record, ...]:
        entries = getattr(self.table, key)
        return tuple(
            self._at(f"{key}[{index}]", lambda entry=entry: make(entry)) for index, entry in enumerate(entries)
        )

    def _point(self, coordinates: list[Decimal]) -> tuple[float, ...]:
        return tuple(units.scale_up(value, self.unit, units.LENGTH) for value in coordinates)

    def _pin(self, entry: Any) -> Pin:
        return Pin(
            at=None if entry.at is None else self._point(entry.at),
            radius=units.scale_up(entry.radius, self.unit, units.LENGTH),
            box=None if entry.box is None else (self._point(entry.box[0]), self._point(entry.box[1])),
            **_given(entry, "stiffness"),
        )

    def _winch(self, entry: Any) -> Winch:
        return Winch(
            name=entry.name,
            at=self._point(entry.at),
            **_given(entry, "spool_radius", "travel", "release", "mount"),
        )

    def _cable(self, entry: Any) -> Cable:
        points = tuple(self._point(point) for point in entry.points)
        sheathed = {} if entry.sheathed is None else {"sheathed": tuple(entry.sheathed)}
        return Cable(winch=entry.winch, points=points, **sheathed, **_given(entry, "stiffness", "smoothing", "slack"))

    def _marker(self, entry: Any) -> Marker:
        return Marker(name=entry.name, at=self._point(entry.at))

    def _pose(self, entry: Any) -> Pose:
        return Pose(name=entry.name, targets={name: self._point(point) for name, point in entry.targets.items()})

    def _body(self) -> Body:
        entry = self.table.body
        sources = [key for key in ("outline", "mesh") if getattr(entry, key) is not None]
        if len(sources) != 1:
            self._fail("body", "give either outline (a drawing) or mesh (a ready mesh)")
        material = self._at("body.material", lambda: _material(entry.material))
        file = self._file(sources[0], getattr(entry, sources[0]))
        if sources[0] == "mesh":
            if entry.element_size is not None:
                self._fail("body.element_size", "a ready mesh has its own element size; remove the key")
            unit = float(units.unit_factor(self.unit, units.LENGTH))
            return self._at(
                "body",
                lambda: mesh_body(file, unit=unit, material=material, size=entry.size, thickness=entry.thickness),
            )
        for key, example in (("element_size", "12 mm"), ("thickness", "40 mm")):
            if getattr(entry, key) is None:
                self._fail(
                    "body",
                    f'the key "{key}" is missing; a flat body needs it, for example {key} = "{example}"',
                )
        content = self._at("body.outline", lambda: _read_bytes(file, file.name))
        return self._at(
            "body",
            lambda: outline_body(
                content,
                file=file.name,
                material=material,
                element_size=entry.element_size,
                thickness=entry.thickness,
                size=entry.size,
            ),
        )

    def _file(self, key: str, name: str) -> Path:
        if Path(name).name != name or name in {FILE, ".", ".."}:
            self._fail(f"body.{key}", f'"{name}" must be the plain name of a file beside robot.toml')
        file = self.file.parent / name
        if not file.is_file():
            self._fail(f"body.{key}", f'there is no file "{name}" beside robot.toml')
        return file

    def _at(self, key: str, make: Callable[[], _Record]) -> _Record:
        try:
            return make()
        except InputError as error:
            self._fail(key, str(error))
            raise

    def _fail(self, key: str, message: str) -> None:
        raise InputError(f"{self._where(key)}: {message}") from None

    def _where(self, key: str) -> str:
        line = _line(self.text, key)
        return f"{self.file}{f', line {line}' if line else ''}{f': {key}' if key else ''}"


def _material(entry: Any) -> Material:
    if isinstance(entry, str):
        return find_material(entry)
    return Material(young=entry.young, poisson=float(entry.poisson), density=entry.density)


def _given(entry: Any, *keys: str) -> dict[str, Any]:
    """The keys that stand in the file; the others keep the record's own defaults."""
    return {key: getattr(entry, key) for key in keys if getattr(entry, key) is not None}


def _dotted(location: tuple[Any, ...]) -> str:
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in location)
    return text.removeprefix(".")


def _line(text: str, key: str) -> int | None:
    """Line of a key such as cable[1].points[0], as near as headers and key names tell."""
    match = re.match(r"(\w+)(?:\[(\d+)\])?(?:\.(\w+))?", key)
    if not match:
        return None
    table, index, entry = match.group(1), int(match.group(2) or 0), match.group(3)
    lines = text.splitlines()
    heads = [number for number, line in enumerate(lines) if re.match(rf"\s*\[\[?\s*{table}\s*\]", line)]
    if len(heads) <= index:
        return next((number + 1 for number, line in enumerate(lines) if re.match(rf"\s*{table}\s*=", line)), None)
    for number in range(heads[index] + 1, len(lines)):
        if re.match(r"\s*\[\[?\s*[A-Za-z_]+\s*\]", lines[number]):
            break
        if entry and re.match(rf"\s*{entry}\s*=", lines[number]):
            return number + 1
    return heads[index] + 1
