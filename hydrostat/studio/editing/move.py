"""`move`: parts of a robot at other places."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from hydrostat.errors import InputError
from hydrostat.robot import Cable, Pin, Point, Robot
from hydrostat.studio.editing.part import Kind, find_part, place_of


def move(robot: Robot, places: Mapping[str, Point]) -> Robot:
    """The same robot with parts elsewhere; cables stay at their winches.

    Args:
        robot: as it was.
        places: where pins, winches, via points and markers go [m], by key.

    Raises:
        InputError: no such part, or a place where it cannot be.
    """
    pins, winches, markers = list(robot.pins), list(robot.winches), list(robot.markers)
    points = [list(cable.points) for cable in robot.cables]
    for key, at in places.items():
        part, before = find_part(robot, key), place_of(robot, key)
        if part is None or before is None:
            raise InputError(f"{key} cannot be moved")
        if part.kind is Kind.PIN:
            pins[part.index] = _pin(robot.pins[part.index], before, at)
        elif part.kind is Kind.MARKER:
            markers[part.index] = replace(robot.markers[part.index], at=at)
        elif part.kind is Kind.VIA:
            points[part.index][part.place] = at
        else:
            winch = robot.winches[part.index]
            winches[part.index] = replace(winch, at=at)
            for own, cable in zip(points, robot.cables, strict=True):
                if cable.winch == winch.name:
                    own[0] = _along(cable.points[0], before, at)
    return replace(
        robot, pins=tuple(pins), winches=tuple(winches), cables=_rerun(robot.cables, points), markers=tuple(markers)
    )


def _pin(pin: Pin, before: Point, at: Point) -> Pin:
    if pin.box is None:
        return replace(pin, at=at)
    return replace(pin, box=tuple(_along(corner, before, at) for corner in pin.box))


def _along(point: Point, before: Point, at: Point) -> Point:
    """A point that goes along with what it is at."""
    return at if point == before else tuple((np.array(point) + np.subtract(at, before)).tolist())


def _rerun(cables: Iterable[Cable], points: Iterable[Iterable[Point]]) -> tuple[Cable, ...]:
    runs = [tuple(own) for own in points]
    return tuple(
        cable if cable.points == run else replace(cable, points=run) for cable, run in zip(cables, runs, strict=True)
    )
