"""Obstacles that move along a path in dynamics. Oracles: interpolation by hand, statics at the end of the way."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import FOAM, mesh_body, strip_mesh

from hydrostat.mechanics import GuideEnergy
from hydrostat.robot import Contact, Marker, Obstacle, Pin, Robot
from hydrostat.simulation import BodyPhysics, ContractionProfile, Simulation, StepOptions, with_replaced, write_motion
from hydrostat.simulation.obstacle_frames import carried_frames

pytestmark = pytest.mark.usefixtures("unchecked")


def pressed(obstacle: Obstacle, *, viscosity: float = 0.0, friction: float = 0.0) -> Robot:
    """A strip of 160 x 30 mm on a pin at its lower side, and an obstacle above it."""
    body = mesh_body(strip_mesh(12, 3, size=(0.16, 0.03)), material=replace(FOAM, viscosity=viscosity))
    return Robot(
        name="pad",
        body=body,
        pins=(Pin(box=((-0.01, -0.02), (0.17, -0.014)), stiffness=1e5),),
        winches=(),
        cables=(),
        markers=(Marker(name="top", at=(0.08, 0.015)),),
        poses={},
        contact=Contact(distance=1e-3, friction=friction),
        obstacles=(obstacle,),
    )


DISC = Obstacle(name="disc", shape="sphere", at=(0.08, 0.037), radius=0.02)
PRESS = Obstacle(name="press", shape="plane", at=(0.08, 0.017), normal=(0.0, -1.0))
BLOCK = Obstacle(name="block", shape="box", at=(-0.1, 0.017), to=(0.26, 0.06))
NONE = ContractionProfile.ramp(np.zeros(0), 1.0)


def down(obstacle: Obstacle, way: float) -> Obstacle:
    return replace(obstacle, path=((0.2, (obstacle.at[0], obstacle.at[1] - way)),))


def test_way_between_keyframes_is_straight_and_even() -> None:
    disc = replace(DISC, path=((1.0, (0.08, 0.027)), (3.0, (0.04, 0.027))))
    for instant, shift in ((0, (0, 0)), (0.5, (0, -0.005)), (1, (0, -0.01)), (2, (-0.02, -0.01)), (9, (-0.04, -0.01))):
        assert disc.shift(instant) == pytest.approx(shift, abs=1e-15)


def guided(obstacle: Obstacle, way: float) -> np.ndarray:
    """Where statics leaves the marker when springs have moved the same thing down by a way [m], step by step."""
    robot = pressed(replace(obstacle, mass=0.01))
    body = BodyPhysics(robot)
    place, axes = robot.obstacles[0].frame()
    guide = GuideEnergy(body.rigid_dofs[0], place=place, axes=axes, along=2e6 * np.eye(2), turning=2e6)
    simulation, pose = Simulation(robot, body=body, energies=[guide]), None
    for share in np.linspace(0, 1, 9):
        moved = guide.with_target(place - (0.0, share * way), axes)
        pose = with_replaced(simulation, guide, moved).solve({}, start=pose)
    assert pose is not None
    return pose.markers["top"]


@pytest.mark.parametrize(("obstacle", "other"), [(DISC, DISC), (PRESS, BLOCK)])
def test_the_body_settles_where_statics_puts_it(obstacle: Obstacle, other: Obstacle) -> None:
    way, options = 0.006, StepOptions(scheme="euler", drag=40.0)
    simulation = Simulation(pressed(down(obstacle, way), viscosity=300.0))
    motion = list(simulation.play(NONE, 1.2, 0.04, options=options))[-1]
    assert motion.carried is not None
    place, axes = carried_frames(simulation.robot, motion.carried[0])[obstacle.name]
    assert place - obstacle.at == pytest.approx((0.0, -way), abs=1e-5)  # its springs give way by less
    assert axes == pytest.approx(np.eye(2), abs=1e-5)
    assert motion.markers["top"] == pytest.approx(guided(other, way), abs=1.5e-5)  # springs again
    assert motion.markers["top"][1] < 0.013


def test_a_file_tells_where_it_is(tmp_path: Path) -> None:
    simulation = Simulation(pressed(down(DISC, 0.006), viscosity=300.0))
    _, table, _ = write_motion(simulation.robot, simulation.play(NONE, 0.2, 0.1), tmp_path)
    assert 1e3 * table.obstacles["disc"] == pytest.approx(np.array([[80, 37], [80, 34], [80, 31]]), abs=0.01)
    assert (tmp_path / "motion.csv").read_text().splitlines()[0].endswith("disc_x_mm,disc_y_mm")


def test_what_rubs_is_taken_along_and_a_later_motion_goes_on() -> None:
    sideways = replace(PRESS, path=((0.2, (0.08, 0.011)), (0.6, (0.09, 0.011))))
    ends = []
    for friction in (0.0, 1.0):
        simulation = Simulation(pressed(sideways, viscosity=300.0, friction=friction))
        start = simulation.motion_at_rest(simulation.solve({}))
        options = StepOptions(scheme="euler", drag=40.0)
        ends.append(list(simulation.play(NONE, 0.6, 0.04, start=start, options=options))[-1].markers["top"][0])
    assert ends[0] == pytest.approx(0.08, abs=1e-4)
    assert 0.084 < ends[1] < 0.0901


def test_statics_and_inverse_kinematics_see_it_where_it_stands_at_first() -> None:
    simulation, other = Simulation(pressed(down(DISC, 0.02))), Simulation(pressed(DISC))
    assert simulation.solve({}).nodes == pytest.approx(other.solve({}).nodes, abs=0)
