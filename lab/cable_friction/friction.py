"""What friction of cables does to every example, and what it costs.

python lab/cable_friction/friction.py [--quick] [--friction 0.2] [EXAMPLE ...]
"""

import argparse
import time
from dataclasses import replace

from machine import machine

import numpy as np  # isort: skip

from robustness import EXAMPLES, example_folders

from hydrostat.robot import Robot, load_robot
from hydrostat.simulation import Equilibrium, Simulation

REPEATS = 5
COMMANDS = 4
USUAL = 0.05  # increment of a loading path, as a share of the shortest cable of a winch
INCREMENTS = (0.01, 0.05, 0.2, 1.0)


def timed(robot: Robot, goal: np.ndarray) -> tuple[float, Simulation, Equilibrium]:
    """Least CPU time of a solve from rest [s], and its pose."""
    simulation, least, pose = Simulation(robot), np.inf, None
    simulation.solve(0.1 * goal)
    for _ in range(REPEATS):
        began = time.process_time()
        pose = simulation.solve(goal, strict=False)
        least = min(least, time.process_time() - began)
    assert pose is not None
    return least, simulation, pose


def row(name: str, friction: float) -> str:
    """One line of the table."""
    plain = load_robot(EXAMPLES / name)
    rubbing = plain.with_network(plain.winches, [replace(cable, friction=friction) for cable in plain.cables])
    goal = np.array(
        [0.2 * min(cable.length for cable in plain.cables if cable.winch == winch.name) for winch in plain.winches]
    )
    before, _, free = timed(plain, goal)
    after, simulation, held = timed(rubbing, goal)
    assert simulation.friction is not None
    back = simulation.solve(0.5 * goal, start=held, strict=False)
    there = simulation.solve(0.5 * goal, strict=False)
    ends = simulation.friction.with_history(held.history, held.nodes, goal).span_tensions(held.nodes, goal)
    apart = max(float(np.linalg.norm(held.markers[marker] - free.markers[marker])) for marker in free.markers)
    loop = max(float(np.linalg.norm(back.markers[marker] - there.markers[marker])) for marker in free.markers)
    failed = sum(not pose.result.converged for pose in (free, held, back, there))
    return (
        f"| {name} | {free.tensions.max():.2f} | {held.tensions.max():.2f} | {ends[ends > 0].min() / ends.max():.2f} "
        f"| {1e3 * apart:.2f} | {1e3 * loop:.2f} | {failed} | {free.result.iterations} | {held.result.iterations} "
        f"| {1e3 * before:.1f} | {1e3 * after:.1f} | {after / before:.1f} |"
    )


def way(name: str, friction: float) -> str:
    """How far poses of random commands, one after the other, are from those in increments of 1 %, by increment."""
    robot = load_robot(EXAMPLES / name)
    robot = robot.with_network(robot.winches, [replace(cable, friction=friction) for cable in robot.cables])
    shortest = [min(cable.length for cable in robot.cables if cable.winch == winch.name) for winch in robot.winches]
    goals = np.random.default_rng(1).uniform(0, 0.3, (COMMANDS, len(shortest))) * shortest
    runs = []
    for share in INCREMENTS:
        simulation, pose, run = Simulation(robot), None, []
        simulation.path._increment = simulation.path._increment * (share / USUAL)
        for goal in goals:
            pose = simulation.solve(goal, start=pose, strict=False)
            run.append(pose)
        runs.append(run)
    failed = sum(not pose.result.converged for run in runs for pose in run)
    apart = [
        [f"{1e3 * np.abs(pose.nodes - finest.nodes).max():.0e}" for pose, finest in zip(run, runs[0], strict=True)]
        for run in runs[1:]
    ]
    return f"| {name} | {failed} | " + " | ".join(", ".join(own) for own in apart) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("examples", nargs="*", help="names of example folders; all if left out")
    parser.add_argument("--quick", action="store_true", help="the starfish only")
    parser.add_argument("--friction", type=float, default=0.2, help="coefficient of every cable")
    options = parser.parse_args()
    names = options.examples or (["starfish"] if options.quick else [folder.name for folder in example_folders()])
    print(f"{machine()}; all winches take in 20 % of their shortest cable, friction {options.friction:g}, CPU time\n")
    print(
        "| example | N without | N with | least of largest | mm apart | mm halfway, in and out | failed "
        "| iterations without | with | ms without | ms with | ratio |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|---|", flush=True)
    for name in names:
        print(row(name, options.friction), flush=True)
    print(f"\nmm between poses of {COMMANDS} random commands and those in increments of 1 % of the shortest cable\n")
    print("| example | failed | " + " | ".join(f"{share:.0%}" for share in INCREMENTS[1:]) + " |")
    print("|---|---|" + "---|" * len(INCREMENTS[1:]), flush=True)
    for name in names:
        print(way(name, options.friction), flush=True)


if __name__ == "__main__":
    main()
