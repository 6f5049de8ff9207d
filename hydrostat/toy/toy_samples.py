"""`sample_shapes`: simulated poses with all nodes, within a limit of time."""

import time
import warnings
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from hydrostat.errors import HydrostatError, InputError
from hydrostat.learning import MIN_SAMPLES, SamplePlan, Samples, SamplingScheme, sample_robot
from hydrostat.progress import Progress, no_progress
from hydrostat.robot import Robot


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
