"""`Visibility`: the half of a body that a point lies in, and the view that shows most of its cables in front."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Bool, Float

from hydrostat.drawing import Camera, DepthBuffer, DrawnSolid
from hydrostat.robot import Robot

_COARSE = 160  # pixels along a body: enough to know its near and its far side
_TURNS = tuple(range(0, 360, 30))  # compass directions that are tried [degrees]
_RISES = (15.0, 40.0)  # heights over the horizon that are tried [degrees]


@dataclass(frozen=True, eq=False)
class Visibility:
    """The near and the far side of a body."""

    front: DepthBuffer  # depths of the near side
    back: DepthBuffer  # of the far side, as seen from there: x and depth change their sign

    @classmethod
    def of(cls, body: DrawnSolid, camera: Camera) -> Self:
        """Look at a body."""
        seen = camera.see(body.vertices)[body.triangles]
        nothing = np.empty((len(seen), 3, 0))
        turned = seen * np.array([1.0, 1.0, -1.0])
        return cls(*(DepthBuffer.of(corners, nothing, pixels=_COARSE) for corners in (seen, turned)))

    def in_front(self, seen: Float[np.ndarray, "points 3"]) -> Bool[np.ndarray, " points"]:
        """Whether points, as seen, lie in the near half of the body or before it; so do those beside it."""
        before = -self.front.behind(seen)
        after = -self.back.behind(seen * np.array([1.0, 1.0, -1.0]))
        return ~((before > 0) & (before > after))


def best_views(robot: Robot, body: DrawnSolid) -> tuple[Camera, ...]:
    """Three views: from where most of the cables lie in front, and then from where most of the others do."""
    cables = [1e3 * np.array(cable.points)[1:] for cable in robot.cables]
    points = np.concatenate([(way[:-1] + way[1:]) / 2 for way in cables if len(way) > 1] or [np.zeros((1, 3))])
    views = [Camera.at(float(turn), rise) for rise in _RISES for turn in _TURNS]
    seen = np.array([Visibility.of(body, view).in_front(view.see(points)) for view in views], dtype=float)
    # Of views that are as good, the one that shows most of the body, then the first.
    areas = np.array([np.prod(np.ptp(view.see(body.vertices)[:, :2], axis=0)) for view in views])
    chosen = [int(np.argmax(seen.mean(axis=1) + 0.4 * areas / areas.max()))]
    rest = seen
    for apart_counts in (0.1, 0.4):
        rest = rest * (1 - seen[chosen[-1]])
        apart = np.min([_apart(views, views[other]) for other in chosen], axis=0)
        worth = rest.mean(axis=1) + 0.3 * areas / areas.max() + apart_counts * np.minimum(apart, 1.0)
        chosen.append(int(np.argmax(worth)))
    return tuple(views[index] for index in chosen)


def _apart(views: list[Camera], one: Camera) -> Float[np.ndarray, " views"]:
    """How far views are from one of them: 0 for itself, 1 for a right angle, 2 for the opposite."""
    return np.array([1 - float(view.axes[2] @ one.axes[2]) for view in views])
