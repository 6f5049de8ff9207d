"""`make_toy`: samples, training and page in one step."""

import time
import warnings
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from hydrostat.control import Calibration, Timeline
from hydrostat.errors import HydrostatError, InputError
from hydrostat.ik import solve_ik
from hydrostat.learning import MIN_SAMPLES, SamplePlan, Samples, SamplingScheme, sample_robot
from hydrostat.progress import Progress, no_progress
from hydrostat.robot import PinDrive, Robot
from hydrostat.simulation import Simulation
from hydrostat.toy.learn_shape import learn_shape
from hydrostat.toy.learned_shape import LearnedShape
from hydrostat.toy.toy_page import ToyPose, toy_page

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


class _TimeUpError(HydrostatError):
    """End of sampling for lack of time."""


def sample_shapes(
    robot: Robot,
    count: int,
    *,
    seconds: float | None = None,
    seed: int = 0,
    jobs: int = -1,
    progress: Progress | None = None,
) -> Samples:
    """Sample poses of a robot with all its nodes.

    Each winch is at 0 in half of the poses, as a page that is dragged moves few winches at a time. With up to four
    winches, every other pose is drawn from the whole box.

    Args:
        robot: robot to sample.
        count: number of poses.
        seconds: time after which sampling ends with the poses found so far [s]; no limit if left out.
        seed: random seed.
        jobs: processes; -1 for one on each core.
        progress: callback for progress.

    Raises:
        InputError: a robot without winches or markers, or too few poses in the time.
    """
    report, until = progress or no_progress, None if seconds is None else time.monotonic() + seconds

    def watch(stage: str, done: int, total: int) -> None:
        report(stage, done, total)
        if until is not None and time.monotonic() > until and done < total:
            raise _TimeUpError("time is up")

    if count < MIN_SAMPLES:
        raise InputError(f"{count} samples are too few. Use {MIN_SAMPLES} or more.")
    a_file = 16  # poses in one file: what is lost when time is up
    few = 4  # winches whose whole box the samples fill
    draws = (SamplingScheme.FACES, SamplingScheme.BOX)[: 2 if len(robot.winches) + len(robot.drives) <= few else 1]
    plan = SamplePlan.of_robot(robot, count, seed=seed, draws=draws, nodes=True, shard=a_file)
    with TemporaryDirectory(prefix="hydrostat-") as folder, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "[0-9]+ tasks", UserWarning)  # joblib: cancelled, as meant
        with suppress(_TimeUpError):
            sample_robot(plan, Path(folder), jobs=jobs, progress=watch)
        samples = Samples.read(folder)
    if len(samples) < MIN_SAMPLES:
        raise InputError(f"only {len(samples)} poses were found. At least {MIN_SAMPLES} are needed: allow more time.")
    return samples
