"""`load_robot`: from a folder with robot.toml to a checked `Robot`."""

import os
from dataclasses import replace
from decimal import Decimal
from functools import partial
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.files import read_stranger, read_text
from hydrostat.given import list_choices
from hydrostat.robot.body import Body, Source
from hydrostat.robot.cable import Cable
from hydrostat.robot.contact import ClosedMesh, Contact, Obstacle, closed_mesh
from hydrostat.robot.grading import Grading
from hydrostat.robot.gravity import gravity_along
from hydrostat.robot.load import Load
from hydrostat.robot.load_drive import LoadDrive
from hydrostat.robot.marker import Marker, PoseTarget
from hydrostat.robot.material import Material
from hydrostat.robot.material_table import given_keys, inelastic_values, material_of
from hydrostat.robot.materials import get_material
from hydrostat.robot.part import BodyPart
from hydrostat.robot.pin import Pin
from hydrostat.robot.pin_drive import PinDrive
from hydrostat.robot.region import PartShape
from hydrostat.robot.robot import Robot
from hydrostat.robot.rod import Rod
from hydrostat.robot.sensor import Sensor
from hydrostat.robot.sheet import Membrane
from hydrostat.robot.tables_file import TablesFile
from hydrostat.robot.winch import Winch
from hydrostat.robot.winch_bodies import fit_winch_bodies

if TYPE_CHECKING:
    from hydrostat.toml_schema import TomlTable

GALLERY = "gallery:"
"""Prefix of the name of a gallery robot, instead of a folder."""


def is_of_gallery(source: object) -> TypeGuard[str]:
    """Return True if a source names a robot of the gallery, such as "gallery:starfish"."""
    return isinstance(source, str) and source.startswith(GALLERY)


def list_gallery() -> list[str]:
    """Return the names of the robots in the gallery, sorted."""
    return sorted(folder.name for folder in _shelf().iterdir() if (folder / "robot.toml").is_file())


def gallery_folder(name: str) -> Path:
    """Folder of a gallery robot (InputError: the gallery has no robot of this name)."""
    if name not in list_gallery():
        raise InputError(f'unknown gallery robot "{name}". {list_choices("robots", list_gallery(), name)}')
    return _shelf() / name


def _shelf() -> Path:
    """Folder of the gallery: inside an installed package, or next to it in a checkout."""
    package = Path(str(files("hydrostat")))
    inside = package / "examples"
    return inside if inside.is_dir() else package.parent / "examples"


FILE = "robot.toml"


def load_robot(path: str | Path) -> Robot:
    """Read a robot from its folder, its robot.toml, or the gallery, as "gallery:starfish".

    Raises:
        InputError: an invalid robot; one line with the file, line or key, the problem and the allowed values.
    """
    if not isinstance(path, str | os.PathLike):
        raise InputError(f'a robot is read from its folder, its robot.toml or "gallery:NAME", not from {path!r:.60}')
    path = gallery_folder(path.removeprefix(GALLERY)) if is_of_gallery(path) else Path(path)
    file = path if path.suffix == ".toml" and not os.path.isdir(path) else path / FILE
    if os.path.isfile(path) and file != path:
        raise InputError(f"{path}: is neither the folder of a robot nor a robot.toml; begin a robot with hydrostat new")
    return RobotReader(file, read_text(file)).robot()


class RobotReader(TablesFile):
    """Converter from the text of a robot.toml to records.

    Attributes:
        unit: length unit of the coordinates.
    """

    def __init__(self, file: Path, text: str) -> None:
        super().__init__(file, text)
        self.unit = self.table.length_unit

    def form(self) -> "type[TomlTable]":
        """Tables of robot.toml."""
        from hydrostat.robot.schema import RobotTable

        return RobotTable

    def robot(self) -> Robot:
        """Robot that the text describes."""
        table = self.table
        self.at("length_unit", lambda: units.unit_factor(self.unit, units.LENGTH))
        parts = {
            "pins": self.records("pin", self._pin),
            "drives": self.records("drive", self._drive),
            "winches": self.records("winch", self._winch),
            "cables": self.records("cable", self._cable),
            "markers": self.records("marker", self._marker),
            "obstacles": self.records("obstacle", self._obstacle),
            "loads": self.records("load", self._load),
            "rods": self.records("rod", self._rod),
            "sheets": tuple(
                self.at(where := f"sheet[{index}]", partial(self._sheet, where, sheet))
                for index, sheet in enumerate(table.sheet)
            ),
            "sensors": self.records("sensor", self._sensor),
        }
        poses: dict[str, PoseTarget] = {}
        for index, pose in enumerate(self.records("pose", self._pose)):
            if pose.name in poses:
                self.fail(f"pose[{index}].name", f'there are two of the name "{pose.name}"; names must be unique')
            poses[pose.name] = pose
        body = self._body()
        gravity = self.at("", lambda: _gravity(table.gravity, body.mesh.dim))
        contact = None if table.contact is None else self.at("contact", lambda: self._contact(table.contact))
        given = given_keys(table, "name", "face", "motor", "max_tension", "max_torque")
        options = {"gravity": gravity, "contact": contact, "length_unit": self.unit, **given}
        robot = self.at("", lambda: Robot(body=body, poses=poses, **options, **parts))
        try:
            return fit_winch_bodies(robot)
        except InputError as error:
            name, _, told = str(error).removeprefix('winch "').partition('": ')
            index = next((index for index, winch in enumerate(robot.winches) if winch.name == name), None)
            self.fail("" if index is None else f"winch[{index}]", str(error) if index is None else told)

    def _pin(self, entry: Any) -> Pin:
        return Pin(
            at=None if entry.at is None else self.point(entry.at),
            radius=units.scale_up(entry.radius, self.unit, units.LENGTH),
            box=None if entry.box is None else (self.point(entry.box[0]), self.point(entry.box[1])),
            **given_keys(entry, "stiffness", "drive"),
        )

    def _drive(self, entry: Any) -> PinDrive | LoadDrive:
        if entry.at is None and entry.slide is None and entry.axis is None:
            return _load_drive(entry)
        given: dict[str, Any] = {} if entry.at is None else {"at": self.point(entry.at)}
        for key in ("axis", "slide"):
            if (way := getattr(entry, key)) is not None:
                given[key] = tuple(float(value) for value in way)
        for key, text in given_keys(entry, "min", "max").items():
            given[key] = _drive_value(key, str(text), turns=entry.slide is None)
        return PinDrive(name=entry.name, **given)

    def _contact(self, entry: Any) -> Contact:
        friction = {} if entry.friction is None else {"friction": float(entry.friction)}
        return Contact(**given_keys(entry, "distance"), **friction)

    def _obstacle(self, entry: Any) -> Obstacle:
        given: dict[str, Any] = {}
        if entry.to is not None:
            given["to"] = self.point(entry.to)
        if entry.radius is not None:
            given["radius"] = units.scale_up(entry.radius, self.unit, units.LENGTH)
        if entry.normal is not None:
            given["normal"] = tuple(float(value) for value in entry.normal)
        if entry.friction is not None:
            given["friction"] = float(entry.friction)
        given |= given_keys(entry, "mass")
        if entry.file is not None:
            given["mesh"] = self._closed_mesh("obstacle.file", entry.file)
        given["path"] = tuple((key.time, self.point(key.at)) for key in entry.path)
        return Obstacle(name=entry.name, shape=entry.shape, at=self.point(entry.at), **given)

    def _winch(self, entry: Any) -> Winch:
        return Winch(
            name=entry.name,
            at=self.point(entry.at),
            **given_keys(entry, "spool_radius", "travel", "release", "mount", "body"),
        )

    def _cable(self, entry: Any) -> Cable:
        points = tuple(self.point(point) for point in entry.points)
        sheathed = {} if entry.sheathed is None else {"sheathed": tuple((start, end) for start, end in entry.sheathed)}
        friction = {} if entry.friction is None else {"friction": float(entry.friction)}
        given = given_keys(entry, "name", "stiffness", "smoothing", "slack", "spool_radius", "reverse")
        return Cable(winch=entry.winch, points=points, **sheathed, **friction, **given)

    def _load(self, entry: Any) -> Load:
        at = {} if entry.at is None else {"at": self.point(entry.at)}
        force = {} if entry.force is None else {"force": tuple(entry.force)}
        if entry.moment is not None:
            force["moment"] = tuple(entry.moment) if isinstance(entry.moment, list) else (entry.moment,)
        path = tuple((key.time, float(key.share)) for key in entry.path)
        return Load(
            name=entry.name, **at, **force, path=path, **given_keys(entry, "marker", "mass", "pressure", "drive")
        )

    def _rod(self, entry: Any) -> Rod:
        given = given_keys(entry, "diameter", "young", "axial_stiffness", "bending_stiffness", "torsional_stiffness")
        return Rod(name=entry.name, points=tuple(self.point(point) for point in entry.points), **given)

    def _sensor(self, entry: Any) -> Sensor:
        given: dict[str, Any] = {"points": tuple(self.point(point) for point in entry.points)}
        if entry.at is not None:
            given["at"] = self.point(entry.at)
        if entry.normal is not None:
            given["normal"] = tuple(float(value) for value in entry.normal)
        if entry.radius is not None:
            given["radius"] = units.scale_up(entry.radius, self.unit, units.LENGTH)
        if entry.noise is not None:
            given["noise"] = Sensor.parse_noise(entry.kind, entry.noise)
        return Sensor(name=entry.name, kind=entry.kind, **given)

    def _marker(self, entry: Any) -> Marker:
        return Marker(name=entry.name, at=self.point(entry.at))

    def _pose(self, entry: Any) -> PoseTarget:
        return PoseTarget(name=entry.name, targets={name: self.point(point) for name, point in entry.targets.items()})

    def _body(self) -> Body:
        entry = self.table.body
        sources = [source for source in Source if getattr(entry, source) is not None]
        if len(sources) != 1:
            self.fail("body", "give one of outline (a drawing), surface (a scan or CAD model) or mesh (a ready mesh)")
        source = sources[0]
        for key in ("inner", "drawing_part"):
            if getattr(entry, key) is not None and source is not Source.OUTLINE:
                self.fail(f"body.{key}", "is for bodies with an outline; remove it")
        file = self._file(f"body.{source}", getattr(entry, source))
        material = self.at("body.material", lambda: read_material(entry.material))
        unit = units.scale_up(Decimal(1), self.unit, units.LENGTH)
        if source is Source.MESH:
            if entry.element_size is not None:
                self.fail("body.element_size", "a ready mesh has its own element size; remove the key")
            make = partial(Body.from_mesh, file, unit=unit)
        else:
            self._need(entry, source)
            content = self.at(f"body.{source}", lambda: read_stranger(file, name=file.name))
            given = {"file": file.name, "element_size": entry.element_size}
            if source is Source.SURFACE:
                make = partial(Body.from_surface, content, unit=unit, **given)
            else:
                make = partial(Body.from_outline, content, **given)
        body = self.at(
            "body",
            lambda: make(
                material=material,
                size=entry.size,
                thickness=entry.thickness,
                **given_keys(entry, "volume", *(("inner", "drawing_part") if source is Source.OUTLINE else ())),
            ),
            otherwise=f"body.{source}",
        )
        parts = tuple(
            self.at(where := f"body.part[{index}]", partial(self._part, where, part))
            for index, part in enumerate(entry.part)
        )
        body = self.at("", lambda: body.with_parts(parts)) if parts else body
        if entry.grading is not None:
            content = read_stranger(self._file("body.grading", entry.grading), name=entry.grading)
            grading = self.at("body.grading", lambda: Grading(content=content, file=entry.grading))
            body = self.at("body.grading", lambda: replace(body, grading=grading))
        if entry.plane is not None:
            body = self.at("body", partial(replace, body, plane=entry.plane))
        kind = entry.elements
        return body if kind is None else self.at("body.elements", lambda: body.with_elements(kind))

    def _part(self, where: str, entry: Any) -> BodyPart:
        if entry.rigid == (entry.material is not None):
            raise InputError("give either material or rigid = true")
        return BodyPart(**self._region(where, entry), **given_keys(entry, "density", "label"))

    def _sheet(self, where: str, entry: Any) -> Membrane:
        return Membrane(**self._region(where, entry), **given_keys(entry, "thickness", "on", "wrinkles"))

    def _region(self, where: str, entry: Any) -> dict[str, Any]:
        """Name, region and material."""
        if (entry.file is not None) != (entry.shape is PartShape.MESH):
            raise InputError('shape = "mesh" needs a file, and no other shape has one')
        given: dict[str, Any] = {key: self.point(getattr(entry, key)) for key in ("at", "to") if getattr(entry, key)}
        if entry.radius is not None:
            given["radius"] = units.scale_up(entry.radius, self.unit, units.LENGTH)
        if entry.file is not None:
            given["mesh"] = self._closed_mesh(f"{where}.file", entry.file)
            given.setdefault("at", (0.0, 0.0, 0.0))
        if entry.material is not None:
            given["material"] = self.at(f"{where}.material", lambda: read_material(entry.material))
        points = tuple(self.point(point) for point in entry.points)
        return {"name": entry.name, "shape": entry.shape, "points": points, **given}

    def _closed_mesh(self, key: str, name: str) -> ClosedMesh:
        file = self._file(key, name)
        content = read_stranger(file, name=file.name)
        return closed_mesh(content, file.name, unit=units.scale_up(Decimal(1), self.unit, units.LENGTH))

    def _need(self, entry: Any, source: Source) -> None:
        """Refuse a body without the sizes that it needs."""
        keys = [("element_size", "12 mm"), ("thickness", "40 mm")]
        for key, example in keys if source is Source.OUTLINE else keys[:1]:
            if getattr(entry, key) is None:
                kind = "a flat body" if source is Source.OUTLINE else "a body from a surface"
                self.fail("body", f'the key "{key}" is missing; {kind} needs it: {key} = "{example}"')

    def _file(self, key: str, name: str) -> Path:
        file = self.file.parent / name
        if Path(name).name != name or "\\" in name or not name.isprintable() or name in {FILE, "..", self.file.name}:
            self.fail(key, f"{units.quote(name)} must be the plain name of a file beside robot.toml, without a folder")
        if not os.path.isfile(file):  # unlike Path.is_file, False for a name too long for the system
            self.fail(key, f"file {units.quote(name)} not found next to robot.toml. Put it there.")
        return file


def read_material(entry: Any) -> Material:
    """Return a material by name or by its values (InputError: an unknown name, or a value out of its range)."""
    if isinstance(entry, str):
        return get_material(entry)
    if not hasattr(entry, "name"):
        return material_of(entry)
    given = inelastic_values(entry)
    known = get_material(entry.name, None if given.get("foam") else entry.law)
    if isinstance(entry.viscosity, tuple):  # LossFrequency
        given["viscosity"] = known.with_damping(entry.viscosity[0]).viscosity
    if entry.hysteresis is None and "hysteresis" in entry.model_fields_set:  # "material"
        given["hysteresis"] = known.with_hysteresis().hysteresis
    return replace(known, **given)


def _gravity(entry: Any, dim: int) -> tuple[float, ...] | None:
    if entry is None:
        return None
    return gravity_along(entry, dim) if isinstance(entry, str) else tuple(entry)


def _load_drive(entry: Any) -> LoadDrive:
    """Drive that has no place, so that it scales loads."""
    limits = {"min": entry.min, "max": entry.max}
    for key, limit in limits.items():
        if not isinstance(limit, Decimal):
            said = "is missing" if limit is None else f"is the text {units.quote(limit)}"
            raise InputError(
                f"{key} {said}. A share of loads is a number, e.g. {key} = {_SHARES[key]}. "
                "A drive of pins has at or slide."
            )
    return LoadDrive(name=entry.name, **{key: float(limit) for key, limit in limits.items()})


_SHARES = {"min": -1, "max": 2}
"""Shares of loads in an example."""


def _drive_value(key: str, text: str, *, turns: bool) -> float:
    try:
        return PinDrive.parse_value(text, turns=turns)
    except InputError as error:
        raise InputError(f"{key}: {error}") from None
