"""Tubes in foam keep off the skin, but where they enter it."""

from foam_bricks import foam_brick

from hydrostat.fabrication.body_work import channel_problems
from hydrostat.fabrication.kit_options import PartOptions

OPTIONS = PartOptions(tube=2.0)


def test_a_tube_that_rises_to_the_skin_and_dives_again_is_refused():
    """Oracle: its highest point is 1.5 mm below the upper side of the brick, at z = 20 mm; it needs 2 mm."""
    robot = foam_brick([(-70, 0, 0), (-30, 0, 0), (0, 0, 18.5), (30, 0, 0), (45, 0, 0)], sheathed=((0, 3),))
    (problem,) = channel_problems(robot, OPTIONS)
    assert problem.startswith("cable 1: its tube comes within 1.5 mm of the skin at [0, 0, 18] mm, but needs 2.0 mm")


def test_half_a_millimeter_deeper_it_is_not():
    robot = foam_brick([(-70, 0, 0), (-30, 0, 0), (0, 0, 17.9), (30, 0, 0), (45, 0, 0)], sheathed=((0, 3),))
    assert channel_problems(robot, OPTIONS) == ()


def test_a_tube_may_end_at_the_skin():
    """Oracle: it enters at the left end and ends 0.5 mm below the upper side, where the bare cable is sewn on."""
    robot = foam_brick([(-70, 0, 0), (-30, 0, 0), (0, 0, 19.5), (45, 0, 19.5)], sheathed=((0, 2),))
    assert channel_problems(robot, OPTIONS) == ()


def test_a_bare_cable_may_run_along_the_skin():
    robot = foam_brick([(-70, 0, 0), (-30, 0, 0), (0, 0, 19.5), (30, 0, 0), (45, 0, 0)], sheathed=((0, 1),))
    assert channel_problems(robot, OPTIONS) == ()
