"""`draw_first_cable`, `place_first_winch`: a first winch and cable that can be built, to edit."""

from dataclasses import replace

import numpy as np
import shapely

from hydrostat.design.buildable import violations
from hydrostat.design.constraints import Constraints
from hydrostat.design.skin_region import cable_region
from hydrostat.design.winch_room import find_winch_places, has_known_room, winch_room
from hydrostat.fabrication import find_refusals
from hydrostat.robot import Cable, Robot, Winch

_TRIALS = 12
"""Maximum number of winches and cables that are checked."""


def draw_first_cable(robot: Robot) -> Robot | None:
    """Robot with a winch and a straight cable toward a marker, as long as possible; None if it has no room for one.

    The body is flat. The cable keeps the usual constraints, and a kit can be made.
    """
    constraints = Constraints(motor=robot.motor)
    places, outline = find_winch_places(robot, constraints), robot.body.outline
    if outline is None or not len(places) or not robot.markers:
        return None
    inner = outline.polygon.buffer(-1.2 * constraints.clearance)
    goal = np.array(robot.markers[0].at)
    ways = goal - places
    away = np.linalg.norm(ways, axis=1)
    lines = shapely.linestrings(np.stack([places, places + 0.85 * ways], axis=1))
    whole = shapely.contains(inner, lines)
    order = np.argsort(np.where(whole, -away, np.inf), kind="stable")
    region = cable_region(robot.body, constraints)
    for number in order[: min(_TRIALS, int(whole.sum()))]:
        points = tuple(
            tuple(np.round(places[number] + share * ways[number], 4).tolist()) for share in (0.0, 0.45, 0.85)
        )
        winch = Winch(name="left", at=points[0], travel=round(0.25 * float(away[number]), 3))
        made = robot.with_network([winch], [Cable(winch="left", points=points)])
        if not violations(made, constraints, region) and not find_refusals(made):
            return made
    return None


def place_first_winch(robot: Robot) -> Robot:
    """Robot with its one winch moved to the nearest room for its unit, if it has none at its place.

    The cable leads on from there to its next points. A robot without such a place returns as it is.
    """
    constraints = Constraints(motor=robot.motor)
    if len(robot.cables) != 1 or not has_known_room(robot.body) or not find_refusals(robot):
        return robot
    winch, points = robot.winches[0], np.array(robot.cables[0].points)
    rooms = [zone.at for zone in winch_room(robot, constraints, 1)[0] if zone.at is not None]
    for room in sorted(rooms, key=lambda at: float(np.linalg.norm(points[0] - at)))[:_TRIALS]:
        rest = robot.cables[0].points[int(np.linalg.norm(points - room, axis=1).argmin()) + 1 :]
        if not rest:
            continue
        cable = Cable(winch=winch.name, points=(room, *rest))
        travel = max(round(0.4 * cable.length, 3), 1e-3)
        made = robot.with_network([replace(winch, at=room, travel=travel)], [cable])
        if not find_refusals(made):
            return made
    return robot
