"""How far markers of designs move on a finer mesh, by the contractions of the mesh that they were designed on.

    python lab/designs/design_meshes.py DESIGN ... [--finer 0.6]

DESIGN is a folder of `hydrostat design`. Columns: nodes of its mesh and of one with elements of `--finer` times the
length, rms difference of the places of all markers over all poses [mm], the same as a share of their moves from rest,
and whether `hydrostat check` warns of few elements across a limb.
"""

import argparse
import json
from pathlib import Path
from shutil import copytree
from tempfile import TemporaryDirectory

from machine import machine

import numpy as np  # isort: skip

from hydrostat.robot import Robot, find_risks, load_robot, with_values
from hydrostat.simulation import Simulation


def meshed_finer(robot: Robot, folder: Path, factor: float) -> Robot:
    """The robot of a folder with shorter elements."""
    assert robot.body.element_size is not None
    text = with_values((folder / "robot.toml").read_text(), element_size=factor * robot.body.element_size)
    with TemporaryDirectory() as copy:
        copytree(folder, copy, dirs_exist_ok=True)
        (Path(copy) / "robot.toml").write_text(text)
        return load_robot(copy)


def row(design: Path, factor: float) -> str:
    """One line of the table."""
    robot = load_robot(design / "robot")
    finer = meshed_finer(robot, design / "robot", factor)
    both = Simulation(robot), Simulation(finer)
    apart, moved = [], []
    for pose in json.loads((design / "score.json").read_text())["poses"].values():
        one, other = (simulation.solve(pose["contractions"], strict=False).markers for simulation in both)
        apart += [np.subtract(one[marker.name], other[marker.name]) for marker in robot.markers]
        moved += [np.subtract(one[marker.name], marker.at) for marker in robot.markers]
    mean = [float(np.sqrt(np.mean(np.sum(np.square(ways), axis=1)))) for ways in (apart, moved)]
    nodes = " | ".join(str(len(one.body.mesh.nodes)) for one in (robot, finer))
    warned = "yes" if any("elements across" in risk for risk in find_risks(robot)) else "no"
    return f"| {design.name} | {nodes} | {1e3 * mean[0]:.2f} | {100 * mean[0] / mean[1]:.0f} % | {warned} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("designs", nargs="+", type=Path)
    parser.add_argument("--finer", type=float, default=0.6)
    given = parser.parse_args()
    print(machine())
    print("| design | nodes | nodes, finer mesh | shift mm | of the motion | warning |\n|---|---|---|---|---|---|")
    for design in given.designs:
        print(row(design, given.finer), flush=True)


if __name__ == "__main__":
    main()
