"""`make_toy`: samples, training and page in one step."""

from dataclasses import dataclass

import numpy as np

from hydrostat.control import Calibration, Timeline
from hydrostat.ik import solve_ik
from hydrostat.learning import Samples
from hydrostat.progress import Progress
from hydrostat.robot import PinDrive, Robot
from hydrostat.simulation import Simulation
from hydrostat.toy.learn_shape import learn_shape
from hydrostat.toy.learned_shape import LearnedShape
from hydrostat.toy.toy_page import ToyPose, toy_page
from hydrostat.toy.toy_samples import sample_shapes

_SHARES = (0.2, 0.45, 0.3)  # of the time, for poses, samples and training


@dataclass(frozen=True, kw_only=True, eq=False)
class Toy:
    """A robot as a page.

    Attributes:
        page: HTML.
        shape: learned shape of the body.
        samples: poses that it was learned from.
    """

    page: str
    shape: LearnedShape
    samples: Samples


def make_toy(
    simulation: Simulation,
    *,
    samples: int | None = None,
    seconds: float | None = None,
    seed: int = 0,
    timeline: Timeline | None = None,
    motors: Calibration | None = None,
    jobs: int = -1,
    progress: Progress,
) -> Toy:
    """Make the page of a robot with cables.

    Args:
        simulation: physics of the robot, whose poses are on the page.
        samples: number of poses to simulate; None: 400 for a flat robot, else 2000.
        seconds: maximum time [s]; None: none.
        seed: random seed.
        timeline: keyframes that the page plays.
        motors: calibration of its motors.
        jobs: processes; -1 for one on each core.
        progress: function that is called on the way.

    Raises:
        InputError: a robot with drives and motors, or no sample has a stable equilibrium.
    """
    robot = simulation.robot
    if motors is not None:
        PinDrive.require_none(robot.drives, "a page that drives motors")
    flat = robot.body.mesh.dim == 2
    poses = []
    each = seconds and _SHARES[0] * seconds / max(len(robot.poses), 1)
    for number, name in enumerate(robot.poses, 1):
        taken = solve_ik(simulation, robot.pose(name), seconds=each).pose.controls
        poses.append(ToyPose(name=name, contractions=tuple(taken.tolist())))
        progress("poses", number, len(robot.poses))
    found = sample_shapes(
        robot,
        samples or default_samples(robot),
        seed=seed,
        seconds=seconds and _SHARES[1] * seconds,
        jobs=jobs,
        progress=progress,
    )
    shape = learn_shape(
        found,
        simulation.rest.nodes,
        steps=6000 if flat else 12_000,
        seconds=seconds and _SHARES[2] * seconds,
        seed=seed,
        progress=progress,
    )
    names = [control.name for control in (*robot.winches, *robot.drives)]  # keyframes leave drives at rest
    moves = [
        (key.time, np.array([key.contractions.get(name, 0.0) for name in names]))
        for key in (timeline.keys if timeline else ())
    ]
    return Toy(page=toy_page(robot, shape, poses=poses, moves=moves, motors=motors), shape=shape, samples=found)


def default_samples(robot: Robot) -> int:
    """Number of poses to simulate."""
    return 400 if robot.body.mesh.dim == 2 else 2000
