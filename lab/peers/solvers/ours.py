"""hydrostat itself, through what its users call, with the same body, pins and forces.

Variants: "kept", a `Simulation` that is there already, with the body's Hessian at rest factorized; "again", the body's
physics made for every solve. An answer is a solve of its own, each with a smaller tolerance, and its own time.
"""

import sys
import time
from dataclasses import asdict
from pathlib import Path

import numpy as np
from held_body import HeldBody, Trail

import hydrostat as hs
from hydrostat.geometry import Mesh
from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import Body, Material, Pin, Robot, Source

PIN_STIFFNESS = 2e8
"""Of each held node [N/m]: 1 N moves it by 5 nm."""

TOLERANCES = (0.1, 1e-2, 1e-4, 1e-10)


def robot_of(body: HeldBody) -> Robot:
    """A robot without cables: the forces are its weight."""
    mesh = Mesh(body.nodes, body.elements)
    density = float(body.masses.sum() / mesh.volumes.sum())
    material = Material(young=body.young, poisson=body.poisson, density=density)
    pull = body.forces.sum(axis=0) / body.masses.sum()
    return Robot(
        name="held",
        body=Body(source=Source.MESH, file="held.vtu", content=b"", material=material, mesh=mesh),
        pins=tuple(Pin(at=tuple(place.tolist()), stiffness=PIN_STIFFNESS) for place in body.nodes[body.held]),
        poses={},
        gravity=tuple(pull.tolist()),
    )


def solved(robot: Robot, tolerance: float, known: hs.Simulation | None) -> tuple[float, np.ndarray]:
    """CPU time of a solve from rest [s], and its nodes; physics that are known are used."""
    options = NewtonOptions(tolerance=tolerance)
    began = time.process_time()
    simulation = hs.Simulation(robot, options=options, body=known.body if known else None)
    pose = simulation.solve({}, strict=False)
    return time.process_time() - began, pose.nodes


def main() -> None:
    """Time all solves: `python ours.py BODY.npz VARIANT BUDGET TRAIL.npz`."""
    given, variant, _, result = sys.argv[1:]
    robot = robot_of(HeldBody.load(Path(given)))
    known = hs.Simulation(robot)
    known.solve({}, strict=False)
    ready = time.process_time()
    known = known if variant == "kept" else None
    runs = [
        min((solved(robot, tolerance, known) for _ in range(3)), key=lambda run: run[0]) for tolerance in TOLERANCES
    ]
    seconds = np.maximum.accumulate([run[0] for run in runs])
    trail = Trail(seconds, np.array([run[1] for run in runs]), ready, done=True)
    np.savez(result, **asdict(trail))


if __name__ == "__main__":
    main()
