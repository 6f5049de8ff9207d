"""3MF files: a zip archive with objects as XML, with a unit, and a list of where each object is to be built."""

import zlib
from array import array
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from xml.parsers import expat
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile

import numpy as np

from hydrostat.errors import SurfaceError
from hydrostat.geometry.files.soup import MAX_TEXT_BYTES, MAX_TRIANGLES, Soup, check_count
from hydrostat.units import plural

_MAX_DEPTH = 50
_METERS = {
    "micron": 1e-6, "millimeter": 1e-3, "centimeter": 1e-2, "meter": 1.0, "inch": 0.0254, "foot": 0.3048,
}  # fmt: skip
_ROOT_KIND = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"

_Key = tuple[str, str]  # an object: the part of the archive that it stands in, and its number there


@dataclass
class _Object:
    """Mesh, or other objects put together, or both."""

    places: array = field(default_factory=lambda: array("d"))
    corners: array = field(default_factory=lambda: array("q"))
    parts: list[tuple[_Key, np.ndarray]] = field(default_factory=list)
    support: bool = False  # a scaffold of the printer, no part of the body


@dataclass
class _Model:
    """Objects of an archive, as all its XML declares them."""

    unit: str = "millimeter"
    objects: dict[_Key, _Object] = field(default_factory=dict)
    items: list[tuple[_Key, np.ndarray]] = field(default_factory=list)
    unprinted: int = 0  # items marked as not to be printed
    others: set[str] = field(default_factory=set)


def read_3mf(content: bytes, name: str) -> Soup:
    """Read all objects that a 3MF file builds, each at its position, as one.

    Raises SurfaceError: no archive, or not a 3MF one; too large when unpacked; broken XML, or XML with entities;
    objects that hold themselves, are not there, or repeat too often.
    """
    most_members = 2000
    if content.count(b"PK\x01\x02") > most_members:  # before anything lists them
        raise SurfaceError(f"{name}: holds more than {most_members} files: save the model alone")
    try:
        with ZipFile(BytesIO(content)) as archive:
            model = _read_archive(archive, name)
    except (BadZipFile, zlib.error, EOFError, OSError, RuntimeError, NotImplementedError, ValueError) as error:
        raise SurfaceError(f"{name}: no archive that can be read ({_first_line(error)}): export it again") from None
    return _read_objects(model, name)


def _first_line(error: BaseException) -> str:
    return (str(error).strip().splitlines() or ["damaged"])[0][:100]


def _read_archive(archive: ZipFile, name: str) -> _Model:
    """Root model of an archive, and the parts that it names."""
    model = _Model()
    root = _root(archive, name)
    waiting, done, left = [root], set(), MAX_TEXT_BYTES
    while waiting:
        part = waiting.pop()
        done.add(part)
        text = _member(archive, part, name, left)
        left -= len(text)
        _read_xml(text, part, model, root=part == root, name=name)
        waiting.extend(sorted(model.others - done - set(waiting)))
    return model


def _root(archive: ZipFile, name: str) -> str:
    """Name of the part where the model begins."""
    members = set(archive.namelist())
    found: list[str] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        if tag.rpartition("}")[2] == "Relationship" and attributes.get("Type") == _ROOT_KIND:
            found.append(attributes.get("Target", "").lstrip("/"))

    if "_rels/.rels" in members:
        _parse(_member(archive, "_rels/.rels", name, 1_000_000), start, name)
    found += sorted(member for member in members if member.lower().endswith(".model"))
    root = next((part for part in found if part in members), None)
    if root is None:
        raise SurfaceError(f"{name}: an archive without a 3D model: export the surface again as 3MF or STL")
    return root


def _member(archive: ZipFile, part: str, name: str, most: int) -> bytes:
    """Bytes of a part, of which neither the declared nor the true size may be too large."""
    try:
        entry = archive.getinfo(part)
    except KeyError:
        raise SurfaceError(f"{name}: names {part[:60]!r}, which it does not hold: export it again") from None
    if entry.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
        raise SurfaceError(f"{name}: is packed in a way that 3MF does not have: export it again")
    if entry.file_size <= most:
        with archive.open(entry) as stream:
            text = stream.read(most + 1)
        if len(text) <= most:
            return text
    raise SurfaceError(
        f"{name}: unpacks to more than {MAX_TEXT_BYTES / 1e6:.0f} MB: simplify the surface, such as to 100000 "
        "triangles, or save it as binary STL"
    )


def _parse(text: bytes, start: "expat._StartElement", name: str) -> None:  # pyright: ignore
    """Parse XML; reject XML that is broken, deep, or declares entities."""
    depth = 0

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > _MAX_DEPTH:
            raise SurfaceError(f"{name}: XML nested deeper than {_MAX_DEPTH}: export it again")
        start(tag, attributes)

    def end(_tag: str) -> None:
        nonlocal depth
        depth -= 1

    def entity(*_arguments: object) -> None:
        raise SurfaceError(f"{name}: declares XML entities, which are not read: export it again")

    parser = expat.ParserCreate(namespace_separator="}")
    parser.StartElementHandler, parser.EndElementHandler, parser.EntityDeclHandler = begin, end, entity
    try:
        parser.Parse(text, True)
    except (expat.ExpatError, LookupError) as error:
        raise SurfaceError(f"{name}: its XML is broken ({_first_line(error)}): export it again") from None


def _read_xml(text: bytes, part: str, model: _Model, *, root: bool, name: str) -> None:
    """Add the contents of one part to the model; only the root lists the objects to build."""
    now = _Object()

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal now
        try:
            match tag.rpartition("}")[2]:
                case "vertex":
                    now.places.extend([float(attributes[axis]) for axis in "xyz"])
                case "triangle":
                    now.corners.extend([int(attributes[corner]) for corner in ("v1", "v2", "v3")])
                case "object":
                    support = attributes.get("type") in ("support", "solidsupport")
                    now = model.objects[part, attributes["id"]] = _Object(support=support)
                case "component":
                    now.parts.append(_read_item(attributes, part, model))
                case "item" if root and attributes.get("printable", "1") in ("0", "false"):
                    model.unprinted += 1
                case "item" if root:
                    model.items.append(_read_item(attributes, part, model))
                case "model" if root:
                    model.unit = attributes.get("unit", "millimeter")
        except (KeyError, ValueError, OverflowError):
            raise SurfaceError(f"{name}: a {tag.rpartition('}')[2]} in {part[:60]} is wrong: export it again") from None
        if len(now.corners) > 3 * MAX_TRIANGLES or len(now.places) > 9 * MAX_TRIANGLES:
            check_count(name, "triangles or vertices", 1 + MAX_TRIANGLES, room=np.inf)

    _parse(text, start, name)


def _read_item(attributes: dict[str, str], part: str, model: _Model) -> tuple[_Key, np.ndarray]:
    """Object and where it goes: four rows of three, for row vectors."""
    path = next((text for key, text in attributes.items() if key.rpartition("}")[2] == "path"), "").lstrip("/")
    if path:
        model.others.add(path)
    numbers = [float(word) for word in attributes.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()]
    transform = np.eye(4)
    transform[:, :3] = np.array(numbers).reshape(4, 3)
    return (path or part, attributes["objectid"]), transform


def _read_objects(model: _Model, name: str) -> Soup:
    """Meshes of all built objects, moved to their positions."""
    if model.unit not in _METERS:
        raise SurfaceError(f"{name}: its unit {model.unit[:40]!r} is none of {', '.join(_METERS)}: export it again")
    if not model.items:
        raise SurfaceError(f"{name}: builds nothing: export the surface again as 3MF or STL")
    places, triangles, vertex_count, triangle_count = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0, 0
    supports = 0
    for found, transform in _meshes(model, name):
        if found.support:
            supports += 1
            continue
        points = np.array(found.places).reshape(-1, 3)
        corners = np.array(found.corners, dtype=np.int64).reshape(-1, 3)
        if len(corners) and (corners.min() < 0 or corners.max() >= len(points)):
            raise SurfaceError(f"{name}: a triangle names a vertex that its object does not have: export it again")
        triangle_count += len(corners)
        check_count(name, "triangles", triangle_count, room=np.inf)
        check_count(name, "vertices", vertex_count + len(points), room=np.inf, most=3 * MAX_TRIANGLES)
        turn = np.linalg.det(transform[:3, :3]) < 0.0
        with np.errstate(all="ignore"):
            places.append(points @ transform[:3, :3] + transform[3, :3])
        triangles.append(vertex_count + (corners[:, ::-1] if turn else corners))
        vertex_count += len(points)
    left = {"of type support": supports, "not to be printed": model.unprinted}
    notes = tuple(f"{plural(count, 'object')} {kind}, left out" for kind, count in left.items() if count)
    return Soup(np.concatenate(places), np.concatenate(triangles), _METERS[model.unit], notes)


def _meshes(model: _Model, name: str) -> Iterator[tuple[_Object, np.ndarray]]:
    """Yield every mesh of the built objects with its transform; a mesh that is used twice comes twice."""
    stack = [(key, transform, 0) for key, transform in reversed(model.items)]
    placed = 0
    most_placed = 10_000
    while stack:
        key, transform, depth = stack.pop()
        placed += 1
        if key not in model.objects:
            raise SurfaceError(f"{name}: builds object {key[1][:20]}, which it does not hold: export it again")
        if depth > _MAX_DEPTH or placed > most_placed:
            raise SurfaceError(f"{name}: its objects hold themselves, or too many others: export it again as STL")
        found = model.objects[key]
        if found.corners:
            yield found, transform
        stack.extend((child, at @ transform, depth + 1) for child, at in reversed(found.parts))
