"""`Marker`: a tracked point, such as a fingertip."""

from dataclasses import dataclass

from hydrostat.errors import InputError
from hydrostat.robot.checks import check_point
from hydrostat.robot.point import Point


@dataclass(frozen=True, kw_only=True)
class Marker:
    """A named point stuck to the body.

    Attributes:
        name: unique in the robot.
        at: place in the rest pose [m].
    """

    name: str
    at: Point

    def __post_init__(self) -> None:
        if not self.name:
            raise InputError("name must not be empty")
        check_point("at", self.at)
