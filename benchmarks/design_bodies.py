"""The bodies of the benchmark of designs, what their networks must keep, and how every network is judged."""

from collections.abc import Sequence
from dataclasses import dataclass

import machine  # noqa: F401  one thread, before NumPy
from robustness import EXAMPLES

from hydrostat.design import Constraints
from hydrostat.design.error import rms_error
from hydrostat.errors import HydrostatError
from hydrostat.ik import Limits, ReachedPose, solve_ik
from hydrostat.robot import Pose, Robot, load_robot
from hydrostat.simulation import Simulation

FLAT = Constraints()
SPACE = Constraints(clearance=0.003)


@dataclass(frozen=True, kw_only=True)
class Body:
    """One row of the table.

    Attributes:
        winches: how many a network has.
        cables: how many in all.
        constraints: that every network keeps.
        fibres: muscle fibres that the thesis counts (N1).
    """

    winches: int
    cables: int
    constraints: Constraints = FLAT
    fibres: int | None = None


BODIES = {
    "starfish": Body(winches=2, cables=6),
    "robot": Body(winches=2, cables=6, fibres=414),
    "pig": Body(winches=1, cables=2, fibres=571),
    "letter_e": Body(winches=1, cables=3, fibres=442),
    "letter_s": Body(winches=1, cables=2, fibres=276),
    "puppy": Body(winches=3, cables=3, fibres=307),
    "squid": Body(winches=8, cables=11, fibres=429),
    "cupping_hand": Body(winches=10, cables=10, constraints=SPACE),
    "trunk": Body(winches=4, cables=6, constraints=Constraints(clearance=0.003, travel=0.15)),
}
"""The designs of the thesis with its numbers of winches and cables (N1), the starfish, and two bodies in space.

The poses of the examples in space are what their own networks reach, to the millimetre. The cupping hand keeps its ten
winches, so its own network can hardly be beaten. The trunk gets four winches of its six, so that its own network is
none of the candidates: bear and octopus arm have no winch to spare, and the poses of the arm need as much travel. The
travel of the trunk's winches is that of its own.
"""


def body_robot(name: str) -> Robot:
    """The example of that name."""
    return load_robot(EXAMPLES / name)


def judged(robot: Robot, poses: Sequence[Pose], constraints: Constraints) -> float:
    """Rms error of a network over markers and poses [m], by `solve_ik` with its own options.

    The same for every method: each pose from rest, within travel and release of the winches and the tension that the
    constraints allow. Infinite where no equilibrium is found.
    """
    simulation, limits = Simulation(robot), Limits(tension=constraints.tension_limit)
    reached: list[ReachedPose] = []
    for pose in poses:
        try:
            reached.append(solve_ik(simulation, pose, limits=limits))
        except HydrostatError:
            return float("inf")
    return rms_error(reached)
