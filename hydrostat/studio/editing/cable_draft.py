"""`CableDraft`: a cable that is being laid, point after point, and how it is shown."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from hydrostat.drawing import Color
from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.robot import Robot
from hydrostat.studio.editing.part import Mirror
from hydrostat.studio.editing.place import add_cable, add_winch
from hydrostat.studio.view.scene_items import Dot, Look, SceneItem, Strand, Stroke


@dataclass(frozen=True, kw_only=True)
class CableDraft:
    """A cable that has no stopper yet."""

    points: tuple[Point, ...]  # so far [m]; the first is the winch
    winch: str | None = None  # that it begins at; None: one that is made with the cable

    def through(self, at: Point) -> Self:
        """The same with one more point."""
        return replace(self, points=(*self.points, at))

    def shorter(self) -> Self | None:
        """The same without its last point; None if that was the winch."""
        return replace(self, points=self.points[:-1]) if len(self.points) > 1 else None


def begin_cable(robot: Robot, at: Point, key: str = "") -> CableDraft:
    """A cable from the winch of this key, or the nearest one if it is near, else from a new one."""
    for winch in robot.winches:
        if key == f"winch:{winch.name}":
            return CableDraft(points=(winch.at,), winch=winch.name)
    near_winch = 0.03  # a first point so near to a winch, as a share of the body, means that winch
    if robot.winches:
        gaps = [float(np.linalg.norm(np.subtract(winch.at, at))) for winch in robot.winches]
        winch = robot.winches[int(np.argmin(gaps))]
        if min(gaps) <= max(2 * winch.spool_radius, near_winch * robot.body.mesh.size):
            return CableDraft(points=(winch.at,), winch=winch.name)
    return CableDraft(points=(at,))


def end_cable(robot: Robot, draft: CableDraft, mirror: Mirror | None = None) -> Robot:
    """The robot with the cable, its winch if new, and their twins (InputError: no stopper, or a point outside)."""
    if len(draft.points) < 2:
        raise InputError("a cable needs a stopper. Click the body where the cable should end")
    winch, robot = draft.winch, robot if draft.winch is not None else add_winch(robot, draft.points[0])
    if winch is None:
        winch = robot.winches[-1].name
    laid = add_cable(robot, winch, draft.points[1:])
    if mirror is None or all(mirror.point(point) == point for point in draft.points):
        return laid
    key = f"winch:{winch}"
    twin = key if mirror.holds(laid, key) else mirror.twin(laid, key)
    if twin is None:
        laid = add_winch(laid, mirror.point(laid.winch(winch).at))
        twin = f"winch:{laid.winches[-1].name}"
    return add_cable(laid, twin.removeprefix("winch:"), tuple(mirror.point(point) for point in draft.points[1:]))


def overlay(robot: Robot, draft: CableDraft | None, mirror: Mirror | None) -> list[SceneItem]:
    """Return the mirror axis and the cable draft, to be shown with the parts of the robot."""
    items: list[SceneItem] = []
    if mirror is not None and robot.body.mesh.dim == 2:
        items.append(_axis(robot, mirror))
    if draft is not None:
        items += _draft(robot, draft)
        if mirror is not None and any(mirror.point(point) != point for point in draft.points):
            twin = CableDraft(points=tuple(mirror.point(point) for point in draft.points))
            items += [item for item in _draft(robot, twin) if isinstance(item, Strand)]
    return items


def _axis(robot: Robot, mirror: Mirror) -> Strand:
    """The line about which a flat body is mirrored."""
    nodes, along = robot.body.mesh.nodes, 1 - mirror.axis
    beyond = 0.06  # the line of the mirror goes so far beyond the body, as a share of it
    margin = beyond * robot.body.mesh.size
    ends = (float(nodes[:, along].min()) - margin, float(nodes[:, along].max()) + margin)
    points = tuple(mirror.on_plane((end, end)) for end in ends)
    return Strand(points=points, stroke=Stroke.PATH, color=Color.MUTED, loose=-1)


def _draft(robot: Robot, draft: CableDraft) -> list[SceneItem]:
    color: str = Color.WINCHES[len(robot.winches) % len(Color.WINCHES)]
    if draft.winch is not None:
        color = Color.of_winches(robot.winches).get(draft.winch, Color.INK)
    start, *rest = draft.points
    items: list[SceneItem] = []
    if rest:
        items.append(Strand(points=draft.points, stroke=Stroke.CABLE, color=color, loose=-1))
    if draft.winch is None:
        items.append(Dot(at=start, look=Look.WINCH, color=color, stuck=False))
    vias = [Dot(at=point, look=Look.HANDLE, color=color, stuck=False) for point in rest]
    return [*items, *vias]
