"""Pockets and dents: oracles are closed forms on a box."""

import numpy as np
import pytest
from mould_robots import foam_robot, slab_body

from hydrostat.errors import InputError
from hydrostat.fabrication.moulds.body_solid import body_solid
from hydrostat.fabrication.moulds.frame import Frame
from hydrostat.fabrication.moulds.pocket import cable_dents, clashes, make_pockets
from hydrostat.fabrication.moulds.release import skin_of
from hydrostat.robot import Robot

PLAIN = Frame(np.eye(3), 0.0)
SLAB = slab_body()


def pockets(robot: Robot, **sizes: tuple[float, float, float]) -> tuple:
    return make_pockets(robot, body_solid(SLAB), PLAIN, sizes)


def test_pocket_reaches_from_its_room_to_the_nearer_side() -> None:
    (pocket,) = pockets(foam_robot(SLAB, (0.0, 0.0, 0.01)), w0=(30.0, 20.0, 10.0))
    assert not pocket.problem
    assert pocket.upper
    across = pocket.size[0] * pocket.size[1]
    assert pocket.core.volume() == pytest.approx(across * (30 - 10 + pocket.size[2] / 2))
    ways = [a * b * (20 + c / 2) for a, b, c in ((30, 20, 10), (30, 10, 20), (20, 10, 30))]
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


def test_pockets_that_meet_are_a_problem() -> None:
    robot = foam_robot(SLAB, (0.0, 0.0, 0.005), (0.012, 0.0, 0.005), (-0.03, 0.0, 0.005))
    found = clashes(pockets(robot, w0=(15.0, 15.0, 15.0), w1=(15.0, 15.0, 15.0), w2=(15.0, 15.0, 15.0)))
    assert len(found) == 1
    assert '"w0" and "w1"' in found[0]


def test_pocket_of_no_winch_or_no_size_is_refused() -> None:
    with pytest.raises(InputError, match='no winch "w7"'):
        pockets(foam_robot(SLAB, (0.0, 0.0, 0.0)), w7=(1.0, 1.0, 1.0))
    with pytest.raises(InputError, match="must be above 0 mm"):
        pockets(foam_robot(SLAB, (0.0, 0.0, 0.0)), w0=(1.0, 0.0, 1.0))


def test_dents_are_where_cables_come_near_the_surface() -> None:
    robot = foam_robot(SLAB, (0.0, 0.0, 0.0), at=(0.02, 0.01, 0.025))
    solid = body_solid(SLAB)
    dents = cable_dents(robot, skin_of(solid), PLAIN, deepest=10.0)
    inside = dents ^ solid
    x_low, y_low, z_low, x_high, y_high, z_high = inside.bounding_box()
    assert [(x_low + x_high) / 2, (y_low + y_high) / 2] == pytest.approx([20, 10], abs=1e-3)
    assert [z_low, z_high] == pytest.approx([29, 30])  # 1 mm deep; the winch's end lies too deep
    assert cable_dents(robot, skin_of(solid), PLAIN, deepest=2.0).is_empty()


def test_winches_are_laid_beside_each_other_if_they_can_be() -> None:
    robot = foam_robot(SLAB, (0.0, -0.0065, 0.012), (0.0, 0.0065, 0.012))
    alone = pockets(robot, w0=(60.0, 14.0, 12.0)) + pockets(robot, w1=(60.0, 14.0, 12.0))
    assert len(clashes(alone)) == 1
    pair = pockets(robot, w0=(60.0, 14.0, 12.0), w1=(60.0, 14.0, 12.0))
    assert clashes(pair) == []
    assert all(pocket.size[1] == 12 for pocket in pair)
