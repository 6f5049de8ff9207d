"""`save_robot`: a `Robot` as a folder that reads back to the very same robot."""

import hashlib
import math
from collections.abc import Iterable
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from typing import Any

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.files import replace_file
from hydrostat.geometry import Inner
from hydrostat.given import Point, check_name, check_type, path_of
from hydrostat.robot.body import Body
from hydrostat.robot.cable import Cable
from hydrostat.robot.contact import Contact, Obstacle
from hydrostat.robot.element_kind import ElementKind, Plane, Volume
from hydrostat.robot.gravity import direction_of
from hydrostat.robot.load import Load
from hydrostat.robot.load_drive import LoadDrive
from hydrostat.robot.material import Material
from hydrostat.robot.material_table import material_values
from hydrostat.robot.materials import FOAMS, MATERIALS
from hydrostat.robot.part import BodyPart
from hydrostat.robot.pin import DefaultStiffness, Pin
from hydrostat.robot.pin_drive import PinDrive
from hydrostat.robot.region import PartRegion
from hydrostat.robot.robot import Robot
from hydrostat.robot.rod import Rod
from hydrostat.robot.sensor import Sensor
from hydrostat.robot.sheet import Membrane, SheetSide
from hydrostat.robot.winch import Mount


def save_robot(robot: Robot, folder: str | Path, *, text: str | None = None) -> Path:
    """Write robot.toml and the body's file to a folder, created if missing; return the path of robot.toml.

    Each file is written atomically. Comments of an existing robot.toml are lost unless `text` has them.

    Args:
        robot: robot to save.
        folder: folder of the robot.
        text: text of robot.toml, such as from `merged_text`; None for `robot_text`.

    Raises:
        InputError: a name that robot.toml does not allow, or a folder that is not writable.
    """
    check_type(robot, Robot, "a folder is written of a Robot, such as load_robot gives")
    folder = path_of(folder, "a robot is kept in a folder")
    for name in (
        robot.name,
        *robot.poses,
        *(part.name for part in (*robot.winches, *robot.cables, *robot.markers)),
        *(part.name for part in (*robot.loads, *robot.rods, *robot.sheets, *robot.sensors, *robot.drives)),
    ):
        check_name(name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made a folder ({error.strerror})") from None
    for file, content in _files(robot).items():
        replace_file(folder / file, content)
    return replace_file(folder / "robot.toml", (text or robot_text(robot)).encode())


def with_values(text: str, *, name: str | None = None, element_size: float | None = None) -> str:
    """Return the text of a robot.toml with another name or element size [m], comments kept; None keeps a value."""
    import tomlkit

    document = tomlkit.parse(text)
    if name is not None:
        document["name"] = name
    if element_size is not None:
        document["body"]["element_size"] = units.format_quantity(element_size, units.LENGTH)  # type: ignore[index]
    return tomlkit.dumps(document)


def robot_hash(robot: Robot) -> str:
    """SHA-256 of all that defines the robot, its body's file included."""
    return hashlib.sha256(b"\0".join([robot_text(robot).encode(), *_files(robot).values()])).hexdigest()


def _files(robot: Robot) -> dict[str, bytes]:
    """Return the files next to robot.toml: the file of the body, then those of obstacles."""
    files = {robot.body.file: robot.body.content}
    if robot.body.grading is not None:
        files[robot.body.grading.file] = robot.body.grading.content
    shapes = (each.mesh for each in (*robot.body.parts, *robot.sheets, *robot.obstacles))
    return files | {mesh.file: mesh.content for mesh in shapes if mesh is not None}


def robot_text(robot: Robot) -> str:
    """Write the robot as the text of robot.toml."""
    import tomlkit

    writer = _Writer(robot)
    document = tomlkit.document()
    document["format"] = 1
    document["name"] = robot.name
    if robot.length_unit != "mm":
        document["length_unit"] = robot.length_unit
    if robot.gravity is not None:
        document["gravity"] = writer.gravity(robot.gravity)
    if robot.face is not None:
        document["face"] = str(robot.face)
    if robot.motor != "auto":
        document["motor"] = robot.motor
    for key, dimension in (("max_tension", units.FORCE), ("max_torque", units.TORQUE)):
        if (limit := getattr(robot, key)) is not None:
            document[key] = units.format_quantity(limit, dimension)
    document["body"] = writer.body(robot.body)
    if robot.contact is not None:
        document["contact"] = writer.contact(robot.contact)
    groups: dict[str, Iterable[dict[str, Any]]] = {
        "pin": map(writer.pin, robot.pins),
        "drive": map(writer.drive, robot.drives),
        "winch": map(writer.winch, robot.winches),
        "cable": map(writer.cable, robot.cables, robot.given_cable_names),
        "marker": ({"name": marker.name, "at": writer.point(marker.at)} for marker in robot.markers),
        "pose": map(writer.pose, robot.poses.values()),
        "obstacle": map(writer.obstacle, robot.obstacles),
        "load": map(writer.load, robot.loads),
        "rod": map(writer.rod, robot.rods),
        "sheet": map(writer.sheet, robot.sheets),
        "sensor": map(writer.sensor, robot.sensors),
    }
    for key, entries in groups.items():
        tables = tomlkit.aot()
        for entry in entries:
            table = tomlkit.table()
            table.update(entry)
            tables.append(table)
        if len(tables):
            document[key] = tables
    return tomlkit.dumps(document)


class _Writer:
    """Turns records into plain values for the file, coordinates in its length unit."""

    def __init__(self, robot: Robot) -> None:
        import tomlkit

        self._toml = tomlkit
        self.unit = robot.length_unit

    def number(self, value: float) -> Any:
        """Bare number that reads back to the very same length [m]."""
        text = units.plain(units.scale_down(value, self.unit, units.LENGTH))
        return self._toml.value(text)

    def point(self, point: Point) -> Any:
        return self._array(self.number(value) for value in point)

    def points(self, points: Iterable[Point]) -> Any:
        return self._array(self.point(point) for point in points)

    def _array(self, values: Iterable[Any]) -> Any:
        array = self._toml.array()
        array.extend(values)
        return array

    def body(self, body: Body) -> dict[str, Any]:
        lengths = {key: getattr(body, key) for key in ("size", "element_size", "thickness")}
        volume = {"volume": str(body.volume)} if body.volume is not Volume.ELEMENT else {}
        inner = {"inner": str(body.inner)} if body.inner is not Inner.HOLES else {}
        part = {"drawing_part": body.drawing_part} if body.drawing_part is not None else {}
        kind = {"elements": str(body.elements)} if body.elements is not ElementKind.LINEAR else {}
        plane = {"plane": str(body.plane)} if body.plane is not Plane.STRAIN else {}
        grading = {} if body.grading is None else {"grading": body.grading.file}
        given = {"material": self.material(body.material), **volume, **kind, **plane, **inner, **part, **grading}
        if parts := [part for part in body.parts if not part.winch]:
            tables = self._toml.aot()
            for part in parts:
                table = self._toml.table()
                table.update(self.part(part))
                tables.append(table)
            given["part"] = tables
        return {str(body.source): body.file, **_lengths(lengths), **given}

    def region(self, part: PartRegion) -> dict[str, Any]:
        entry: dict[str, Any] = {"name": part.name} | ({} if part.shape is None else {"shape": str(part.shape)})
        for key in ("at", "to"):
            if getattr(part, key) is not None:
                entry[key] = self.point(getattr(part, key))
        if part.radius is not None:
            entry["radius"] = self.number(part.radius)
        if part.points:
            entry["points"] = self.points(part.points)
        if part.mesh is not None:
            entry["file"] = part.mesh.file
        return entry

    def sheet(self, sheet: Membrane) -> dict[str, Any]:
        given: dict[str, Any] = {"thickness": units.format_quantity(sheet.thickness, units.LENGTH)}
        on = {} if sheet.on is SheetSide.SKIN else {"on": str(sheet.on)}
        wrinkles = {"wrinkles": True} if sheet.wrinkles else {}
        return {**self.region(sheet), "material": self.material(sheet.material), **given, **on, **wrinkles}

    def part(self, part: BodyPart) -> dict[str, Any]:
        entry = self.region(part) | ({} if part.label is None else {"label": part.label})
        if part.material is not None:
            return {**entry, "material": self.material(part.material)}
        return {**entry, "rigid": True, "density": units.format_quantity(part.density or 0.0, units.DENSITY)}

    def material(self, material: Material) -> Any:
        """Name of the table, or an inline table of the name or the numbers, then the viscosity."""
        if MATERIALS.get(material.name) == material:
            return material.name
        elastic, known = material.elastic, FOAMS.get(material.name)
        is_named = elastic == known or replace(elastic, foam=()) == MATERIALS.get(material.name)
        table = self._toml.inline_table()
        table.update(material_values(material, name=material.name if is_named else "", known=known))
        return table

    def gravity(self, gravity: tuple[float, ...]) -> Any:
        """Direction such as "-y", or one acceleration for each axis."""
        return direction_of(gravity) or [units.format_quantity(value, units.ACCELERATION) for value in gravity]

    def contact(self, contact: Contact) -> Any:
        table = self._toml.table()
        if contact.distance is not None:
            table["distance"] = units.format_quantity(contact.distance, units.LENGTH)
        if contact.friction:
            table["friction"] = contact.friction
        return table

    def obstacle(self, obstacle: Obstacle) -> dict[str, Any]:
        entry: dict[str, Any] = {"name": obstacle.name, "shape": str(obstacle.shape), "at": self.point(obstacle.at)}
        if obstacle.to is not None:
            entry["to"] = self.point(obstacle.to)
        if obstacle.radius is not None:
            entry["radius"] = self.number(obstacle.radius)
        if obstacle.normal is not None:
            entry["normal"] = self.direction(obstacle.normal)
        if obstacle.mesh is not None:
            entry["file"] = obstacle.mesh.file
        if obstacle.friction is not None:
            entry["friction"] = obstacle.friction
        if obstacle.mass is not None:
            entry["mass"] = units.format_quantity(obstacle.mass, units.MASS)
        if obstacle.path:
            entry["path"] = self._array(
                self._key(units.format_quantity(time, units.TIME), place) for time, place in obstacle.path
            )
        return entry

    def load_keyframe(self, keyframe: tuple[float, float]) -> Any:
        table = self._toml.inline_table()
        table["time"], table["share"] = units.format_quantity(keyframe[0], units.TIME), keyframe[1]
        return table

    def load(self, load: Load) -> dict[str, Any]:
        entry: dict[str, Any] = {"name": load.name}
        if load.at is not None:
            entry["at"] = self.point(load.at)
        if load.marker is not None:
            entry["marker"] = load.marker
        if load.force is not None:
            entry["force"] = [units.format_quantity(value, units.FORCE) for value in load.force]
        if load.mass is not None:
            entry["mass"] = units.format_quantity(load.mass, units.MASS)
        if load.pressure is not None:
            entry["pressure"] = units.format_quantity(load.pressure, units.PRESSURE)
        if load.moment is not None:
            moment = [units.format_quantity(value, units.TORQUE) for value in load.moment]
            entry["moment"] = moment if len(moment) > 1 else moment[0]
        if load.path:
            entry["path"] = self._array(map(self.load_keyframe, load.path))
        if load.drive is not None:
            entry["drive"] = load.drive
        return entry

    def rod(self, rod: Rod) -> dict[str, Any]:
        entry: dict[str, Any] = {"name": rod.name, "points": self.points(rod.points)}
        units_of = {
            "diameter": units.LENGTH,
            "young": units.PRESSURE,
            "axial_stiffness": units.FORCE,
            "bending_stiffness": units.BENDING,
            "torsional_stiffness": units.BENDING,
        }
        given = {key: getattr(rod, key) for key in units_of}
        return entry | {
            key: units.format_quantity(value, units_of[key]) for key, value in given.items() if value is not None
        }

    def sensor(self, sensor: Sensor) -> dict[str, Any]:
        entry: dict[str, Any] = {"name": sensor.name, "kind": str(sensor.kind)}
        if sensor.points:
            entry["points"] = self.points(sensor.points)
        if sensor.at is not None:
            entry["at"] = self.point(sensor.at)
        if sensor.normal is not None:
            entry["normal"] = self.direction(sensor.normal)
        if sensor.radius is not None:
            entry["radius"] = self.number(sensor.radius)
        return entry | ({"noise": sensor.noise_value()} if sensor.noise else {})

    def direction(self, way: Iterable[float]) -> Any:
        return self._array(self._toml.value(units.plain(Decimal(repr(float(value))))) for value in way)

    def _key(self, time: str, place: Point) -> Any:
        table = self._toml.inline_table()
        table.update({"time": time, "at": self.point(place)})
        return table

    def pin(self, pin: Pin) -> dict[str, Any]:
        entry: dict[str, Any] = {}
        if pin.box is not None:
            entry["box"] = self.points(pin.box)
        if pin.at is not None:
            entry["at"] = self.point(pin.at)
            entry["radius"] = self.number(pin.radius)
        if not isinstance(pin.stiffness, DefaultStiffness):
            entry["stiffness"] = units.format_quantity(pin.stiffness, units.STIFFNESS)
        if pin.drive is not None:
            entry["drive"] = pin.drive
        return entry

    def drive(self, drive: PinDrive | LoadDrive) -> dict[str, Any]:
        entry: dict[str, Any] = {"name": drive.name}
        if isinstance(drive, LoadDrive):
            return entry | {"min": drive.min, "max": drive.max}
        if drive.at is not None:
            entry["at"] = self.point(drive.at)
        for key in ("axis", "slide"):
            if (way := getattr(drive, key)) is not None:
                entry[key] = self.direction(way)
        low, high = drive.limits
        if drive.slide is not None or (low, high) != (-math.pi, math.pi):
            entry["min"], entry["max"] = drive.limit_texts()
        return entry

    def winch(self, winch: Any) -> dict[str, Any]:
        lengths = {"spool_radius": winch.spool_radius, "travel": winch.travel, "release": winch.release or None}
        mount = {"mount": str(winch.mount)} if winch.mount is not Mount.BODY else {}
        body = {"body": True} if winch.body else {}
        return {"name": winch.name, "at": self.point(winch.at), **_lengths(lengths), **mount, **body}

    def cable(self, cable: Cable, given_name: str) -> dict[str, Any]:
        entry: dict[str, Any] = {"name": given_name} if given_name else {}
        entry.update({"winch": cable.winch, "points": self.points(cable.points)})
        entry["stiffness"] = units.format_quantity(cable.stiffness, units.STIFFNESS)
        lengths = {"smoothing": cable.smoothing, "slack": cable.slack or None, "spool_radius": cable.spool_radius}
        entry.update(_lengths(lengths))
        if cable.sheathed:
            entry["sheathed"] = [list(pair) for pair in cable.sheathed]
        if cable.friction:
            entry["friction"] = cable.friction
        if cable.reverse:
            entry["reverse"] = True
        return entry

    def pose(self, pose: Any) -> dict[str, Any]:
        targets = self._toml.inline_table()
        for name, point in pose.targets.items():
            targets[name] = self.point(point)
        return {"name": pose.name, "targets": targets}


def _lengths(values: dict[str, float | None]) -> dict[str, str]:
    return {key: units.format_quantity(value, units.LENGTH) for key, value in values.items() if value is not None}
