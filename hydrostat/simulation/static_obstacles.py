"""Statics of obstacles: `require_static_obstacles` refuses moving ones; `without_contact_friction` returns a robot."""

from dataclasses import replace

from hydrostat.errors import InputError
from hydrostat.robot import Robot


def without_contact_friction(robot: Robot) -> Robot:
    """Return the same robot without contact friction; itself if there is none."""
    rubs = robot.contact is not None and robot.contact.friction > 0
    if not rubs and not any(map(robot.friction_of, robot.obstacles)):
        return robot
    contact = None if robot.contact is None else replace(robot.contact, friction=0.0)
    obstacles = tuple(replace(obstacle, friction=None) for obstacle in robot.obstacles)
    return replace(robot, contact=contact, obstacles=obstacles)


def require_static_obstacles(robot: Robot, what: str) -> None:
    """Check that no obstacle moves.

    Args:
        robot: robot to check.
        what: does not know obstacles that move, in words.

    Raises:
        InputError: one has a mass.
    """
    for obstacle in robot.obstacles:
        if obstacle.mass is not None:
            name = obstacle.name
            raise InputError(f'{what} knows no obstacle that moves: "{name}" has a mass; without it, it stands still')


def rests_at_first(robot: Robot) -> bool:
    """Return True if statics determines the initial state: pins hold the robot, and no obstacle is free to move."""
    return bool(robot.pins) and all(obstacle.mass is None for obstacle in robot.obstacles)
