"""Surface files of all kinds as bytes, made by hand here (in millimeters), for what no library writes."""

from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np

from hydrostat.geometry.surface import Surface

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_KIND = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006/relationships"


def mesh_xml(surface: Surface, scale: float = 1e3) -> str:
    """A mesh of 3MF."""
    vertices = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in (surface.vertices * scale).tolist())
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in surface.triangles.tolist())
    return f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"


def model_xml(objects: str, items: str, unit: str = "millimeter", extra: str = "") -> str:
    """A model of 3MF."""
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>{extra}<model unit="{unit}" xmlns="{_CORE}" '
        'xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06">'
        f"<resources>{objects}</resources><build>{items}</build></model>"
    )


def archive(parts: dict[str, str]) -> bytes:
    """A 3MF archive of XML parts, of which 3D/3dmodel.model is the root; the same bytes on every run."""
    from zipfile import ZipInfo

    relations = f'<Relationships xmlns="{_PACKAGE}"><Relationship Target="/3D/3dmodel.model" Id="r" Type="{_KIND}"/>'
    stream = BytesIO()
    with ZipFile(stream, "w", ZIP_DEFLATED) as target:
        for name, text in {"_rels/.rels": relations + "</Relationships>", **parts}.items():
            target.writestr(ZipInfo(name), text, ZIP_DEFLATED)
    return stream.getvalue()


def threemf(surface: Surface, unit: str = "millimeter", scale: float = 1e3) -> bytes:
    """A surface as one object."""
    objects = f'<object id="1">{mesh_xml(surface, scale)}</object>'
    return archive({"3D/3dmodel.model": model_xml(objects, '<item objectid="1"/>', unit)})


def stl(surface: Surface) -> bytes:
    """Binary STL."""
    records = np.zeros(len(surface.triangles), dtype=[("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")])
    records["c"] = 1e3 * surface.vertices[surface.triangles]
    return b"a surface".ljust(80) + np.uint32(len(records)).tobytes() + records.tobytes()


def stl_text(surface: Surface) -> bytes:
    """Text STL."""
    rows = []
    for corners in (1e3 * surface.vertices[surface.triangles]).tolist():
        rows.append("facet normal 0 0 0\n outer loop")
        rows.extend(f"  vertex {x:e} {y:e} {z:e}" for x, y, z in corners)
        rows.append(" endloop\nendfacet")
    return ("solid a surface\n" + "\n".join(rows) + "\nendsolid\n").encode()


def _rows(surface: Surface) -> tuple[list[str], list[list[int]]]:
    return [f"{x!r} {y!r} {z!r}" for x, y, z in (1e3 * surface.vertices).tolist()], surface.triangles.tolist()


def obj(surface: Surface) -> bytes:
    """OBJ, with words that a reader has to pass over."""
    vertices, triangles = _rows(surface)
    rows = ["# a surface", "mtllib /etc/passwd", "o body", *(f"v {row}" for row in vertices), "vn 0 0 1", "s off"]
    rows += [f"f {a + 1}//1 {b + 1}//1 {c + 1}//1" for a, b, c in triangles]
    return ("\n".join(rows) + "\n").encode()


def off(surface: Surface) -> bytes:
    """OFF with a comment."""
    vertices, triangles = _rows(surface)
    rows = ["OFF # a surface", f"{len(vertices)} {len(triangles)} 0", "", *vertices]
    return "\n".join(rows + [f"3 {a} {b} {c}" for a, b, c in triangles]).encode() + b"\n"


def ply_text(surface: Surface) -> bytes:
    """PLY as text."""
    vertices, triangles = _rows(surface)
    head = ["ply", "format ascii 1.0", "comment made here", f"element vertex {len(vertices)}"]
    head += [f"property double {axis}" for axis in "xyz"]
    head += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    return "\n".join(head + vertices + [f"3 {a} {b} {c}" for a, b, c in triangles]).encode() + b"\n"


def ply_big(surface: Surface) -> bytes:
    """PLY, big-endian, with colors and an element between vertices and faces."""
    vertices = np.zeros(len(surface.vertices), dtype=[("p", ">f8", 3), ("c", "u1", 3)])
    vertices["p"] = 1e3 * surface.vertices
    faces = np.zeros(len(surface.triangles), dtype=[("f", "u1"), ("n", "u1"), ("v", ">i4", 3)])
    faces["n"], faces["v"] = 3, surface.triangles
    head = ["ply", "format binary_big_endian 1.0", f"element vertex {len(vertices)}"]
    head += [f"property double {axis}" for axis in "xyz"] + [f"property uchar {color}" for color in ("r", "g", "b")]
    head += ["element edge 2", "property int vertex1", "property list uchar short weights"]
    head += [f"element face {len(faces)}", "property uchar flags", "property list uchar int vertex_index", "end_header"]
    edges = b"\0\0\0\1\2\0\1\0\1" + b"\0\0\0\1\1\0\1"  # lists of different lengths
    return "\n".join(head).encode() + b"\n" + vertices.tobytes() + edges + faces.tobytes()
