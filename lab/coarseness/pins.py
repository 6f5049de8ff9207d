"""How stiff a pin must be: errors of markers against held nodes, by the pin's share of the stiffness that it holds.

    python lab/coarseness/pins.py

For each robot of the gallery without drives its first winch takes in 0.3 of its travel. Pins have a multiple of the
stiffness of the elements that they hold, in sum; the reference has 10,000 times. Printed is how far markers are from
the reference, as a share of their travel. A pin in robot.toml without a stiffness has 100 kN/m (last columns); where
that is less than 5 times (in space 15 times) what it holds, it has 100 times that.
"""

from dataclasses import replace

import numpy as np
from machine import machine

from hydrostat.robot import Pin, Robot, gallery_folder, list_gallery, load_robot
from hydrostat.simulation import Simulation

RATIOS = (1.0, 5.0, 15.0, 100.0)
FIXED = 1e4


def moved(robot: Robot, stiffnesses: list[float]) -> np.ndarray:
    """Moves of the markers [m] with pins of these stiffnesses [N/m]."""
    pins = tuple(replace(pin, stiffness=each) for pin, each in zip(robot.pins, stiffnesses, strict=True))
    winch = robot.winches[0]
    pose = Simulation(replace(robot, pins=pins)).solve({winch.name: 0.3 * winch.travel})
    return np.array([np.subtract(pose.markers[marker.name], marker.at) for marker in robot.markers])


def main() -> None:
    print(f"{machine()}\n")
    heads = [f"{ratio:g} times" for ratio in RATIOS]
    print(f"| robot | {' | '.join(heads)} | 100 kN/m | that is, times |")
    print("|---|" + "---|" * (len(RATIOS) + 2))
    for name in list_gallery():
        robot = load_robot(gallery_folder(name))
        if robot.drives:
            continue
        needed = [pin.held_stiffness(robot.body) for pin in robot.pins]
        fixed = moved(robot, [FIXED * each for each in needed])
        tried = [[ratio * each for each in needed] for ratio in RATIOS] + [[float(Pin.stiffness)] * len(needed)]
        off = [np.linalg.norm(moved(robot, each) - fixed) / np.linalg.norm(fixed) for each in tried]
        errors = " | ".join(f"{100 * each:.2f} %" for each in off)
        print(f"| {name} ({robot.body.mesh.dim}D) | {errors} | {Pin.stiffness / max(needed):.2g} |", flush=True)


if __name__ == "__main__":
    main()
