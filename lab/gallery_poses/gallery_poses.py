"""How well the robots in space of the gallery reach their poses.

    python lab/gallery_poses/gallery_poses.py [NAME ...] [--element-size 4.72] [--contact]

For every robot the size of its mesh, and for each pose how far its markers are from their targets (root of the mean
square) at rest and after inverse kinematics, and whether the body then passes through itself. The targets are rounded
to whole millimeters, so about 0.5 mm is left even where a pose can be reached. They are made for the element size of
the robot's file; another one can be tried.
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.geometry import find_crossings, tetrahedralize
from hydrostat.robot import Robot, gallery_folder, list_gallery


def in_space(names: Sequence[str]) -> list[Robot]:
    """The robots of these names that are no flat drawings."""
    robots = [hs.load_robot(gallery_folder(name)) for name in names]
    return [robot for robot in robots if robot.body.mesh.dim == 3]


def meshed(robot: Robot, element_size: float) -> Robot:
    """The robot with elements of another size [m]."""
    healing = robot.body.healing
    if healing is None:
        raise InputError(f"{robot.name} has no surface to fill with other elements")
    return replace(robot, body=replace(robot.body, mesh=tetrahedralize(healing.surface, element_size)))


def rest_error(robot: Robot, pose: hs.PoseTarget) -> float:
    """Distance of the markers from the targets of a pose while nothing pulls [m], root of the mean square."""
    places = {marker.name: marker.at for marker in robot.markers}
    squares = [np.sum(np.subtract(places[name], target) ** 2) for name, target in pose.targets.items()]
    return float(np.sqrt(np.mean(squares)))


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="robots; all of the gallery if left out")
    parser.add_argument("--element-size", type=float, help="length of a mesh edge [mm] instead of each file's")
    parser.add_argument("--contact", action="store_true", help="bodies that feel themselves")
    options = parser.parse_args(arguments)
    print(machine())
    print("| robot | nodes | elements | pose | at rest mm | reached mm | crosses itself | largest tension N | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for kept in in_space(options.names or list_gallery()):
        robot = meshed(kept, 1e-3 * options.element_size) if options.element_size else kept
        robot = replace(robot, contact=hs.Contact() if options.contact else None)
        simulation = hs.Simulation(robot)
        simulation.solve({})  # compiles
        size = f"{robot.name} | {len(robot.body.mesh.nodes)} | {len(robot.body.mesh.elements)}"
        for name, pose in robot.poses.items():
            start = time.process_time()
            reached = hs.solve_ik(simulation, pose)
            spent = time.process_time() - start
            errors = f"{1e3 * rest_error(robot, pose):.1f} | {1e3 * reached.rms_error:.2f}"
            crosses = "yes" if len(find_crossings(robot.body.mesh, reached.pose.nodes)) else "no"
            print(f"| {size} | {name} | {errors} | {crosses} | {reached.pose.tensions.max():.1f} | {spent:.1f} |")


if __name__ == "__main__":
    main()
