"""`ease`, `save_film`: time steps from one keyframe to the next, and their film."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from hydrostat.arrays import Vector
from hydrostat.plot import Frame, save_gif
from hydrostat.robot import Robot
from hydrostat.simulation import Motion


def ease(
    go: Callable[[Vector, float], Motion], begin: Vector, goal: Vector, *, seconds: float, step: float
) -> Iterator[Motion]:
    """Yield the motion after each time step from contractions to others [m], which begins and ends at rest.

    `go` takes contractions [m] and a time step [s], and returns the motion one step later.
    """
    count = max(1, round(seconds / step))
    for number in range(1, count + 1):
        share = number / count
        yield go(begin + share * share * (3 - 2 * share) * (goal - begin), seconds / count)


def save_film(robot: Robot, frames: Sequence[Frame], path: Path, step: float) -> None:
    """Write frames that are `step` apart [s], at most twenty a second of motion, as a GIF at half speed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    shown = frames[:: max(1, round(0.05 / step))]
    print(f"wrote {save_gif(replace(robot, obstacles=()), shown, path, step=0.1, width=480)}", flush=True)
