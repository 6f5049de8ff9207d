"""`MoldOrientation`: rotation of a mold in the coordinates of the body, chosen so that it traps little air."""

from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold
from shapely import MultiPoint

from hydrostat.arrays import Float, Int, Vector
from hydrostat.fabrication.moulds.pull import Pull
from hydrostat.fabrication.moulds.release import axes_along
from hydrostat.fabrication.solids.printed import TriangleMesh, root_of

MIN_TRAP = 1.0  # a bubble no higher than that is left to the foam, which pushes it into its cells [mm]
_HELD_UPWARDS = 3.0  # a held end at the top is worth so many vents: nobody sees there where the sprue was cut off
_TALL = 0.5  # vents that a mold may have more for being once less as tall as it is wide
_TOP = 0.5  # maximum depth below a high point of points that belong to it [mm]


@dataclass(frozen=True, eq=False)
class MoldOrientation:
    """Axes of a mold; its parting plane is z = 0."""

    # unit vectors across, upwards when poured, and along the pull, as rows, in the body's coordinates
    axes: Float[np.ndarray, "3 3"]
    height: float  # height of the parting plane along the pull [mm]
    held_upwards: bool = False  # True if the pinned end is at the top: the foam is poured in there

    def into(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 3"]:
        """Points of the body [mm] in the mold."""
        return points @ self.axes.T - [0.0, 0.0, self.height]

    def enter(self, solid: Manifold) -> Manifold:
        """A solid of the body's coordinates in those of the mold."""
        return solid.transform(np.column_stack([self.axes, [0.0, 0.0, -self.height]]))

    def leave(self, solid: Manifold) -> Manifold:
        """A solid of the mold's coordinates in those of the body."""
        return solid.transform(np.column_stack([self.axes.T, self.height * self.axes[2]]))


def find_stance(pull: Pull, held: Float[np.ndarray, "held 3"]) -> MoldOrientation:
    """Find the way to stand the closed mold on an edge, parting plane upright, so that little air is caught.

    Sides of the box are along axes of the robot or those of the smallest box. That edge is chosen that needs the fewest
    vents, has what is held at the top (nodes at pins, in the body's coordinates [mm]), is not too narrow to stand on
    and does not make the mold much larger.
    """
    first, second, along = axes_along(pull.direction)
    flat = pull.surface.vertices @ np.column_stack([first, second])
    # sine of the angle between an axis of the robot and the pull, above which it gives the box its sides
    across = 0.7
    main = np.eye(3)[int(np.argmax(np.linalg.norm(np.cross(np.eye(3), along), axis=1) > across))]
    sides = {_smallest_side(flat), float(np.arctan2(main @ second, main @ first)) % (np.pi / 2)}
    found = []
    for angle in sorted(side + turn * np.pi / 2 for side in sides for turn in range(4)):
        up = np.cos(angle) * first + np.sin(angle) * second
        found.append(_rated_stance(pull, np.array([np.cross(up, along), up, along]), held))
    least = min(area for _, area, _ in found)
    large = 10.0  # vents that a box may need less for being twice as large
    return min(found, key=lambda one: (round(one[0] + large * (one[1] / least - 1), 6), _order(one[2])))[2]


def _rated_stance(
    pull: Pull, axes: Float[np.ndarray, "3 3"], held: Float[np.ndarray, "held 3"]
) -> tuple[float, float, MoldOrientation]:
    """A way to stand, before it what speaks against it and the area of the box [mm^2]."""
    places = pull.surface.vertices @ axes.T
    width, tall, depth = np.ptp(places, axis=0)
    level = (held @ axes[1] - places[:, 1].min()) / tall
    at_the_top = 0.85  # from which part of the height on something is at the top
    held_upwards = len(held) > 0 and float(level.mean()) > at_the_top
    vents = len(high_points(pull.surface.vertices, pull.surface.triangles, axes[1], rise=MIN_TRAP))
    against = vents - _HELD_UPWARDS * held_upwards + _TALL * tall / min(width, 3 * depth)
    return float(against), float(width * tall), MoldOrientation(axes, pull.height, held_upwards)


def _order(stance: MoldOrientation) -> list[float]:
    """Decides between ways to stand that are equally good."""
    return (stance.axes[1].round(6) + 0.0).tolist()


def _smallest_side(flat: Float[np.ndarray, "points 2"]) -> float:
    """Angle of a side of the smallest rectangle round points [radians]."""
    corners = np.array(MultiPoint(flat).minimum_rotated_rectangle.exterior.coords)  # type: ignore[union-attr]
    sides = np.diff(corners, axis=0)
    angles = np.arctan2(sides[:, 1], sides[:, 0]) % (np.pi / 2)
    angle = float(angles[0])
    return 0.0 if min(angle, np.pi / 2 - angle) < 1e-6 else angle


def high_points(
    vertices: Float[np.ndarray, "vertices 3"],
    triangles: Int[np.ndarray, "triangles 3"],
    up: Float[np.ndarray, "3"],
    *,
    rise: float,
) -> Int[np.ndarray, " points"]:
    """Vertices of a cavity's surface that are its local high points, the highest first.

    Only those that rise from the highest pass to a higher one by `rise` [mm] or more, and only ceilings: the top of a
    bump of the mold into the cavity holds no air.
    """
    heights = vertices @ up
    neighbors = _neighbors(len(vertices), triangles)
    summits = [summit for summit, prominence in _summits(heights, neighbors) if prominence >= rise]
    ceilings = TriangleMesh(vertices, triangles).facing @ up > 0
    middles = [_middle(summit, vertices, heights, neighbors) for summit in summits if ceilings[summit]]
    return np.array(middles, dtype=np.int64)


def _summits(heights: Vector, neighbors: list[list[int]]) -> list[tuple[int, float]]:
    """Each local maximum with how far it stands above the highest pass to a higher one, by falling height."""
    order = np.argsort(-heights, kind="stable")
    peak = np.full(len(heights), -1, dtype=np.int64)
    parent = list(range(len(heights)))
    found: list[tuple[int, float]] = []

    for vertex in order.tolist():
        regions = {root_of(parent, other) for other in neighbors[vertex] if peak[other] >= 0}
        if not regions:
            peak[vertex] = vertex
            continue
        highest = max(regions, key=lambda region: (heights[peak[region]], -peak[region]))
        peak[vertex] = peak[highest]
        parent[vertex] = highest
        for region in sorted(regions - {highest}):
            found.append((int(peak[region]), float(heights[peak[region]] - heights[vertex])))
            parent[region] = highest
    lasting = {root_of(parent, vertex) for vertex in range(len(heights)) if peak[vertex] >= 0}
    found += [(int(peak[region]), float(np.ptp(heights))) for region in sorted(lasting)]
    return sorted(found, key=lambda summit: (-heights[summit[0]], summit[0]))


def _middle(summit: int, vertices: np.ndarray, heights: Vector, neighbors: list[list[int]]) -> int:
    """The vertex in the middle of the flat top round a summit."""
    top, waiting = {summit}, [summit]
    while waiting:
        for other in neighbors[waiting.pop()]:
            if other not in top and heights[other] > heights[summit] - _TOP:
                top.add(other)
                waiting.append(other)
    members = np.array(sorted(top))
    return int(members[np.argmin(np.linalg.norm(vertices[members] - vertices[members].mean(axis=0), axis=1))])


def _neighbors(count: int, triangles: Int[np.ndarray, "triangles 3"]) -> list[list[int]]:
    joined: list[list[int]] = [[] for _ in range(count)]
    for one, two, three in triangles.tolist():
        joined[one].append(two)
        joined[two].append(three)
        joined[three].append(one)
    return joined  # of a closed surface each edge is walked both ways, so all neighbors are there
