"""`BodySketch`: small pictures of a network, as SVG that follows the colors of the page."""

from functools import cached_property

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.drawing import Color
from hydrostat.robot import Body, Robot

DURATION = 0.45  # time from one shape to the next [s]


class Ease:
    """A shape, nodes [m] and tensions [N], on its way to another; what lies between is shown, not solved."""

    def __init__(self, nodes: Nodes, tensions: Vector) -> None:
        self.nodes, self.tensions = nodes, tensions
        self._start, self._goal, self._pulled = nodes, nodes, tensions
        self._began: float | None = None
        self.moving = False  # whether it is on its way

    def go(self, nodes: Nodes, tensions: Vector) -> None:
        """Set out for another shape of the same body; nothing happens if it goes there already."""
        if nodes is self._goal and np.array_equal(tensions, self._pulled):
            return
        far = nodes is not self._goal
        self._start, self._goal, self._pulled = self.nodes, nodes, tensions
        self._began, self.moving = None, far
        self.tensions = np.zeros_like(tensions) if far else tensions

    def step(self, now: float) -> bool:
        """Go on until a time [s]; whether there is more to do."""
        if not self.moving:
            return False
        if self._began is None:
            self._began = now
        share = min((now - self._began) / DURATION, 1.0)
        gentle = share * share * (3.0 - 2.0 * share)
        self.nodes = self._goal if share == 1.0 else (1.0 - gentle) * self._start + gentle * self._goal
        self.tensions = gentle * self._pulled
        self.moving = share < 1.0
        return self.moving


EDGE = 200.0  # longest side of a picture, in units of its drawing
MARGIN = 12.0

SIGHT = np.array([[0.905, -0.426, 0.0], [0.168, 0.357, 0.919]])
"""A body in space is seen from the front, a little from the right and from above: picture axes, (2, 3)."""


class BodySketch:
    """The silhouette of a body, made once, with networks drawn into it."""

    def __init__(self, body: Body) -> None:
        self.body = body

    def network(self, robot: Robot) -> str:
        """The picture of a network in this body."""
        colors = Color.of_winches(robot.winches)
        parts = [f'<path d="{self._outline}" class="sketch-body"/>']
        for cable in robot.cables:
            places = self._places(np.array(cable.points))
            color = colors[cable.winch]
            parts.append(f'<path d="{_path(places)}" class="sketch-cable" stroke="{color}"/>')
            x, y = places[-1]
            parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.2" fill="{color}"/>')
        for winch in robot.winches:
            x, y = self._places(np.array([winch.at]))[0]
            parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="7" class="sketch-winch" fill="{colors[winch.name]}"/>')
        left, top, wide, high = self._frame(robot)
        box = f"{left:.0f} {top:.0f} {wide:.0f} {high:.0f}"
        return f'<svg viewBox="{box}" class="sketch" aria-hidden="true">{"".join(parts)}</svg>'

    def _frame(self, robot: Robot) -> tuple[float, float, float, float]:
        """Left, top, width and height of the body with all winches, which may stand beside it."""
        places = self._places(np.array([winch.at for winch in robot.winches]).reshape(-1, self.body.mesh.dim))
        corners = np.concatenate([places - MARGIN, places + MARGIN, [(0.0, 0.0), self._size]])
        (left, top), (right, bottom) = corners.min(axis=0), corners.max(axis=0)
        return float(left), float(top), float(right - left), float(bottom - top)

    @property
    def _size(self) -> tuple[float, float]:
        low, high = self._box
        wide, tall = self._scale * (high - low) + 2 * MARGIN
        return float(wide), float(tall)

    @cached_property
    def _box(self) -> tuple[np.ndarray, np.ndarray]:
        flat = _to_plane(self.body.mesh.nodes)
        return flat.min(axis=0), flat.max(axis=0)

    @property
    def _scale(self) -> float:
        low, high = self._box
        return float((EDGE - 2 * MARGIN) / (high - low).max())

    def _places(self, points: Points) -> Float[np.ndarray, "points 2"]:
        """Points [m] in the picture, y down."""
        low = self._box[0]
        seen = self._scale * (_to_plane(points) - low) + MARGIN
        seen[:, 1] = self._size[1] - seen[:, 1]
        return seen

    @cached_property
    def _outline(self) -> str:
        from shapely import Polygon, polygons, union_all

        mesh = self.body.mesh
        places = self._places(mesh.nodes)
        corners = places[mesh.elements if mesh.dim == 2 else mesh.boundary]
        spans = corners[:, 1:] - corners[:, :1]
        areas = spans[:, 0, 0] * spans[:, 1, 1] - spans[:, 0, 1] * spans[:, 1, 0]
        whole = union_all(polygons(corners[np.abs(areas) > 1e-6]), grid_size=0.05).simplify(0.3)
        pieces = getattr(whole, "geoms", [whole])
        speck = 12.0  # a hole of less area is none: triangles that are seen edge-on leave such
        holes = [hole for piece in pieces for hole in piece.interiors if Polygon(hole).area > speck]
        rings = [*(piece.exterior for piece in pieces), *holes]
        return "".join(_path(np.array(ring.coords)) + "Z" for ring in rings)


def _to_plane(points: Points) -> Float[np.ndarray, "points 2"]:
    """Places of points in the plane of a picture, y up [m]."""
    return points.astype(float) if points.shape[1] == 2 else points @ SIGHT.T


def _path(places: Float[np.ndarray, "points 2"]) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
