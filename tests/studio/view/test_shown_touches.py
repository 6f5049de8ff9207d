"""What the studio shows of contact. Oracles: the library's touches, and crossings."""

from dataclasses import replace

import numpy as np
import pytest
from builders import gallery_robot
from touching import fork_robot

from hydrostat.robot import Obstacle
from hydrostat.simulation import Simulation, find_contacts
from hydrostat.studio.posing.movers import same_physics
from hydrostat.studio.posing.pose_state import Mode
from hydrostat.studio.view.contact_items import OFF, contact_items, with_touches
from hydrostat.studio.view.robot_items import robot_items
from hydrostat.studio.view.scene_items import Cloud, Dot, Look, RobotShape, Strand

CLOSED = {"up": 0.02, "down": 0.016}


def shown(dim: int, *, contact: bool, settled: bool = True) -> RobotShape:
    simulation = Simulation(fork_robot(dim, contact=contact))
    pose = simulation.solve(CLOSED)
    shape = RobotShape(nodes=pose.nodes, tensions=pose.tensions, contractions=pose.contractions, notes=("before",))
    found = with_touches(simulation, pose, shape, settled=settled)
    assert [touch.strength for touch in found.touches] == [touch.strength for touch in find_contacts(simulation, pose)]
    return found


@pytest.mark.parametrize("dim", [2, 3])
def test_where_it_touches(dim: int) -> None:
    shape = shown(dim, contact=True)
    assert shape.crossing is None
    assert shape.notes == ("before",)
    items = contact_items(shape, 0.12)
    dots = [item for item in items if isinstance(item, Dot)]
    assert dots
    assert all(dot.look is Look.TOUCH and not dot.stuck for dot in dots)
    np.testing.assert_allclose(dots[0].at, shape.touches[0].place)
    arrow = next(item for item in items if isinstance(item, Strand))
    way = np.subtract(arrow.points[1], arrow.points[0])
    assert np.linalg.norm(np.cross(np.append(way, 0.0)[:3], np.append(shape.touches[0].force, 0.0)[:3])) < 1e-12


@pytest.mark.parametrize("dim", [2, 3])
def test_where_contact_is_off(dim: int) -> None:
    """A ring with words where the body passes through itself; in space once it has settled."""
    shape = shown(dim, contact=False)
    assert shape.touches == ()
    assert shape.notes[-1] == "contact off: the body intersects itself"
    (ring,) = contact_items(shape, 0.12)
    assert isinstance(ring, Dot)
    assert (ring.look, ring.label, ring.at) == (Look.FLAG, OFF, shape.crossing)
    assert (shown(dim, contact=False, settled=False).crossing is None) == (dim == 3)


def test_the_switch_makes_another_mover() -> None:
    robot = fork_robot(2)
    other = replace(robot, contact=None)
    assert not same_physics(robot, other, Mode.CABLES)
    assert same_physics(robot, other, Mode.MUSCLES)


def test_what_moves_is_drawn_where_the_pose_has_it() -> None:
    """Oracle: the middle of the ring, and the unknowns of the solved pose."""
    ball = Obstacle(name="ball", shape="sphere", at=(0.1, 0.2), radius=0.02, mass=0.05)
    robot = replace(fork_robot(2), obstacles=(ball,))
    middles = []
    for carried in (None, np.array([[0.13, 0.25], [1.0, 0.0], [0.0, 1.0]])):
        (rim,) = [one for one in robot_items(robot, carried=carried) if isinstance(one, Strand) and not one.key][:1]
        middles.append(np.mean(rim.points[:-1], axis=0))
    np.testing.assert_allclose(middles, [(0.1, 0.2), (0.13, 0.25)], atol=1e-9)
    simulation = Simulation(fork_robot(2))
    pose = simulation.rest
    object.__setattr__(pose, "carried", np.eye(3, 2))
    shape = RobotShape(nodes=pose.nodes, tensions=pose.tensions, contractions=pose.contractions)
    assert with_touches(Simulation(fork_robot(2)), pose, shape, settled=False).carried is pose.carried


def test_what_pins_hold_is_dotted_on_the_skin_in_space() -> None:
    """Oracle: the pin's own rule for nodes; a flat disc has its ring instead."""
    hand = gallery_robot("cupping_hand")
    (cloud,) = [item for item in robot_items(hand) if isinstance(item, Cloud)]
    nodes = hand.body.mesh.nodes
    held = np.any([pin.holds(hand.body.mesh) for pin in hand.pins], axis=0)
    assert held.any()
    near = np.linalg.norm(cloud.points[:, None] - nodes[held][None], axis=2)
    assert near.min(axis=0).max() < 1e-6, "a held node has no dot"
    low, high = nodes[held].min(axis=0), nodes[held].max(axis=0)
    assert (cloud.points >= low - 1e-6).all()
    assert (cloud.points <= high + 1e-6).all()
    again = next(item for item in robot_items(hand) if isinstance(item, Cloud))
    assert again.points is cloud.points, "the same points are no new scene"
    assert not [item for item in robot_items(gallery_robot("starfish")) if isinstance(item, Cloud)]
