"""The bodies of the benchmark of designs, what their networks must keep, and how every network is judged."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import machine  # noqa: F401  one thread, before NumPy

import numpy as np  # isort: skip

from robustness import EXAMPLES
from scipy.optimize import nnls

from hydrostat.design import Constraints, rms_error
from hydrostat.errors import HydrostatError
from hydrostat.ik import IKResult, Limits, solve_ik
from hydrostat.robot import PoseTarget, Robot, load_robot
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
        example: whose body it is, if that has another name.
        more: poses beside those of the example, by name, as places of markers [mm].
    """

    winches: int
    cables: int
    constraints: Constraints = FLAT
    fibres: int | None = None
    example: str = ""
    more: Mapping[str, Mapping[str, tuple[float, ...]]] = field(default_factory=dict)


TWO_FINGERS = {
    "thumb": (33, -50, 69),
    "index": (43, -41, 146),
    "middle": (9, -52, 150),
    "ring": (-10, -32, 76),
    "little": (-40, -43, 74),
}
"""Index and middle finger stretch, the others close [mm]."""

BODIES = {
    "starfish": Body(winches=2, cables=6),
    "starfish_3": Body(winches=3, cables=5, example="starfish"),
    "robot": Body(winches=2, cables=6, fibres=414),
    "pig": Body(winches=1, cables=2, fibres=571),
    "letter_e": Body(winches=1, cables=3, fibres=442),
    "letter_s": Body(winches=1, cables=2, fibres=276),
    "puppy": Body(winches=3, cables=3, fibres=307),
    "squid": Body(winches=8, cables=11, fibres=429),
    "cupping_hand": Body(winches=10, cables=10, constraints=SPACE),
    "five_poses": Body(
        winches=10, cables=10, constraints=SPACE, example="cupping_hand", more={"two fingers": TWO_FINGERS}
    ),
    "trunk": Body(winches=4, cables=6, constraints=Constraints(clearance=0.003, travel=0.15)),
    "fish_tail": Body(winches=2, cables=2, constraints=Constraints(clearance=0.003, travel=0.067)),
}
"""The designs of the thesis with its numbers of winches and cables (N1), the starfish with two winches and with three,
and bodies in space.

The poses of the examples in space are what their own networks reach, to the millimeter; `five_poses` is the cupping
hand with one more of that kind. It keeps its ten winches, so its own network can hardly be beaten. The trunk gets four
winches of its six, so that its own network is none of the candidates: bear and octopus arm have no winch to spare, and
the poses of the arm need as much travel. The travel of the trunk's winches is that of its own,
as is the fish tail's.
"""


def body_robot(name: str) -> Robot:
    """The example of that name, with more poses if the benchmark has some."""
    body = BODIES[name]
    robot = load_robot(EXAMPLES / (body.example or name))
    more = {
        called: PoseTarget(name=called, targets={m: tuple(1e-3 * x for x in place) for m, place in targets.items()})
        for called, targets in body.more.items()
    }
    return replace(robot, poses={**robot.poses, **more})


def judged(robot: Robot, poses: Sequence[PoseTarget], constraints: Constraints) -> float:
    """Rms error of a network over markers and poses [m], by `solve_ik` with its own options.

    The same for every method: each pose from rest, within travel and release of the winches and the tension that the
    constraints allow. Infinite where no equilibrium is found.
    """
    simulation, limits = Simulation(robot), Limits(tension=constraints.tension_limit)
    reached: list[IKResult] = []
    for pose in poses:
        try:
            reached.append(solve_ik(simulation, pose, limits=limits))
        except HydrostatError:
            return float("inf")
    return rms_error(reached)


def rest_error(robot: Robot) -> float:
    """Rms error over markers and poses where nothing moves [m]."""
    return float(np.sqrt(np.mean([np.nansum(moves**2) / len(pose.targets) for pose, moves in _moves(robot)])))


def sharing_error(robot: Robot, winches: int) -> float:
    """Rms error over markers and poses [m] if each winch moved all markers along straight lines of one's choice.

    What sharing winches costs at least, to first order: each pose is then a sum of the winches' moves, each as much as
    its contraction, which is not negative. A body that bends far moves along curves, and may do better or worse.
    Alternating least squares from some random beginnings; 0 where there is a winch for each pose.
    """
    poses = _moves(robot)
    if winches >= len(poses):
        return 0.0
    draw = np.random.default_rng(0)
    return min(_shared(poses, winches, draw) for _ in range(40))


def _shared(poses: list[tuple[PoseTarget, np.ndarray]], winches: int, draw: np.random.Generator) -> float:
    wanted = np.array([moves for _, moves in poses])
    asked = np.array([np.repeat(_asked(moves), moves.shape[1]) for _, moves in poses])
    wanted = np.nan_to_num(wanted).reshape(len(poses), -1)
    weights = asked / np.sqrt([[len(pose.targets)] for pose, _ in poses])
    pulls = draw.random((len(poses), winches))
    moved = np.zeros_like(wanted)
    for _ in range(200):
        lines = np.column_stack(
            [
                np.linalg.lstsq(weights[:, [column]] * pulls, weights[:, column] * wanted[:, column], rcond=None)[0]
                for column in range(wanted.shape[1])
            ]
        )
        pulls = np.array(
            [nnls((weight * lines).T, weight * goal)[0] for weight, goal in zip(weights, wanted, strict=True)]
        )
        moved = pulls @ lines
    return float(np.sqrt(np.sum((weights * (moved - wanted)) ** 2) / len(poses)))


def _asked(moves: np.ndarray) -> np.ndarray:
    return np.asarray(~np.isnan(moves).any(axis=1))


def _moves(robot: Robot) -> list[tuple[PoseTarget, np.ndarray]]:
    """Each pose, and how far each marker should go in it [m]; NaN where it has no target."""
    nowhere = (np.nan,) * robot.body.mesh.dim
    return [
        (
            pose,
            np.array([np.subtract(pose.targets.get(marker.name, nowhere), marker.at) for marker in robot.markers]),
        )
        for pose in robot.poses.values()
    ]
