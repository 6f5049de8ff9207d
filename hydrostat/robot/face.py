"""`Face`: on which face of a flat robot its cables run once it is filled; `sewn_robot`: each as often as it is sewn."""

from dataclasses import replace
from enum import StrEnum
from typing import TYPE_CHECKING

from hydrostat.robot.cable import Cable
from hydrostat.robot.checks import LONGEST_NAME

if TYPE_CHECKING:
    from hydrostat.robot.robot import Robot


class Face(StrEnum):
    """Where the cables of a flat robot run once it is filled."""

    FRONT = "front"  # sewn on the panel that is looked at
    BACK = "back"  # on the other one
    PAIRS = "pairs"  # each twice, on both panels, pulled together
    MIDDLE = "middle"  # through the filling, half way between

    @property
    def words(self) -> str:
        """Such as "on both faces, in pairs"."""
        return _WORDS[self]

    @property
    def sides(self) -> tuple[str, ...]:
        """Panels on which cables are sewn, by their names; none for the middle."""
        return _SIDES[self]

    @property
    def flat(self) -> bool:
        """Whether cables there keep a body in its plane, but for fractions of a millimetre (decision 0029)."""
        return self in (Face.PAIRS, Face.MIDDLE)


_WORDS = {
    Face.FRONT: "on the front",
    Face.BACK: "on the back",
    Face.PAIRS: "on both faces, in pairs",
    Face.MIDDLE: "in the middle",
}
_SIDES = {Face.FRONT: ("front",), Face.BACK: ("back",), Face.PAIRS: ("front", "back"), Face.MIDDLE: ()}


def sewn_robot(robot: "Robot") -> "Robot":
    """The flat robot with each cable as often as it is sewn: in pairs all those of the front, then all of the back.

    Both of a pair are as stiff as the one that is drawn. A robot whose cables are no pairs is given back as it is.
    """
    if robot.face is not Face.PAIRS:
        return robot
    sewn = tuple(replace(cable, name=side_name(cable, side)) for side in Face.PAIRS.sides for cable in robot.cables)
    return replace(robot, cables=sewn, face=None)


def side_name(cable: Cable, side: str) -> str:
    """Such as "left 1 back"; nothing, so that a robot gives it one, where that is longer than a name may be."""
    name = f"{cable.name} {side}"
    return name if len(name) <= LONGEST_NAME else ""


def face_words(robot: "Robot") -> str:
    """Where the cables of a flat robot run, such as "on the front"; empty for one in space or without cables."""
    if robot.body.mesh.dim != 2 or not robot.cables:
        return ""
    return _UNSAID if robot.face is None else robot.face.words


_UNSAID = (
    'not said where: a plush kit sews them on the front alone; face = "pairs" before [body] has them on both faces'
)
