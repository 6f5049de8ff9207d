"""The pattern of a body in space, on the sheet: that of the gallery's bear, and what is refused."""

import numpy as np
import pytest
from builders import gallery_robot
from patch_bodies import cushion, ellipsoid_body

from hydrostat.errors import InputError
from hydrostat.fabrication.checks.pattern_checks import patch_checks
from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patches import cutting
from hydrostat.fabrication.patches.space_pattern import Sewing, SpacePattern, space_pattern
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.shape import PatternPart
from hydrostat.fabrication.patterns.stitches import Side
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.robot import Robot


@pytest.fixture(scope="module")
def bear() -> Robot:
    return gallery_robot("bear")


@pytest.fixture(scope="module")
def pattern(bear) -> SpacePattern:
    return space_pattern(bear, PatternOptions())


def failed(robot: Robot, pattern: SpacePattern, svg: bytes) -> list[str]:
    return [check.what for check in patch_checks(robot, pattern, svg, pattern_dxf(pattern)) if not check.passed]


@pytest.mark.slow
def test_the_bear_is_a_front_and_a_back(pattern):
    assert [panel.name for panel in pattern.panels] == ["front", "back"]
    assert not pattern.problems
    assert pattern.opening is not None
    assert sum(patch.disc.areas.sum() for patch in pattern.patches) == pytest.approx(pattern.skin, rel=1e-9)


@pytest.mark.slow
def test_all_checks_hold(bear, pattern):
    assert not failed(bear, pattern, pattern_svg(pattern))


@pytest.mark.slow
def test_the_same_bytes_again(bear, pattern):
    cutting._cut_skin.cache_clear()
    again = space_pattern(bear, PatternOptions())
    assert pattern_svg(again) == pattern_svg(pattern)
    assert pattern_dxf(again) == pattern_dxf(pattern)


@pytest.mark.slow
def test_checks_fail_for_another_drawing(bear, pattern):
    svg = pattern_svg(pattern).decode()
    hole = next(line for line in svg.splitlines() if "<circle" in line)
    assert "pinholes" in failed(bear, pattern, svg.replace(hole, "").encode())[0]
    moved = hole.replace('cx="', 'cx="1')
    assert "pinholes" in failed(bear, pattern, svg.replace(hole, moved).encode())[0]
    cross = next(line for line in svg.splitlines() if 'class="marker"' in line)
    assert "crosses" in failed(bear, pattern, svg.replace(cross, "").encode())[0]
    seam = next(line for line in svg.splitlines() if 'class="seam"' in line)
    assert "seam lines" in failed(bear, pattern, svg.replace(seam, "").encode())[0]
    wide = svg.replace(f'width="{pattern.width:.3f}'.rstrip("0"), f'width="{1.01 * pattern.width:.3f}')
    assert len(failed(bear, pattern, wide.encode())) >= 3


def test_checks_fail_for_other_patches(bear, pattern):
    from dataclasses import replace

    svg = pattern_svg(pattern)
    longer = replace(pattern.seams[0], sides=(pattern.seams[0].sides[0], 1.1 * pattern.seams[0].sides[1]))
    assert any("equally long" in what for what in failed(bear, replace(pattern, seams=(longer,)), svg))
    turned = replace(pattern.patches[0], flat=pattern.patches[0].flat * [-1, 1])
    assert any("on its back" in what for what in failed(bear, replace(pattern, patches=(turned,)), svg))


def test_cables_are_sewn_in_and_out_and_end_outside(pattern):
    for sewn in pattern.stitches:
        sides = [stitch.after for stitch in sewn.passes]
        assert sides == [(Side.OUTSIDE, Side.INSIDE)[index % 2] for index in range(len(sides))]
        assert sewn.stopper is Side.OUTSIDE


def test_left_and_right_are_alike(bear, pattern):
    """The bear is the same on both sides: so are the holes of its two arms, to the freedom of its triangles."""
    depths = [[hole.depth for hole in pattern.holes if hole.cable == cable] for cable in (1, 2, 3, 4)]
    assert depths[0] == pytest.approx(depths[1], abs=0.3)
    assert depths[2] == pytest.approx(depths[3], abs=0.6)
    assert all(hole.in_seam for hole in pattern.holes if hole.cable in (3, 4))


def test_notches_have_their_partner(pattern):
    """Both panels have as many notches, as far apart along the seam."""
    strokes = [
        [shape for shape in panel.shapes if shape.part is PatternPart.NOTCH]
        for panel in (pattern.panels[0], pattern.panels[1])
    ]
    assert len(strokes[0]) == len(strokes[1]) > 10
    gaps = []
    for number, lines in enumerate(strokes):
        rim = pattern.patches[number].outline.exterior
        along = np.sort([rim.project(line.geometry.interpolate(0.0)) for line in lines])
        gaps.append(np.sort(np.diff([*along, along[0] + rim.length])))
    assert gaps[0] == pytest.approx(gaps[1], abs=1.0)


def test_cut_is_one_allowance_outside_the_seam(pattern):
    for panel, patch in zip(pattern.panels, pattern.patches, strict=True):
        (edge,) = [shape for shape in panel.shapes if shape.part is PatternPart.EDGE]
        assert patch.outline.exterior.distance(edge.geometry) == pytest.approx(8.0, abs=0.02)


@pytest.mark.slow
def test_a_body_too_small_to_sew_is_refused():
    tiny = cushion(ellipsoid_body((0.012, 0.004, 0.004)), [(0, 0, 0), (0.004, 0, 0)])
    with pytest.raises(InputError, match="narrower than 8 mm"):
        space_pattern(tiny, PatternOptions())
    problems = space_pattern(tiny, PatternOptions(force=True)).problems
    assert problems
    assert Sewing.find(tiny.body).problems == problems


@pytest.mark.slow
def test_deep_cables_get_no_hole_and_are_told():
    deep = cushion(ellipsoid_body((0.2, 0.1, 0.16)), [(0, 0, 0), (0.03, 0, 0)])
    pattern = space_pattern(deep, PatternOptions(force=True))
    assert not pattern.holes
    assert any("nowhere within 15 mm" in warning for warning in pattern.warnings)


@pytest.mark.slow
def test_a_cable_through_the_body_is_refused():
    """Sewn in and out, it would go round the outside."""
    across = [(0.0, 0.0, 0.0), (0.0, 0.0, 0.055), (0.0, 0.0, -0.055), (0.02, 0.0, -0.055)]
    robot = cushion(ellipsoid_body((0.2, 0.08, 0.14)), across)
    with pytest.raises(InputError, match="cable 1 would run outside from point 2 to point 3"):
        space_pattern(robot, PatternOptions())


@pytest.mark.slow
def test_a_body_without_winch_inside_is_turned_through_a_seam():
    robot = cushion(ellipsoid_body((0.2, 0.06, 0.16)))
    pattern = space_pattern(robot, PatternOptions())
    assert pattern.opening is None
    assert any("leave the seam" in warning for warning in pattern.warnings)
