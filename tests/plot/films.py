"""Short films of small robots, made once for all tests of animations."""

from functools import cache

import numpy as np
from builders import box_robot, strip_robot

from hydrostat.plot import Film, Frame, Stop
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Simulation

NOD = PoseTarget(name="nod", targets={"tip": (0.11, 0.03, 0.03)})
DIP = PoseTarget(name="dip", targets={"tip": (0.19, 0.03)})


@cache
def space_film() -> tuple[Robot, Film]:
    """A box in space that nods and comes back: 13 frames of 0.1 s."""
    robot = box_robot()
    stop = Stop(name="nod", contractions=np.array([0.012, 0.0]), target=NOD, words="there")
    return robot, Film.of_stops(Simulation(robot), [stop], seconds=1.3, step=0.1)


@cache
def flat_film() -> tuple[Robot, Film]:
    """A strip in the plane that dips and comes back."""
    robot = strip_robot(columns=8, rows=2)
    stop = Stop(name="dip", contractions=np.array([0.01, 0.0]), target=DIP, words="there")
    return robot, Film.of_stops(Simulation(robot), [stop], seconds=1.3, step=0.1)


def frames_of(robot: Robot, count: int) -> list[Frame]:
    """So many frames at rest."""
    return [Frame(nodes=robot.body.mesh.nodes, tensions=np.zeros(len(robot.cables)))] * count
