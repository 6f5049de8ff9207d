"""What layers of cable on spools do to a pose, told as contractions, before and after a ruler has measured them.

    python lab/spool_layers/spool_layers.py examples/cupping_hand

Every winch has a hidden spool: 1 % larger than robot.toml says, with another layer of 0.4 mm after each turn. A ruler
of half millimeters reads seven places over the travel. Each winch alone is then told to take in 90 % of its travel: by
the spool of robot.toml, and by its measured curve. Errors are of the cable, and of the node of the body that is
furthest from the pose that was meant.
"""

import argparse

import numpy as np
from machine import machine

import hydrostat as hs
from hydrostat.control import Calibration, SpoolCurve, add_cable_layers

STOPS, RULER = 7, 5e-4


def measured(known: Calibration, true: Calibration, travels: list[float]) -> Calibration:
    """What the ruler finds of hidden spools."""
    found = []
    for motor, hidden, travel in zip(known.motors, true.motors, travels, strict=True):
        turned = np.array([motor.angle(goal) for goal in np.linspace(0.0, travel, STOPS).tolist()])
        read = np.array([RULER * round(hidden.contraction(angle) / RULER) for angle in turned.tolist()])
        found.append(SpoolCurve.fit(motor, turned, read).motor)
    return Calibration(tuple(found))


def main() -> None:
    """Print the errors of each pose."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robot")
    folder = parser.parse_args().robot
    robot = hs.load_robot(folder)
    known = Calibration.usual(robot).assume_zeros(robot)
    true = add_cable_layers(known)
    curves = measured(known, true, [winch.travel for winch in robot.winches])
    simulation = hs.Simulation(robot)
    print(machine(), flush=True)
    for index, winch in enumerate(robot.winches):
        pose = np.zeros(len(robot.winches))
        pose[index] = 0.9 * winch.travel
        meant = simulation.solve(pose, strict=False)
        words, good = [], meant.result.converged
        for name, calibration in (("robot.toml", known), ("curve", curves)):
            taken = true.contractions(calibration.angles(pose))
            got = simulation.solve(taken, start=meant, strict=False)
            away = np.linalg.norm(got.nodes - meant.nodes, axis=1).max()
            words.append(f"by {name} {1e3 * (taken - pose)[index]:+.2f} mm of cable, body {1e3 * away:.2f} mm")
            good &= got.result.converged
        print(f"{winch.name}, {1e3 * pose[index]:.0f} mm: {'; '.join(words)}{'' if good else ' (not converged)'}")


if __name__ == "__main__":
    main()
