"""`lay_cables_on_skin`: cables moved to the skin of a body, where they are sewn onto a glove."""

# Of the thesis (docs/thesis.md): R53

from dataclasses import replace
from itertools import pairwise

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry import Shell
from hydrostat.given import check_not_negative
from hydrostat.robot.cable import Cable
from hydrostat.robot.risks import limit_travels
from hydrostat.robot.robot import Robot
from hydrostat.units import MM

SKIN_DEPTH = 0.75 * MM
"""Depth of a line in a channel that is sewn onto the skin [m]."""

SHEATH_DEPTH = 2.7 * MM
"""Depth of a tube in a groove of the body under the skin [m]."""

MAX_SPAN = 0.045
"""Longest span between points of a cable on the skin, in sizes of the body: a straight span leaves a curved skin."""

SMOOTHINGS = 8
"""Times that a cable is smoothed along itself and laid on the skin again."""

MIN_SPAN = 0.025
"""Shortest such span: points that the skin brings nearer to each other become one."""


def lay_cables_on_skin(robot: Robot, depth: float = SKIN_DEPTH) -> Robot:
    """Move the points of all cables, those in sheaths as well, to the nearest place of the skin.

    Points at winches and outside the body stay. Travels are cut so that they do not crush the body. Poses stay, though
    other cables reach them less exactly.

    Args:
        robot: robot with a body in space.
        depth: depth of bare points below the skin [m]; sheaths lie at `SHEATH_DEPTH`, if that is deeper.

    Raises:
        InputError: a flat body, or no cable.
    """
    check_not_negative("depth", depth, "m")
    mesh = robot.body.mesh
    if mesh.dim == 2 or not robot.cables:
        what = "a flat body" if mesh.dim == 2 else "no cables"
        raise InputError(
            f"{robot.name}: cables on the skin need a 3D body with cables ({what}). Take a hand or a trunk."
        )
    shell = Shell(mesh.nodes, mesh.boundary)
    laid = [_lay_cable(cable, shell, mesh.size, depth) for cable in robot.cables]
    return limit_travels(robot.with_network(robot.winches, laid))


def _lay_cable(cable: Cable, shell: Shell, size: float, depth: float) -> Cable:
    """The cable on the skin, with as many points as its spans need."""
    points, depths, place = [np.array(cable.points[0])], [np.nan], [0]
    for index, (start, end) in enumerate(pairwise(np.array(cable.points)), start=1):
        between, deep = end[None], np.nan
        if shell.nearest(between).distances[0] <= 0:
            count = int(np.ceil(np.linalg.norm(end - start) / (MAX_SPAN * size)))
            between = start + np.arange(1, count + 1)[:, None] / count * (end - start)
            between = between[shell.nearest(between).distances <= 0]
            in_sheath = any(first <= index <= last for first, last in cable.sheathed)
            deep = max(depth, SHEATH_DEPTH) if in_sheath else depth
        points += [*between]
        depths += [deep] * len(between)
        place.append(len(points) - 1)
    laid = _lay_points(np.array(points), np.array(depths), shell)
    kept, number = [0], [0]
    for index in range(1, len(laid)):
        if np.linalg.norm(laid[index] - laid[kept[-1]]) > MIN_SPAN * size:
            kept.append(index)
        number.append(len(kept) - 1)
    return replace(
        cable,
        points=tuple(tuple(point) for point in laid[kept].tolist()),
        sheathed=tuple((number[place[start]], number[place[end]]) for start, end in cable.sheathed),
    )


def _lay_points(points: np.ndarray, depths: np.ndarray, shell: Shell) -> np.ndarray:
    """Places at depths below the skin, near to points; points without a depth stay.

    The nearest places of neighbors may lie on facets that are apart, so the cable is smoothed between projections.
    """
    moves = np.isfinite(depths)
    for turn in range(1 + SMOOTHINGS):
        if turn:
            smooth = points.copy()
            smooth[1:-1] = (points[:-2] + 2 * points[1:-1] + points[2:]) / 4
            points = np.where(moves[:, None], smooth, points)
        near = shell.nearest(points)
        shift = np.where(moves, near.distances + depths, 0.0)
        points = points - shift[:, None] * near.directions
    return np.round(points, 4)
