"""Which elements a body in space pays for: errors of markers and time of a pose, by kind and size of the elements.

    python lab/coarseness/space.py

The first winch takes in 0.3 of its travel. Sizes are shares of the element size in robot.toml. The reference has
quadratic elements of 0.9 of that size. Meshes of other sizes have other surfaces and held nodes; errors include this.
"""

import time
from dataclasses import replace

import numpy as np
from machine import machine

from hydrostat.robot import Body, Robot, Volume, gallery_folder, load_robot
from hydrostat.simulation import Simulation

BODIES = ("octopus_arm", "tongue", "fish_tail")
REFERENCE = ("quadratic", 0.9)
KINDS = (("linear", 1.0), ("patch", 1.0), ("patch", 0.65), ("quadratic", 1.7), ("quadratic", 1.41), ("quadratic", 1.0))


def meshed(robot: Robot, kind: str, share: float) -> Robot:
    """Robot with elements of a kind and size."""
    body = robot.body
    assert body.element_size is not None
    given = {"file": body.file, "unit": 1e-3, "material": body.material, "size": body.size}
    volume = Volume.PATCH if kind == "patch" else Volume.ELEMENT
    made = Body.from_surface(body.content, **given, element_size=share * body.element_size, volume=volume)
    return replace(robot, body=made.with_elements("quadratic" if kind == "quadratic" else "linear"))


def pose(robot: Robot) -> tuple[np.ndarray, float]:
    """Places of the markers [m] and CPU time of the pose from rest [ms], the second of two."""
    pull, simulation = {robot.winches[0].name: 0.3 * robot.winches[0].travel}, Simulation(robot)
    simulation.solve(pull)
    began = time.process_time()
    found = simulation.solve(pull)
    spent = 1e3 * (time.process_time() - began)
    return np.array([found.markers[marker.name] for marker in robot.markers]), spent


def main() -> None:
    print(f"{machine()}\n\n| robot | elements, size | nodes | error, share of travel | ms |\n|---|---|---|---|---|")
    for name in BODIES:
        robot = load_robot(gallery_folder(name))
        true, _ = pose(meshed(robot, *REFERENCE))
        travel = np.linalg.norm(true - np.array([marker.at for marker in robot.markers]), axis=1).max()
        for kind, share in KINDS:
            tried = meshed(robot, kind, share)
            places, spent = pose(tried)
            error = np.linalg.norm(places - true, axis=1).max() / travel
            nodes = len(tried.body.mesh.nodes)
            print(f"| {name} | {kind}, {share:g} | {nodes} | {100 * error:.1f} % | {spent:.0f} |", flush=True)


if __name__ == "__main__":
    main()
