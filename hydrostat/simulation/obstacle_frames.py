"""Forces on obstacles, and guides that move them."""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from hydrostat.arrays import Float, Points, Vector
from hydrostat.mechanics import Energy
from hydrostat.robot import Obstacle, Robot
from hydrostat.simulation.equilibrium import Equilibrium

if TYPE_CHECKING:
    from hydrostat.simulation.simulation import Simulation


def obstacle_forces(simulation: "Simulation", pose: Equilibrium) -> Float[np.ndarray, "obstacles dim"]:
    """Force of the body on each obstacle at an equilibrium [N], friction included."""
    assembly = simulation.path.with_history(pose) if simulation.assembly.has_history else simulation.assembly
    forces = [assembly.energies[slot].push(pose.unknowns) for slot in simulation.body.obstacles]  # type: ignore[attr-defined]
    return np.array(forces).reshape(len(forces), pose.nodes.shape[1])


def with_replaced(simulation: "Simulation", old: Energy, new: Energy) -> "Simulation":
    """Return the same physics with one of its energies replaced by another state, such as a moved guide."""
    other = copy(simulation)
    for name in ("rest", "rest_stiffness", "path", "dynamics"):
        other.__dict__.pop(name, None)
    other.assembly = simulation.assembly.with_energies(
        [new if one is old else one for one in simulation.assembly.energies]
    )
    other.solver = replace(simulation.solver, assembly=other.assembly)
    return other


def carried_frames(robot: Robot, carried: Points | None) -> dict[str, tuple[Vector, Float[np.ndarray, "axes dim"]]]:
    """Place [m] and axes of each obstacle that moves, by name, from its unknowns."""
    if carried is None:
        return {}
    free = [obstacle for obstacle in robot.obstacles if obstacle.mass is not None]
    moving = free + [obstacle for obstacle in robot.obstacles if obstacle.path]
    frames = {}
    for obstacle, rows in zip(moving, carried.reshape(-1, 1 + carried.shape[1], carried.shape[1]), strict=False):
        place, axes = obstacle.frame()
        turned = rows[1:] / np.linalg.norm(rows[1:], axis=1, keepdims=True)
        frames[obstacle.name] = (place + rows[0], axes) if obstacle.path else (rows[0], turned)
    return frames


def obstacles_in_pose(robot: Robot, carried: Points | None) -> Robot:
    """Return the robot with its obstacles at the positions of their unknowns, for pictures, without checks."""
    frames = carried_frames(robot, carried)
    if not frames:
        return robot
    return with_obstacles(
        robot, [one.with_frame(*frames[one.name]) if one.name in frames else one for one in robot.obstacles]
    )


def with_obstacles(robot: Robot, obstacles: Sequence[Obstacle]) -> Robot:
    """Return the robot with other obstacles, for pictures, without checks of their positions."""
    other = copy(robot)
    object.__setattr__(other, "obstacles", tuple(obstacles))
    return other
