"""`cable_segments` and `cable_turns`: the runs of cables between their points, and the corners where they rub."""

import numpy as np

from hydrostat.geometry.anchors import locate
from hydrostat.mechanics import Turns
from hydrostat.robot import Cable, Mount, Robot


def cable_segments(robot: Robot, cable: Cable) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stencils, signed weights and offsets of all segments of a cable."""
    points = np.array(cable.points)
    fixed = np.zeros((len(points), 1), dtype=bool)
    fixed[0] = robot.winch(cable.winch).mount is Mount.WORLD
    anchors = locate(robot.body.mesh, points)
    weights, offsets = np.where(fixed, 0.0, anchors.weights), np.where(fixed, points, 0.0)
    return (
        np.concatenate([anchors.stencils[:-1], anchors.stencils[1:]], axis=1),
        np.concatenate([-weights[:-1], weights[1:]], axis=1),
        np.diff(offsets, axis=0),
    )


def cable_turns(robot: Robot) -> Turns:
    """Corners of the cables of a robot that have friction; their points are those of the bare segments in robot order.

    A corner is where two bare segments meet, or where a sheath between two of them begins and ends. Nothing rubs at the
    ends of a cable: before its first bare segment it is the winch that moves it, behind its last one nothing does.
    """
    corners, dim = 2 * (robot.body.mesh.dim + 1), robot.body.mesh.dim
    stencils, weights = [np.zeros((2, 0, corners), dtype=np.int64)], [np.zeros((2, 0, corners))]
    offsets, points = [np.zeros((2, 0, dim))], [np.zeros(0, dtype=np.int64)]
    first = 0
    for cable in robot.cables:
        bare = np.flatnonzero(cable.bare)
        if cable.friction > 0:
            before, after, behind = _corners(bare)
            own = cable_segments(robot, cable)
            for found, parts in zip((stencils, weights, offsets), own, strict=True):
                found.append(np.stack([parts[before], parts[after]]))
            points.append(first + behind)
        first += len(bare)
    return Turns(
        stencils=np.concatenate(stencils, axis=1),
        weights=np.concatenate(weights, axis=1),
        offsets=np.concatenate(offsets, axis=1),
        points=np.concatenate(points),
    )


def _corners(bare: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Segment before and after each corner of a cable, and which bare segment comes behind it."""
    found = []
    for behind in range(1, len(bare)):
        last, following = bare[behind - 1], bare[behind]
        found.append((last, last + 1, behind))
        if following > last + 1:
            found.append((following - 1, following, behind))
    before, after, behind = np.array(found, dtype=np.int64).reshape(-1, 3).T
    return before, after, behind
