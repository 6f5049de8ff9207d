"""What meets a robot: forces on obstacles, guides that move them, physics without their friction."""

from copy import copy
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from hydrostat.errors import InputError
from hydrostat.mechanics import Energy
from hydrostat.robot import Robot
from hydrostat.simulation.solved_pose import SolvedPose

if TYPE_CHECKING:
    from hydrostat.simulation.simulation import Simulation


def obstacle_forces(simulation: "Simulation", pose: SolvedPose) -> Float[np.ndarray, "obstacles dim"]:
    """Force of the body on each obstacle at an equilibrium [N], friction included."""
    assembly = simulation.path.resumed(pose) if simulation.assembly.has_history else simulation.assembly
    forces = [assembly.energies[slot].push(pose.unknowns) for slot in simulation.body.obstacles]  # type: ignore[attr-defined]
    return np.array(forces).reshape(len(forces), pose.nodes.shape[1])


def replacing(simulation: "Simulation", old: Energy, new: Energy) -> "Simulation":
    """The same physics with one of the energies given to it in another state, such as a guide that has moved.

    Args:
        simulation: made with `energies=[old, ...]`.
        old: one of them.
        new: what takes its place, on the same stencils.
    """
    other = copy(simulation)
    for name in ("rest", "rest_stiffness", "path", "dynamics"):
        other.__dict__.pop(name, None)
    other.assembly = simulation.assembly.with_energies(
        [new if one is old else one for one in simulation.assembly.energies]
    )
    other.solver = replace(simulation.solver, assembly=other.assembly)
    return other


def smooth_robot(robot: Robot) -> Robot:
    """The same robot without friction on obstacles; itself where there is none."""
    if not any(map(robot.friction_of, robot.obstacles)):
        return robot
    contact = None if robot.contact is None else replace(robot.contact, friction=0.0)
    obstacles = tuple(replace(obstacle, friction=None) for obstacle in robot.obstacles)
    return replace(robot, contact=contact, obstacles=obstacles)


def check_still(robot: Robot, what: str) -> None:
    """Check that no obstacle moves.

    Args:
        robot: which.
        what: does not know obstacles that move, in words.

    Raises:
        InputError: one has a mass.
    """
    for obstacle in robot.obstacles:
        if obstacle.mass is not None:
            name = obstacle.name
            raise InputError(f'{what} knows no obstacle that moves: "{name}" has a mass; without it, it stands still')
