"""`load_robot`: from a folder with robot.toml to a checked `Robot`."""

import os
import re
import tomllib
from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal
from functools import partial
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.robot.body import Body, Source, mesh_body, outline_body, surface_body
from hydrostat.robot.cable import Cable
from hydrostat.robot.gravity import gravity_along
from hydrostat.robot.lines import find_line
from hydrostat.robot.marker import Marker
from hydrostat.robot.material import Material
from hydrostat.robot.materials import find_material
from hydrostat.robot.pin import Pin
from hydrostat.robot.pose import Pose
from hydrostat.robot.relaxation import Relaxation
from hydrostat.robot.robot import Robot
from hydrostat.robot.winch import Winch

FILE = "robot.toml"
LARGEST_FILE = 200_000_000
"""The file of a body may have this many bytes."""

LARGEST_TEXT = 1_000_000
"""robot.toml may have this many bytes."""

_LONGEST = 400
"""Characters of a complaint, its file and line not counted."""

_PLACE = re.compile(r"([a-z_]+)(?:\[\d+\])*(?:\.[a-z_]+(?:\[\d+\])*)*(?=[ :.])")
_LONG_KEY = re.compile(r"""(?<![\w-])(?:["']?[\w-]*["']?[ \t]*\.[ \t]*){30}""")
_Record = TypeVar("_Record")


def load_robot(path: str | Path) -> Robot:
    """Robot from its folder, or from the robot.toml in it.

    Raises:
        InputError: one line that names the file, the line or key, what is wrong and what is allowed.
    """
    path = Path(path)
    file = path if path.suffix == ".toml" and not os.path.isdir(path) else path / FILE
    if os.path.isfile(path) and file != path:
        raise InputError(f"{path}: is neither the folder of a robot nor a robot.toml; begin a robot with hydrostat new")
    content = _read_bytes(file, units.printable(str(file)), LARGEST_TEXT)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError(f"{file}, line {line}: not UTF-8 text; save the file again as UTF-8") from None
    return _Reader(file, text).robot()


def _read_bytes(file: Path, name: str, most: int) -> bytes:
    try:
        if not file.exists():
            raise InputError(f"{name}: there is no such file")
        if not file.is_file():
            raise InputError(f"{name}: is not a file")
        if file.stat().st_size > most:
            raise InputError(f"{name}: has {file.stat().st_size / 1e6:.3g} MB, at most {most / 1e6:g} MB are read")
        return file.read_bytes()
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
        for index, pose in enumerate(self._records("pose", self._pose)):
            if pose.name in poses:
                self._fail(f"pose[{index}].name", f'there are two of the name "{pose.name}"; names must be unique')
            poses[pose.name] = pose
        body = self._body()
        gravity = self._at("", lambda: _gravity(table.gravity, body.mesh.dim))
        options = {"length_unit": self.unit, "gravity": gravity}
        return self._at("", lambda: Robot(name=table.name, body=body, poses=poses, **options, **parts))

    def _parse(self) -> Any:
        from pydantic import ValidationError

        from hydrostat.robot.schema import RobotTable
        from hydrostat.robot.schema_error import first_complaint

        if not self.text.strip():
            self._fail("", "the file is empty; begin with format = 1, or run hydrostat new")
        try:
            return RobotTable.model_validate(self._data())
        except ValidationError as error:
            self._fail(*first_complaint(error))

    def _data(self) -> dict[str, Any]:
        """The file as tomllib reads it, which takes time in the square of a key's parts."""
        if _LONG_KEY.search(self.text):
            self._fail("", "not TOML of a robot: a key has more than 30 parts")
        try:
            return tomllib.loads(self.text, parse_float=Decimal)
        except tomllib.TOMLDecodeError as error:
            what, _, place = str(error).partition(" (at line ")
            line = re.match(r"\d+", place)
            self._fail("", f"not TOML: {what}", int(line[0]) if line else None)
        except RecursionError:
            self._fail("", "not TOML of a robot: brackets are nested too deep")
        except (ValueError, ArithmeticError):
            self._fail("", "not TOML of a robot: a number is too large or has too many digits")

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
        sheathed = {} if entry.sheathed is None else {"sheathed": tuple((start, end) for start, end in entry.sheathed)}
        friction = {} if entry.friction is None else {"friction": float(entry.friction)}
        given = _given(entry, "stiffness", "smoothing", "slack", "spool_radius")
        return Cable(winch=entry.winch, points=points, **sheathed, **friction, **given)

    def _marker(self, entry: Any) -> Marker:
        return Marker(name=entry.name, at=self._point(entry.at))

    def _pose(self, entry: Any) -> Pose:
        return Pose(name=entry.name, targets={name: self._point(point) for name, point in entry.targets.items()})

    def _body(self) -> Body:
        entry = self.table.body
        sources = [source for source in Source if getattr(entry, source) is not None]
        if len(sources) != 1:
            self._fail("body", "give one of outline (a drawing), surface (a scan or CAD model) or mesh (a ready mesh)")
        source = sources[0]
        file = self._file(f"body.{source}", getattr(entry, source))
        material = self._at("body.material", lambda: _material(entry.material))
        unit = units.scale_up(Decimal(1), self.unit, units.LENGTH)
        if source is Source.MESH:
            if entry.element_size is not None:
                self._fail("body.element_size", "a ready mesh has its own element size; remove the key")
            make = partial(mesh_body, file, unit=unit)
        else:
            self._need(entry, source)
            content = self._at(f"body.{source}", lambda: _read_bytes(file, file.name, LARGEST_FILE))
            given = {"file": file.name, "element_size": entry.element_size}
            if source is Source.SURFACE:
                make = partial(surface_body, content, unit=unit, **given)
            else:
                make = partial(outline_body, content, **given)
        return self._at(
            "body",
            lambda: make(material=material, size=entry.size, thickness=entry.thickness, **_given(entry, "volume")),
            otherwise=f"body.{source}",
        )

    def _need(self, entry: Any, source: Source) -> None:
        """Refuse a body without the sizes that it needs."""
        keys = [("element_size", "12 mm"), ("thickness", "40 mm")]
        for key, example in keys if source is Source.OUTLINE else keys[:1]:
            if getattr(entry, key) is None:
                kind = "a flat body" if source is Source.OUTLINE else "a body from a surface"
                self._fail("body", f'the key "{key}" is missing; {kind} needs it: {key} = "{example}"')

    def _file(self, key: str, name: str) -> Path:
        file = self.file.parent / name
        if Path(name).name != name or "\\" in name or not name.isprintable() or name in {FILE, "..", self.file.name}:
            self._fail(key, f"{units.quote(name)} must be the plain name of a file beside robot.toml, without a folder")
        if not os.path.isfile(file):  # unlike Path.is_file, False for a name too long for the system
            self._fail(key, f"there is no file {units.quote(name)} beside robot.toml; put it there")
        if file.stat().st_size > LARGEST_FILE:
            self._fail(key, f"{units.quote(name)} is larger than {LARGEST_FILE // 10**6} MB")
        return file

    def _at(self, key: str, make: Callable[[], _Record], *, otherwise: str | None = None) -> _Record:
        """What `make` makes; its complaint is located at the field it begins with, else at `otherwise`."""
        from hydrostat.robot.schema_error import allowed_keys

        try:
            return make()
        except InputError as error:
            message = str(error)
            place = _PLACE.match(message)
            if place and place[1] in allowed_keys(key):
                self._fail(f"{key}.{place[0]}".removeprefix("."), message[place.end() :])
            self._fail(key if otherwise is None else otherwise, message)

    def _fail(self, key: str, message: str, line: int | None = None) -> NoReturn:
        line = line or find_line(self.text, key)
        where = f"{self.file}{f', line {line}' if line else ''}"
        told = key + message if message.startswith((" ", ":")) else f"{key}: {message}" if key else message
        told = told if len(told) <= _LONGEST else told[: _LONGEST - 3] + "..."
        raise InputError(units.printable(f"{where}: {told}")) from None


def _material(entry: Any) -> Material:
    if isinstance(entry, str):
        return find_material(entry)
    viscous = _given(entry, "viscosity")
    if entry.relaxation is not None:
        viscous["relaxation"] = tuple(_branch(index, branch) for index, branch in enumerate(entry.relaxation))
    if hasattr(entry, "name"):
        return replace(find_material(entry.name), **viscous)
    return Material(young=entry.young, poisson=float(entry.poisson), density=entry.density, **viscous)


def _branch(index: int, entry: Any) -> Relaxation:
    try:
        return Relaxation(modulus=entry.modulus, time=entry.time)
    except InputError as error:
        raise InputError(f"relaxation[{index}].{error}") from None


def _gravity(entry: Any, dim: int) -> tuple[float, ...] | None:
    if entry is None:
        return None
    return gravity_along(entry, dim) if isinstance(entry, str) else tuple(entry)


def _given(entry: Any, *keys: str) -> dict[str, Any]:
    """The keys that stand in the file; the others keep the record's own defaults."""
    return {key: getattr(entry, key) for key in keys if getattr(entry, key) is not None}
