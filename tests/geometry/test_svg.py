import numpy as np
import pytest

from hydrostat.errors import HydrostatError, InputError, OutlineError
from hydrostat.geometry import Outline, read_outline

LINE = 'fill="none" stroke="black"'
SQUARE = '<path d="M10,10 h20 v20 h-20 z"/>'


def svg(shapes: str, attributes: str = 'width="100mm" height="100mm" viewBox="0 0 100 100"') -> bytes:
    """A drawing; one unit is a millimeter unless told otherwise."""
    return f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{shapes}</svg>'.encode()


def read(shapes: str, attributes: str = 'width="100mm" height="100mm" viewBox="0 0 100 100"') -> Outline:
    return read_outline(svg(shapes, attributes), name="a.svg")


@pytest.mark.parametrize(
    ("shapes", "area"),
    [
        (SQUARE, 400),
        ('<rect x="5" y="5" width="20" height="10"/>', 200),
        ('<circle cx="50" cy="50" r="40"/>', np.pi * 1600),
        ('<ellipse cx="50" cy="50" rx="40" ry="10"/>', np.pi * 400),
        ('<polygon points="0,0 10,0 0,10"/>', 50),
        ('<polyline points="0,0 10,0 0,10 0,0"/>', 50),
        ('<path d="M0,0 Q10,0 10,10 L0,10 Z"/>', 250 / 3),
        ('<path d="M0,0 C0,0 10,0 10,10 L0,10 Z"/>', 80),
        ('<path d="M0,0 A10,10 0 0 1 10,10 L0,10 Z"/>', 25 * np.pi),
        ('<circle cx="50" cy="50" r="40"/><circle cx="50" cy="50" r="10"/>', np.pi * 1500),
        ('<path d="M0,0 h30 v30 h-30 z M10,10 h10 v10 h-10 z"/>', 800),
        ('<path d="M0,0 h30 v30 h-30 z m10,10 v10 h10 v-10 z"/>', 800),
        (SQUARE + SQUARE, 400),
        ('<g transform="translate(5,9) rotate(30) scale(2 3)">' + SQUARE + "</g>", 2400),
        ('<defs><g id="a">' + SQUARE + '</g></defs><use href="#a" x="20"/>', 400),
        ('<text x="0" y="90">hi</text><image width="99" height="99" href="x.png"/>' + SQUARE, 400),
        ('<rect width="90" height="90" style="display:none"/>' + SQUARE, 400),
        ('<g visibility="hidden"><rect width="90" height="90"/></g>' + SQUARE, 400),
        ('<clipPath id="c"><rect width="90" height="90"/></clipPath>' + SQUARE, 400),
        ('<path d="M12,12 h5" stroke="red"/>' + SQUARE, 400),
        ('<path d="M10,10 h20 v20 h-20 v-19.995"/>', 400),
    ],
)
def test_area(shapes: str, area: float) -> None:
    """Oracle: closed forms [mm^2]; chords cost at most their error times the length of the outline."""
    assert 1e6 * read(shapes).area == pytest.approx(area, rel=3e-4)


@pytest.mark.parametrize(
    ("attributes", "unit"),
    [
        ('width="100mm" viewBox="0 0 100 100"', 1.0),
        ('width="10cm" height="10cm" viewBox="0 0 50 50"', 2.0),
        ('width="1in" height="1in" viewBox="-5,-5,254,254"', 0.1),
        ('height="36pt" viewBox="0 0 10 127"', 0.1),
        ('width="200mm" height="100mm" viewBox="0 0 100 100"', 1.0),
        ('width="200mm" height="100mm" viewBox="0 0 100 100" preserveAspectRatio="xMidYMid slice"', 2.0),
        ('width="100mm" height="100mm"', 25.4 / 96),
    ],
)
def test_physical_size(attributes: str, unit: float) -> None:
    """Oracle: the SVG standard: the viewBox is fitted into width and height; without one a unit is 1/96 in."""
    assert read(SQUARE, attributes).size == pytest.approx(20e-3 * unit, rel=1e-12)


def test_size_given_wins() -> None:
    """Oracle: the asked size is the longest side, exactly, whatever the file says."""
    for attributes in ("", 'viewBox="0 0 9 9"', 'width="5mm"', 'width="300" height="20px"'):
        outline = read_outline(svg('<rect width="31" height="7"/>', attributes), name="a.svg", size=0.2)
        assert outline.size == pytest.approx(0.2, rel=1e-15)
        assert np.ptp(outline.exterior[:, 1]) == pytest.approx(0.2 * 7 / 31)


def test_y_up_and_centered() -> None:
    """Oracle: a triangle whose tip is at the top of the page, corner by corner."""
    outline = read('<path d="M20,10 L30,50 L10,50 Z"/>')
    expected = {(0.0, 20.0), (-10.0, -20.0), (10.0, -20.0)}
    assert {tuple(np.round(1e3 * corner, 9)) for corner in outline.exterior} == expected


def test_curves_are_close() -> None:
    """Oracle: the circle; chords stray less than 1e-4 of its size."""
    ring = 1e3 * read('<circle cx="50" cy="50" r="40"/>').exterior
    middle = 0.5 * (ring + np.roll(ring, -1, axis=0))
    assert np.abs(np.linalg.norm(ring, axis=1) - 40).max() < 1e-9
    assert np.linalg.norm(middle, axis=1).min() > 40 - 80e-4


USES = "".join(f'<g id="u{n}"><use href="#u{n + 1}"/><use href="#u{n + 1}"/></g>' for n in range(30))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "a.svg: the file is empty"),
        (b"  \n ", "a.svg: the file is empty"),
        (b"not xml", "a.svg: not an SVG drawing"),
        (b"\x89PNG\r\n\x1a\n\x00", "a.svg: not an SVG drawing but a PNG: rename it to end in .png"),
        (b"<svg", "a.svg: not an SVG drawing that is whole .*it is cut off or damaged; save it again"),
        (b"<html/>", "a.svg: not an SVG drawing, its first element is <html>"),
        (b'<!DOCTYPE svg [<!ENTITY c "&a;&a;"><!ENTITY a "b">]><svg>&c;</svg>', "a.svg: declares XML entities"),
        ('<!DOCTYPE svg [<!ENTITY a SYSTEM "b">]><svg>&a;</svg>'.encode("utf-16"), "a.svg: declares XML entities"),
        (f'<!DOCTYPE svg [<!ENTITY a "{"b" * 4000}">]><svg>{"&a;" * 600}</svg>'.encode(), "a.svg: declares XML"),
        (b" " * 20_000_001 + b"<svg/>", "a.svg: the file has 20 MB, at most 20 MB are read"),
        (b"<svg>" * 300 + b"</svg>" * 300, "a.svg: elements nested deeper than 200"),
        (svg(USES), "a.svg: more than 100000 points"),
        (svg('<g id="a"><use href="#a"/></g>'), "a.svg: the <use> of #a holds itself"),
        (svg('<path d="M0,0' + " l1,0 0,1" * 110_000 + 'z"/>'), "a.svg: more than 100000 points"),
        (svg(SQUARE, ""), "a.svg: the drawing has no physical size .* give its size"),
        (svg(SQUARE, 'width="50" height="50px"'), "a.svg: the drawing has no physical size"),
        (svg(SQUARE, 'width="100%" viewBox="0 0 9 9"'), "a.svg: the drawing has no physical size"),
        (svg(""), "a.svg: no closed shape"),
        (svg("<text>hi</text>", ""), "a.svg: no closed shape"),
        (svg("<text>hi</text>"), "a.svg: no closed shape.*Text must become paths"),
        (
            svg(f'<path {LINE} d="M0,0 h10 v10 h-7"/>'),
            r"a.svg: the outline is open between \(0, 0\) and \(3, 10\), a gap of 10.",
        ),
        (svg(f'<path d="M0,0 h50 v50 h-50" {LINE}/>' + SQUARE), "a.svg: the outline is open between"),
        (svg('<path d="M0,0 L10,10 V0 L0,10 Z"/>'), r"a.svg: the outline crosses itself at \(5, 5\)"),
        (svg('<path d="M0,0 h10 z"/>'), "a.svg: the outline has no area"),
        (svg(SQUARE + '<circle cx="50" cy="50" r="5"/>'), r"2 parts \(1: 20 x 20 at \(10, 10\); 2: 10 x 10 .*--part N"),
        (svg(SQUARE + f'<circle cx="30" cy="20" r="5" {LINE}/>'), r"a.svg: two closed shapes cross at \(30, "),
        (svg(SQUARE + f'<circle cx="25" cy="20" r="5" {LINE}/>'), r"a.svg: two closed shapes cross at \(30, 20\)"),
        (svg('<path d="M0,0 h1e400 v5 z"/>'), "a.svg: "),
    ],
)
def test_refused(content: bytes, message: str) -> None:
    """Oracle: the message: one line that names the file, what is wrong, where, and what to do."""
    with pytest.raises(OutlineError, match=message) as caught:
        read_outline(content, name="a.svg")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize("size", [0.0, -1.0, float("inf"), float("nan")])
def test_bad_size(size: float) -> None:
    """Oracle: the message names the file and the value."""
    with pytest.raises(InputError, match=f"a.svg: the size must be positive, not {size} m"):
        read_outline(svg(SQUARE), name="a.svg", size=size)


def test_garbage_never_crashes() -> None:
    """Oracle: whatever bytes are flipped, the reader returns an outline or says what is wrong, in one line."""
    random = np.random.default_rng(3)
    good = bytearray(svg('<path d="M0,0 C0,0 10,0 10,10 A5 5 0 0 1 3 3 Z" transform="rotate(30)"/>' + SQUARE))
    lines = []
    for _ in range(200):
        bad = bytearray(good)
        for place in random.integers(0, len(good), 3):
            bad[place] = random.integers(32, 127)
        try:
            read_outline(bytes(bad), name="a.svg", size=0.1)
        except HydrostatError as error:
            lines.append(str(error))
    assert len(lines) > 20
    assert not any("\n" in line for line in lines)
