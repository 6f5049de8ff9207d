import math

import numpy as np
import pytest
import shapely
from plush_robots import HOLED, SQUARE, crossed, disc_path, drawn_body, plush_robot

from hydrostat.errors import InputError
from hydrostat.fabrication import PatternOptions, plush_pattern
from hydrostat.fabrication.kit_options import Corner
from hydrostat.fabrication.patterns.shape import Circle, LaserLine, Layer, Panel, PatternPart
from hydrostat.geometry import Mesh
from hydrostat.robot import MATERIALS, Body, Cable, Mount, Pin, Robot, Source


def drawn(panel: Panel, part: PatternPart) -> list:
    return [shape for shape in panel.shapes if shape.part is part]


def area(line: LaserLine) -> float:
    return shapely.Polygon(line.points).area


def test_the_cut_round_a_disc_is_a_larger_disc():
    """Oracle: closed form, area pi (R + a)^2 and length 2 pi (R + a); tolerance: chords of 0.01 mm sagitta."""
    panel = plush_pattern(plush_robot(drawn_body(disc_path(60.0)))).panel("front")
    (cut,) = drawn(panel, PatternPart.EDGE)
    assert area(cut) == pytest.approx(math.pi * 68.0**2, abs=2 * math.pi * 68.0 * 0.02)
    assert cut.geometry.length == pytest.approx(2 * math.pi * 68.0, abs=0.1)


def test_the_cut_round_a_square_has_round_corners():
    """Oracle: closed form, area s^2 + 4 s a + pi a^2 and length 4 s + 2 pi a."""
    panel = plush_pattern(plush_robot(drawn_body(SQUARE))).panel("front")
    (cut,) = drawn(panel, PatternPart.EDGE)
    assert area(cut) == pytest.approx(100.0**2 + 4 * 100 * 8 + math.pi * 64, abs=2 * math.pi * 8 * 0.02)
    assert cut.geometry.length == pytest.approx(400 + 2 * math.pi * 8, abs=0.05)


def test_mitred_corners_keep_the_square_square():
    """Oracle: closed form, (s + 2 a)^2."""
    robot = plush_robot(drawn_body(SQUARE))
    panel = plush_pattern(robot, options=PatternOptions(corner=Corner.MITRE, seam_allowance=5)).panel("front")
    (cut,) = drawn(panel, PatternPart.EDGE)
    assert area(cut) == pytest.approx(110.0**2, abs=1e-6)


def test_a_hole_is_cut_inside_itself():
    """Oracle: closed form, a hole of 40 mm under an allowance of 8 mm is cut as a square of 24 mm."""
    panel = plush_pattern(plush_robot(drawn_body(HOLED))).panel("front")
    outer, hole = sorted(drawn(panel, PatternPart.EDGE), key=area, reverse=True)
    assert area(hole) == pytest.approx(24.0**2, rel=1e-9)
    assert shapely.Polygon(outer.points).contains(hole.geometry)
    assert len(drawn(panel, PatternPart.SEAM)) == 2


def test_the_seam_is_the_outline_itself():
    """Oracle: the body's own outline, in millimeters from the panel's origin."""
    robot = crossed()
    panel = plush_pattern(robot).panel("front")
    (seam,) = drawn(panel, PatternPart.SEAM)
    outline = robot.body.outline
    assert outline is not None
    np.testing.assert_allclose(np.subtract(seam.points, panel.origin), 1e3 * outline.exterior, atol=1e-9)


def test_the_back_is_the_mirror_of_the_front():
    """Oracle: the front's cut, seam, notches and winches, reflected about its origin; text is not."""
    pattern = plush_pattern(crossed())
    front, back = pattern.panel("front"), pattern.panel("back")
    for part in (PatternPart.EDGE, PatternPart.SEAM, PatternPart.NOTCH):
        ahead = [np.subtract(line.points, front.origin) * [-1, 1] for line in drawn(front, part)]
        behind = [np.subtract(line.points, back.origin) for line in drawn(back, part)]
        for one, other in zip(ahead, behind, strict=True):
            np.testing.assert_allclose(one, other, atol=1e-9)
    assert drawn(front, PatternPart.WINCH)[0].center == pytest.approx(front.on_sheet((-0.02, -0.01)))
    assert drawn(back, PatternPart.WINCH)[0].center == pytest.approx(back.on_sheet((-0.02, -0.01)))
    assert not drawn(back, PatternPart.PINHOLE)
    assert drawn(back, PatternPart.OPENING)
    assert not drawn(front, PatternPart.OPENING)


def test_pinholes_on_the_back_are_an_option():
    """Oracle: the cable's points through the panel's own mapping."""
    robot = crossed()
    back = plush_pattern(robot, options=PatternOptions(back_pinholes=True)).panel("back")
    holes = {tuple(np.round(hole.center, 6)) for hole in drawn(back, PatternPart.PINHOLE)}
    assert holes == {tuple(np.round(back.on_sheet(point), 6)) for cable in robot.cables for point in cable.points}


def test_panels_lie_on_the_sheet_and_apart():
    """Oracle: bounding boxes of all shapes, gap 12 mm."""
    pattern = plush_pattern(crossed(), options=PatternOptions(gap=12))
    boxes = [shapely.box(*shapely.total_bounds([s.geometry for s in panel.shapes])) for panel in pattern.panels]
    ruler = shapely.box(*shapely.total_bounds([shape.geometry for shape in pattern.shapes]))
    assert boxes[0].distance(boxes[1]) == pytest.approx(12)
    assert ruler.distance(shapely.union_all(boxes)) > 3
    sheet = shapely.box(0, 0, pattern.width, pattern.height)
    assert all(sheet.covers(box) for box in (*boxes, ruler))


def test_the_bar_is_100_mm():
    """Oracle: its name."""
    bar = max(
        (s for s in plush_pattern(crossed()).shapes if s.part is PatternPart.RULER), key=lambda s: s.geometry.length
    )
    assert bar.geometry.length == 100


def test_cables_that_meet_share_one_hole():
    """Oracle: counting: six cable points, two of them the same."""
    assert len(drawn(plush_pattern(crossed()).panel("front"), PatternPart.PINHOLE)) == 5


def test_exits_of_one_winch_that_overlap_become_one_hole_round_both():
    """Oracle: closed form: holes of 2 mm, 1 mm apart, lie in one of 3 mm about their middle."""
    body = drawn_body(SQUARE)
    robot = plush_robot(body, [(0, 0), (20, 0)], [(1, 0), (20, 20)])
    holes = drawn(panel := plush_pattern(robot).panel("front"), PatternPart.PINHOLE)
    exits = [hole for hole in holes if hole.radius > 1]
    assert len(holes) == 3
    assert exits[0].radius == pytest.approx(1.5)
    assert exits[0].center == pytest.approx(panel.on_sheet((0.0005, 0.0)))


def test_lines_stop_before_holes():
    """Oracle: distance to the hole's center, radius 1 mm and 0.8 mm of clearance."""
    panel = plush_pattern(crossed()).panel("front")
    for hole in drawn(panel, PatternPart.PINHOLE):
        for line in drawn(panel, PatternPart.CABLE):
            assert line.geometry.distance(shapely.Point(hole.center)) > 1.75


def test_sheathed_stretches_are_drawn_as_tubes():
    """Oracle: the sheath's run is 40 mm: two sides of 40 mm and two ends of 3 mm, less what the holes take."""
    body = drawn_body(SQUARE)
    robot = plush_robot(body, [(-30, 0), (10, 0), (30, 0)])
    cable = Cable(winch="pull", points=robot.cables[0].points, sheathed=((0, 1),))
    panel = plush_pattern(robot.with_network(robot.winches, [cable])).panel("front")
    sheath = sum(line.geometry.length for line in drawn(panel, PatternPart.SHEATH))
    assert 75 < sheath < 86
    dashes = np.concatenate([line.points for line in drawn(panel, PatternPart.CABLE)])
    assert np.ptp(dashes[:, 0]) == pytest.approx(20 - 2 * 1.8, abs=0.01)


def test_markers_are_drawn_if_asked_for():
    """Oracle: the option."""
    robot = crossed()
    assert not drawn(plush_pattern(robot).panel("front"), PatternPart.MARKER)
    assert drawn(plush_pattern(robot, options=PatternOptions(marker_names=True)).panel("front"), PatternPart.MARKER)


def test_labels_stay_off_holes_and_cables():
    """Oracle: distances between shapes of a robot with room for all labels."""
    panel = plush_pattern(crossed()).panel("front")
    text = shapely.union_all([line.geometry for line in drawn(panel, PatternPart.TEXT)])
    for part in (PatternPart.PINHOLE, PatternPart.CABLE, PatternPart.SEAM, PatternPart.WINCH):
        assert min(text.distance(shape.geometry) for shape in drawn(panel, part)) > 1


def test_the_opening_runs_along_the_winches_and_stays_inside():
    """Oracle: one winch 30 mm from the seam, a reach of 30 mm, 10 mm off the seam: 20 mm one way, 30 mm the other."""
    back = plush_pattern(crossed()).panel("back")
    (opening,) = drawn(back, PatternPart.OPENING)
    left, right = sorted(x for x, _ in opening.points)
    winch = back.on_sheet((-0.02, -0.01))
    assert [y for _, y in opening.points] == pytest.approx([winch[1]] * 2)
    assert (winch[0] - left, right - winch[0]) == pytest.approx((30, 20))


def test_no_reach_is_no_opening():
    """Oracle: the option."""
    assert not drawn(
        plush_pattern(crossed(), options=PatternOptions(opening_reach=0)).panel("back"), PatternPart.OPENING
    )


def test_a_bay_that_the_allowance_closes_is_slit_open():
    """Oracle: topology: the bay's edge and a slit that joins it with the outer cut."""
    bottle = "M0 0H45V20H40V60H60V20H55V0H100V100H0Z"
    panel = plush_pattern(plush_robot(drawn_body(bottle, element_size=0.01))).panel("front")
    slits = [line.geometry for line in drawn(panel, PatternPart.SLIT)]
    (cut,) = (line.geometry for line in drawn(panel, PatternPart.EDGE))
    assert len(slits) == 2
    mouth = min(slits, key=lambda slit: slit.length)
    assert mouth.distance(cut) < 1e-6
    assert mouth.distance(max(slits, key=lambda slit: slit.length)) < 1e-6


def test_a_winch_beside_the_body_has_no_hole_and_its_cable_is_drawn_inside_only():
    """Oracle: two of three points lie in the body; the seam is at x = -50 mm."""
    robot = plush_robot(drawn_body(SQUARE), [(-90, 0), (-30, 0), (20, 5)], mount=Mount.WORLD)
    panel = plush_pattern(robot).panel("front")
    assert len(drawn(panel, PatternPart.PINHOLE)) == 2
    assert not drawn(panel, PatternPart.WINCH)
    cables = np.concatenate([np.subtract(line.points, panel.origin) for line in drawn(panel, PatternPart.CABLE)])
    assert cables[:, 0].min() == pytest.approx(-50)


@pytest.mark.parametrize(
    ("route", "words"),
    [
        ([(0, 0), (48, 0)], ["cable[0].points[1]", "2.00 mm from the seam", "2.5 mm"]),
        ([(0, 0), (20, 0), (21.5, 0)], ["cable[0].points[1]", "cable[0].points[2]", "1.50 mm apart"]),
    ],
)
def test_holes_that_cannot_be_cut_are_refused(route, words):
    """Oracle: the distances are in the robot's numbers."""
    robot = plush_robot(drawn_body(SQUARE), route)
    with pytest.raises(InputError) as caught:
        plush_pattern(robot)
    assert "\n" not in str(caught.value)
    assert all(word in str(caught.value) for word in words), caught.value
    forced = plush_pattern(robot, options=PatternOptions(force=True))
    assert forced.problems == (str(caught.value),)
    assert not set(forced.problems) & set(forced.warnings)


def test_a_hole_narrower_than_two_allowances_is_refused():
    """Oracle: 40 mm cannot hold two allowances of 21 mm."""
    with pytest.raises(InputError, match=r"hole 1 .* too narrow .* 21 mm"):
        plush_pattern(plush_robot(drawn_body(HOLED)), options=PatternOptions(seam_allowance=21))


def test_problems_are_counted():
    """Oracle: two points too near the seam."""
    robot = plush_robot(drawn_body(SQUARE), [(0, 0), (48, 0), (48, 10)])
    with pytest.raises(InputError, match=r"and 1 more such"):
        plush_pattern(robot)


def test_a_body_in_space_is_refused():
    """Oracle: one tetrahedron."""
    mesh = Mesh(0.1 * np.vstack([np.zeros(3), np.eye(3)]), np.array([[0, 1, 2, 3]]))
    body = Body(source=Source.MESH, file="t.vtk", content=b"", material=MATERIALS["polyester fibre"], mesh=mesh)
    with pytest.raises(InputError, match="no flat pattern"):
        plush_pattern(solid_robot(body), options=PatternOptions(force=True))


def solid_robot(body: Body) -> Robot:
    return Robot(name="solid", body=body, pins=(Pin(at=(0.0, 0.0, 0.0), radius=1.0),), poses={})


def test_a_flat_mesh_is_cut_along_its_boundary():
    """Oracle: the same square as a mesh of two triangles has the same cut as the drawing."""
    nodes = np.array([[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]])
    mesh = Mesh(nodes, np.array([[0, 1, 2], [0, 2, 3]]))
    material = MATERIALS["polyester fibre"]
    body = Body(source=Source.MESH, file="t.vtk", content=b"", material=material, thickness=0.03, mesh=mesh)
    (cut,) = drawn(plush_pattern(plush_robot(body)).panel("front"), PatternPart.EDGE)
    (same,) = drawn(plush_pattern(plush_robot(drawn_body(SQUARE))).panel("front"), PatternPart.EDGE)
    assert area(cut) == pytest.approx(area(same))


@pytest.mark.parametrize("wrong", [{"pinhole": 0}, {"seam_allowance": -1}, {"gap": math.inf}])
def test_options_out_of_range_are_refused(wrong):
    """Oracle: the option's own name in the message."""
    with pytest.raises(InputError, match=next(iter(wrong))):
        PatternOptions(**wrong)


def test_every_layer_is_used():
    """Oracle: the list of layers."""
    shapes = [shape for panel in plush_pattern(crossed()).panels for shape in panel.shapes]
    assert {shape.layer for shape in shapes} == set(Layer)
    assert all(isinstance(shape, Circle) for shape in shapes if shape.layer is Layer.PINHOLE)
    assert all(shape.closed for shape in shapes if shape.part is PatternPart.EDGE)
