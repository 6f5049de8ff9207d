import time
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from drawings import dxf

from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry.files.outline_file import read_drawing, read_outline
from hydrostat.geometry.files.rings import join_lines

Draw = Callable[[Any, Any], object]
SQUARE = [(10, 10), (30, 10), (30, 30), (10, 30)]
ROOT = 0.5**0.5


def block(draw: Callable[[Any], object], **attributes: object) -> Draw:
    """A block with what is drawn into it, inserted once."""

    def made(space: Any, document: Any) -> None:
        draw(document.blocks.new("part"))
        space.add_blockref("part", (50, 20), dxfattribs=attributes)

    return made


def several(*draws: Draw) -> Draw:
    return lambda space, document: [draw(space, document) for draw in draws]


def lines(*corners: tuple[float, float], closed: bool = True) -> Draw:
    """A LINE from each corner to the next, every other one the other way round."""
    ends = list(zip(corners, corners[1:] + corners[: int(closed)], strict=False))
    ends = [pair[::-1] if index % 2 else pair for index, pair in enumerate(ends)]
    return lambda space, _: [space.add_line(start, end) for start, end in ends]


def polyline(*points: tuple[float, ...], form: str = "xy", close: bool = True) -> Draw:
    return lambda space, _: space.add_lwpolyline(list(points), format=form, close=close)


def circle(x: float, y: float, radius: float, **attributes: object) -> Draw:
    return lambda space, _: space.add_circle((x, y), radius, dxfattribs=attributes)


def circle_of_arcs(space: Any, _: Any) -> None:
    for start in (0, 180, 90, 270):
        space.add_arc((0, 0), 10, start, start + 90)


def nurbs_circle(space: Any, _: Any) -> None:
    """A circle of radius 5 as a rational spline of degree 2 (The NURBS Book, 7.5)."""
    points = [(0, 5), (0, 10), (5, 10), (10, 10), (10, 5), (10, 0), (5, 0), (0, 0), (0, 5)]
    space.add_rational_spline(points, [1, ROOT] * 4 + [1], degree=2, knots=[0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4])


def periodic_spline(space: Any, _: Any) -> None:
    """A closed uniform cubic B-spline through nothing: its area follows from its control points."""
    space.add_spline().set_closed([(0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0)])


def hidden_and_words(space: Any, document: Any) -> None:
    document.layers.add("off").off()
    document.layers.add("frozen").freeze()
    for layer in ("off", "frozen"):
        space.add_circle((0, 0), 90, dxfattribs={"layer": layer})
    space.add_circle((0, 0), 90, dxfattribs={"invisible": 1})
    space.add_text("body", dxfattribs={"insert": (200, 200)})
    space.add_linear_dim(base=(0, 40), p1=(10, 10), p2=(30, 10)).render()
    polyline(*SQUARE)(space, document)


@pytest.mark.parametrize(
    ("draw", "area"),
    [
        (polyline(*SQUARE), 400),
        (polyline(*SQUARE, SQUARE[0], close=False), 400),
        (polyline((0, 0, 1), (10, 0, 0), (10, 5, 0), (0, 5, 0), form="xyb"), 50 + 12.5 * np.pi),
        (lambda space, _: space.add_polyline2d(SQUARE, close=True), 400),
        (lambda space, _: space.add_polyline3d([(x, y, 7) for x, y in SQUARE], close=True), 400),
        (circle(50, 50, 40), np.pi * 1600),
        (circle(50, 50, 40, extrusion=(0, 0, -1)), np.pi * 1600),
        (lambda space, _: space.add_ellipse((0, 0), (40, 30), 0.2), np.pi * 500),
        (several(circle(50, 50, 40), circle(55, 50, 10), circle(55, 50, 10)), np.pi * 1500),
        (circle_of_arcs, np.pi * 100),
        (nurbs_circle, np.pi * 25),
        (periodic_spline, 61 / 90 * 100),
        (lines(*SQUARE), 400),
        (several(lines(*SQUARE), lines(*SQUARE)), 400),
        (several(lines(*SQUARE), lines((30, 30), (35, 35), (32, 38), closed=False)), 400),
        (
            several(
                lines((30.005, 10), (30, 30), (10, 30), closed=False), lines((10, 30), (10, 10), (30, 10), closed=False)
            ),
            400,
        ),
        (
            several(lines((0, 0), (20, 0), closed=False), lambda space, _: space.add_arc((10, 0), 10, 0, 180)),
            np.pi * 50,
        ),
        (block(lambda part: part.add_lwpolyline(SQUARE, close=True), xscale=2, yscale=3, rotation=30), 2400),
        (
            block(lambda part: (part.add_circle((0, 0), 5), part.add_circle((0, 0), 1)), xscale=2, rotation=9),
            np.pi * 48,
        ),
        (hidden_and_words, 400),
    ],
)
def test_area(draw: Draw, area: float) -> None:
    """Oracle: closed forms [mm^2]; chords cost at most their error times the length of the outline."""
    assert 1e6 * read_outline(dxf(draw), name="a.dxf").area == pytest.approx(area, rel=3e-4)


def test_area_of_the_periodic_spline() -> None:
    """Oracle of the closed form above: half the integral of x dy - y dx by Gauss, exact for products of cubics."""
    basis = np.array([[-1, 3, -3, 1], [3, -6, 3, 0], [-3, 0, 3, 0], [1, 4, 1, 0]]) / 6.0
    corners = np.array([(0, 0), (10, 0), (10, 10), (0, 10)], dtype=float)
    at, weights = np.polynomial.legendre.leggauss(5)
    at, weights = 0.5 * (at + 1), 0.5 * weights
    powers = np.stack([at**3, at**2, at, np.ones_like(at)], axis=1)
    slopes = np.stack([3 * at**2, 2 * at, np.ones_like(at), np.zeros_like(at)], axis=1)
    area = 0.0
    for first in range(4):
        control = corners[(first + np.arange(4)) % 4]
        place, slope = powers @ basis @ control, slopes @ basis @ control
        area += 0.5 * float(weights @ (place[:, 0] * slope[:, 1] - place[:, 1] * slope[:, 0]))
    assert area == pytest.approx(61 / 90 * 100, rel=1e-12)


@pytest.mark.parametrize(("code", "meters"), [(1, 0.0254), (2, 0.3048), (4, 1e-3), (5, 1e-2), (6, 1.0), (13, 1e-6)])
def test_unit(code: int, meters: float) -> None:
    """Oracle: the codes of $INSUNITS in the DXF reference."""
    assert read_outline(dxf(polyline(*SQUARE), unit=code), name="a.dxf").size == pytest.approx(20 * meters, rel=1e-12)


def test_size_given_wins_and_y_is_up() -> None:
    """Oracle: a triangle with its tip at the top, corner by corner, from the middle of its box."""
    for unit in (0, 1, 4):
        outline = read_outline(dxf(polyline((50, 90), (40, 50), (60, 50)), unit=unit), name="a.dxf", size=0.08)
        expected = {(0.0, 40.0), (-20.0, -40.0), (20.0, -40.0)}
        assert {tuple(np.round(1e3 * corner, 9)) for corner in outline.exterior} == expected


def test_notes() -> None:
    """Oracle: what was drawn and is no line of the outline, in words."""
    notes = read_drawing(dxf(hidden_and_words), name="a.dxf").notes
    assert notes == ("left out 1 DIMENSION, 1 TEXT, 3 hidden",)
    tail = several(lines(*SQUARE), lines((30, 30), (35, 35), closed=False))
    assert read_drawing(dxf(tail), name="a.dxf").notes == ("left out 1 open line, the largest at (30, 30)",)
    assert read_drawing(dxf(lines(*SQUARE)), name="a.dxf").notes == ()


def grid_of_blocks(space: Any, document: Any) -> None:
    document.blocks.new("part").add_line((0, 0), (1, 0))
    grid = {"row_count": 30000, "column_count": 30000, "row_spacing": 1, "column_spacing": 1}
    space.add_blockref("part", (0, 0), dxfattribs=grid)


def bomb_of_blocks(space: Any, document: Any) -> None:
    for level in range(18):
        part = document.blocks.new(f"b{level}")
        for _ in range(9):
            part.add_blockref(f"b{level + 1}", (1, 1))
    document.blocks.new("b18")
    space.add_blockref("b0", (0, 0))


def deep_blocks(space: Any, document: Any) -> None:
    for level in range(40):
        document.blocks.new(f"b{level}").add_blockref(f"b{level + 1}", (1, 1))
    document.blocks.new("b40")
    space.add_blockref("b0", (0, 0))


def block_in_itself(space: Any, document: Any) -> None:
    document.blocks.new("part").add_blockref("part", (1, 1))
    space.add_blockref("part", (0, 0))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "a.dxf: the file is empty"),
        (b"not dxf", "a.dxf: not a whole DXF drawing, it does not end with EOF"),
        (dxf(polyline(*SQUARE))[:-2000], "a.dxf: not a whole DXF drawing"),
        (b"AutoCAD Binary DXF\r\n\x1a\x00", "a.dxf: a binary DXF"),
        (b"0\nEOF\n", "a.dxf: "),
        (b" " * 10_000_001, "a.dxf: the file is empty"),
        (b"x" * 10_100_001, "a.dxf: the file has 10 MB, at most 10 MB are read"),
        (dxf(polyline(*SQUARE), unit=0), r"a.dxf: the drawing has no unit \(\$INSUNITS\): give its size"),
        (dxf(lambda space, _: space.add_text("hi")), "a.dxf: no closed shape"),
        (dxf(lines(*SQUARE, closed=False)), r"a.dxf: the outline is open between .*10.* and .*10.*, a gap of 20"),
        (dxf(several(lines(*SQUARE), lines(SQUARE[0], SQUARE[2], closed=False))), "a.dxf: lines branch at"),
        (dxf(polyline((0, 0), (9, 9), (9, 0), (0, 9))), r"a.dxf: the outline crosses itself at \(4.5, 4.5\)"),
        (dxf(several(circle(0, 0, 5), circle(20, 0, 3))), r"a.dxf: has 2 parts .*2: 6 x 6 at \(17, -3\)"),
        (dxf(circle(0, float("nan"), 5)), "a.dxf: a coordinate is not a finite number"),
        (dxf(circle(0, 0, 1e200)), "a.dxf: a coordinate is not a finite number"),
        (dxf(grid_of_blocks), "a.dxf: more than 20000 entities"),
        (dxf(bomb_of_blocks), "a.dxf: more than 20000 entities"),
        (dxf(deep_blocks), "a.dxf: blocks nested deeper than 20"),
        (dxf(block_in_itself), "a.dxf: the file is damaged"),
        (dxf(lambda space, _: space.add_blockref("none", (0, 0))), "a.dxf: "),
    ],
)
def test_refused(content: bytes, message: str) -> None:
    """Oracle: the message: one line that names file, fault, place and remedy; within 10 s of the processor."""
    begin = time.process_time()
    with pytest.raises(OutlineError, match=message) as caught:
        read_outline(content, name="a.dxf")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300
    assert time.process_time() - begin < 10.0


def test_bad_size() -> None:
    """Oracle: the message names the file and the value."""
    with pytest.raises(InputError, match=r"a.dxf: the size must be positive, not -1.0 m"):
        read_outline(dxf(polyline(*SQUARE)), name="a.dxf", size=-1.0)


@pytest.mark.parametrize("seed", range(5))
def test_chains(seed: int) -> None:
    """Oracle: the rings that were cut into pieces, turned, shuffled and moved by a millionth of their size."""
    random = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, 121)[:, None]
    pieces = []
    for center in range(3):
        ring = np.concatenate([3.0 * center + np.cos(angle), np.sin(angle)], axis=1)
        cuts = np.r_[0, np.sort(random.choice(np.arange(1, 120), random.integers(0, 12), replace=False)), 120]
        for start, end in pairwise(cuts):
            piece = ring[start : end + 1] + random.uniform(-1e-6, 1e-6, 2)
            pieces.append(piece[:: random.choice([-1, 1])])
    joined = join_lines([pieces[index] for index in random.permutation(len(pieces))], "a")
    assert [closed for _, closed in joined] == [True] * 3
    assert sorted(round(float(line[:, 0].mean() / 3)) for line, _ in joined) == [0, 1, 2]
    assert [len(line) for line, _ in joined] == [121] * 3
