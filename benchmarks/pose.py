"""How long one pose and its Jacobian take on the starfish, a flat body of about 300 nodes.

python benchmarks/pose.py [--example starfish] [--count 30] [--repeats 5] [--seed 0]
"""

import argparse
import time
from collections.abc import Callable
from statistics import median

from machine import machine

import numpy as np  # isort: skip

from robustness import EXAMPLES, reaches

import hydrostat as hs


def cpu_milliseconds(work: Callable[[], object], repeats: int) -> float:
    """Median CPU time of several runs."""
    times = []
    for _ in range(repeats):
        began = time.process_time()
        work()
        times.append(1e3 * (time.process_time() - began))
    return median(times)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--example", default="starfish")
    parser.add_argument("--count", type=int, default=30, help="random contractions")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    robot = hs.load_robot(EXAMPLES / options.example)
    simulation = hs.Simulation(robot)
    print(machine())
    print(
        f"{options.example}: {len(robot.body.mesh.nodes)} nodes, {len(robot.body.mesh.elements)} elements, "
        f"{len(robot.cables)} cables; {options.count} random contractions, seed {options.seed}, CPU time, "
        f"median of {options.repeats} repeats\n"
    )
    random, largest = np.random.default_rng(options.seed), reaches(robot)
    rows: dict[str, list[tuple[float, int]]] = {"pose from rest": [], "pose from one 2 mm away": [], "jacobian": []}
    for _ in range(options.count):
        goal = random.uniform(0, largest)
        near = simulation.solve(np.maximum(goal - 2e-3, 0))
        pose = simulation.solve(goal)
        works: list[Callable[[], object]] = [
            lambda goal=goal: simulation.solve(goal),
            lambda goal=goal, near=near: simulation.solve(goal, start=near),
            lambda pose=pose: simulation.jacobian(pose),
        ]
        steps = [pose.result.iterations, simulation.solve(goal, start=near).result.iterations, 0]
        for row, work, taken in zip(rows.values(), works, steps, strict=True):
            row.append((cpu_milliseconds(work, options.repeats), taken))
    print("| | ms median | ms p90 | ms max | iterations median | max |\n|---|---|---|---|---|---|")
    for name, row in rows.items():
        times, steps = np.array([time for time, _ in row]), [taken for _, taken in row]
        print(
            f"| {name} | {np.median(times):.1f} | {np.percentile(times, 90):.1f} | {times.max():.1f} "
            f"| {median(steps):.0f} | {max(steps)} |"
        )


if __name__ == "__main__":
    main()
