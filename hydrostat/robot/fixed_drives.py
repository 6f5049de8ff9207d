"""`with_fixed_drives`: a robot whose drives stay at rest."""

from dataclasses import replace

from hydrostat.robot.robot import Robot


def with_fixed_drives(robot: Robot) -> Robot:
    """Return the robot with its drives at rest: pins are fixed, loads that a drive scales do not act."""
    if not robot.drives:
        return robot
    pins = tuple(replace(pin, drive=None) for pin in robot.pins)
    return replace(robot, pins=pins, loads=tuple(load for load in robot.loads if load.drive is None), drives=())
