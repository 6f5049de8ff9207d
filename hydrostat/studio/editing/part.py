"""`Part`: what a key such as "winch:left" or "via:0:2" names in a robot; `Mirror`: twins on both sides of a plane."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.given import Point
from hydrostat.robot import Robot
from hydrostat.studio.editing.body_parts import middle_of, own_parts


class Kind(StrEnum):
    """Kind of a part."""

    PIN = "pin"
    WINCH = "winch"
    CABLE = "cable"
    VIA = "via"
    MARKER = "marker"
    REGION = "region"


@dataclass(frozen=True, kw_only=True)
class Part:
    """One part of a robot."""

    kind: Kind  # what it is
    index: int  # its number among the pins, winches, cables, markers or regions of another material
    place: int = 0  # number of the point of a cable, for a via point


def find_part(robot: Robot, key: str) -> Part | None:
    """The part that a key names; None if the robot has none such."""
    kind, _, rest = key.partition(":")
    if kind == Kind.PIN:
        return _parse_numbered(Kind.PIN, rest, len(robot.pins))
    if kind == Kind.CABLE:
        return _parse_numbered(Kind.CABLE, rest, len(robot.cables))
    if kind == Kind.REGION:
        return _parse_numbered(Kind.REGION, rest, len(own_parts(robot.body)))
    if kind == Kind.WINCH:
        return _parse_named(Kind.WINCH, rest, [winch.name for winch in robot.winches])
    if kind == Kind.MARKER:
        return _parse_named(Kind.MARKER, rest, [marker.name for marker in robot.markers])
    if kind == Kind.VIA:
        index, _, place = rest.partition(":")
        cable = _parse_numbered(Kind.CABLE, index, len(robot.cables))
        if cable is not None and place.isdecimal() and 0 < int(place) < len(robot.cables[cable.index].points):
            return Part(kind=Kind.VIA, index=cable.index, place=int(place))
    return None


def place_of(robot: Robot, key: str) -> Point | None:
    """Place of a part [m]; None for a cable, which is in many places, a region without one, and what there is not."""
    part = find_part(robot, key)
    if part is None or part.kind is Kind.CABLE:
        return None
    if part.kind is Kind.PIN:
        pin = robot.pins[part.index]
        return pin.at if pin.at is not None else tuple(np.mean(pin.box or (), axis=0).tolist())
    if part.kind is Kind.VIA:
        return robot.cables[part.index].points[part.place]
    if part.kind is Kind.REGION:
        return middle_of(robot.body.parts[part.index], robot.body.mesh.dim)
    return (robot.winches if part.kind is Kind.WINCH else robot.markers)[part.index].at


def keys_of(robot: Robot) -> list[str]:
    """The keys of all pins, winches, cables, markers and regions, each cable after its winch."""
    keys = [f"pin:{index}" for index in range(len(robot.pins))]
    for winch in robot.winches:
        keys.append(f"winch:{winch.name}")
        keys += [f"cable:{index}" for index, cable in enumerate(robot.cables) if cable.winch == winch.name]
    keys += [f"marker:{marker.name}" for marker in robot.markers]
    return [*keys, *(f"region:{index}" for index in range(len(own_parts(robot.body))))]


def name_of(robot: Robot, key: str) -> str:
    """Name of a winch, cable, marker or region; "" for what has none."""
    part = find_part(robot, key)
    named = {Kind.WINCH: robot.winches, Kind.CABLE: robot.cables, Kind.MARKER: robot.markers}
    named[Kind.REGION] = robot.body.parts
    return "" if part is None or part.kind not in named else named[part.kind][part.index].name


def title_of(key: str) -> str:
    """A part as a person would call it: "cable 1", "winch left", "point 2 of cable 1"."""
    kind, _, rest = key.partition(":")
    if kind == Kind.VIA:
        index, _, place = rest.partition(":")
        return f"point {place} of cable {int(index) + 1}"
    return f"{kind} {int(rest) + 1}" if kind in (Kind.PIN, Kind.CABLE, Kind.REGION) else f"{kind} {rest}"


def _parse_numbered(kind: Kind, text: str, count: int) -> Part | None:
    return Part(kind=kind, index=int(text)) if text.isdecimal() and int(text) < count else None


def _parse_named(kind: Kind, name: str, names: list[str]) -> Part | None:
    return Part(kind=kind, index=names.index(name)) if name in names else None


TWIN_TOLERANCE = 1e-3  # what is so near to the mirrored place, as a share of the body, is the twin


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
        """Return True if a part is on the plane."""
        at = place_of(robot, key)
        return at is not None and abs(at[self.axis]) <= TWIN_TOLERANCE * robot.body.mesh.size

    def near(self, robot: Robot, at: Point) -> bool:
        """Return True if a new part there is meant to be on the plane."""
        on_plane = 0.01  # what is placed so near to the plane, as a share of the body, is put on it
        return abs(at[self.axis]) <= on_plane * robot.body.mesh.size

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
            Kind.REGION: [f"region:{index}" for index in range(len(own_parts(robot.body)))],
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
        placed = [(other, place) for other in keys if (place := place_of(robot, other)) is not None]
        if at is None or not placed:
            return None
        gaps = np.linalg.norm(np.array([place for _, place in placed]) - np.array(self.point(at)), axis=1)
        least = int(np.argmin(gaps))
        return placed[least][0] if gaps[least] <= TWIN_TOLERANCE * robot.body.mesh.size else None

    def _cable(self, robot: Robot, index: int) -> int | None:
        own = np.array([self.point(point) for point in robot.cables[index].points])
        for number, cable in enumerate(robot.cables):
            if number != index and len(cable.points) == len(own):
                gaps = np.linalg.norm(np.array(cable.points) - own, axis=1)
                if gaps.max() <= TWIN_TOLERANCE * robot.body.mesh.size:
                    return number
        return None
