"""`Marker`, `PoseTarget`: named points of a body, and where they should be in a pose."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hydrostat.errors import InputError
from hydrostat.given import Point, check_point


@dataclass(frozen=True, kw_only=True)
class Marker:
    """Named point on the body to track.

    Attributes:
        name: name, unique in the robot.
        at: position in the rest pose [m].
    """

    name: str
    at: Point

    def __post_init__(self) -> None:
        if not self.name:
            raise InputError("name must not be empty")
        check_point("at", self.at)


@dataclass(frozen=True, kw_only=True)
class PoseTarget:
    """Target positions for some markers.

    Attributes:
        name: name, unique in the robot.
        targets: target position of each named marker [m].
    """

    name: str
    targets: Mapping[str, Point]

    def __post_init__(self) -> None:
        if not self.name:
            raise InputError("name must not be empty")
        if not self.targets:
            raise InputError("targets must name at least one marker")
        for name, target in self.targets.items():
            check_point(f"targets.{name}", target)

    def mean_square_error(self, places: Mapping[str, Point]) -> float:
        """Return the mean squared distance of markers at given positions [m] from their targets [m^2]."""
        return float(np.mean([np.sum((np.array(places[name]) - goal) ** 2) for name, goal in self.targets.items()]))
