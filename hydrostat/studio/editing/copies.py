"""`shift_parts`, `paste_parts`: many parts of a robot together, moved or put in once more."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.project import fresh_name
from hydrostat.robot import Pin, Robot
from hydrostat.studio.editing.body_parts import move_body_part, own_parts, with_body_parts
from hydrostat.studio.editing.part import Kind, Mirror, find_part, place_of
from hydrostat.studio.editing.place import move


def spots(robot: Robot, keys: Collection[str]) -> list[str]:
    """Keys of what has a place; a cable by its points after the winch."""
    found: dict[str, None] = {}
    for key in keys:
        part = find_part(robot, key)
        if part is not None and part.kind is Kind.CABLE:
            last = len(robot.cables[part.index].points)
            found.update({f"via:{part.index}:{place}": None for place in range(1, last)})
        elif place_of(robot, key) is not None:
            found[key] = None
    return list(found)


def shift_parts(robot: Robot, keys: Collection[str], way: Sequence[float], mirror: Mirror | None = None) -> Robot:
    """Return the robot with parts, and their mirror twins, moved by a way [m] (InputError: one would lie outside)."""
    own = spots(robot, keys)
    places: dict[str, Point] = {}
    for key in own:
        at = _beside(place_of(robot, key) or (), way)
        if mirror is not None and mirror.holds(robot, key):
            at = mirror.on_plane(at)
        places[key] = at
        twin = mirror.twin(robot, key) if mirror is not None else None
        if mirror is not None and twin is not None and twin not in own:
            places[twin] = mirror.point(at)
    return move(robot, places)


def paste_parts(robot: Robot, source: Robot, keys: Collection[str]) -> tuple[Robot, tuple[str, ...]]:
    """Return the robot with copies of parts of a source, slightly offset, and the keys of the copies.

    A winch brings its cables; a cable alone is laid once more from its own winch. An InputError says that there is no
    room beside them, or that the winch of a cable is gone.
    """
    reach, refused = source.body.mesh.size, InputError("no free space next to the parts")
    # copies lie so far beside what they are of, in sizes of the body, the first that fits
    shares = (0.05, 0.1, 0.2)
    for share in shares:
        for way in _ways(robot.body.mesh.dim):
            try:
                return _with_copies(robot, source, keys, tuple(share * reach * value for value in way))
            except InputError as error:
                refused = error
    raise refused


def _ways(dim: int) -> list[Point]:
    """Directions of the axes, to the right and up first."""
    return [tuple(row) for row in np.concatenate([np.eye(dim), -np.eye(dim)]).tolist()]


def _with_copies(robot: Robot, source: Robot, keys: Collection[str], way: Point) -> tuple[Robot, tuple[str, ...]]:
    made, names = [], {}
    pins, winches, cables, markers = list(robot.pins), list(robot.winches), list(robot.cables), list(robot.markers)
    regions = list(own_parts(robot.body))
    parts = [part for key in dict.fromkeys(keys) if (part := find_part(source, key)) is not None]
    for part in parts:
        if part.kind is Kind.PIN:
            made.append(f"pin:{len(pins)}")
            pins.append(_pin_beside(source.pins[part.index], way))
        elif part.kind is Kind.MARKER:
            marker = source.markers[part.index]
            name = fresh_name(_stem(marker.name), [other.name for other in markers])
            made.append(f"marker:{name}")
            markers.append(replace(marker, name=name, at=_beside(marker.at, way)))
        elif part.kind is Kind.REGION:
            region, middle = source.body.parts[part.index], place_of(source, f"region:{part.index}")
            if middle is None:
                raise InputError(f"part {region.name} cannot be copied here. Copy it in robot.toml")
            made.append(f"region:{len(regions)}")
            name = fresh_name(_stem(region.name), [other.name for other in regions])
            regions.append(replace(move_body_part(region, middle, _beside(middle, way)), name=name))
        elif part.kind is Kind.WINCH:
            winch = source.winches[part.index]
            name = names[winch.name] = fresh_name(_stem(winch.name), [other.name for other in winches])
            made.append(f"winch:{name}")
            winches.append(replace(winch, name=name, at=_beside(winch.at, way)))
    alone = {part.index for part in parts if part.kind is Kind.CABLE}
    for index, cable in enumerate(source.cables):
        if cable.winch in names:
            points = tuple(_beside(point, way) for point in cable.points)
        elif index in alone:
            points = (cable.points[0], *(_beside(point, way) for point in cable.points[1:]))
            robot.winch(cable.winch)
        else:
            continue
        made.append(f"cable:{len(cables)}")
        cables.append(replace(cable, winch=names.get(cable.winch, cable.winch), points=points, name=""))
    grown = {"winches": tuple(winches), "cables": tuple(cables), "markers": tuple(markers)}
    robot = robot if len(regions) == len(own_parts(robot.body)) else with_body_parts(robot, regions)
    return replace(robot, pins=tuple(pins), **grown), tuple(made)


def _pin_beside(pin: Pin, way: Point) -> Pin:
    if pin.at is not None:
        return replace(pin, at=_beside(pin.at, way))
    return replace(pin, box=tuple(_beside(corner, way) for corner in pin.box or ()))


def _beside(at: Point, way: Sequence[float]) -> Point:
    return tuple((np.array(at) + np.array(way)).round(9).tolist())


def _stem(name: str) -> str:
    """A name without the number at its end."""
    stem, _, number = name.rpartition("_")
    return stem if stem and number.isdecimal() else name
