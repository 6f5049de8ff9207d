import io
import math
from dataclasses import replace
from itertools import pairwise

import ezdxf
import numpy as np
import pytest
import shapely
from plush_robots import HOLED, SQUARE, crossed, disc_path, drawn_body, plush_robot
from read_back import see_dxf, see_svg

from hydrostat.errors import InputError
from hydrostat.fabrication import PatternOptions, plush_pattern
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import Pattern, stuffed_thickness
from hydrostat.fabrication.patterns.shape import Panel, PatternPart
from hydrostat.fabrication.patterns.skin import find_notches, flat_skin
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.geometry import Mesh
from hydrostat.robot import MATERIALS, Body, Source

GUSSET = PatternOptions(gusset=True)


def seam_of(panel: Panel) -> np.ndarray:
    """Bounds of the rectangle that is seen when sewn."""
    (seam,) = (shape for shape in panel.shapes if shape.part is PatternPart.SEAM)
    return np.array(seam.geometry.bounds)


def strip_notches(pattern: Pattern, edge: int) -> list[float]:
    """How far along the whole strip each notch is [mm]; edge 0: to the back, 1: to the front."""
    found, before = [], 0.0
    for panel in pattern.gusset:
        left, bottom, right, top = seam_of(panel)
        y = (bottom, top)[edge]
        line = shapely.LineString([(left, y), (right, y)])
        notches = [shape for shape in panel.shapes if shape.part is PatternPart.NOTCH]
        found += [before + notch.points[0][0] - left for notch in notches if notch.geometry.distance(line) < 1e-9]
        before += right - left
    return found


def seam_notches(panel: Panel, length: float, *, mirrored: bool) -> list[float]:
    """How far along the seam each notch is from the first of the double notch, the body on the left (seen in front)."""
    (seam,) = (shape.geometry for shape in panel.shapes if shape.part is PatternPart.SEAM)
    feet = [shapely.Point(shape.points[0]) for shape in panel.shapes if shape.part is PatternPart.NOTCH]
    along = np.array([seam.project(foot) for foot in feet])
    turn = 1 if seam.is_ccw != mirrored else -1
    return sorted(round(float(turn * (one - along[0]) % length), 5) % round(length, 5) for one in along)


def mismatch(pattern: Pattern) -> float:
    """Largest distance between a notch of the strip and its partners on front and back [mm]."""
    length = sum(seam_of(panel)[2] - seam_of(panel)[0] for panel in pattern.gusset)
    worst = 0.0
    for name, edge in (("front", 1), ("back", 0)):
        ours = sorted({round(along, 5) for along in strip_notches(pattern, edge)} - {round(length, 5)})
        theirs = seam_notches(pattern.panel(name), length, mirrored=name == "back")
        assert len(ours) == len(theirs)
        worst = max(worst, float(np.abs(np.subtract(ours, theirs)).max()))
    return worst


@pytest.mark.parametrize("piece", [400.0, 150.0, 90.0, 1000.0])
def test_the_strip_is_as_long_as_the_seam_and_as_wide_as_the_body_is_thick(piece):
    """Oracle: closed form: the girth of a disc, 2 R sin(pi/n) n, and the thickness; no piece is longer than allowed."""
    pattern = plush_pattern(
        plush_robot(drawn_body(disc_path(60.0))), options=PatternOptions(gusset=True, gusset_piece=piece)
    )
    boxes = np.array([seam_of(panel) for panel in pattern.gusset])
    lengths = boxes[:, 2] - boxes[:, 0]
    assert lengths.sum() == pytest.approx(720 * 2 * 60 * math.sin(math.pi / 720), abs=1e-6)
    assert lengths.max() <= piece + 1e-9
    np.testing.assert_allclose(boxes[:, 3] - boxes[:, 1], 30.0)


def test_each_piece_has_its_own_allowance():
    """Oracle: closed form: length + 2 a by thickness + 2 a."""
    for panel in plush_pattern(crossed(), options=GUSSET).gusset:
        (edge,) = (shape.geometry for shape in panel.shapes if shape.part is PatternPart.EDGE)
        np.testing.assert_allclose(np.subtract(edge.bounds, seam_of(panel)), [-8, -8, 8, 8], atol=1e-9)


def test_holes_get_their_own_strip():
    """Oracle: closed form: 400 mm round the square, 160 mm round its hole."""
    pattern = plush_pattern(plush_robot(drawn_body(HOLED)), options=GUSSET)
    lengths = [seam_of(panel)[2] - seam_of(panel)[0] for panel in pattern.gusset]
    assert lengths == pytest.approx([400, 160])


@pytest.mark.parametrize("path", [SQUARE, disc_path(60.0), "M0 0H45V20H40V60H60V20H55V0H100V100H0Z"])
def test_notches_meet_those_of_front_and_back(path):
    """Oracle: arc length along the drawn seams, by shapely; the strip turns the same way round as the body."""
    pattern = plush_pattern(plush_robot(drawn_body(path)), options=PatternOptions(gusset=True, gusset_piece=170))
    assert mismatch(pattern) < 1e-4


def test_the_check_of_notches_can_fail():
    """Oracle: a strip laid the other way round."""
    pattern = plush_pattern(crossed(), options=GUSSET)
    (strip,) = pattern.gusset
    wrong = replace(strip, shapes=tuple(shape.mirror() for shape in strip.shapes))
    assert mismatch(replace(pattern, panels=(*pattern.panels[:2], wrong))) > 1


def test_strips_follow_a_body_with_a_hole_with_the_cloth_on_the_left():
    """Oracle: by hand: the second notch is 5 mm off the top: to the left on the outer seam, to the right in a hole."""
    robot = plush_robot(drawn_body(disc_path(60.0) + disc_path(25.0)), marker=(0, 40))
    skin = flat_skin(robot.body, GUSSET)
    for ring, turn in ((0, -1), (1, 1)):
        top, second = (notch for notch in find_notches(skin) if notch.ring == ring and notch.along < 6)
        assert second.stroke.coords[0][0] - top.stroke.coords[0][0] == pytest.approx(5 * turn, abs=0.05)
        assert (top.name, second.name) == (("A", "") if ring == 0 else ("F", ""))


def test_a_mesh_drawn_clockwise_is_the_same_cloth():
    """Oracle: shapely's direction of the seam."""
    nodes = np.array([[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]])
    for order in ([0, 1, 2, 3], [3, 2, 1, 0], [2, 1, 0, 3]):
        mesh = Mesh(nodes[order], np.array([[0, 1, 2], [0, 2, 3]])[:, :: 1 if order[0] == 0 else -1])
        material = MATERIALS["polyester fibre"]
        body = Body(source=Source.MESH, file="t.vtk", content=b"", material=material, thickness=0.03, mesh=mesh)
        assert flat_skin(body, GUSSET).seam.exterior.is_ccw


@pytest.mark.parametrize(("write", "see"), [(pattern_svg, see_svg), (pattern_dxf, see_dxf)])
def test_strips_are_in_the_files(write, see):
    """Oracle: svgelements and ezdxf: closed cuts of 116 mm for both panels, and each strip's own size."""
    pattern = plush_pattern(crossed(), options=PatternOptions(gusset=True, gusset_piece=200))
    seen = see(write(pattern))
    edges = [line for line, closed in zip(seen.lines["CUT"], seen.closed["CUT"], strict=True) if closed]
    sizes = sorted(tuple(np.round(np.ptp(edge, axis=0), 2).tolist()) for edge in edges)
    assert sizes == sorted([(116.0, 116.0)] * 2 + [(176.0, 46.0)] * 2 + [(96.0, 46.0)])
    if write is pattern_dxf:
        audit = ezdxf.read(io.StringIO(write(pattern).decode())).audit()
        assert not audit.errors
        assert not audit.fixes


def test_nothing_overlaps_on_a_sheet_with_strips():
    """Oracle: bounding boxes of all panels, the gap between them, and the sheet."""
    pattern = plush_pattern(crossed(), options=PatternOptions(gusset=True, gusset_piece=120, gap=7))
    boxes = [shapely.box(*shapely.total_bounds([s.geometry for s in panel.shapes])) for panel in pattern.panels]
    boxes.append(shapely.box(*shapely.total_bounds([shape.geometry for shape in pattern.shapes])))
    assert len(boxes) > 6
    apart = [one.distance(other) for index, one in enumerate(boxes) for other in boxes[:index]]
    assert min(apart) > 5
    assert min(one.distance(other) for one, other in pairwise(boxes[:-1])) > 7 - 1e-6
    sheet = shapely.box(0, 0, pattern.width, pattern.height)
    assert all(sheet.contains_properly(box) for box in boxes)


def test_a_stuffed_strip_is_a_round_tube():
    """Oracle: closed form: a strip of 40 mm by 4 m and a ring 30 mm wide keep their girth: d = 2 w / pi."""
    assert stuffed_thickness(shapely.box(0, 0, 40, 4000)) == pytest.approx(80 / math.pi, rel=0.011)
    ring = shapely.Point(0, 0).buffer(130, quad_segs=200) - shapely.Point(0, 0).buffer(100, quad_segs=200)
    assert stuffed_thickness(ring) == pytest.approx(60 / math.pi, rel=1e-4)


def test_a_thick_body_gets_a_gusset_unless_told_otherwise():
    """Oracle: a square of 100 mm stuffs to 31.8 mm."""
    thin = plush_robot(drawn_body(SQUARE))
    thick = replace(thin, body=replace(thin.body, thickness=0.033))
    assert not plush_pattern(thin).gusset
    assert plush_pattern(thick).gusset
    told = plush_pattern(thick, options=PatternOptions(gusset=False))
    assert not told.gusset
    assert any("32 mm thick" in warning and "33 mm" in warning for warning in told.warnings)


def test_a_piece_too_short_to_sew_is_refused():
    """Oracle: the option's own name."""
    with pytest.raises(InputError, match=r"gusset_piece .* 50 mm"):
        PatternOptions(gusset_piece=10)


def test_the_title_of_a_short_piece_stays_on_it():
    """Oracle: the outline that is cut: a strip of 430 mm leaves 30 mm for its second piece, the name is longer."""
    robot = plush_robot(drawn_body("M0 0H115V100H0Z"), [(-20, 0), (20, 0)], name="the_long_name_of_a_small_robot")
    last = plush_pattern(robot, options=GUSSET).gusset[-1]
    assert last.name == "gusset-2"
    (edge,) = (shape for shape in last.shapes if shape.part is PatternPart.EDGE)
    texts = [shape.geometry for shape in last.shapes if shape.part is PatternPart.TEXT]
    assert texts
    assert all(shapely.Polygon(edge.points).contains(text) for text in texts)
