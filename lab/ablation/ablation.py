"""What each idea of the statics solver is worth: the same solves without one of them at a time.

    python lab/ablation/ablation.py [--count 20] [--seed 0] [--robots FOLDER]

All from rest. Hand and squid: random contractions up to 30 % of the shortest cable of each winch; finger 20 mm and
trunk 10 mm on one cable (left out if their folder is not there; see benchmark_bodies.py).
"""

import argparse
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from benchmark_bodies import ROBOTS, hand_robot, sofa_robots
from machine import machine
from robustness import EXAMPLES, reaches

import hydrostat as hs
from hydrostat.arrays import Vector
from hydrostat.mechanics import TensionLaw
from hydrostat.robot import Robot


@contextmanager
def whole(_simulation: hs.Simulation) -> Iterator[None]:
    yield


@contextmanager
def straight(simulation: hs.Simulation) -> Iterator[None]:
    with patch.object(simulation, "solver", replace(simulation.solver, warp=None)):
        yield


@contextmanager
def linear(_simulation: hs.Simulation) -> Iterator[None]:
    with patch.object(TensionLaw, "solve_slack_complementarity", lambda *_given: None):
        yield


@contextmanager
def cold(simulation: hs.Simulation) -> Iterator[None]:
    with patch.dict(simulation.__dict__, {"rest_stiffness": None}):
        yield


@contextmanager
def fresh(simulation: hs.Simulation) -> Iterator[None]:
    options = replace(simulation.solver.options, near=0.0)
    with patch.object(simulation, "solver", replace(simulation.solver, options=options)):
        yield


@contextmanager
def plain(simulation: hs.Simulation) -> Iterator[None]:
    with straight(simulation), linear(simulation), cold(simulation), fresh(simulation):
        yield


VARIANTS: dict[str, Callable[[hs.Simulation], Any]] = {
    "all of it": whole,
    "straight steps, no arcs": straight,
    "a step does not know slack": linear,
    "first step by the Hessian under load": cold,
    "new factors to the end": fresh,
    "none of these": plain,
}


def cases(count: int, seed: int, robots: Path) -> Iterator[tuple[str, Robot, list[Vector]]]:
    """Name, robot and contractions to solve for."""
    for name, make in (("hand", hand_robot), ("squid", lambda: hs.load_robot(EXAMPLES / "squid"))):
        robot = make()
        random = np.random.default_rng(seed)
        yield name, robot, [random.uniform(0, 0.75 * reaches(robot)) for _ in range(count)]
    found = sofa_robots(robots)
    for name, contraction in (("finger", 0.02), ("trunk", 0.01)):
        if name in found:
            robot = found[name]()
            yield f"{name} {1e3 * contraction:g} mm", robot, [contraction * np.eye(len(robot.winches))[0]] * 3


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--robots", type=Path, default=ROBOTS)
    options = parser.parse_args()
    print(f"{machine()}\nCPU ms median / iterations median, max; {options.count} poses of hand and squid\n")
    columns: dict[str, list[str]] = {name: [] for name in VARIANTS}
    heads = []
    for name, robot, goals in cases(options.count, options.seed, options.robots):
        heads.append(name)
        simulation = hs.Simulation(robot)
        simulation.solve(goals[0], strict=False)
        for variant, without in VARIANTS.items():
            times, steps, failed = [], [], 0
            with without(simulation):
                for goal in goals:
                    began = time.process_time()
                    pose = simulation.solve(goal, strict=False)
                    times.append(1e3 * (time.process_time() - began))
                    steps.append(pose.result.iterations)
                    failed += not pose.result.converged
            text = f"{np.median(times):.0f} / {np.median(steps):.0f}, {max(steps)}"
            columns[variant].append(text + (f", {failed} failed" if failed else ""))
    print(f"| | {' | '.join(heads)} |\n|{'---|' * (len(heads) + 1)}")
    for variant, texts in columns.items():
        print(f"| {variant} | {' | '.join(texts)} |")


if __name__ == "__main__":
    main()
