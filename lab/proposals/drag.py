"""What one step of a drag costs in the studio, without contact and with it.

    python lab/proposals/drag.py [NAME ...] [--steps 200]

The first marker of each robot goes round an ellipse, a quarter of the body wide, in 60 steps: the studio's mover on the
robot's own cables makes one update for each, as while a person drags, touches and their words included. Times are CPU
time of one thread in milliseconds: median and the 95th percentile; `touching`: the share of steps in which something
touches, and without contact that of those in which the body passes through itself.
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace
from math import cos, pi, sin

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.robot import Robot, gallery_folder, list_gallery
from hydrostat.studio import CableMover, HeldPoint

ROUND = 60
"""Steps of one round."""


def drag(robot: Robot, steps: int) -> tuple[np.ndarray, float]:
    """Times of all steps [ms], and the share in which something touches or crosses."""
    mover = CableMover(hs.Simulation(robot), tension=50.0)
    marker, size = robot.markers[0], robot.body.mesh.size
    spent, touching = [], 0
    for step in range(steps + 5):
        turn = 2 * pi * step / ROUND
        move = 0.125 * size * np.array([cos(turn) - 1, sin(turn), 0.0][: robot.body.mesh.dim])
        held = {marker.name: HeldPoint(at=marker.at, target=tuple((np.array(marker.at) + move).tolist()))}
        begin = time.process_time()
        shape, _ = mover.update(held)
        spent.append(1e3 * (time.process_time() - begin))
        touching += bool(shape.touches) or shape.crossing is not None
    return np.array(spent[5:]), touching / steps


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="robots; all flat ones of the gallery if left out")
    parser.add_argument("--steps", type=int, default=200)
    options = parser.parse_args(arguments)
    robots = [hs.load_robot(gallery_folder(name)) for name in options.names or list_gallery()]
    print(machine())
    print("| robot | nodes | contact | median ms | 95 % ms | touching |")
    print("|---|---|---|---|---|---|")
    for robot in robots:
        if not options.names and robot.body.mesh.dim == 3:
            continue
        for contact in (None, hs.Contact()):
            spent, touching = drag(replace(robot, contact=contact), options.steps)
            words = f"{robot.name} | {len(robot.body.mesh.nodes)} | {'on' if contact else 'off'}"
            print(f"| {words} | {np.median(spent):.1f} | {np.percentile(spent, 95):.1f} | {touching:.0%} |", flush=True)


if __name__ == "__main__":
    main()
