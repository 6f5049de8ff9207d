import itertools

import pytest
from plush_robots import SQUARE, crossed, drawn_body, plush_robot

from hydrostat.fabrication import PatternOptions, plush_pattern
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import PatternPart
from hydrostat.fabrication.patterns.stitches import CableStitches, Side
from hydrostat.robot import Cable, Mount, Robot


def sewn(count: int, *sheathed: tuple[int, int], mount: Mount = Mount.BODY, start: float = -40.0) -> CableStitches:
    """A straight cable of some points, with sheaths."""
    route = [(start, 0.0), *((-30.0 + 9.0 * index, 0.0) for index in range(count - 1))]
    robot = plush_robot(drawn_body(SQUARE), route, mount=mount)
    cable = Cable(winch="pull", points=robot.cables[0].points, sheathed=sheathed)
    (stitches,) = pattern_of(robot.with_network(robot.winches, [cable])).stitches
    return stitches


def pattern_of(robot: Robot) -> Pattern:
    return plush_pattern(robot, options=PatternOptions(force=True))


def faults(stitches: CableStitches, sheathed: tuple[tuple[int, int], ...] = ()) -> list[str]:
    """What a person with a needle would find wrong, told from the list alone."""
    found, side = [], stitches.begins
    for stitch in stitches.stitches:
        side = {Side.INSIDE: Side.OUTSIDE, Side.OUTSIDE: Side.INSIDE}[side] if stitch.passes else side
        if stitch.after is not side:
            found.append(f"{stitch.number} does not alternate")
    sides = [stitch.after for stitch in stitches.stitches]
    found += [f"sheath {i} is outside" for start, end in sheathed for i in range(start, end) if sides[i] == "outside"]
    if sides[-1] != "outside" or not stitches.stitches[-1].passes:
        found.append("the stopper is not outside behind a hole")
    return found


@pytest.mark.parametrize("count", range(2, 9))
def test_a_bare_cable_ends_outside(count):
    """Oracle: following the thread; all holes are used but for the first of an even number."""
    stitches = sewn(count)
    assert not faults(stitches)
    assert stitches.begins is Side.INSIDE
    assert [stitch.number for stitch in stitches.passes] == list(range(1 + (count % 2 == 0), count + 1))


SHEATHS = [((0, 1),), ((0, 2),), ((2, 4),), ((0, 1), (3, 5)), ((1, 3), (4, 5)), ((5, 6),), ((6, 7),), ((0, 1), (2, 3))]


@pytest.mark.parametrize(("sheathed", "count"), list(itertools.product(SHEATHS, (8, 9))))
def test_sheaths_lie_inside(sheathed, count):
    """Oracle: following the thread."""
    assert not faults(sewn(count, *sheathed), sheathed)


def test_the_check_of_stitches_can_fail():
    """Oracle: a list with one pass left out, and one whose sheath is elsewhere."""
    stitches = sewn(5)
    wrong = stitches.stitches[:2] + stitches.stitches[3:]
    changed = CableStitches(cable=1, winch="pull", begins=stitches.begins, stitches=wrong)
    assert faults(changed)
    assert faults(stitches, ((0, 1),))


def test_a_sheath_to_the_winch_makes_its_end_the_first_hole():
    """Oracle: seven points, six after the sheath's end: an even number, so the cable stays inside up to the next."""
    assert [stitch.number for stitch in sewn(7, (0, 1)).passes] == [3, 4, 5, 6, 7]
    assert [stitch.number for stitch in sewn(6, (0, 1)).passes] == [2, 3, 4, 5, 6]


@pytest.mark.parametrize("count", [3, 4, 5])
def test_a_cable_from_beside_the_body_ends_outside_too(count):
    """Oracle: following the thread; it comes over the cloth or through the seam, and has no hole at its winch."""
    stitches = sewn(count, mount=Mount.WORLD, start=-90.0)
    assert not faults(stitches)
    assert not stitches.stitches[0].passes
    assert len(stitches.passes) == count - 1
    assert stitches.begins is (Side.OUTSIDE if count % 2 else Side.INSIDE)


def test_stitches_are_where_the_cable_is_and_have_a_hole():
    """Oracle: the cable's points, and the circles of the front panel."""
    robot = crossed()
    pattern = plush_pattern(robot)
    front = pattern.panel("front")
    holes = [shape.center for shape in front.shapes if shape.part is PatternPart.PINHOLE]
    for cable, stitches in zip(robot.cables, pattern.stitches, strict=True):
        for point, stitch in zip(cable.points, stitches.stitches, strict=True):
            assert stitch.place == pytest.approx([1e3 * x for x in point])
            assert min(abs(x - a) + abs(y - b) for x, y in holes for a, b in [front.on_sheet(point)]) < 1e-9


def test_lines_are_solid_outside_and_dashed_inside():
    """Oracle: counting: a cable of three holes goes out, in and out: one solid line, one of dashes."""
    robot = plush_robot(drawn_body(SQUARE), [(-40, 0), (-10, 0), (30, 0)])
    front = plush_pattern(robot).panel("front")
    lines = [line.geometry for line in front.shapes if line.part is PatternPart.CABLE]
    hole = front.on_sheet((-0.01, 0.0))[0]
    assert [line.length for line in lines if line.bounds[2] < hole] == pytest.approx([30 - 2 * 1.8])
    dashes = [line for line in lines if line.bounds[0] > hole]
    assert len(dashes) > 5
    assert 0.4 * 36.4 < sum(line.length for line in dashes) < 0.65 * 36.4
    assert max(line.bounds[2] for line in dashes) - min(line.bounds[0] for line in dashes) == pytest.approx(36.4)
