"""A hand with fewer winches than cables: price, checks of its kit, and errors of its poses in the model.

    python lab/kits/shared_winches.py [--out DIR]

The side cables of fingers go to one winch, from which they begin. Errors are rms over markers.
"""

import argparse
import os
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import hydrostat as hs
from hydrostat.fabrication import KitOptions, build_kit
from hydrostat.robot import Robot, gallery_folder, save_robot

SHARED = {
    "none": (),
    "side cables of middle, ring, little": (("middle side", "ring side", "little side"),),
    "side cables of four fingers": (("index side", "middle side", "ring side", "little side"),),
}


def main() -> None:
    """Print a row for each choice."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", default="extended_hand")
    parser.add_argument("--out", type=Path, help="also write the robots there")
    given = parser.parse_args()
    robot = hs.load_robot(gallery_folder(given.robot))
    print("| on one winch | winches | used up [USD] | checks | error [mm] | CPU [s] |", "|---" * 6 + "|", sep="\n")
    for words, groups in SHARED.items():
        began, shared = time.process_time(), share_winches(robot, groups)
        kit = build_kit(shared, options=KitOptions(motor="sts3215"))
        (price,) = (line.split(",")[0].removeprefix("Material used: about ") for line in kit.summary if "used:" in line)
        simulation = hs.Simulation(shared)
        errors = {name: 1e3 * hs.solve_ik(simulation, pose).rms_error for name, pose in shared.poses.items()}
        told = ", ".join(f"{name} {error:.2f}" for name, error in errors.items())
        held = f"{sum(check.passed for check in kit.checks)} of {len(kit.checks)}"
        seconds = time.process_time() - began
        print(f"| {words} | {len(shared.winches)} | {price} | {held} | {told} | {seconds:.0f} |", flush=True)
        if given.out is not None:
            save_robot(shared, given.out / f"{len(shared.winches)}_winches")


def share_winches(robot: Robot, groups: Sequence[Sequence[str]]) -> Robot:
    """Robot with the cables of each group of winches on the first of them, where they then begin."""
    first = {name: group[0] for group in groups for name in group}
    cables = [
        replace(cable, winch=winch.name, points=(winch.at, *cable.points[1:]))
        for cable in robot.cables
        for winch in [robot.winch(first.get(cable.winch, cable.winch))]
    ]
    used = {cable.winch for cable in cables}
    return robot.with_network([winch for winch in robot.winches if winch.name in used], cables)


if __name__ == "__main__":
    main()
