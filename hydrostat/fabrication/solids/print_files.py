"""Printed parts as files for a slicer: binary STL, and 3MF laid out on beds."""

import io
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from hydrostat.fabrication.solids.printed import Printed

_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl_bytes(printed: Printed) -> bytes:
    """A part as binary STL in millimeters; the header names it. One copy: STL knows no count."""
    vertices, triangles = printed.file_mesh
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    records = np.zeros(len(triangles), dtype=_TRIANGLE)
    records["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    records["corners"] = corners
    header = f"hydrostat {printed.name} [mm]".encode("ascii", "replace")[:80].ljust(80, b" ")
    return header + np.uint32(len(triangles)).astype("<u4").tobytes() + records.tobytes()


@dataclass(frozen=True)
class PartOnBed:
    """One part on a bed."""

    part: int  # its index
    x: float  # offset along x [mm], after the rotation
    y: float  # the same along y
    turned: bool  # True if it is rotated by 90 degrees, counter-clockwise from above


@dataclass(frozen=True)
class _BedPiece:
    part: int
    turned: bool
    low: tuple[float, float]
    size: tuple[float, float]


def lay_plates(parts: Iterable[Printed], bed: tuple[float, float]) -> tuple[tuple[PartOnBed, ...], ...]:
    """The parts of each bed [mm], every part as often as it is needed, in rows, the deepest first.

    A part is turned where only so it fits; one that does not fit at all has a bed of its own.
    """
    pieces = [_piece(number, part, bed) for number, part in enumerate(parts) for _ in range(part.count)]
    pieces.sort(key=lambda piece: (-piece.size[1], piece.part))
    plates: list[list[PartOnBed]] = [[]]
    x = y = row = 0.0
    gap = 5.0  # between parts on the bed [mm]
    for piece in pieces:
        wide, deep = piece.size
        if x > 0 and x + wide > bed[0]:
            x, y, row = 0.0, y + row + gap, 0.0
        if y > 0 and y + deep > bed[1]:
            plates.append([])
            x = y = row = 0.0
        plates[-1].append(PartOnBed(piece.part, x - piece.low[0], y - piece.low[1], piece.turned))
        x, row = x + wide + gap, max(row, deep)
    return tuple(tuple(plate) for plate in plates if plate)


def _piece(number: int, part: Printed, bed: tuple[float, float]) -> _BedPiece:
    """A part as it lies best."""
    low_x, low_y, _, high_x, high_y, _ = part.solid.bounding_box()
    wide, deep = high_x - low_x, high_y - low_y
    turned = (wide > bed[0] or deep > bed[1]) and deep <= bed[0] and wide <= bed[1]
    if turned:
        return _BedPiece(number, turned, (-high_y, low_x), (deep, wide))
    return _BedPiece(number, turned, (low_x, low_y), (wide, deep))


_STRAIGHT, _TURNED = "1 0 0 0 1 0 0 0 1", "0 1 0 -1 0 0 0 0 1"
"""Rotation of a part in a 3MF file: each row is the image of one axis."""

_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
    "</Types>\n"
)

_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>'
    "</Relationships>\n"
)


def three_mf_plates(parts: tuple[Printed, ...], title: str, *, bed: tuple[float, float]) -> tuple[bytes, ...]:
    """Parts as 3MF in millimeters, a file for each bed, each part as often as it is needed; ValueError for no parts."""
    if not parts:
        raise ValueError("a 3MF needs a part")
    plates = lay_plates(parts, bed)
    return tuple(
        _file(parts, plate, f"{title}, plate {number} of {len(plates)}" if len(plates) > 1 else title)
        for number, plate in enumerate(plates, start=1)
    )


def _file(parts: tuple[Printed, ...], plate: tuple[PartOnBed, ...], title: str) -> bytes:
    used = sorted({laid.part for laid in plate})
    numbers = {part: number for number, part in enumerate(used, start=1)}
    objects = "".join(_object(numbers[part], parts[part]) for part in used)
    items = "".join(
        f'  <item objectid="{numbers[laid.part]}" transform="{_TURNED if laid.turned else _STRAIGHT} '
        f'{_number(laid.x)} {_number(laid.y)} 0"/>\n'
        for laid in plate
    )
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<model unit="millimeter" xml:lang="en-US" '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">\n'
        f' <metadata name="Title">{escape(title)}</metadata>\n'
        ' <metadata name="Application">hydrostat</metadata>\n'
        f" <resources>\n{objects} </resources>\n <build>\n{items} </build>\n</model>\n"
    )
    return _zip_texts({"[Content_Types].xml": _TYPES, "_rels/.rels": _RELATIONS, "3D/3dmodel.model": model})


def _object(number: int, part: Printed) -> str:
    vertices, triangles = part.file_mesh
    corners = "".join(
        f'<vertex x="{_number(x)}" y="{_number(y)}" z="{_number(z)}"/>\n' for x, y, z in vertices.tolist()
    )
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>\n' for a, b, c in triangles.tolist())
    return (
        f'  <object id="{number}" type="model" name={quoteattr(part.title)} partnumber={quoteattr(part.name)}>\n'
        f"   <mesh>\n<vertices>\n{corners}</vertices>\n<triangles>\n{faces}</triangles>\n   </mesh>\n  </object>\n"
    )


def _number(length: float) -> str:
    """A length [mm] to 1e-5, shortest."""
    return f"{length:.5f}".rstrip("0").rstrip(".")


def _zip_texts(texts: dict[str, str]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for name, text in texts.items():
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, text)
    return packed.getvalue()
