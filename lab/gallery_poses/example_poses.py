"""How near inverse kinematics brings every example to each of its poses, and what it costs.

python lab/gallery_poses/example_poses.py [--quick] [EXAMPLE ...]
"""

import argparse
import time

from machine import machine

import numpy as np  # isort: skip

from robustness import EXAMPLES, example_folders

from hydrostat.ik import solve_ik
from hydrostat.robot import PoseTarget, Robot, load_robot
from hydrostat.simulation import Simulation


def rest_error(robot: Robot, pose: PoseTarget) -> float:
    """Root of the mean squared distance of the targeted markers from their targets at rest [m]."""
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    return float(np.sqrt(np.mean([np.sum((places[name] - at) ** 2) for name, at in pose.targets.items()])))


def row(folder: str, simulation: Simulation, pose: PoseTarget) -> str:
    """One line of the table."""
    began = time.process_time()
    reached = solve_ik(simulation, pose)
    spent = time.process_time() - began
    return (
        f"| {folder} | {pose.name} | {1e3 * rest_error(simulation.robot, pose):.2f} | {1e3 * reached.rms_error:.3f} "
        f"| {reached.status.name} | {reached.optimality:.0e} | {reached.iterations} | {reached.solves} "
        f"| {1e3 * spent:.0f} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("examples", nargs="*", help="names of example folders; all if left out")
    parser.add_argument("--quick", action="store_true", help="the starfish only")
    options = parser.parse_args()
    names = options.examples or (["starfish"] if options.quick else [folder.name for folder in example_folders()])
    print(f"{machine()}; rms errors over the targeted markers, CPU time\n")
    print("| example | pose | mm at rest | mm reached | reason | optimality | iterations | solves | CPU ms |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    for name in names:
        simulation = Simulation(load_robot(EXAMPLES / name))
        for pose in simulation.robot.poses.values():
            print(row(name, simulation, pose), flush=True)


if __name__ == "__main__":
    main()
