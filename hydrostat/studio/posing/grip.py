"""`name_under`, `point_of`: which point of the body a pointer is about to hold."""

import numpy as np

from hydrostat.geometry import locate
from hydrostat.project import fresh_name
from hydrostat.studio.posing.held import HeldPoint, PoseState
from hydrostat.studio.stage import Hit

NEAR = 0.02  # a plain point so near to one that is held is that one, in sizes of the body


def name_under(now: PoseState, hit: Hit) -> str:
    """The point that the pointer is on: a marker, one that is held, or a new one; "" beside the body."""
    kind, _, name = hit.key.partition(":")
    markers = [marker.name for marker in now.robot.markers]
    if kind == "marker" and name in markers:
        return name
    if kind in ("target", "point") and name in now.targets.held:
        return name
    if hit.rest is None:
        return ""
    near = NEAR * now.robot.body.mesh.size
    for own, held in now.targets.held.items():
        if np.linalg.norm(np.subtract(held.at, hit.rest)) < near:
            return own
    return fresh_name("point", [*now.targets.held, *markers])


def point_of(now: PoseState, name: str, hit: Hit) -> HeldPoint:
    """A point by name, held where it is if it is not held yet."""
    if name in now.targets.held:
        return now.targets.held[name]
    for marker in now.robot.markers:
        if marker.name == name:
            return HeldPoint(at=marker.at, target=marker.at, marker=True)
    assert hit.rest is not None
    mesh = now.robot.body.mesh
    at = tuple(locate(mesh, np.array([hit.rest])).positions(mesh.nodes)[0].tolist())
    return HeldPoint(at=at, target=at)
