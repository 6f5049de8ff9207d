"""Files as strangers bring them, made here: parts with small features, 40 drawings and surfaces, 20 kinds of reports.

    python lab/strangers/strangers.py [parts | kinds | reports]

`parts` meshes ten printed or cast parts with about 1,000 nodes and prints CPU seconds with reading and healing, nodes,
and the largest distance between mesh and surface with its small holes filled, in element sizes. `kinds` reads files of
the kinds in decision 0045, `reports` others that public issue trackers describe. Their oracle is the size of what was
drawn. Ends with 1 if a file is not read as it was meant.
"""

import sys
from collections.abc import Callable, Iterator
from functools import partial
from io import BytesIO, StringIO
from itertools import pairwise
from time import process_time
from zipfile import ZipFile

import ezdxf
from machine import machine

import numpy as np  # isort: skip
from manifold3d import CrossSection, Manifold

from hydrostat.errors import HydrostatError
from hydrostat.geometry import HOLE_SHARE, Solid, fill_small_holes, fit, heal, read_drawing, read_surface
from hydrostat.robot import SurfaceSketch

Row = tuple[str, str, bytes, float | str]  # kind, file name, content, and longest side [mm] or words of the refusal


def box(x: float, y: float, z: float, at: tuple[float, float, float] = (0, 0, 0)) -> Manifold:
    return Manifold.cube((x, y, z)).translate(at)


def rod(diameter: float, length: float, at: tuple[float, float, float], axis: str = "z") -> Manifold:
    turn = {"x": (0, 90, 0), "y": (-90, 0, 0), "z": (0, 0, 0)}[axis]
    return Manifold.cylinder(length, diameter / 2, diameter / 2, 24).rotate(turn).translate(at)


def make_plate() -> Manifold:
    body = box(60, 30, 4)
    for number in range(10):
        body -= rod(1.5, 6, (4 + 5.5 * number, 8 + 5 * (number % 3), -1))
    return body


def make_finger() -> Manifold:
    body = box(88, 16, 2.5, (0, 0, 3)) + Manifold.sphere(7, 32).translate((84, 8, 7))
    for at, length in ((0, 30), (32, 26), (62, 22)):
        body += box(length, 16, 14, (at, 0, 0))
    body -= rod(2, 100, (-5, 8, 11), "x") + rod(2, 100, (-5, 8, 1.6), "x")
    for x in (8, 22, 40, 50, 70, 78):
        body -= rod(3, 20, (x, -2, 7.5), "y")
    return body


def make_pneunet() -> Manifold:
    body = box(76, 26, 7)
    for number in range(4):
        body += box(16, 26, 26, (20 * number, 0, 0)) - box(6, 14, 14, (5 + 20 * number, 6, 6))
    body -= rod(2, 68, (-1, 13, 8), "x")
    for number in range(4):
        body -= box(6, 14, 14, (5 + 20 * number, 6, 6))
    return body


def make_bracket() -> Manifold:
    body = box(60, 40, 6) + box(6, 40, 50)
    for y in (8, 32):
        for x in (24, 48):
            body -= rod(3.2, 10, (x, y, -1)) + Manifold.cylinder(2, 1.6, 3.6, 32).translate((x, y, 4.2))
        for z in (20, 40):
            body -= rod(3.2, 10, (-1, y, z), "x")
    return body


def make_teapot() -> Manifold:
    profile = [(0, 0), (22, 0), (30, 8), (33, 20), (30, 32), (20, 42), (8, 46), (5, 48), (5, 51), (3, 54), (0, 55)]
    body = Manifold.revolve(CrossSection([profile]), 64)
    spout = [((26, 0, 16), 7.0), ((38, 0, 20), 5.0), ((46, 0, 32), 3.5), ((52, 0, 42), 2.6)]
    balls = [Manifold.sphere(radius, 24).translate(at) for at, radius in spout]
    for one, two in pairwise(balls):
        body += Manifold.batch_hull([one, two])
    handle = Manifold.revolve(CrossSection.circle(3, 20).translate((13, 0)), 48)
    return body + handle.rotate((90, 0, 0)).translate((-34, 0, 24)) - rod(1.2, 30, (9, 3, 30))


def make_lattice() -> Manifold:
    body = Manifold()
    for one in (0, 20, 40):
        for two in (0, 20, 40):
            body += rod(9, 40, (one, two, 0)) + rod(9, 40, (one, 0, two), "y") + rod(9, 40, (0, one, two), "x")
    return body


def make_wheel() -> Manifold:
    body = rod(60, 10, (0, 0, 0)) - rod(44, 12, (0, 0, -1)) + rod(18, 10, (0, 0, 0))
    for number in range(6):
        body += box(26, 6, 10, (0, -3, 0)).rotate((0, 0, 60 * number))
    for number in range(24):
        body -= rod(1.6, 12, (26, 0, -1)).rotate((0, 0, 15 * number))
    return body - rod(5, 14, (0, 0, -2))


def make_engraved() -> Manifold:
    body = box(90, 40, 8)
    for number in range(7):
        body -= box(1, 24, 2, (10 + 11 * number, 8, 7)) + box(7, 1, 2, (10 + 11 * number, 19, 7))
    return body


def make_case() -> Manifold:
    body = box(60, 50, 30) - box(44, 34, 30, (8, 8, 8))
    for number in range(30):
        body -= rod(1.5, 12, (14 + 8 * (number % 5), 12 + 5 * (number // 5), -1))
    return body


def make_pad() -> Manifold:
    body = Manifold.batch_hull([rod(24, 8, (0, 0, 0)), rod(24, 8, (50, 0, 0))])
    for number in range(50):
        body += Manifold.sphere(0.9, 12).translate((5 * (number % 10) + 2, 4 * (number // 10 - 2), 8))
    for number in range(6):
        body -= rod(1.5, 30, (4 + 8.4 * number, -15, 4), "y")
    return body


PARTS: dict[str, Callable[[], Manifold]] = {
    "plate with ten holes": make_plate,
    "finger of a printed hand": make_finger,
    "pneunet": make_pneunet,
    "bracket": make_bracket,
    "teapot": make_teapot,
    "lattice": make_lattice,
    "wheel": make_wheel,
    "engraved plate": make_engraved,
    "case with 30 vents": make_case,
    "grip pad with 50 bumps": make_pad,
}


def corners_of(body: Manifold) -> np.ndarray:
    """Corners of each triangle [mm]."""
    mesh = body.to_mesh()
    return np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts)]


def write_stl(body: Manifold, head: bytes = b"a part") -> bytes:
    corners = corners_of(body)
    records = np.zeros(len(corners), dtype=[("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")])
    records["c"] = corners
    return head.ljust(80) + np.uint32(len(corners)).tobytes() + records.tobytes()


def mesh_parts() -> bool:
    print("| part | CPU s | nodes | element size | largest distance | holes filled |\n|---|---|---|---|---|---|")
    good = True
    for name, make in PARTS.items():
        content, start = write_stl(make()), process_time()
        try:
            sketch = SurfaceSketch.of_scan(content, file="part.stl", name="part", nodes=1000)
        except HydrostatError as error:
            print(f"| {name} | {process_time() - start:.1f} | {error} |", flush=True)
            good = False
            continue
        seconds, body = process_time() - start, sketch.robot.body
        size = body.element_size or 0.0
        filled = fill_small_holes(sketch.healing.surface, HOLE_SHARE * size)
        away = fit(body.mesh, Solid(filled.surface), size / 3).largest
        good &= away <= max(0.5 * size, 0.3e-3)
        cells = (
            name,
            f"{seconds:.1f}",
            len(body.mesh.nodes),
            f"{1e3 * size:.2f} mm",
            f"{away / size:.2f}",
            len(filled),
        )
        print("|", " | ".join(map(str, cells)), "|", flush=True)
    return good


FISH = "M 12 45 L 30 30 L 60 28 L 78 45 L 60 62 L 30 60 Z"
LINES = 'fill="none" stroke="black"'


def svg(body: str, attributes: str = 'width="90mm" height="90mm" viewBox="0 0 90 90"', head: str = "") -> bytes:
    return f'{head}<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{body}</svg>'.encode()


def dxf(draw: Callable[..., None], version: str = "R2010", unit: int = 4, ending: bytes = b"") -> bytes:
    made = ezdxf.new(version)
    if version != "R12":
        made.units = unit
    draw(made.modelspace())
    text = StringIO()
    made.write(text)
    return text.getvalue().encode() + ending


BAR = [(0, 0), (80, 0), (80, 30), (0, 30)]


def bar(space: object, **attributes: object) -> None:
    space.add_lwpolyline(BAR, close=True, dxfattribs=attributes)  # type: ignore[attr-defined]


def frame(space: object) -> None:
    space.add_lwpolyline([(-60, -90), (237, -90), (237, 120), (-60, 120)], close=True)  # type: ignore[attr-defined]


def sheet(space: object, layer: str) -> None:
    for left, low, right, high in ((-100, -100, 320, 197), (140, -100, 320, -64)):
        corners = [(left, low), (right, low), (right, high), (left, high)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})  # type: ignore[attr-defined]
    bar(space)


def sides(space: object) -> None:
    for one, two in zip(BAR, BAR[1:] + BAR[:1], strict=True):
        space.add_line(one, two)  # type: ignore[attr-defined]


def list_kinds() -> Iterator[Row]:
    fish = f'<path d="{FISH}"/>'
    grounds = {
        "white ground": '<rect width="90" height="90" fill="white"/>',
        "white by style": '<rect width="90" height="90" style="fill:rgb(255,255,255)"/>',
        "gray page": '<rect width="100%" height="100%" fill="#ddd"/>',
        "page in a group": '<g id="background"><rect width="90" height="90" fill="#abc"/></g>',
        "no paint": '<rect width="90" height="90" fill="none" stroke="none"/>',
        "hidden": '<rect width="90" height="90" visibility="hidden"/>',
        "hidden by class": '<style>.h{display:none}</style><rect class="h" width="90" height="90"/>',
        "clear": '<rect width="90" height="90" style="opacity:0"/>',
        "frame": f'<rect x="2" y="2" width="86" height="86" {LINES}/>',
        "two frames": f'<rect width="90" height="90" {LINES}/><rect x="4" y="4" width="82" height="82" {LINES}/>',
        "path as page": '<path d="M 0 0H90V90H0Z" fill="white"/>',
        "rounded ground": '<rect width="90" height="90" rx="6" fill="white"/>',
        "white badge": '<circle cx="45" cy="45" r="45" fill="white"/>',
        "gradient": '<rect width="90" height="90" fill="url(#g)"/>',
        "polygon as page": '<polygon points="0,0 90,0 90,90 0,90" fill="#fff"/>',
    }
    for name, ground in grounds.items():
        yield name, "a.svg", svg(ground + fish), 66.0
    yield "overlapping circles", "a.svg", svg('<circle cx="30" cy="45" r="20"/><circle cx="55" cy="45" r="20"/>'), 65.0
    yield (
        "mirrored halves",
        "a.svg",
        svg('<path id="h" d="M 45 10 L 80 45 L 45 80Z"/><use href="#h" transform="translate(90 0) scale(-1 1)"/>'),
        70.0,
    )
    yield (
        "ears on a head",
        "a.svg",
        svg('<circle cx="45" cy="50" r="30"/><path d="M 20 30 L 25 5 L 40 25Z"/><path d="M 50 25 L 65 5 L 70 30Z"/>'),
        75.0,
    )
    yield "fill without end", "a.svg", svg('<path d="M 10 10 L 80 10 L 80 60 L 10 60"/>'), 70.0
    yield "polyline with fill", "a.svg", svg('<polyline points="10,10 80,10 80,60 10,60"/>'), 70.0
    yield (
        "four lines",
        "a.svg",
        svg(
            f'<g {LINES}><line x1="10" y1="10" x2="80" y2="10"/><line x1="80" y1="10" x2="80" y2="60"/>'
            '<line x1="80" y1="60" x2="10" y2="60"/><line x1="10" y1="60" x2="10" y2="10"/></g>'
        ),
        70.0,
    )
    yield "two open halves", "a.svg", svg(f'<g {LINES}><path d="M 10 10H80V60"/><path d="M 10 10V60H80"/></g>'), 70.0
    ends = '<polyline points="10,10 80,10 80,60 10,60 10,10.9" stroke-width="2"'
    yield "ends that meet within their width", "a.svg", svg(f"{ends} {LINES}/>"), 70.0
    yield "symbol and use", "a.svg", svg(f'<symbol id="s">{fish}</symbol><use href="#s"/>'), 66.0
    yield (
        "xlink use",
        "a.svg",
        svg(f'<defs><g id="s">{fish}</g></defs><use xlink:href="#s" xmlns:xlink="http://www.w3.org/1999/xlink"/>'),
        66.0,
    )
    yield (
        "clip path",
        "a.svg",
        svg(
            '<clipPath id="c"><rect x="10" y="10" width="40" height="40"/></clipPath>'
            '<g clip-path="url(#c)"><rect width="90" height="90"/></g>'
        ),
        40.0,
    )
    yield "entity", "a.svg", svg(fish.replace(FISH, "&f;"), head=f'<!DOCTYPE svg [<!ENTITY f "{FISH}">]>'), 66.0
    yield "marks beside", "a.svg", svg(fish + "".join(f'<circle cx="{x}" cy="85" r="1"/>' for x in (5, 85))), 66.0
    yield "center line", "a.svg", svg(fish + f'<path d="M 0 45H90" {LINES}/>'), 66.0
    yield "DXF R12, without a unit", "a.dxf", dxf(sides, "R12"), "has no unit"
    for version in ("R2000", "R2004", "R2007", "R2010", "R2013", "R2018"):
        yield f"DXF {version}", "a.dxf", dxf(sides, version), 80.0
    yield "DXF in inches", "a.dxf", dxf(bar, unit=1), 80 * 25.4
    yield "DXF in meters", "a.dxf", dxf(bar, unit=6), "size"
    yield "Ctrl-Z", "a.dxf", dxf(bar, ending=b"\x1a"), 80.0
    spline = [(12, 45), (30, 30), (60, 28), (78, 45), (60, 62), (30, 60)]
    yield (
        "DXF in a frame of A4",
        "a.dxf",
        dxf(lambda space: (frame(space), space.add_lwpolyline(spline, close=True))),
        66.0,
    )
    for layer in ("FRAME", "0"):
        yield (
            f"DXF bar in a frame with a title block, layer {layer}",
            "a.dxf",
            dxf(partial(sheet, layer=layer)),
            80.0,
        )
    slot = [(0, 0, 0), (80, 0, 1), (80, 30, 0), (0, 30, 1)]
    yield (
        "DXF frozen layer",
        "a.dxf",
        dxf(
            lambda space: (
                bar(space),
                space.doc.layers.add("AXES").freeze(),
                space.add_circle((40, 15), 90, dxfattribs={"layer": "AXES"}),
            )
        ),
        80.0,
    )
    yield (
        "DXF slot with zeros after its end",
        "a.dxf",
        dxf(lambda space: space.add_lwpolyline(slot, format="xyb", close=True), ending=bytes(512)),
        110.0,
    )
    yield "DXF plate of A4 with a rectangular hole", "a.dxf", dxf(lambda space: (frame(space), bar(space))), 297.0
    yield "DXF center line", "a.dxf", dxf(lambda space: (bar(space), space.add_line((-5, 15), (85, 15)))), 80.0
    yield (
        "DXF speck",
        "a.dxf",
        dxf(lambda space: (bar(space), space.add_lwpolyline([(5, 5), (6, 5)], close=True))),
        80.0,
    )
    yield "DXF marks", "a.dxf", dxf(lambda space: (bar(space), space.add_circle((95, 35), 2))), 80.0
    yield "two parts", "a.svg", svg('<rect width="30" height="30"/><rect x="50" width="30" height="30"/>'), "2 parts"


def write_obj(body: Manifold, face: Callable[[int, int], str], end: str = "\n") -> bytes:
    corners = corners_of(body).reshape(-1, 3)
    lines = [f"v {x} {y} {z} 0.5 0.5 0.5" for x, y, z in corners.tolist()]
    count = len(corners)
    lines += ["f " + " ".join(face(index + corner, count) for corner in range(3)) for index in range(0, count, 3)]
    return (end.join(lines) + end).encode()


def write_ply(body: Manifold, kind: str, lists: str, end: str = "\n") -> bytes:
    corners = corners_of(body).reshape(-1, 3)
    head = ["ply", "format ascii 1.0", "comment made by a scanner", "obj_info none", f"element vertex {len(corners)}"]
    head += [f"property {kind} {axis}" for axis in "xyz"]
    head += [f"element face {len(corners) // 3}", f"property list {lists} vertex_indices", "end_header"]
    rows = [f"{x} {y} {z}" for x, y, z in corners.tolist()]
    faces = [f"3 {index} {index + 1} {index + 2}" for index in range(0, len(corners), 3)]
    return (end.join(head + rows + faces) + end).encode()


def write_3mf(body: Manifold, unit: str, kind: str, move: str) -> bytes:
    corners = corners_of(body).reshape(-1, 3)
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in corners.tolist())
    triangles = "".join(f'<triangle v1="{i}" v2="{i + 1}" v3="{i + 2}"/>' for i in range(0, len(corners), 3))
    model = (
        f'<model unit="{unit}" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
        f'<object id="1" type="{kind}"><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>'
        f'</object></resources><build><item objectid="1" {move}/></build></model>'
    )
    stream = BytesIO()
    with ZipFile(stream, "w") as archive:
        archive.writestr("3D/3dmodel.model", model)
    return stream.getvalue()


def block(space: object) -> None:
    made = space.doc.blocks.new("part")  # type: ignore[attr-defined]
    made.add_lwpolyline(BAR, close=True)
    outer = space.doc.blocks.new("outer")  # type: ignore[attr-defined]
    outer.add_blockref("part", (5, 5))
    space.add_blockref("outer", (0, 0), dxfattribs={"xscale": -1, "rotation": 30})  # type: ignore[attr-defined]


def list_reports() -> Iterator[Row]:
    """Facts of public reports on STL heads, OBJ of Rhino, SVG of Affinity and Corel, 3MF of slicers, DXF of CAD."""
    brick = box(40, 20, 10)
    yield "binary STL that begins with solid", "a.stl", write_stl(brick, b"solid base"), 40.0
    yield "STL with colors in its head", "a.stl", write_stl(brick, b"COLOR=\xff\x00\x00\xff MATERIAL="), 40.0
    yield "OBJ with negative indices", "a.obj", write_obj(brick, lambda at, count: str(at - count)), 40.0
    yield "OBJ faces v//vn", "a.obj", write_obj(brick, lambda at, _: f"{at + 1}//1"), 40.0
    yield "OBJ faces v/vt/vn", "a.obj", write_obj(brick, lambda at, _: f"{at + 1}/1/1"), 40.0
    yield "OBJ with continued lines", "a.obj", write_obj(brick, lambda at, _: f"\\\n{at + 1}"), 40.0
    yield "OBJ with CRLF", "a.obj", write_obj(brick, lambda at, _: str(at + 1), "\r\n"), 40.0
    yield "PLY of doubles", "a.ply", write_ply(brick, "double", "uchar uint"), 40.0
    yield "PLY of float64, ushort lists", "a.ply", write_ply(brick, "float64", "ushort uint"), 40.0
    yield "PLY with CRLF", "a.ply", write_ply(brick, "float", "uchar int", "\r\n"), 40.0
    points = b"0 0 0\n40 0 0\n0 40 0\n0 0 40\n"
    faces = b"3 0 2 1\n3 0 1 3 # last but two\n3 0 3 2\n3 1 2 3\n"
    yield "OFF with comments everywhere", "a.off", b"# one\n\nOFF # two\n# three\n4 4 0\n" + points + faces, 40.0
    yield "OFF with counts in its first line", "a.off", b"OFF 4 4 6\n" + points + faces, 40.0
    yield "STL with bytes after its end", "a.stl", write_stl(brick) + b"made by a scanner\n", 40.0
    move = 'transform="1 0 0 0 1 0 0 0 1 2 0 0"'
    yield "3MF in inches, moved", "a.3mf", write_3mf(brick, "inch", "model", move), 40 * 25.4
    yield "3MF in feet", "a.3mf", write_3mf(box(0.4, 0.2, 0.1), "foot", "model", ""), 0.4 * 304.8
    yield "3MF of type surface", "a.3mf", write_3mf(brick, "millimeter", "surface", move), 40.0
    percent = 'width="100%" height="100%" viewBox="0 0 1182 1182"'
    yield "SVG of 100 % width", "a.svg", svg('<rect x="100" y="100" width="600" height="300"/>', percent), "size"
    corel = 'width="457.285mm" height="135.043mm" viewBox="0 0 38014 11224"'
    yield (
        "SVG of Corel's units",
        "a.svg",
        svg(f'<path d="M 3 3H19010V11221H3Z" {LINES}/>', corel),
        19007 / 38014 * 457.285,
    )
    scad = 'width="200mm" height="40mm" viewBox="0 -40 200 40"'
    yield "SVG of OpenSCAD", "a.svg", svg('<path d="\nM 0,-0 L 200,-0 L 200,-40 L 0,-40 z\n"/>', scad), 200.0
    inches = 'width="8.5in" height="11in" viewBox="0 0 8.5 11"'
    yield "SVG in inches", "a.svg", svg('<rect x="1" y="1" width="6" height="4"/>', inches), 6 * 25.4
    yield "DXF blocks, nested and mirrored", "a.dxf", dxf(block), 80 * np.cos(np.pi / 6) + 30 * np.sin(np.pi / 6)
    rounded = [(0, 0, 0), (60, 0, 1), (60, 30, 0), (0, 30, 1)]
    yield "DXF with bulges", "a.dxf", dxf(lambda space: space.add_lwpolyline(rounded, format="xyb", close=True)), 90.0
    yield "DXF with extrusion downward", "a.dxf", dxf(lambda space: bar(space, extrusion=(0, 0, -1))), 80.0


def read_rows(rows: Iterator[Row]) -> bool:
    print("| file | meant | read | good |\n|---|---|---|---|")
    wrong = 0
    for name, file, content, meant in rows:
        try:
            if file.endswith((".svg", ".dxf")):
                size = 1e3 * read_drawing(content, name=file).outline.size
            else:
                size = 1e3 * heal(read_surface(content, name=file), resolution=1e-3).surface.size
            found, good = f"{size:.1f} mm", not isinstance(meant, str) and abs(size / meant - 1) < 2e-3
        except HydrostatError as error:
            found, good = str(error)[:90], isinstance(meant, str) and meant in str(error)
        wrong += not good
        wish = meant if isinstance(meant, str) else f"{meant:.1f} mm"
        print(f"| {name} | {wish} | {found} | {'yes' if good else 'NO'} |", flush=True)
    print(f"{wrong} wrong")
    return not wrong


def main() -> None:
    chosen = sys.argv[1:] or ["parts", "kinds", "reports"]
    print(machine())
    good = True
    if "parts" in chosen:
        good &= mesh_parts()
    if "kinds" in chosen:
        good &= read_rows(list_kinds())
    if "reports" in chosen:
        good &= read_rows(list_reports())
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
