"""`overlay`: the cable that is being laid, and the plane of the mirror."""

from hydrostat.plot.palette import INK, MUTED, WINCHES, winch_colours
from hydrostat.robot import Robot
from hydrostat.studio.editing.draft import Draft
from hydrostat.studio.editing.mirror import Mirror
from hydrostat.studio.view.things import Dot, Line, Look, Stroke, Thing

BEYOND = 0.06
"""The line of the mirror goes so far beyond the body, as a share of it."""


def overlay(robot: Robot, draft: Draft | None, mirror: Mirror | None) -> list[Thing]:
    """What is shown beside the parts of the robot."""
    things: list[Thing] = []
    if mirror is not None and robot.body.mesh.dim == 2:
        things.append(_axis(robot, mirror))
    if draft is not None:
        things += _draft(robot, draft)
        if mirror is not None and any(mirror.point(point) != point for point in draft.points):
            twin = Draft(points=tuple(mirror.point(point) for point in draft.points))
            things += [thing for thing in _draft(robot, twin) if isinstance(thing, Line)]
    return things


def _axis(robot: Robot, mirror: Mirror) -> Line:
    """The line about which a flat body is mirrored."""
    nodes, along = robot.body.mesh.nodes, 1 - mirror.axis
    margin = BEYOND * robot.body.mesh.size
    ends = (float(nodes[:, along].min()) - margin, float(nodes[:, along].max()) + margin)
    points = tuple(mirror.on_plane((end, end)) for end in ends)
    return Line(points=points, stroke=Stroke.PATH, colour=MUTED, loose=-1)


def _draft(robot: Robot, draft: Draft) -> list[Thing]:
    colour: str = WINCHES[len(robot.winches) % len(WINCHES)]
    if draft.winch is not None:
        colour = winch_colours(robot).get(draft.winch, INK)
    start, *rest = draft.points
    things: list[Thing] = []
    if rest:
        things.append(Line(points=draft.points, stroke=Stroke.CABLE, colour=colour, loose=-1))
    if draft.winch is None:
        things.append(Dot(at=start, look=Look.WINCH, colour=colour, stuck=False))
    vias = [Dot(at=point, look=Look.HANDLE, colour=colour, stuck=False) for point in rest]
    return [*things, *vias]
