"""How hard a tennis ball is pulled out of the gallery's hands and gripper, with bands.

    python lab/grasping/grasp.py [--step 4] [--closings 1 4] [--bands] [NAME ...]

A rigid ball of 67 mm is held deep in the hand at rest, clear of it; the robot closes by the contractions that inverse
kinematics finds for a pose without the ball, and by several times these, as far as its winches go; then the ball is
pulled straight out, away from the wrist. With --bands friction (0.5 otherwise), stiffness of the body and place are
changed one at a time, for the firmest closing that came to its end.

Escape is the work of the pull without friction, up to its most: the energy that keeps the ball in, along this one way,
so the least energy is no more than that.

The thesis pulled a tennis ball out of foam hands by a spring scale: 250 gf (2.45 N) from the anthropomorphic, up to 600
gf (5.88 N) from the other one; single readings, friction, stiffness and tensions unknown: they stand beside ours, and
prove nothing.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.errors import HydrostatError
from hydrostat.grasp import PullOptions, move_object, pull_bands, pull_out, read_object

EXAMPLES = Path(__file__).parents[2] / "examples"
GRASPS = {
    "caging_gripper": ("close", (0, 0, 72), (0.0, 0.0, 1.0), "5.88"),
    "cupping_hand": ("fist", (10, -55, 86), (0.0, 0.0, 1.0), "2.45"),
    "extended_hand": ("grasp", (10, -55, 90), (0.0, 0.0, 1.0), "2.45"),
}
"""Pose that closes it, where the ball is [mm], way of the pull, what the thesis read [N], once."""


def study(name: str, step: float, closings: list[float], *, bands: bool) -> None:
    """Print the rows of one robot."""
    pose, at, direction, thesis = GRASPS[name]
    robot = replace(hs.load_robot(EXAMPLES / name), contact=hs.Contact())
    ball = move_object(read_object("sphere:67mm", 3, mass=0.058, friction=0.5), 1e-3 * np.array(at))
    options = PullOptions(direction=direction, step=step)
    travel = np.array([winch.travel for winch in robot.winches])
    closed = hs.solve_ik(hs.Simulation(robot), robot.pose(pose)).pose.contractions
    firm = None
    for closing in closings:
        taken, begin = np.minimum(closing * closed, travel), time.process_time()
        row = f"| {name} | {pose} x {closing:g} | {', '.join(map(str, at))}"
        try:
            pull = pull_out(robot, ball, taken, options)
            free = pull_out(robot, replace(ball, friction=0.0), taken, options)
        except HydrostatError as error:
            print(f"{row} | {error} |||||||", flush=True)
            continue
        tight = max(float(solved.tensions.max()) for solved in pull.poses)
        print(
            f"{row} | {pull.peak:.2f} | {1e3 * pull.moved[int(pull.forces.argmax())]:.0f} | {free.peak:.2f} | "
            f"{1e3 * free.work:.1f} | {tight:.1f} | {thesis} | {pull.status} | {time.process_time() - begin:.0f} |",
            flush=True,
        )
        firm = (taken, pull, closing) if pull.released else firm
    if bands and firm is not None:
        taken, pull, closing = firm
        cases = pull_bands(robot, ball, taken, options)
        known = [case.pull.peak for case in cases if case.pull is not None and case.name != "no friction"]
        print(f"{name}, {pose} x {closing:g}: {pull.peak:.2f} N; {min(known):.2f} to {max(known):.2f} N over these:")
        for case in cases:
            print(f"    {case.name}: {case.trouble if case.pull is None else f'{case.pull.peak:.2f} N'}", flush=True)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", default=list(GRASPS))
    parser.add_argument("--step", type=float, default=4.0, help="of the pull [mm]")
    parser.add_argument("--closings", type=float, nargs="+", default=[1.0, 4.0], help="times the contractions")
    parser.add_argument("--bands", action="store_true")
    given = parser.parse_args()
    print(machine())
    print(
        "| robot | closed by | ball at mm | peak N | after mm | without friction N | escape mJ | tightest cable N ",
        end="",
    )
    print("| thesis N | end | CPU s |\n|" + 11 * "---|")
    for name in given.names:
        study(name, 1e-3 * given.step, given.closings, bands=given.bands)


if __name__ == "__main__":
    main()
