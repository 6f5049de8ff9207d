"""Workspace of the thumb by two cable patterns on the same hand (thesis, Fig 4.5).

    python lab/gallery_poses/thumbs.py [--count 25]

Each hand of the gallery keeps the flexor of its thumb and one more cable: along the back of the thumb (pattern 1), or
through the palm to the thumb (pattern 2). The gallery has one pattern on each hand; the other follows the same formula
(docs/bodies/hands.py). Both winches take in up to 40 mm. The other fingers rest, without contact.
"""

import argparse
import time
from dataclasses import replace

from machine import machine  # first: it sets one thread

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.ik import find_workspaces
from hydrostat.robot import Robot, gallery_folder

OTHER = {
    "cupping_hand": (
        *((34.0, 20.0, -62.0), (0.0, 4.0, -12.0), (-7.2, -8.7, 38.4), (-10.9, -10.9, 61.6)),
        *((29.8, -12.1, 54.1), (41.0, -27.2, 46.0), (46.5, -31.2, 51.3), (58.0, -43.8, 67.7)),
    ),
    "extended_hand": (
        *((34.0, 20.0, -62.0), (15.3, 7.0, -12.0), (33.3, -7.2, 25.2), (58.8, -15.8, 47.4)),
        *((69.9, -20.2, 57.9), (80.8, -24.9, 68.7), (84.3, -26.8, 72.6), (87.5, -28.8, 76.6)),
    ),
}
"""Points of the pattern that the hand does not have [mm], from the winch to the stopper."""
ALONG, ACROSS = "1, along the thumb", "2, through the palm"
SHEATHED = {ALONG: ((0, 2),), ACROSS: ((0, 3),)}  # stretches in a tube
OWN = {"cupping_hand": ALONG, "extended_hand": ACROSS}
TRAVEL = 40e-3  # of both winches [m]


def main() -> None:
    """Print a row for each hand and pattern."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=25, help="poses of each row")
    given = parser.parse_args()
    print(machine())
    print("| hand | pattern | extents of the tip [mm] | nearest to the little fingertip [mm] | poses | CPU [s] |")
    print("|---" * 6 + "|")
    for name in OTHER:
        for pattern in (ALONG, ACROSS):
            began = time.process_time()
            robot = with_pattern(hs.load_robot(gallery_folder(name)), pattern)
            (thumb,) = (
                one for one in find_workspaces(hs.Simulation(robot), count=given.count) if one.marker == "thumb"
            )
            little = np.array(robot.marker("little").at)
            near = float(np.linalg.norm(thumb.cells - little, axis=-1).min())
            extents = " x ".join(f"{1e3 * extent:.0f}" for extent in thumb.extents)
            print(
                f"| {name} | {pattern} | {extents} | {1e3 * near:.0f} | {len(thumb.places)} "
                f"| {time.process_time() - began:.0f} |",
                flush=True,
            )


def with_pattern(robot: Robot, pattern: str) -> Robot:
    """The hand with the two cables of its thumb alone, the second in a pattern."""
    flexor, second = robot.cables[:2]
    if pattern != OWN[robot.name]:
        points = tuple(tuple(1e-3 * value for value in point) for point in OTHER[robot.name])
        second = replace(second, points=points, sheathed=SHEATHED[pattern])
    return robot.with_network([replace(winch, travel=TRAVEL) for winch in robot.winches[:2]], [flexor, second])


if __name__ == "__main__":
    main()
