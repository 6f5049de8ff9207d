"""`Surface`: triangles in space, as from a scan or a CAD model; `Solid`: region enclosed by a closed surface."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Points, Vector
from hydrostat.errors import SurfaceError


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles in space, however they meet (SurfaceError: none, wrong shapes or indices, or not finite)."""

    vertices: Float[np.ndarray, "vertices 3"]  # places [m], (vertices, 3); kept as a read-only copy
    # indices of three vertices each, (triangles, 3); seen from outside they turn counter-clockwise
    triangles: Int[np.ndarray, "triangles 3"]
    notes: tuple[str, ...] = ()  # what the reader of its file left out

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=float, order="C")
        triangles = np.array(self.triangles, dtype=np.int64, order="C")
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
            raise SurfaceError("a surface needs finite vertices in space, (vertices, 3)")
        if triangles.ndim != 2 or triangles.shape[1] != 3 or not len(triangles):
            raise SurfaceError("a surface needs triangles, (triangles, 3), at least one")
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            raise SurfaceError("the surface names a vertex that it does not have")
        vertices.setflags(write=False)
        triangles.setflags(write=False)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "triangles", triangles)

    @cached_property
    def box(self) -> Float[np.ndarray, "2 3"]:
        """Lowest and highest coordinates of the vertices in use [m]."""
        corners = self.vertices[np.unique(self.triangles)]
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    @property
    def size(self) -> float:
        """Longest side of the bounding box [m]."""
        return float(np.ptp(self.box, axis=0).max())

    @cached_property
    def crosses(self) -> Float[np.ndarray, "triangles 3"]:
        """Cross product of two sides of each triangle [m^2]: its normal, outward, twice as long as its area."""
        one, two, three = (self.vertices[corner] for corner in self.triangles.T)
        return np.cross(two - one, three - one)

    def part(self, chosen: Bool[np.ndarray, " triangles"] | Int[np.ndarray, " some"]) -> Self:
        """Some of its triangles, by a mask or by number, with the vertices that they use."""
        used, triangles = np.unique(self.triangles[chosen], return_inverse=True)
        return type(self)(self.vertices[used], triangles.reshape(-1, 3))

    @property
    def area(self) -> float:
        """Area of all triangles [m^2]."""
        return float(np.linalg.norm(self.crosses, axis=1).sum() / 2)

    @property
    def volume(self) -> float:
        """Volume enclosed [m^3] if the surface is closed, negative if it is inside out; else without meaning."""
        middle = self.box.mean(axis=0)  # near the surface, for rounding
        return float(np.einsum("td,td->", self.vertices[self.triangles[:, 0]] - middle, self.crosses) / 6)


def covering_points(surface: Surface, spacing: float) -> Float[np.ndarray, "points 3"]:
    """Vertices of a surface, and points spread evenly over its triangles, one for each `spacing` squared [m]."""
    return np.concatenate([surface.vertices[np.unique(surface.triangles)], spread_points(surface, spacing)[0]])


def spread_points(surface: Surface, spacing: float) -> tuple[Float[np.ndarray, "points 3"], Int[np.ndarray, " points"]]:
    """Points spread evenly, about one for each square of the spacing [m], one at least on each triangle; and which."""
    areas = np.linalg.norm(surface.crosses, axis=1) / 2
    most_points = 2_000_000  # no more points than this, and one for each triangle
    square = max(spacing**2, float(areas.sum()) / most_points)
    counts = np.maximum(np.ceil(areas / square).astype(np.int64), 1)
    owner = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    plastic = 1.32471795724474602596  # its powers spread points evenly over a square (Roberts 2018)
    one, two = ((0.5 + (1 + number) / plastic**power) % 1 for power in (1, 2))
    over = one + two > 1
    one, two = np.where(over, 1 - one, one), np.where(over, 1 - two, two)
    weights = np.column_stack([1 - one - two, one, two])
    return np.einsum("pc,pcd->pd", weights, surface.vertices[surface.triangles[owner]]), owner


_RAY_SIZE = 1e6
"""Size to which a surface is scaled for rays: libigl takes triangles of less than about 1e-6 square units for flat."""


@dataclass(frozen=True, eq=False)
class Solid:
    """Inside of a surface, by its winding number (Jacobson et al. 2013; fast: Barill et al. 2018)."""

    surface: Surface  # closed, oriented outward
    clean: bool = False  # no part crosses or overlaps another, so that the nearest triangle tells the side of a point

    def __getstate__(self) -> dict[str, Any]:
        """Return the state that is sent to another process: without the trees, which are rebuilt there."""
        return {"surface": self.surface, "clean": self.clean}

    def winding(self, points: Points) -> Vector:
        """Winding number of the surface about each point: 1 inside, 0 outside, in between near holes."""
        return self._winding_tree.winding_number(np.ascontiguousarray(points))

    def inside(self, points: Points) -> Bool[np.ndarray, " points"]:
        """Return True for points inside."""
        return self.winding(points) > 0.5

    def distances(self, points: Points) -> Vector:
        """Distance of points from the surface [m], negative inside."""
        if not self.clean:
            return np.where(self.inside(points), -1.0, 1.0) * self.gaps(points)
        squares, triangles, places = self._nearest(points)
        heights = np.einsum("pd,pd->p", points - places, self._normals_at(places, triangles))
        gaps, inside = np.sqrt(squares), heights < 0.0
        on = gaps < 1e-6 * self.surface.size  # too near for rounding
        inside[on] = self.inside(points[on])
        return np.where(inside, -1.0, 1.0) * gaps

    def _normals_at(self, places: Points, triangles: Int[np.ndarray, " points"]) -> Points:
        """Pseudonormals of places on triangles: those of the edge or corner where they lie on one.

        Their sides are right for all points that are nearest to the place (Baerentzen and Aanaes 2005).
        """
        corners = self.surface.vertices[self.surface.triangles[triangles]]
        result = self.normals[triangles].copy()
        near = 1e-7
        heights = np.stack(
            [
                np.linalg.norm(np.cross(corners[:, (k + 1) % 3] - places, corners[:, (k + 2) % 3] - places), axis=1)
                for k in range(3)
            ],
            axis=1,
        )
        on_edge = heights < near * np.linalg.norm(self.surface.crosses[triangles], axis=1, keepdims=True)
        edges, vertices = self._edge_normals, self._vertex_normals
        for side in range(3):  # opposite to the corner of this number
            some = on_edge[:, side]
            result[some] = edges[triangles[some], side]
        for corner in range(3):
            some = on_edge[:, (corner + 1) % 3] & on_edge[:, (corner + 2) % 3]
            result[some] = vertices[self.surface.triangles[triangles[some], corner]]
        return result

    @cached_property
    def _edge_normals(self) -> Float[np.ndarray, "triangles 3 3"]:
        """Sum of the normals at the edge opposite to each corner of each triangle."""
        ends = self.surface.triangles[:, [1, 2, 0]], self.surface.triangles[:, [2, 0, 1]]
        count = len(self.surface.vertices)
        keys = (np.minimum(*ends) * count + np.maximum(*ends)).ravel()
        _, which = np.unique(keys, return_inverse=True)
        normals = np.repeat(self.normals, 3, axis=0)
        total = np.stack([np.bincount(which, axis) for axis in normals.T], axis=1)
        return total[which].reshape(-1, 3, 3)

    @cached_property
    def _vertex_normals(self) -> Float[np.ndarray, "vertices 3"]:
        """Sum of the normals at each vertex, weighted by the angles of their triangles there."""
        corners = self.surface.vertices[self.surface.triangles]
        one, two = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
        angles = np.arctan2(np.linalg.norm(np.cross(one, two), axis=2), np.einsum("tcd,tcd->tc", one, two))
        weighted = (angles[:, :, None] * self.normals[:, None]).reshape(-1, 3)
        at, count = self.surface.triangles.ravel(), len(self.surface.vertices)
        return np.stack([np.bincount(at, axis, minlength=count) for axis in weighted.T], axis=1)

    def gaps(self, points: Points) -> Vector:
        """Distance of points from the surface [m], inside or outside alike."""
        return np.sqrt(self._nearest(points)[0])

    def nearest(self, points: Points) -> tuple[Points, Int[np.ndarray, " points"]]:
        """Nearest place of the surface to each point [m], and the triangle that it is on."""
        _, triangles, places = self._nearest(points)
        return places, triangles.astype(np.int64)  # from long long, another type to NumPy

    def first_hits(self, starts: Points, directions: Points, reach: float) -> tuple[Int[np.ndarray, " points"], Vector]:
        """First triangle that a ray from each point meets, -1 for none, and the length of the ray until there [m]."""
        tree, vertices = self._ray_tree
        scale = _RAY_SIZE / self.surface.size
        found, lengths, _ = tree.intersect_ray_first(
            vertices, self.surface.triangles, scale * starts, np.ascontiguousarray(directions), scale * reach
        )
        return found.astype(np.int64), lengths / scale

    @cached_property
    def normals(self) -> Float[np.ndarray, "triangles 3"]:
        """Unit normal of each triangle, outward; zero where a triangle has no area."""
        crosses = self.surface.crosses
        lengths = np.linalg.norm(crosses, axis=1, keepdims=True)
        return crosses / np.where(lengths > 0, lengths, 1.0)

    def _nearest(self, points: Points) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Squared distances, triangles and places."""
        return self._distance_tree.squared_distance(
            self.surface.vertices, self.surface.triangles, np.ascontiguousarray(points)
        )

    @cached_property
    def _distance_tree(self) -> Any:
        import igl

        tree = igl.AABB()
        tree.init(self.surface.vertices, self.surface.triangles)
        return tree

    @cached_property
    def _ray_tree(self) -> tuple[Any, Points]:
        """Tree of the surface, scaled, and its vertices."""
        import igl

        tree, vertices = igl.AABB(), self.surface.vertices * (_RAY_SIZE / self.surface.size)
        tree.init(vertices, self.surface.triangles)
        return tree, vertices

    @cached_property
    def _winding_tree(self) -> Any:
        import igl

        tree = igl.FastWindingNumberBVH()
        tree.init(self.surface.vertices, self.surface.triangles)
        return tree
