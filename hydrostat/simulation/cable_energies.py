"""`cable_energy` and `friction_energy`: from the cables of a robot to their energies."""

from typing import Any

import numpy as np

from hydrostat.arrays import Int
from hydrostat.mechanics import CableEnergy, CableSegments, FrictionCableEnergy, TensionLaw, ViaPointTurns
from hydrostat.robot import Robot
from hydrostat.simulation.route_points import RoutePoints


def cable_energy(robot: Robot, points: RoutePoints) -> CableEnergy:
    """Energy of all cables without friction, in their order; the control of each is the index of its winch."""
    return CableEnergy(robot.body.mesh.nodes, **_bare_segments(robot, points))


def friction_energy(robot: Robot, points: RoutePoints) -> FrictionCableEnergy | None:
    """Energy of all cables with friction, in place of `cable_energy`; None if no cable has friction."""
    friction = np.array([cable.friction for cable in robot.cables])
    if not friction.any():
        return None
    turns = _turns(robot, points)
    return FrictionCableEnergy(robot.body.mesh.nodes, **_bare_segments(robot, points), friction=friction, turns=turns)


def _bare_segments(robot: Robot, points: RoutePoints) -> dict[str, Any]:
    """Arguments of a `CableEnergy` but for the nodes."""
    order = {winch.name: index for index, winch in enumerate(robot.winches)}
    cables = robot.cables
    stencils, weights, offsets = points.segments(points.starts)
    return {
        "segments": CableSegments(stencils=stencils, weights=weights, offsets=offsets, cables=points.cables),
        "law": TensionLaw(
            stiffness=np.array([cable.stiffness for cable in cables]),
            smoothing=np.array([cable.smoothing for cable in cables]),
        ),
        "winches": np.array([order[cable.winch] for cable in cables], dtype=np.int64),
        "slack": np.array([cable.slack for cable in cables]),
        "ratios": robot.spool_ratios,
    }


def _turns(robot: Robot, points: RoutePoints) -> ViaPointTurns:
    """Corners of the cables of a robot that have friction; their points are those of the bare segments in robot order.

    A corner is where two bare segments meet, or where a sheath between two of them begins and ends. Nothing rubs at the
    ends of a cable: before its first bare segment it is the winch that moves it, behind its last one nothing does.
    """
    (before, after), behind = turn_starts(robot)
    stencils, weights, offsets = (
        np.stack(parts) for parts in zip(points.segments(before), points.segments(after), strict=True)
    )
    return ViaPointTurns(stencils=stencils, weights=weights, offsets=offsets, points=behind)


def turn_starts(robot: Robot) -> tuple[Int[np.ndarray, "2 turns"], Int[np.ndarray, " turns"]]:
    """First points of the segments before and after each of these corners, and which bare segment comes behind it."""
    none = np.zeros(0, dtype=np.int64)
    corners, first, begin = [(none, none, none)], 0, 0
    for cable in robot.cables:
        bare = np.flatnonzero(cable.bare)
        if cable.friction > 0:
            before, after, behind = _corners(bare)
            corners.append((begin + before, begin + after, first + behind))
        first, begin = first + len(bare), begin + len(cable.points)
    before, after, behind = (np.concatenate(parts) for parts in zip(*corners, strict=True))
    return np.stack([before, after]), behind


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
