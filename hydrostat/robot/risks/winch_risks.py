"""Risks of winches."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Points
from hydrostat.geometry.anchors import clearance
from hydrostat.robot.body import Body
from hydrostat.robot.risks.words import Found, mm, told_together
from hydrostat.robot.robot import Robot
from hydrostat.robot.winch import Mount


def winch_risks(robot: Robot) -> Iterator[str]:
    """Winches that pull nothing or too far, collide, or stick out."""
    yield from told_together(_idle(robot))
    yield from told_together(_too_far(robot))
    yield from told_together(_collisions(robot))
    yield from told_together(_sticking_out(robot))


def cover(body: Body, points: Points) -> Float[np.ndarray, " points"]:
    """How far points are from the edge of a flat body, as drawn, or from the surface of a body in space [m]."""
    if body.outline is None:
        return clearance(body.mesh, points)
    from shapely import distance
    from shapely import points as shapely_points

    return np.asarray(distance(body.outline.polygon.boundary, shapely_points(points)))


def _name(robot: Robot, index: int) -> str:
    return f"winch[{index}] {robot.winches[index].name}"


def _idle(robot: Robot) -> Iterator[Found]:
    for index, winch in enumerate(robot.winches):
        if not any(cable.winch == winch.name for cable in robot.cables):
            yield Found(_name(robot, index), 0.0, "pulls no cable")


def _too_far(robot: Robot) -> Iterator[Found]:
    """Travel or release longer than a cable is."""
    for index, winch in enumerate(robot.winches):
        pulled = [
            (ratio, float(cable.segments[cable.bare].sum()))
            for cable, ratio in zip(robot.cables, robot.spool_ratios, strict=True)
            if cable.winch == winch.name
        ]
        if not pulled:
            continue
        ratio, length = min(pulled, key=lambda one: one[1] / one[0])
        for key, far in (("travel", winch.travel), ("release", winch.release)):
            if ratio * far > length:
                step = "" if ratio == 1 else f", {mm(ratio * far)} at its spool,"
                text = (
                    f"the {key} of {mm(far)}{step} is longer than a cable that it pulls ({mm(length)} outside sheaths)"
                )
                yield Found(_name(robot, index), ratio * far / length, text)


def _collisions(robot: Robot) -> Iterator[Found]:
    for index, winch in enumerate(robot.winches):
        for other in robot.winches[:index]:
            gap = float(np.linalg.norm(np.subtract(winch.at, other.at)))
            if gap < robot.largest_spool(winch) + robot.largest_spool(other):
                text = f"only {mm(gap)} from winch {other.name}, the spools collide"
                yield Found(_name(robot, index), -gap, text)


def _sticking_out(robot: Robot) -> Iterator[Found]:
    inside = [index for index, winch in enumerate(robot.winches) if winch.mount is Mount.BODY]
    if not inside:
        return
    depths = cover(robot.body, np.array([robot.winches[index].at for index in inside], dtype=float))
    for index, depth in zip(inside, depths, strict=True):
        radius = robot.largest_spool(robot.winches[index])
        if depth < radius:
            edge = "edge" if robot.body.mesh.dim == 2 else "surface"
            text = f"a spool of radius {mm(radius)} sticks out, the {edge} is {mm(float(depth))} away; move it inward"
            yield Found(_name(robot, index), radius - depth, text)
