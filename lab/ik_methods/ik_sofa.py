"""Inverse kinematics on robots that SOFA ships, next to what SOFA's inverse takes.

    python lab/ik_methods/ik_sofa.py [finger diamond trunk] [--repeats 15]

The goal of the tip is where our own equilibrium has it under known contractions, so it can be reached. The search
begins at rest under gravity; what that pose costs is said below each table. SOFA's figures (SOFA 25.06 with
SoftRobots.Inverse, goals of the same contractions) are the least and the most of its CPU times for its corotated
material, ours is Neo-Hookean. They were taken on another machine (one thread at 2.1 GHz), so no ratio is given. For the
trunk, eight cables for one point, no figure of its inverse is known: its direct simulation takes 2.3 to 12 s to rest
with one cable. Answer "one" is that of least effort where cables are redundant, "any" the first that reaches the goal;
"tensions" is the length of the vector of all tensions, as hidden and as found.
"""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

from ik_problem import largest_error, machine, places, timed

import numpy as np  # isort: skip

from benchmark_bodies import sofa_robots

import hydrostat as hs
from hydrostat.ik import IKOptions, Limits


@dataclass(frozen=True, kw_only=True)
class Task:
    """Goals of one robot, and what SOFA makes of them.

    Attributes:
        goals: contractions [mm] of all winches, whose pose is the goal.
        limits: least and largest contraction of every winch [mm].
        sofa: least and largest CPU time of SOFA's inverse on another machine [ms]; none is known where it is left out.
        left: error that SOFA leaves [mm], in words.
    """

    goals: Sequence[Sequence[float]]
    limits: tuple[float, float]
    sofa: tuple[float, float] | None = None
    left: str = "-"


ONE, ANY = IKOptions(), IKOptions(min_tension=False)
"""The answer of least effort where cables are redundant, or any."""

TASKS = {
    "finger": Task(goals=[[5], [10], [20], [30]], limits=(0, 60), sofa=(26, 95), left="0.03"),
    "diamond": Task(
        goals=[[20, 0, 0, 0], [10, 5, 0, 0], [15, -10, -10, 5], [-10, 20, 10, -20]],
        limits=(-20, 20),
        sofa=(340, 470),
        left="0.02 to 0.07",
    ),
    "trunk": Task(
        goals=[
            [5, 0, 0, 0, 0, 0, 0, 0],
            [10, 0, 0, 0, 0, 0, 0, 0],
            [20, 0, 0, 0, 0, 0, 0, 0],
            [20, 10, 0, 0, 0, 0, 5, 0],
            [10, 10, 10, 10, 5, 5, 5, 5],
        ],
        limits=(0, 60),
    ),
}


def rows(name: str, task: Task, repeats: int) -> list[str]:
    """A line for each goal, and one on the rest pose."""
    robot = sofa_robots()[name]()
    simulation = hs.Simulation(robot)
    low, high = (1e-3 * limit for limit in task.limits)
    limits = Limits(contraction={winch.name: (low, high) for winch in robot.winches})
    lines = []
    for goal in task.goals:
        hidden = simulation.solve(1e-3 * np.array(goal, dtype=float))
        for kind, options in (("one", ONE), ("any", ANY)):
            runs = [
                timed(
                    lambda hidden=hidden, options=options: hs.solve_ik(
                        simulation, places(hidden), limits=limits, options=options
                    )
                )
                for _ in range(repeats)
            ]
            found, spent = runs[-1][0], float(np.median([milliseconds for _, milliseconds in runs[1:] or runs]))
            error = largest_error(found.pose, places(hidden))
            pulls = [np.linalg.norm(pose.tensions) for pose in (hidden, found.pose)]
            sofa = "- | -"
            if task.sofa is not None:
                least, most = task.sofa
                sofa = f"{least:.0f} to {most:.0f} | {task.left}"
            lines.append(
                f"| {name} | {', '.join(f'{value:g}' for value in goal)} | {kind} | {found.status.name} "
                f"| {1e3 * error:.1e} | {found.iterations} | {found.solves} | {pulls[0]:.2f} / {pulls[1]:.2f} "
                f"| {spent:.1f} | {sofa} |"
            )
    fresh = [timed(lambda: hs.Simulation(robot).rest)[1] for _ in range(3)]
    lines.append(f"\n{name}: {len(robot.body.mesh.elements)} elements; its rest pose once {np.median(fresh):.0f} ms\n")
    return lines


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("robots", nargs="*", default=list(TASKS), metavar="ROBOT")
    parser.add_argument("--repeats", type=int, default=15, help="of each goal; the first, which warms up, is left out")
    options = parser.parse_args(arguments)
    known = sofa_robots()
    print(f"{machine()}; median of {options.repeats} runs\n")
    head = (
        "robot | hidden contractions mm | answer | reason | error mm | iterations | equilibria "
        "| tensions N, hidden / found | CPU ms | SOFA, another machine: CPU ms | error mm"
    )
    for name in options.robots:
        if name not in known:
            print(f"{name}: its mesh is not beside this checkout, left out", flush=True)
            continue
        print(f"| {head} |\n{'|---' * (head.count('|') + 1)}|", flush=True)
        print("\n".join(rows(name, TASKS[name], options.repeats)), flush=True)


if __name__ == "__main__":
    main()
