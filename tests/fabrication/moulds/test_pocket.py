"""Pockets and dents: oracles are closed forms on a box."""

import numpy as np
import pytest
from manifold3d import Manifold
from mould_robots import foam_robot, slab_body

from hydrostat.errors import InputError
from hydrostat.fabrication.checks.mold_checks import mold_checks
from hydrostat.fabrication.kit_options import MoldOptions
from hydrostat.fabrication.moulds.mould import make_mold
from hydrostat.fabrication.moulds.pocket import Pocket, Sides, WinchRoom, cable_dents, clashes, make_pockets
from hydrostat.fabrication.moulds.release import fine_surface
from hydrostat.fabrication.moulds.solids import rod
from hydrostat.fabrication.moulds.stance import MoldOrientation
from hydrostat.fabrication.solids.assembly import interferences
from hydrostat.fabrication.solids.body_solid import body_solid
from hydrostat.robot import Robot

PLAIN = MoldOrientation(np.eye(3), 0.0)
SLAB = slab_body()


GROOVE = 4.0 * 8.0


def pockets(robot: Robot, *, clearance: float = 0.0, **rooms: Sides | WinchRoom) -> tuple[Pocket, ...]:
    return make_pockets(robot, body_solid(SLAB), PLAIN, rooms, clearance=clearance)


def test_pocket_reaches_from_its_room_to_the_nearer_side() -> None:
    (pocket,) = pockets(foam_robot(SLAB, (0.0, 0.0, 0.01)), w0=(30.0, 20.0, 10.0))
    assert not pocket.problem
    assert pocket.upper
    across = pocket.size[0] * pocket.size[1] + GROOVE
    assert pocket.core.volume() == pytest.approx(across * (30 - 10 + pocket.size[2] / 2))
    ways = [(a * b + GROOVE) * (20 + c / 2) for a, b, c in ((30, 20, 10), (30, 10, 20), (20, 10, 30))]
    assert pocket.core.volume() == pytest.approx(min(ways))  # the way that takes least of the body


def test_pocket_on_the_other_side_opens_to_the_other_half() -> None:
    (pocket,) = pockets(foam_robot(SLAB, (0.0, 0.0, -0.01)), w0=(30.0, 20.0, 10.0))
    assert not pocket.upper


def test_pocket_that_does_not_fit_is_a_problem() -> None:
    (outside,) = pockets(foam_robot(SLAB, (0.045, 0.0, 0.0)), w0=(70.0, 70.0, 70.0))
    assert "does not fit" in outside.problem
    assert '"w0"' in outside.problem
    (thin,) = pockets(foam_robot(SLAB, (0.0, 0.034, 0.0)), w0=(11.0, 11.0, 11.0))
    assert "foam would be left" in thin.problem


def test_winches_that_meet_are_a_problem() -> None:
    robot = foam_robot(SLAB, (0.0, 0.0, 0.005), (0.012, 0.0, 0.005), (-0.03, 0.0, 0.005))
    found = clashes(pockets(robot, w0=(15.0, 15.0, 15.0), w1=(15.0, 15.0, 15.0), w2=(15.0, 15.0, 15.0)))
    assert len(found) == 1
    assert '"w0" and "w1"' in found[0]


@pytest.mark.slow
def test_pockets_that_meet_become_one_room() -> None:
    """Oracle: winches of 15 mm, 16 mm apart, with 1 mm of air each: rooms share 1 mm, winches nothing."""
    robot = foam_robot(SLAB, (-0.008, 0.0, 0.005), (0.008, 0.0, 0.005))
    one, other = pockets(robot, clearance=1.0, w0=(15.0, 15.0, 15.0), w1=(15.0, 15.0, 15.0))
    assert (one.core ^ other.core).volume() >= 17 * 1 * 17
    assert clashes((one, other)) == []
    assert one.upper == other.upper
    assert len((body_solid(SLAB) - one.core - other.core).decompose()) == 1
    mould = make_mold(robot, MoldOptions(), pockets={"w0": (15.0, 15.0, 15.0), "w1": (15.0, 15.0, 15.0)})
    assert mould.problems == ()
    assert not interferences(mould.assembly)
    assert all(check.passed for check in mold_checks(robot, mould))


def test_a_winch_has_air_on_all_sides() -> None:
    """Oracle: its own box, larger by the clearance, is in the pocket; larger by more it is not."""
    (pocket,) = pockets(foam_robot(SLAB, (0.0, 0.0, 0.0)), clearance=1.0, w0=(30.0, 20.0, 10.0))
    sides = [size - 2.0 for size in pocket.size]
    assert sorted(sides) == pytest.approx([10, 20, 30])
    for air, fits in ((0.999, True), (1.1, False)):
        room = Manifold.cube([side + 2 * air for side in sides], True)
        assert ((room - pocket.core).volume() < 1e-6) is fits


def test_the_shaft_is_at_the_place_of_the_winch() -> None:
    """Oracle: how far the box reaches from the shaft, 12 mm one way and 28 mm the other across it."""
    at = (0.004, -0.003, 0.002)
    room = WinchRoom(low=(-12.0, -12.0, -7.0), high=(12.0, 28.0, 3.0))
    (pocket,) = pockets(foam_robot(SLAB, at), w0=room)
    low, high = np.reshape(pocket.unit.bounding_box(), (2, 3)) - 1e3 * np.array(at)
    reaches = sorted((round(float(min(-a, b)), 3), round(float(max(-a, b)), 3)) for a, b in zip(low, high, strict=True))
    assert reaches == [(5.0, 5.0), (12.0, 12.0), (12.0, 28.0)]


def test_wires_find_a_way_from_the_motor_to_the_outside() -> None:
    """Oracle: a rod beside the winch at the end of its shaft, from its deep end to the open side of the body."""
    (pocket,) = pockets(foam_robot(SLAB, (0.0, 0.0, 0.0)), w0=WinchRoom(low=(-9.0, -15.0, -5.0), high=(9.0, 15.0, 5.0)))
    axis = int(np.argmin(pocket.size))  # of the shaft
    assert axis < 2
    for side, free in ((-1.0, True), (1.0, False)):
        start, end = np.zeros(3), np.zeros(3)
        start[axis] = end[axis] = side * (5.0 + 2.0)
        end[2] = 29.9 if pocket.upper else -29.9
        assert ((rod(start, end, 1.5) - pocket.core).volume() < 1e-6) is free


def test_pocket_of_no_winch_or_no_size_is_refused() -> None:
    with pytest.raises(InputError, match='unknown winch "w7"'):
        pockets(foam_robot(SLAB, (0.0, 0.0, 0.0)), w7=(1.0, 1.0, 1.0))
    with pytest.raises(InputError, match="must be above 0 mm"):
        pockets(foam_robot(SLAB, (0.0, 0.0, 0.0)), w0=(1.0, 0.0, 1.0))


def test_dents_are_where_cables_come_near_the_surface() -> None:
    robot = foam_robot(SLAB, (0.0, 0.0, 0.0), at=(0.02, 0.01, 0.025))
    solid = body_solid(SLAB)
    dents = cable_dents(robot, fine_surface(solid), PLAIN, deepest=10.0)
    inside = dents ^ solid
    x_low, y_low, z_low, x_high, y_high, z_high = inside.bounding_box()
    assert [(x_low + x_high) / 2, (y_low + y_high) / 2] == pytest.approx([20, 10], abs=1e-3)
    assert [z_low, z_high] == pytest.approx([29, 30])  # 1 mm deep; the winch's end lies too deep
    assert cable_dents(robot, fine_surface(solid), PLAIN, deepest=2.0).is_empty()


def test_winches_are_laid_beside_each_other_if_they_can_be() -> None:
    robot = foam_robot(SLAB, (0.0, -0.0065, 0.012), (0.0, 0.0065, 0.012))
    alone = pockets(robot, w0=(60.0, 14.0, 12.0)) + pockets(robot, w1=(60.0, 14.0, 12.0))
    assert len(clashes(alone)) == 1
    pair = pockets(robot, w0=(60.0, 14.0, 12.0), w1=(60.0, 14.0, 12.0))
    assert clashes(pair) == []
    assert all(pocket.size[1] == 12 for pocket in pair)


def test_dents_that_meet_are_one_hollow() -> None:
    """Oracle: two cones of 5.2 mm across at the root, 4 mm apart, and the sum of them one by one."""
    solid = body_solid(SLAB)

    def dents(*spots: float) -> Manifold:
        robot = foam_robot(SLAB, *((spot, 0.0, 0.025) for spot in spots), at=(0.0, 0.0, 0.0))
        return cable_dents(robot, fine_surface(solid), PLAIN, deepest=10.0)

    alone = dents(0.0).volume()
    both = dents(0.0, 0.004)
    assert alone < both.volume() < 1.99 * alone
    assert len(both.decompose()) == 1
