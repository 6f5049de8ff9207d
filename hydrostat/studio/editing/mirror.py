"""`Mirror`: twins on both sides of a plane."""

from dataclasses import dataclass

import numpy as np

from hydrostat.robot import Point, Robot
from hydrostat.studio.editing.part import Kind, find_part, place_of

SAME = 1e-3  # what is so near to the mirrored place, as a share of the body, is the twin
ON_PLANE = 0.01  # what is placed so near to the plane, as a share of the body, is put on it


@dataclass(frozen=True, kw_only=True)
class Mirror:
    """The plane in which one coordinate is 0."""

    axis: int  # number of that coordinate

    def point(self, at: Point) -> Point:
        """The place on the other side."""
        return tuple(0.0 - value if axis == self.axis else value for axis, value in enumerate(at))

    def on_plane(self, at: Point) -> Point:
        """The nearest place on the plane."""
        return tuple(0.0 if axis == self.axis else value for axis, value in enumerate(at))

    def holds(self, robot: Robot, key: str) -> bool:
        """Tell whether a part is on the plane."""
        at = place_of(robot, key)
        return at is not None and abs(at[self.axis]) <= SAME * robot.body.mesh.size

    def near(self, robot: Robot, at: Point) -> bool:
        """Tell whether a new part there is meant to be on the plane."""
        return abs(at[self.axis]) <= ON_PLANE * robot.body.mesh.size

    def twin(self, robot: Robot, key: str) -> str | None:
        """The part of the same kind at the mirrored place; None for a part on the plane, or without a twin."""
        part = find_part(robot, key)
        if part is None or self.holds(robot, key):
            return None
        if part.kind is Kind.CABLE:
            twin = self._cable(robot, part.index)
            return None if twin is None else f"cable:{twin}"
        if part.kind is Kind.VIA:
            return self._via(robot, part.index, part.place)
        keys = {
            Kind.PIN: [f"pin:{index}" for index in range(len(robot.pins))],
            Kind.WINCH: [f"winch:{winch.name}" for winch in robot.winches],
            Kind.MARKER: [f"marker:{marker.name}" for marker in robot.markers],
        }[part.kind]
        return self._nearest(robot, key, [other for other in keys if other != key])

    def _via(self, robot: Robot, index: int, place: int) -> str | None:
        """The same point of the twin cable; if it has none, any point of another cable that is there."""
        cable = self._cable(robot, index)
        if cable is not None:
            return f"via:{cable}:{place}"
        keys = [
            f"via:{number}:{other}"
            for number, cable in enumerate(robot.cables)
            for other in range(1, len(cable.points))
            if (number, other) != (index, place)
        ]
        return self._nearest(robot, f"via:{index}:{place}", keys)

    def _nearest(self, robot: Robot, key: str, keys: list[str]) -> str | None:
        at = place_of(robot, key)
        places = [place_of(robot, other) for other in keys]
        if at is None or not places:
            return None
        gaps = np.linalg.norm(np.array(places) - np.array(self.point(at)), axis=1)
        least = int(np.argmin(gaps))
        return keys[least] if gaps[least] <= SAME * robot.body.mesh.size else None

    def _cable(self, robot: Robot, index: int) -> int | None:
        own = np.array([self.point(point) for point in robot.cables[index].points])
        for number, cable in enumerate(robot.cables):
            if number != index and len(cable.points) == len(own):
                gaps = np.linalg.norm(np.array(cable.points) - own, axis=1)
                if gaps.max() <= SAME * robot.body.mesh.size:
                    return number
        return None
