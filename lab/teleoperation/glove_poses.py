"""Poses that a glove commands, as Chang (2018) shows them in Fig 5.6: above the shown pose, below the robot by the map.

    hydrostat mimic gallery:cupping_hand --glove emulated --count 30 --out build/glove
    python lab/teleoperation/glove_poses.py gallery:cupping_hand build/glove

The map is learned from all poses but the last three. Three of these, and the last three, which are new to it, are drawn
to glove_poses.png. Of an emulated hand, what is shown is the pose that it copied.
"""

import sys
from pathlib import Path

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.robot import load_robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.teleop import Mimicry
from hydrostat_lab.learning_figures import draw_side_by_side

NEW = 3


def main(source: str, folder: Path) -> None:
    """Print the largest marker error of each pose [mm], and draw all."""
    simulation, made = Simulation(load_robot(source)), Mimicry.open(folder / "poses.csv")
    known = Mimicry(made.sensors, made.outputs)
    for row in range(len(made.poses) - NEW):
        known.add(made.poses[row], made.inputs[row], made.answers[row])
    told = known.learn()(made.inputs)
    columns: dict[str, list[Nodes]] = {}
    for number, row in enumerate([0, 1, 2, *range(-NEW, 0)]):
        shown, robot = (solve(simulation, values) for values in (made.answers[row], told[row]))
        error = max(float(np.linalg.norm(robot.markers[name] - place)) for name, place in shown.markers.items())
        name = f"{'training' if row >= 0 else 'new'} {number % NEW + 1}: {1e3 * error:.1f} mm"
        print(name)
        columns[name] = [shown.nodes, robot.nodes]
    draw_side_by_side(simulation.robot, columns, width=1.7).savefig(folder / "glove_poses.png", dpi=150)


def solve(simulation: Simulation, contractions: Vector) -> Equilibrium:
    """Equilibrium at contractions, within travel."""
    return simulation.solve(np.clip(contractions, 0.0, [winch.travel for winch in simulation.robot.winches]))


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
