"""What designed networks reach, beside all muscle fibres at once and the networks that were placed by hand.

    python benchmarks/design.py [--quick] [EXAMPLE ...]

The starfish and the six designs of the thesis, with its numbers of winches and cables (N1), each for all its poses and
for the first alone. The networks placed by hand may have other numbers. Fibres are counted for both definitions (E21).
"""

import argparse
import time
from collections.abc import Sequence

from machine import machine

import numpy as np  # isort: skip

from robustness import EXAMPLES

from hydrostat.design import DesignOptions, activate, design_cables, edge_fibres
from hydrostat.errors import HydrostatError
from hydrostat.ik import solve_ik
from hydrostat.robot import Pose, Robot, load_robot
from hydrostat.simulation import Simulation

THESIS = {
    "starfish": (2, 6, None),
    "robot": (2, 6, 414),
    "pig": (1, 2, 571),
    "letter_e": (1, 3, 442),
    "letter_s": (1, 2, 276),
    "puppy": (3, 3, 307),
    "squid": (8, 11, 429),
}
"""Winches, cables and muscle fibres of each design."""


def rms(errors: Sequence[float]) -> float:
    """Root mean square of rms errors [mm]."""
    return 1e3 * float(np.sqrt(np.mean(np.square(errors))))


def rest_errors(robot: Robot, poses: Sequence[Pose]) -> list[float]:
    """Rms error of each pose at rest [m]."""
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    squares = [[np.sum((places[name] - at) ** 2) for name, at in pose.targets.items()] for pose in poses]
    return [float(np.sqrt(np.mean(pose))) for pose in squares]


def row(name: str, robot: Robot, poses: Sequence[Pose]) -> str:
    """One line of the table."""
    winches, cables, _ = THESIS[name]
    simulation, fibres = Simulation(robot), edge_fibres(robot.body.mesh)
    hand = [solve_ik(simulation, pose).rms_error for pose in poses]
    muscles = [activate(robot, pose, fibres, DesignOptions()).rms_error for pose in poses]
    began = time.process_time()
    try:
        network = design_cables(robot, poses, winches=winches, cables=cables)
        counts, tried = f"{len(network.robot.winches)} / {len(network.robot.cables)}", str(network.tried)
        found = f"{1e3 * network.rms_error:.2f}"
    except HydrostatError as error:
        counts, tried, found = "none", "", str(error)
    return (
        f"| {name} | {len(poses)} | {rms(rest_errors(robot, poses)):.2f} | {rms(muscles):.3f} "
        f"| {len(robot.winches)} / {len(robot.cables)} | {rms(hand):.2f} | {counts} | {found} "
        f"| {tried} | {time.process_time() - began:.1f} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("examples", nargs="*", help="names of example folders; all of them if left out")
    parser.add_argument("--quick", action="store_true", help="the pig only")
    options = parser.parse_args()
    names = options.examples or (["pig"] if options.quick else list(THESIS))
    robots = {name: load_robot(EXAMPLES / name) for name in names}
    print(f"{machine()}; rms errors over targeted markers and poses, CPU time\n")
    print("| example | edges | elements | fibres in the thesis |\n|---|---|---|---|")
    for name, robot in robots.items():
        mesh, counted = robot.body.mesh, THESIS[name][2]
        print(f"| {name} | {len(mesh.edges)} | {len(mesh.elements)} | {counted or ''} |")
    print(
        "\n| example | poses | mm at rest | mm with all fibres | winches / cables by hand | mm by hand "
        "| winches / cables of trees | mm with trees | judged | CPU s |\n|---|---|---|---|---|---|---|---|---|---|"
    )
    for name, robot in robots.items():
        poses = list(robot.poses.values())
        for chosen in (poses, poses[:1]):
            print(row(name, robot, chosen), flush=True)


if __name__ == "__main__":
    main()
