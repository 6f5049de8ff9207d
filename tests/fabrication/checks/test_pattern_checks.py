"""The checks of a pattern hold for what is written, and fail where it is wrong."""

from dataclasses import replace

import pytest
from plush_robots import crossed

from hydrostat.errors import InputError
from hydrostat.fabrication import PatternOptions, plush_pattern
from hydrostat.fabrication.checks.pattern_checks import pattern_checks
from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import PatternPart
from hydrostat.fabrication.patterns.svg_writer import pattern_svg


def checked(svg: bytes | None = None, dxf: bytes | None = None) -> tuple[bool, ...]:
    """Whether holes, agreement and scale hold."""
    pattern = plush_pattern(crossed())
    return passed(
        pattern_checks(crossed(), pattern, svg or pattern_svg(pattern), dxf or pattern_dxf(pattern), PatternOptions())
    )


def passed(checks: tuple[Check, ...]) -> tuple[bool, ...]:
    return tuple(check.passed for check in checks)


def shifted(by: float) -> Pattern:
    """The pattern with the holes of its front moved [mm]."""
    pattern = plush_pattern(crossed())
    front, *others = pattern.panels
    shapes = tuple(shape.move(by, 0.0) if shape.part is PatternPart.PINHOLE else shape for shape in front.shapes)
    return replace(pattern, panels=(replace(front, shapes=shapes), *others))


def test_a_pattern_holds():
    assert checked() == (True, True, True)


@pytest.mark.slow
def test_holes_that_are_moved_are_seen():
    """Oracle: holes 0.09 mm off are within 0.1 mm, holes 0.11 mm off are not."""
    assert checked(pattern_svg(shifted(0.09)), pattern_dxf(shifted(0.09)))[0]
    assert not checked(pattern_svg(shifted(0.11)), pattern_dxf(shifted(0.11)))[0]


def test_drawings_that_differ_are_seen():
    """Oracle: a DXF whose holes are 0.02 mm off."""
    assert not checked(dxf=pattern_dxf(shifted(0.02)))[1]


@pytest.mark.slow
def test_holes_in_each_others_columns_are_seen():
    """Oracle: two drawings with the same x and the same y, but not in the same holes."""
    pattern = plush_pattern(crossed())
    front, *others = pattern.panels
    holes = [shape for shape in front.shapes if shape.part is PatternPart.PINHOLE]
    one, two = holes[1], holes[2]
    swapped = {
        one.center: replace(one, center=(one.center[0], two.center[1])),
        two.center: replace(two, center=(two.center[0], one.center[1])),
    }
    shapes = tuple(
        swapped.get(shape.center, shape) if shape.part is PatternPart.PINHOLE else shape for shape in front.shapes
    )
    assert not checked(dxf=pattern_dxf(replace(pattern, panels=(replace(front, shapes=shapes), *others))))[1]


def test_a_missing_hole_is_seen():
    """Oracle: a drawing without its last hole."""
    svg = pattern_svg(plush_pattern(crossed()))
    lines = svg.split(b"\n")
    last = max(index for index, line in enumerate(lines) if b'class="pinhole"' in line)
    without = b"\n".join(line for index, line in enumerate(lines) if index != last)
    assert checked(without)[:2] == (False, False)


def test_a_page_that_is_scaled_is_seen():
    """Oracle: a page 0.5 % wider than its drawing."""
    pattern = plush_pattern(crossed())
    svg = pattern_svg(pattern)
    width = svg.split(b'width="')[1].split(b"mm")[0]
    wider = svg.replace(b'width="' + width, b'width="%.3f' % (1.005 * float(width)), 1)
    assert checked(wider) == (False, False, False)


def test_a_drawing_without_a_size_is_refused():
    with pytest.raises(InputError, match="no size in millimeters"):
        checked(b'<svg xmlns="http://www.w3.org/2000/svg"/>')
