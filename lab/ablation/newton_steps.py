"""Newton steps and factorizations of poses from rest: random contractions up to the full travel.

    python lab/ablation/newton_steps.py [--count 16] [--only starfish ...]

The last column is the sum of the energies, which tells whether two commits end in the same poses.
"""

import argparse
from pathlib import Path
from statistics import mean

from machine import machine  # isort: skip  (before NumPy)
import numpy as np

import hydrostat as hs
from hydrostat.mechanics import Assembly

EXAMPLES = Path(__file__).parents[2] / "examples"
BODIES = ("starfish", "puppy", "squid", "robot", "letter_s", "cupping_hand", "extended_hand", "octopus_arm")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=16, help="poses of each body")
    parser.add_argument("--only", nargs="+", default=BODIES, metavar="BODY")
    options = parser.parse_args()
    made = [0]
    factorize = Assembly.stiffness

    def counted(*given: object, **named: object) -> object:
        made[0] += 1
        return factorize(*given, **named)  # pyright: ignore[reportArgumentType]

    Assembly.stiffness = counted  # pyright: ignore[reportAttributeAccessIssue]
    print(f"{machine()}\n\n| body | Newton steps | factorizations | energy, J |\n|---|---|---|---|")
    for name in options.only:
        robot = hs.load_robot(EXAMPLES / name)
        simulation = hs.Simulation(robot)
        travel, random = np.array([winch.travel for winch in robot.winches]), np.random.default_rng(3)
        _, made[0] = simulation.rest, 0
        poses = [
            simulation.solve(random.uniform(0, 1, len(travel)) * travel, strict=False) for _ in range(options.count)
        ]
        steps, energy = mean(pose.result.iterations for pose in poses), sum(pose.energy for pose in poses)
        print(f"| {name} | {steps:.1f} | {made[0] / options.count:.2f} | {energy:.10g} |", flush=True)


if __name__ == "__main__":
    main()
