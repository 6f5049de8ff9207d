"""`sewn_robot`: flat robot with each cable as often as it is sewn; `describe_cable_side`: side of its cables."""

from dataclasses import replace

from hydrostat.robot.cable import Cable
from hydrostat.robot.checks import LONGEST_NAME
from hydrostat.robot.face import Face
from hydrostat.robot.robot import Robot


def sewn_robot(robot: Robot) -> Robot:
    """Return the flat robot with each cable as often as it is sewn: in pairs, all front cables, then all back ones.

    Both of a pair are as stiff as the one that is drawn. A robot whose cables are no pairs is given back as it is.
    """
    if robot.face is not Face.PAIRS:
        return robot
    sewn = tuple(replace(cable, name=side_name(cable, side)) for side in Face.PAIRS.sides for cable in robot.cables)
    return replace(robot, cables=sewn, face=None)


def sewn_sides(robot: Robot) -> tuple[str, ...]:
    """Panels on which the cables of a flat plush robot are sewn: the front where it does not say, or cannot be."""
    return (robot.face.sides if robot.face else ()) or Face.FRONT.sides


def side_name(cable: Cable, side: str) -> str:
    """Such as "left 1 back"; nothing, so that a robot gives it one, where that is longer than a name may be."""
    name = f"{cable.name} {side}"
    return name if len(name) <= LONGEST_NAME else ""


def describe_cable_side(robot: Robot) -> str:
    """Describe the side of a flat robot's cables, such as "on the front"; empty in space or without cables."""
    if robot.body.mesh.dim != 2 or not robot.cables:
        return ""
    return _UNSAID if robot.face is None else robot.face.words


_UNSAID = 'side not set: a plush kit uses the front panel. Set face = "pairs" above [body] to use both panels'
