"""`three_mf_bytes`: printed parts as one 3MF, laid out on the bed with their titles and counts."""

import io
import zipfile
from xml.sax.saxutils import escape, quoteattr

from hydrostat.fabrication.solids.printed import Printed

_GAP = 5.0
"""Between parts on the bed [mm]."""

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


def three_mf_bytes(parts: tuple[Printed, ...], title: str, *, bed: float = 220.0) -> bytes:
    """Parts as one 3MF in millimetres, each as often as it is needed, side by side in rows across the bed.

    Args:
        parts: one or several; a part larger than the bed has a row of its own.
        title: of the file.
        bed: width of the bed [mm]. What does not fit on its depth is beyond it, for the slicer to lay on a second one.

    Raises:
        ValueError: no parts.
    """
    if not parts:
        raise ValueError("a 3MF needs a part")
    objects = "".join(_object(number, part) for number, part in enumerate(parts, start=1))
    items = "".join(
        f'  <item objectid="{number + 1}" transform="1 0 0 0 1 0 0 0 1 {_number(x)} {_number(y)} 0"/>\n'
        for number, x, y in laid_out(parts, bed=bed)
    )
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<model unit="millimeter" xml:lang="en-US" '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">\n'
        f' <metadata name="Title">{escape(title)}</metadata>\n'
        ' <metadata name="Application">hydrostat</metadata>\n'
        f" <resources>\n{objects} </resources>\n <build>\n{items} </build>\n</model>\n"
    )
    return _zipped({"[Content_Types].xml": _TYPES, "_rels/.rels": _RELATIONS, "3D/3dmodel.model": model})


def laid_out(parts: tuple[Printed, ...], *, bed: float) -> list[tuple[int, float, float]]:
    """For each copy: number of its part, and how far it is moved along x and y [mm], the deepest first, in rows."""
    boxes = [part.solid.bounding_box() for part in parts]
    copies = [number for number, part in enumerate(parts) for _ in range(part.count)]
    copies.sort(key=lambda number: (boxes[number][1] - boxes[number][4], number))
    places, x, y, deepest = [], 0.0, 0.0, 0.0
    for number in copies:
        low_x, low_y, _, high_x, high_y, _ = boxes[number]
        if x > 0 and x + high_x - low_x > bed:
            x, y, deepest = 0.0, y + deepest + _GAP, 0.0
        places.append((number, x - low_x, y - low_y))
        x += high_x - low_x + _GAP
        deepest = max(deepest, high_y - low_y)
    return places


def _object(number: int, part: Printed) -> str:
    vertices, triangles = part.written
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


def _zipped(texts: dict[str, str]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for name, text in texts.items():
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, text)
    return packed.getvalue()
