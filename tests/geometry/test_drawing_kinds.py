"""Kinds of drawings that strangers bring: grounds, frames, overlapping paint, open lines, marks, versions of DXF.

Oracle: the sizes of the shapes that were drawn.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from drawings import dxf
from ezdxf.document import Drawing as Document
from ezdxf.layouts import Modelspace
from shapely import Point, Polygon

from hydrostat.errors import OutlineError, SeveralPartsError
from hydrostat.geometry.files.outline_file import read_drawing
from hydrostat.ik import new_robot
from hydrostat.robot import Body, get_material, load_robot, save_robot

FISH = "M12 45 L30 30 L60 28 L78 45 L60 62 L30 60 Z"
TEAL, BLACK, RED = f'<path d="{FISH}" fill="teal"/>', f'<path d="{FISH}"/>', f'<path d="{FISH}" {{}} stroke="red"/>'
LINE = RED.format('fill="none"')
FULL, WINDOW = 'width="90" height="90"', 'width="40" height="40"'
NOSE = '<path d="m40 40 h9 l-4 6z" fill="gray"/>'


CORNERS = [(12, 45), (30, 30), (60, 28), (78, 45), (60, 62), (30, 60)]
AREA = Polygon(CORNERS).area
LEFT = Polygon([(12, 45), (30, 30), (45, 29), (45, 61), (30, 60)]).area
EYED = Polygon(CORNERS).union(Point(78, 45).buffer(8)).area
SIDES = Polygon([(10, 15), (75, 15), (80, 60), (20, 70)]).area


def svg(body: str, head: str = "") -> bytes:
    """A page of 90 mm; one unit is a millimeter."""
    return f'{head}<svg xmlns="http://www.w3.org/2000/svg" {SHEET}>{body}</svg>'.encode()


SHEET = 'width="90mm" height="90mm" viewBox="0 0 90 90"'
STROKE = 'fill="none" stroke="black"'


@pytest.mark.parametrize(
    "ground",
    [
        f'<rect {FULL} fill="white"/>',
        f'<rect {FULL} style="fill:#fffffe;stroke:none"/>',
        f"<style>.g {{fill: #fff}}</style><rect class='g' {FULL}/>",
        f'<rect {FULL} fill="white" stroke="black"/>',
        '<rect x="5" y="9" width="80" height="70" fill="ivory"/>',
        f'<rect {FULL} fill="skyblue"/>',
        f'<rect {FULL} fill="none"/>',
        f'<rect {FULL} opacity="0"/>',
        f'<g opacity="0"><rect {FULL}/></g>',
        f'<rect {FULL} fill="red" fill-opacity="0"/>',
        f'<rect {FULL} style="display:none"/>',
        f"<rect {FULL} {STROKE}/>",
        f'<rect id="background" {FULL} fill="#888"/>',
        f'<g style="clip-path:url(#p)"><rect {FULL} fill="snow"/></g><clipPath id="p"><rect {FULL}/></clipPath>',
        f'<rect {FULL} rx="6" fill="white"/>',
        '<circle cx="45" cy="45" r="45" fill="white"/>',
        f'<rect {FULL} fill="url(#g)"/>',
        f'<rect width="89" height="89" x=".5" y=".5" {STROKE}/><rect x="3" y="3" width="84" height="84" {STROKE}/>'
        f'<rect x="50" y="72" width="37" height="15" {STROKE}/>',
    ],
)
def test_a_ground_is_no_body(ground: str) -> None:
    found = read_drawing(svg(ground + TEAL), name="a.svg")
    assert found.outline.size == pytest.approx(0.066)
    assert found.outline.holes == ()


@pytest.mark.parametrize(
    ("body", "area", "holes"),
    [
        (f'<rect {FULL}/><circle cx="45" cy="45" r="20" fill="white"/>', 8100 - np.pi * 400, 1),
        (f'<rect {FULL} {STROKE}/><circle cx="45" cy="45" r="20" {STROKE}/>', 8100 - np.pi * 400, 1),
        ('<rect width="50" height="40" fill="red"/><rect x="30" y="10" width="50" height="20" fill="blue"/>', 2600, 0),
        ('<rect width="40" height="40"/><rect x="40" width="40" height="40"/>', 3200, 0),
        ('<path d="M0 0 h40 v40 h-40z m10 10 h20 v20 h-20z"/><rect x="18" y="5" width="4" height="30"/>', 1280, 2),
        ('<path d="M10 15 L75 15 L80 60 L20 70"/>', SIDES, 0),
        (f'{TEAL}<path d="m40 45 q5 5 10 0"/>', AREA, 0),
        (
            '<g stroke="red"><line x1="10" y1="15" x2="75" y2="15"/><line x2="75" y2="15" x1="80" y1="60"/>'
            '<line x1="80" y1="60" x2="20" y2="70"/><line x1="20.4" y1="70.4" x2="10" y2="15"/></g>',
            SIDES,
            0,
        ),
        (f'<symbol id="s" viewBox="0 0 45 45"><path d="{FISH}"/></symbol><use href="#s" {FULL}/>', 4 * AREA, 0),
        (f'<symbol id="s"><path d="{FISH}"/></symbol>{TEAL}', AREA, 0),
        (f'<clipPath id="c"><rect width="45" height="90"/></clipPath><g clip-path="url(#c)">{TEAL}</g>', LEFT, 0),
        (f'<clipPath id="c"><rect {FULL}/></clipPath><g clip-path="url(#c)">{TEAL}</g>', AREA, 0),
        (
            f'<style>.k, .l {{clip-path: url(#c)}}</style><clipPath id="c"><rect {WINDOW}/></clipPath>'
            f'<rect class="k" {FULL}/>',
            1600,
            0,
        ),
        (f'<polyline points="10,10 80,10 80,60 10,60 10,10.9" stroke-width="2" {STROKE}/>', 3500, 0),
        (f'<mask id="c"><rect {WINDOW} fill="#D9D9D9"/></mask><rect mask="url(#c)" {FULL}/>', 1600, 0),
        (f'<mask id="c"><rect {WINDOW} fill="black"/></mask><rect mask="url(#c)" {FULL}/>', 8100, 0),
        (f'<rect {FULL} fill="#fff"/><path d="{FISH}" fill="white" stroke="black"/>', AREA, 0),
        (f'{TEAL}<circle cx="78" cy="45" r="8" fill="white" stroke="black"/>', EYED, 0),
    ],
)
def test_what_is_painted_is_the_body(body: str, area: float, holes: int) -> None:
    """Oracle: closed forms [mm^2]."""
    found = read_drawing(svg(body), name="a.svg").outline
    assert 1e6 * found.area == pytest.approx(area, rel=3e-3)
    assert len(found.holes) == holes


@pytest.mark.parametrize(
    "clip",
    [
        f'<mask id="c"><rect {WINDOW} fill="black"/></mask><g mask="url(#c)">{TEAL}</g>',
        '<clipPath id="c" clipPathUnits="objectBoundingBox"><rect width="1" height="1"/></clipPath>'
        f'<g clip-path="url(#c)">{TEAL}</g>',
        f'<g clip-path="inset(5px)">{TEAL}</g>',
        f'<clipPath id="c"><rect {FULL}/></clipPath><g clip-path="url(#c)" mask="url(#m)">{TEAL}</g>',
    ],
)
def test_a_clip_that_is_not_applied_is_noted(clip: str) -> None:
    assert read_drawing(svg(clip), name="a.svg").notes == (
        "did not apply 1 clip (clip-path or mask); if the body needs it, release it",
    )
    assert read_drawing(svg(TEAL), name="a.svg").notes == ()


def test_entities_that_are_words_are_read() -> None:
    head = '<!DOCTYPE svg [<!ENTITY ns "http://www.w3.org/2000/svg"><!ENTITY red "fill:red">]>'
    body = f'<svg xmlns="&ns;" {SHEET}><path style="&red;" d="{FISH}"/></svg>'
    assert read_drawing((head + body).encode(), name="a.svg").outline.size == pytest.approx(0.066)
    nested = f'<!DOCTYPE svg [<!ENTITY fish "{FISH}"><!ENTITY again "&fish;">]>'
    assert read_drawing(svg('<path d="&again;"/>', nested), name="a.svg").outline.size == pytest.approx(0.066)


EYE = '<circle cx="66" cy="42" r="4" fill="white"/>'


@pytest.mark.parametrize("pupil", [67, 68, 69.5], ids=["within", "touching", "across"])
def test_an_eye_with_a_pupil_is_drawn_on_the_body(pupil: float) -> None:
    """What lies in or across another cannot be a hole; what is painted beside it is drawn as well."""
    mouth = '<path d="m40 50h9v2h-9z" fill="navy"/>'
    found = read_drawing(svg(f'{TEAL}{EYE}<circle cx="{pupil}" cy="42" r="2"/>{mouth}'), name="a.svg")
    assert 1e6 * found.outline.area == pytest.approx(AREA)
    assert (len(found.outline.holes), len(found.marks)) == (0, 3)
    assert "lies in or across another, as in an eye" in found.notes[0]


def test_a_ring_in_a_plate_is_drawn_and_other_holes_stay() -> None:
    """A drawing without paint: only what cannot be a hole is drawn."""

    def draw(space: Modelspace, _: Document) -> None:
        box(0, 0, 100, 60)(space)
        for radius in (6, 10):
            space.add_circle((30, 30), radius)
        space.add_circle((70, 30), 8)

    found = read_drawing(dxf(draw), name="a.dxf")
    assert [1e3 * np.ptp(hole[:, 0]) for hole in found.outline.holes] == pytest.approx([16], rel=1e-3)
    assert len(found.marks) == 2


@pytest.mark.parametrize("kind", ["hatch", "solid", "face"])
def test_filled_areas_are_read_where_there_are_no_lines(kind: str) -> None:
    def draw(space: Modelspace, _: Document) -> None:
        space.add_text("a part")
        if kind == "hatch":
            hatch = space.add_hatch()
            for points in (PART, [(20, 20), (40, 20), (40, 40), (20, 40)]):
                hatch.paths.add_polyline_path(points, is_closed=True)
        elif kind == "solid":
            space.add_solid([(0, 0), (130, 0), (0, 50), (130, 50)])
        else:
            space.add_3dface([(0, 0), (130, 0), (130, 50), (0, 50)])

    outline = read_drawing(dxf(draw), name="a.dxf").outline
    assert outline.size == pytest.approx(0.13)
    assert len(outline.holes) == (kind == "hatch")


PART = [(0, 0), (130, 0), (130, 50), (70, 75), (0, 50)]


def drawn(*more: Callable[[Modelspace], object]) -> bytes:
    """A part of lines, 130 mm long, and more."""

    def draw(space: Modelspace, _: Document) -> None:
        for start, end in zip(PART, PART[1:] + PART[:1], strict=True):
            space.add_line(start, end)
        for each in more:
            each(space)

    return dxf(draw)


def box(x: float, y: float, across: float, up: float, **more: str) -> Callable[[Modelspace], object]:
    corners = [(x, y), (x + across, y), (x + across, y + up), (x, y + up)]
    return lambda space: space.add_lwpolyline(corners, close=True, dxfattribs=more)


def title(space: Modelspace) -> None:
    for number in range(3):
        space.add_text("Part", height=4).set_placement((150, -20 + 8 * number))


@pytest.mark.parametrize(
    "content",
    [
        drawn(),
        drawn(box(-40, -40, 420, 297)),
        drawn(box(-40, -40, 277, 190)),
        drawn(box(-50, -50, 1188, 840)),
        drawn(box(-40, -40, 300, 200, layer="BORDER")),
        drawn(box(-40, -40, 300, 200, layer="Zeichnungs-Rahmen")),
        drawn(box(-40, -40, 300, 200, layer="Defpoints")),
        drawn(box(-40, -40, 300, 200), title),
        drawn(box(-50, -50, 420, 297), box(-40, -40, 400, 277), box(250, -40, 110, 30)),
        drawn(lambda space: space.add_line((-15, 25), (145, 25)), lambda space: space.add_line((65, -20), (65, 95))),
        drawn(lambda space: [space.add_circle(at, 2) for at in ((-25, -25), (155, -25), (155, 100), (-25, 100))]),
        drawn(lambda space: space.add_lwpolyline([(30, 30), (29.5, 30), (29.5, 30)], close=True)),
        drawn() + b"\r\n\x1a",
        drawn().replace(b"100\nAcDbLine\n", b""),
    ],
)
def test_one_good_outline_is_enough(content: bytes) -> None:
    outline = read_drawing(content, name="a.dxf").outline
    assert outline.size == pytest.approx(0.13)
    assert 1e6 * outline.area == pytest.approx(130 * 50 + 0.5 * 130 * 25)


@pytest.mark.parametrize("layer", ["FRAME", "0"])
def test_a_bar_in_a_frame_with_a_title_block_is_the_body(layer: str) -> None:
    """A rectangle was a hole of the sheet. Oracle: its side."""

    def draw(space: Modelspace, _: object) -> None:
        for left, low, right, high in ((-100, -100, 320, 197), (140, -100, 320, -64), (0, 0, 80, 30)):
            corners = [(left, low), (right, low), (right, high), (left, high)]
            space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer if left < 0 else "0"})

    assert 1e3 * read_drawing(dxf(draw), name="a.dxf").outline.size == pytest.approx(80.0)


def test_old_and_bare_dxf() -> None:
    bare = "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n8\n0\n90\n5\n70\n1\n" + "".join(
        f"10\n{x}\n20\n{y}\n" for x, y in PART
    )
    for head in ("", "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1006\n0\nENDSEC\n"):
        content = f"{head}{bare}0\nENDSEC\n0\nEOF\n".encode()
        assert read_drawing(content, name="a.dxf", size=0.2).outline.size == pytest.approx(0.2)

    def fitted(space: Modelspace, _: Document) -> None:
        """Corners of the frame are flagged 16, points of the curve 8."""
        turns = np.linspace(0, 2 * np.pi, 60, endpoint=False)
        line = space.add_polyline2d([(0, 0), (140, 0), (140, 70), (0, 70)], close=True)
        line.append_vertices([(70 + 52 * np.cos(turn), 35 + 26 * np.sin(turn)) for turn in turns])
        for number, vertex in enumerate(line.vertices):
            vertex.dxf.flags = 16 if number < 4 else 8

    outline = read_drawing(dxf(fitted), name="a.dxf").outline
    assert outline.size == pytest.approx(0.104)
    assert outline.area == pytest.approx(np.pi * 0.052 * 0.026, rel=3e-3)

    def paper(_: Modelspace, document: Document) -> None:
        document.layout("Layout1").add_circle((0, 0), 30)

    found = read_drawing(dxf(paper), name="a.dxf")
    assert found.outline.size == pytest.approx(0.06)
    assert "read from the layout 'Layout1'" in found.notes[0]


def test_a_drawing_in_meters_is_asked_about() -> None:
    content = drawn().replace(b"$INSUNITS\n 70\n4\n", b"$INSUNITS\n 70\n6\n")
    with pytest.raises(OutlineError, match=r"a.dxf: would be 130 m long, as its unit says .* give its size"):
        read_drawing(content, name="a.dxf")
    assert read_drawing(content, name="a.dxf", size=0.13).outline.size == pytest.approx(0.13)


def test_of_several_parts_one_is_chosen() -> None:
    content = drawn(box(200, 0, 60, 60), box(210, 10, 5, 5), box(300, 0, 2, 2))
    with pytest.raises(SeveralPartsError, match=r"2 parts \(1: 130 x 75 at \(0, 0\); 2: 60 x 60 .*--part N") as told:
        read_drawing(content, name="a.dxf")
    assert {number: np.ptp(ring[:, 0]) for number, ring in told.value.parts.items()} == pytest.approx(
        {1: 0.13, 2: 0.06}
    )
    second = read_drawing(content, name="a.dxf", part=2).outline
    assert (second.size, len(second.holes)) == (pytest.approx(0.06), 1)
    with pytest.raises(OutlineError, match=r"part 5 is not there. Allowed: 1 to 4"):
        read_drawing(content, name="a.dxf", part=5)


@pytest.mark.parametrize(
    ("content", "name", "size"),
    [
        (
            svg('<rect width="90" height="80" rx="9" fill="white" stroke="black"/><path d="m40 40 h9 l-4 6z"/>'),
            "a.svg",
            90,
        ),
        (svg(f'<rect {FULL} fill="navy"/><circle cx="45" cy="45" r="20"/>'), "a.svg", 90),
        (svg(f'<rect {FULL} fill="white" stroke="black"/><circle cx="45" cy="45" r="20"/>'), "a.svg", 90),
        (
            svg(f'<rect class="sheet_metal" {FULL} {STROKE}/><rect x="9" y="9" width="40" height="40" {STROKE}/>'),
            "a.svg",
            90,
        ),
        (svg('<rect width="90" height="60" stroke-width="0" fill="none" stroke="red"/>'), "a.svg", 90),
        (svg('<rect width="60" height="40" transform="rotate(90)"/>'), "a.svg", 60),
        (dxf(lambda space, _: (box(0, 0, 277, 190)(space), box(50, 50, 99, 80)(space))), "a.dxf", 277),
        (dxf(lambda space, _: (box(0, 0, 300, 90)(space), space.add_circle((60, 40), 20), title(space))), "a.dxf", 300),
    ],
)
def test_a_plate_keeps_its_holes_and_what_is_drawn_on_it(content: bytes, name: str, size: float) -> None:
    assert 1e3 * read_drawing(content, name=name).outline.size == pytest.approx(size)


def test_the_choice_is_kept_and_a_robot_without_one_is_as_before(tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_bytes(svg(f'<rect {FULL} fill="white"/>{TEAL}'))
    robot = new_robot(tmp_path / "a.svg")
    assert (robot.body.drawing_part, robot.body.outline.size) == (2, pytest.approx(0.066))
    save_robot(robot, tmp_path / "fish")
    assert load_robot(tmp_path / "fish") == robot
    body = Body.from_outline((tmp_path / "a.svg").read_bytes(), file="a.svg", **BODY)
    assert body.outline.size == pytest.approx(0.09)


BODY = {"material": get_material("polyester fibre"), "element_size": 5e-3, "thickness": 0.02}


def test_a_turned_ellipse_is_turned() -> None:
    """Oracle: the box of an ellipse turned by t is 2 sqrt(a^2 cos^2 t + b^2 sin^2 t) wide."""
    body = '<ellipse cx="45" cy="45" rx="30" ry="10" transform="rotate(30 45 45)"/>'
    ring = read_drawing(svg(body), name="a.svg").outline.exterior
    assert 1e3 * np.ptp(ring[:, 0]) == pytest.approx(2 * np.sqrt(900 * 0.75 + 100 * 0.25), rel=1e-3)


def test_a_white_bite_and_a_doubtful_frame_are_asked_about() -> None:
    bite = f'{BLACK}<circle cx="78" cy="45" r="8" fill="white"/>'
    with pytest.raises(OutlineError, match="two closed shapes cross"):
        read_drawing(svg(bite), name="a.svg")
    small = f'<rect width="200" height="180" {STROKE}/>{TEAL}'
    with pytest.raises(SeveralPartsError, match=r"1: 200 x 180 at \(0, 0\); 2: 66 x 34"):
        read_drawing(svg(small), name="a.svg")


def test_bombs_are_refused() -> None:
    window = "".join(f"M{n} 0h1v1z" for n in range(4000))
    clip = f'<clipPath id="c"><path d="{window}"/></clipPath><g clip-path="url(#c)">{TEAL}</g>'
    with pytest.raises(OutlineError, match="a clip path has 4000 lines"):
        read_drawing(svg(clip), name="a.svg")
    laughs = "".join(f'<!ENTITY e{n + 1} "{f"&e{n};" * 40}">' for n in range(4))
    with pytest.raises(OutlineError, match="entities that are not plain words"):
        read_drawing(svg('<path d="&e4;"/>', f'<!DOCTYPE svg [<!ENTITY e0 "M0 0h9">{laughs}]>'), name="a.svg")
    with pytest.raises(OutlineError, match="declares XML attributes"):
        read_drawing(svg(TEAL, '<!DOCTYPE svg [<!ATTLIST path d CDATA "M0 0">]>'), name="a.svg")


def test_a_white_body_on_a_dark_page_is_asked_about() -> None:
    with pytest.raises(SeveralPartsError, match=r"1: 90 x 90 at \(0, 0\); 2: 66 x 34"):
        read_drawing(svg(f'<rect {FULL}/><path d="{FISH}" fill="white"/>'), name="a.svg")


def test_a_frame_can_be_the_body() -> None:
    content = drawn(box(-40, -40, 420, 297))
    note = next(note for note in read_drawing(content, name="a.dxf").notes if "frame" in note)
    assert "left out a ground or frame of 420 x 297; if it is the body, say --part 1" in note
    framed = read_drawing(content, name="a.dxf", part=1).outline
    assert (framed.size, len(framed.holes)) == (pytest.approx(0.42), 1)
    block = drawn(box(-40, -40, 420, 297), box(320, -40, 60, 30))
    notes = read_drawing(block, name="a.dxf", part=1).notes
    assert "left out 1 closed shape on the edge, the largest at" in " ".join(notes)
