"""`Draft`: a cable that is being laid, point after point."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from hydrostat.errors import InputError
from hydrostat.robot import Point, Robot
from hydrostat.studio.editing.add import add_cable, add_winch
from hydrostat.studio.editing.mirror import Mirror

NEAR_WINCH = 0.03
"""A first point so near to a winch, as a share of the body, means that winch."""


@dataclass(frozen=True, kw_only=True)
class Draft:
    """A cable that has no stopper yet.

    Attributes:
        points: so far [m]; the first is the winch.
        winch: that it begins at; None: one that is made with the cable.
    """

    points: tuple[Point, ...]
    winch: str | None = None

    def through(self, at: Point) -> Self:
        """The same with one more point."""
        return replace(self, points=(*self.points, at))

    def shorter(self) -> Self | None:
        """The same without its last point; None if that was the winch."""
        return replace(self, points=self.points[:-1]) if len(self.points) > 1 else None


def begin_cable(robot: Robot, at: Point, key: str = "") -> Draft:
    """A cable from the winch of this key, or the nearest one if it is near, else from a new one."""
    for winch in robot.winches:
        if key == f"winch:{winch.name}":
            return Draft(points=(winch.at,), winch=winch.name)
    if robot.winches:
        gaps = [float(np.linalg.norm(np.subtract(winch.at, at))) for winch in robot.winches]
        winch = robot.winches[int(np.argmin(gaps))]
        if min(gaps) <= max(2 * winch.spool_radius, NEAR_WINCH * robot.body.mesh.size):
            return Draft(points=(winch.at,), winch=winch.name)
    return Draft(points=(at,))


def end_cable(robot: Robot, draft: Draft, mirror: Mirror | None = None) -> Robot:
    """The robot with the cable, and with its winch where that is new; with a mirror also with their twins.

    Raises:
        InputError: it has no stopper, or a point outside the body.
    """
    if len(draft.points) < 2:
        raise InputError("a cable needs a stopper: click on the body where it shall end")
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
