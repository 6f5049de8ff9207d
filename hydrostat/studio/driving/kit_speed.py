"""`kit_speed`: how fast the motors of a robot's kit take in cable."""

import math

from hydrostat.control import FASTEST
from hydrostat.fabrication import choose_motor
from hydrostat.robot import Mount, Robot


def kit_speed(robot: Robot, tension: float) -> tuple[float, str]:
    """The speed of the slowest winch where its cables pull all that they may [m/s], and the motor's name.

    Args:
        robot: with winches; without, the speed is that of motors in general.
        tension: the most that a cable bears [N].
    """
    counts = {winch.name: sum(cable.winch == winch.name for cable in robot.cables) for winch in robot.winches}
    loads = {winch: counts[winch.name] * tension * winch.spool_radius for winch in robot.winches if counts[winch.name]}
    if not loads:
        return FASTEST, ""
    inside = any(winch.mount is Mount.BODY for winch in robot.winches)
    motor = choose_motor("auto", loads.values(), inside=inside, winches=len(loads))
    share = max(1e3 * load / motor.stall_torque for load in loads.values())
    turns = motor.speed / 60 * max(1 - share, _LEAST)
    return 2 * math.pi * min(winch.spool_radius for winch in loads) * turns, motor.title


_LEAST = 0.1
"""Motors that would stall are shown at this share of their free speed: the kit says that they are too weak."""
