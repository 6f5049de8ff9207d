"""Whether contractions alone decide the pose: every example at full travel and at random contractions (E20).

    python lab/path_dependence/path_dependence.py [--branches | --random 2] [--count 12] [--seed 0] [EXAMPLE ...]

Each is approached in `count` ways; a way on which no stable equilibrium was found is counted as lost. With --branches
the branch from rest to full travel is followed instead, around its folds, and back again.
"""

import argparse
import time

from machine import machine

import numpy as np  # isort: skip

from robustness import EXAMPLES, example_folders

from hydrostat.arrays import Vector
from hydrostat.robot import load_robot
from hydrostat.simulation import Simulation, continue_branch, find_equilibria


def row(folder: str, simulation: Simulation, name: str, contractions: Vector, count: int, seed: int) -> str:
    """One line of the table."""
    began = time.process_time()
    found = find_equilibria(simulation, contractions, count=count, seed=seed)
    spent = time.process_time() - began
    apart = "" if found.unique or not found.poses else f"{1e3 * found.largest[1]:.2f} at {found.largest[0]}"
    shares = " + ".join(str(len(pose.ways)) for pose in found.poses)
    size = 1e3 * simulation.robot.body.mesh.size
    return (
        f"| {folder} | {len(simulation.robot.body.mesh.nodes)} | {size:.0f} | {name} | {len(found.poses)} | {shares} "
        f"| {len(found.lost)} | {apart} | {spent:.1f} |"
    )


def branch_row(folder: str, simulation: Simulation) -> str:
    """One line of the table of branches."""
    rest = simulation.solve({})
    began = time.process_time()
    there = continue_branch(simulation, rest, travels(simulation), around_folds=True)
    spent = time.process_time() - began
    back = continue_branch(simulation, there.end, {}, around_folds=True)
    missed = np.abs(back.end.nodes - rest.nodes).max() / simulation.robot.body.mesh.size
    folds = ", ".join(f"{100 * share:.1f}" for share in there.folds) or "none"
    again = all(abs(1 - one - other) < 1e-6 for one, other in zip(back.folds[::-1], there.folds, strict=False))
    again &= len(back.folds) == len(there.folds)
    unstable = sum(not point.stable for point in there.points)
    return (
        f"| {folder} | {there.status.name} | {folds} | {len(there.critical) - len(there.folds)} | {len(there.points)} "
        f"| {unstable} | {'yes' if again else 'no'} | {missed:.0e} | {spent:.1f} |"
    )


def travels(simulation: Simulation) -> Vector:
    """The most cable that each winch takes in [m]."""
    return np.array([winch.travel for winch in simulation.robot.winches])


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("examples", nargs="*", help="names of example folders; all if left out")
    parser.add_argument("--branches", action="store_true", help="follow the branch to full travel and back")
    parser.add_argument("--random", type=int, default=2, help="random contractions of each example")
    parser.add_argument("--count", type=int, default=12, help="ways to each contractions")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    names = options.examples or [folder.name for folder in example_folders()]
    print(f"{machine()}; {options.count} ways to each contractions, seed {options.seed}, CPU time\n")
    if options.branches:
        print("| example | ended | folds at % | bifurcations | points | unstable | same back | rest missed | CPU s |")
        print("|---|---|---|---|---|---|---|---|---|", flush=True)
        for name in names:
            print(branch_row(name, Simulation(load_robot(EXAMPLES / name))), flush=True)
        return
    print("| example | nodes | size mm | contractions | poses | paths to each pose | lost | mm apart | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    for name in names:
        simulation = Simulation(load_robot(EXAMPLES / name))
        random = np.random.default_rng(options.seed)
        low = np.array([-winch.release for winch in simulation.robot.winches])
        high = travels(simulation)
        goals = {"full travel": high}
        goals |= {f"random {index + 1}": random.uniform(low, high) for index in range(options.random)}
        for which, goal in goals.items():
            print(row(name, simulation, which, goal, options.count, options.seed), flush=True)


if __name__ == "__main__":
    main()
