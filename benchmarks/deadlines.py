"""How far inverse kinematics runs over its time limit on random robots with friction, some with contact.

    python benchmarks/deadlines.py [--robots 200] [--limit 0.3] [--seed 7]

Robots are those of the gallery; a via point beside the middle of each segment makes their cables zigzag, friction is
drawn from 0.1 to 0.6, targets lie up to some 30 % of the body away. Times are by the clock: what a person waits.
"""

import argparse
import time
from dataclasses import replace
from itertools import pairwise

from machine import machine  # isort: skip  (before NumPy)
import numpy as np

from hydrostat.errors import HydrostatError, InputError
from hydrostat.ik import solve_ik
from hydrostat.robot import Cable, Contact, Robot, gallery_folder, load_robot
from hydrostat.simulation import Simulation

NAMES = ("starfish", "octopus_arm", "letter_e", "fish_tail", "pig", "squid")


def draw_robot(name: str, random: np.random.Generator) -> Robot:
    """A robot of the gallery with friction; its cables zigzag and its body has contact where that is possible."""
    robot = load_robot(gallery_folder(name))
    friction, touching = float(random.uniform(0.1, 0.6)), random.random() < 0.4
    plain = tuple(replace(cable, friction=friction) for cable in robot.cables)
    bent = tuple(_zigzag(cable, random) for cable in plain)
    try:
        return replace(robot, cables=bent, contact=Contact() if touching else robot.contact)
    except InputError:  # a via point outside the body, or a body that touches itself at rest
        return replace(robot, cables=plain)


def _zigzag(cable: Cable, random: np.random.Generator) -> Cable:
    points = [np.array(point) for point in cable.points]
    found = points[:1]
    for start, end in pairwise(points):
        side = np.zeros_like(start)
        side[:2] = start[1] - end[1], end[0] - start[0]
        found += [(start + end) / 2 + side * random.uniform(-0.12, 0.12), end]
    try:
        return replace(cable, points=tuple(map(tuple, found)))
    except InputError:
        return cable


def overrun(robot: Robot, limit: float, random: np.random.Generator) -> tuple[float, str]:
    """Seconds beyond the limit, and how the search ended."""
    simulation, size = Simulation(robot), robot.body.mesh.size
    some, dim = robot.markers[:2], robot.body.mesh.dim
    targets = {marker.name: np.array(marker.at) + 0.15 * size * random.normal(size=dim) for marker in some}
    began = time.monotonic()
    try:
        reason = str(solve_ik(simulation, targets, seconds=limit).status)
    except HydrostatError as error:
        reason = type(error).__name__
    return time.monotonic() - began - limit, reason


def main() -> None:
    """Print one table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robots", type=int, default=200)
    parser.add_argument("--limit", type=float, default=0.3, help="time limit [s]")
    parser.add_argument("--seed", type=int, default=7)
    asked = parser.parse_args()
    random = np.random.default_rng(asked.seed)
    robots = (draw_robot(NAMES[number % len(NAMES)], random) for number in range(asked.robots))
    found = [overrun(robot, asked.limit, random) for robot in robots]
    late = np.array([seconds for seconds, _ in found])
    print(f"{machine()}; limit {asked.limit:g} s, seed {asked.seed}\n")
    print("| robots | stopped by the limit | overrun median s | 95 % | worst |\n|---|---|---|---|---|")
    stopped = sum(reason == "time limit reached" for _, reason in found)
    print(f"| {len(found)} | {stopped} | {np.median(late):.2f} | {np.percentile(late, 95):.2f} | {late.max():.2f} |")


if __name__ == "__main__":
    main()
