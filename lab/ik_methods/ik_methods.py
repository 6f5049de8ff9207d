"""Inverse kinematics by four methods, side by side on the same poses.

    python lab/ik_methods/ik_methods.py [--count 20] [--seed 0] [starfish cupping_hand finger]

Hidden contractions are drawn evenly from the ranges of all winches; their poses are the targets of all markers. Each
method takes its turn at every pose, and ends at the same error (1e-6 of the body's size for every marker), by its own
rule; SciPy's after 100 evaluations at most, not counting those for differences. Ours begins at rest, and begins nowhere
else (no restarts), as they do not. At rest no cable is taut and no marker has a slope, so the others begin with every
winch at 2 % of its travel. Their equilibria are sharp, each begun at the last one.
"""

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from ik_problem import REACHED, Problem, hidden_poses, largest_error, machine, places, timed

import numpy as np  # isort: skip

from benchmark_bodies import sofa_robots
from robustness import CountingSimulation

import hydrostat as hs
from hydrostat.given import Point
from hydrostat.robot import Robot, gallery_folder

BEGIN = 0.02
"""Share of its travel that each winch has taken in where SciPy's solvers begin."""

Method = Callable[[hs.Simulation, Mapping[str, Point]], tuple[hs.Equilibrium, int]]
"""From physics and targets to the pose found, and how many equilibria that took."""


@dataclass
class Score:
    """What came of one method on one robot.

    Attributes:
        spent: CPU time of each pose [ms].
        solves: equilibria of each.
        steps: steps of Newton of each.
        errors: largest error of a marker of each [m].
    """

    spent: list[float] = field(default_factory=list)
    solves: list[int] = field(default_factory=list)
    steps: list[int] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)


def ours(simulation: hs.Simulation, targets: Mapping[str, Point]) -> tuple[hs.Equilibrium, int]:
    found = hs.solve_ik(simulation, targets, options=hs.IKOptions(restarts=0))
    return found.pose, found.solves


def least_squares(simulation: hs.Simulation, targets: Mapping[str, Point]) -> tuple[hs.Equilibrium, int]:
    problem = Problem(simulation, targets)
    problem.least_squares(BEGIN * problem.high)
    return problem.best, problem.solves


def differences(simulation: hs.Simulation, targets: Mapping[str, Point]) -> tuple[hs.Equilibrium, int]:
    problem = Problem(simulation, targets)
    problem.least_squares(BEGIN * problem.high, differences=True)
    return problem.best, problem.solves


def quasi_newton(simulation: hs.Simulation, targets: Mapping[str, Point]) -> tuple[hs.Equilibrium, int]:
    problem = Problem(simulation, targets)
    problem.quasi_newton(BEGIN * problem.high)
    return problem.best, problem.solves


METHODS: dict[str, Method] = {
    "hydrostat": ours,
    "least_squares (trf), exact slopes": least_squares,
    "least_squares (trf), 2-point differences": differences,
    "L-BFGS-B, adjoint": quasi_newton,
}


def robot_named(name: str) -> Robot:
    """A robot that SOFA ships, or one of the gallery."""
    others = sofa_robots()
    return others[name]() if name in others else hs.load_robot(gallery_folder(name))


def compare(robot: Robot, count: int, seed: int) -> dict[str, Score]:
    """All methods on the same poses, one after the other at each."""
    simulation = CountingSimulation(robot)
    scores = {name: Score() for name in METHODS}
    poses = hidden_poses(simulation, count, seed)
    for method in METHODS.values():
        method(simulation, places(poses[0]))  # compiles
    for pose in poses:
        targets = places(pose)
        for name, method in METHODS.items():
            simulation.calls.clear()
            (found, solves), spent = timed(lambda method=method, targets=targets: method(simulation, targets))
            score = scores[name]
            score.spent.append(spent)
            score.solves.append(solves)
            score.steps.append(sum(call.iterations for call in simulation.calls))
            score.errors.append(largest_error(found, targets))
    return scores


def rows(robot: Robot, scores: Mapping[str, Score]) -> list[str]:
    """A line for each method."""
    size, first = robot.body.mesh.size, np.array(next(iter(scores.values())).spent)
    lines = []
    for name, score in scores.items():
        errors = np.array(score.errors)
        ratio = float(np.median(np.array(score.spent) / first))
        lines.append(
            f"| {robot.name} | {name} | {np.sum(errors <= REACHED * size)} of {len(errors)} "
            f"| {np.median(score.spent):.1f} / {max(score.spent):.1f} | {ratio:.1f} "
            f"| {np.median(score.solves):.0f} / {max(score.solves)} | {np.median(score.steps):.0f} "
            f"| {1e3 * np.median(errors):.1e} / {1e3 * errors.max():.1e} |"
        )
    return lines


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("robots", nargs="*", default=["starfish", "cupping_hand", "finger"], metavar="ROBOT")
    parser.add_argument("--count", type=int, default=20, help="hidden contractions of each robot")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    print(f"{machine()}; {options.count} hidden contractions each, seed {options.seed}; median / largest\n")
    print(
        "| robot | method | reached | CPU ms | times ours | equilibria | steps of Newton | error mm |\n"
        "|---|---|---|---|---|---|---|---|",
        flush=True,
    )
    for name in options.robots:
        robot = robot_named(name)
        print("\n".join(rows(robot, compare(robot, options.count, options.seed))), flush=True)


if __name__ == "__main__":
    main()
