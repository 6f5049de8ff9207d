"""How hard a tennis ball is pulled out of the gallery's hands and gripper, with bands.

    python benchmarks/grasp.py [--step 2] [--bands] [NAME ...]

A rigid ball of 65 mm lies where `hydrostat grasp` would put it, and is pulled straight. With --bands friction,
stiffness and place are changed one at a time. The thesis pulled a tennis ball out of foam hands by a spring scale: 250
gf (2.45 N) from the anthropomorphic, up to 600 gf (5.88 N) from the other one; single readings, friction, stiffness and
tensions unknown: they stand beside ours, and prove nothing.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.errors import HydrostatError
from hydrostat.grasp import PullOptions, place_thing, pull_bands, pull_out, read_thing

EXAMPLES = Path(__file__).parents[1] / "examples"
GRASPS = {
    "caging_gripper": ("close", (0.0, 0.0, 1.0), "5.88 N, single reading"),
    "cupping_hand": ("fist", (0.0, 0.0, 1.0), "2.45 N, single reading"),
    "extended_hand": ("grasp", (0.0, 0.0, 1.0), "-"),
}
"""Pose that closes it, way of the pull, what the thesis read."""


def study(name: str, step: float, *, bands: bool) -> None:
    """Print the rows of one robot."""
    pose, direction, thesis = GRASPS[name]
    robot = replace(hs.load_robot(EXAMPLES / name), contact=hs.Contact())
    ball = read_thing("sphere:65mm", 3, mass=0.058, friction=0.5)
    options = PullOptions(direction=direction, step=step)
    begin = time.process_time()
    found = hs.solve_ik(hs.Simulation(robot), robot.pose(pose))
    closed = np.array([found.pose.markers[marker] for marker in robot.pose(pose).targets])
    placed = place_thing(robot, ball, closed)
    place = ", ".join(f"{1e3 * value:.0f}" for value in placed.at)
    try:
        pull = pull_out(robot, placed, found.pose.contractions, options)
    except HydrostatError as error:
        print(f"| {name} | {pose} | {place} | {error} | | | {thesis} |", flush=True)
        return
    cases = pull_bands(robot, placed, found.pose.contractions, options) if bands else ()
    known = [case.pull for case in cases if case.pull is not None and case.name != "no friction"]
    peaks = [pull.peak, *(each.peak for each in known)]
    cage = next((case.pull.work for case in cases if case.pull is not None and case.name == "no friction"), np.nan)
    print(
        f"| {name} | {pose} | {place} | {pull.peak:.3f} | {min(peaks):.3f} to {max(peaks):.3f} ({len(peaks)}) | "
        f"{1e3 * cage:.2f} | {thesis} | {pull.reason} | {time.process_time() - begin:.0f} |",
        flush=True,
    )
    for case in cases:
        print(
            f"    {case.name}: "
            + (case.trouble if case.pull is None else f"{case.pull.peak:.3f} N; {case.pull.reason}")
        )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", default=list(GRASPS))
    parser.add_argument("--step", type=float, default=2.0, help="of the pull [mm]")
    parser.add_argument("--bands", action="store_true")
    given = parser.parse_args()
    print(machine())
    print("| robot | pose | ball at [mm] | peak [N] | over cases [N] | escape [mJ] | thesis | end | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name in given.names:
        study(name, 1e-3 * given.step, bands=given.bands)


if __name__ == "__main__":
    main()
