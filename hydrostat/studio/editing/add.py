"""`add_pin`, `add_marker`, `add_winch`, `add_cable`, `insert_via`: a robot with one more part."""

from dataclasses import replace

import numpy as np

from hydrostat.robot import Cable, Marker, Pin, Point, Robot, Winch
from hydrostat.studio.records.fresh_name import fresh_name

PIN_SHARE = 0.06
"""Radius of a robot's first pin as a share of the body."""


def add_pin(robot: Robot, at: Point) -> Robot:
    """One more pin, as wide as the last one.

    Raises:
        InputError: it would hold nothing.
    """
    radii = [pin.radius for pin in robot.pins if pin.at is not None]
    radius = radii[-1] if radii else round(PIN_SHARE * robot.body.mesh.size, 3)
    return replace(robot, pins=(*robot.pins, Pin(at=at, radius=radius)))


def add_marker(robot: Robot, at: Point) -> Robot:
    """One more marker, with a name of its own.

    Raises:
        InputError: it would lie outside the body.
    """
    name = fresh_name("marker", [marker.name for marker in robot.markers])
    return replace(robot, markers=(*robot.markers, Marker(name=name, at=at)))


def add_winch(robot: Robot, at: Point) -> Robot:
    """One more winch, like the last one, with a name of its own.

    Raises:
        InputError: it would lie outside the body.
    """
    name = fresh_name("winch", [winch.name for winch in robot.winches])
    like = robot.winches[-1] if robot.winches else None
    if like is None:
        winch = Winch(name=name, at=at)
    else:
        winch = Winch(name=name, at=at, spool_radius=like.spool_radius, travel=like.travel, release=like.release)
    return replace(robot, winches=(*robot.winches, winch))


def add_cable(robot: Robot, winch: str, points: tuple[Point, ...]) -> Robot:
    """One more cable, as stiff as the last one.

    Args:
        robot: as it was.
        winch: that pulls it.
        points: after the winch [m], in which it begins; the last is its stopper.

    Raises:
        InputError: no such winch, no points, or one outside the body.
    """
    run = (robot.winch(winch).at, *points)
    cable = Cable(winch=winch, points=run)
    if robot.cables:
        cable = replace(cable, stiffness=robot.cables[-1].stiffness)
    return replace(robot, cables=(*robot.cables, cable))


def insert_via(robot: Robot, index: int, at: Point) -> tuple[Robot, int]:
    """One more via point, in the segment of a cable that is nearest to it; with its number.

    Raises:
        InputError: it would lie outside the body.
    """
    cable = robot.cables[index]
    place = nearest_segment(cable.points, at) + 1
    points = (*cable.points[:place], at, *cable.points[place:])
    sheathed = tuple((start + (start >= place), end + (end >= place)) for start, end in cable.sheathed)
    changed = replace(cable, points=points, sheathed=sheathed)
    return replace(robot, cables=(*robot.cables[:index], changed, *robot.cables[index + 1 :])), place


def nearest_segment(points: tuple[Point, ...], at: Point) -> int:
    """Number of the segment of a line that is nearest to a place."""
    corners = np.stack([np.array(points[:-1]), np.array(points[1:])], axis=1)
    along = corners[:, 1] - corners[:, 0]
    share = np.einsum("sd,sd->s", np.array(at) - corners[:, 0], along) / np.einsum("sd,sd->s", along, along)
    feet = corners[:, 0] + np.clip(share, 0.0, 1.0)[:, None] * along
    return int(np.argmin(np.linalg.norm(feet - np.array(at), axis=1)))
