"""`Solid`: what a closed surface encloses, asked by points."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from hydrostat.arrays import Points, Vector
from hydrostat.geometry.surface import Surface


@dataclass(frozen=True, eq=False)
class Solid:
    """The inside of a surface, by its winding number (Jacobson et al. 2013; fast: Barill et al. 2018).

    Attributes:
        surface: closed, oriented outward.
    """

    surface: Surface

    def __getstate__(self) -> dict[str, Any]:
        """What another process is sent: trees cannot be, and are made again where they are asked for."""
        return {"surface": self.surface}

    def winding(self, points: Points) -> Vector:
        """How often the surface goes round each point: 1 inside, 0 outside, in between near holes."""
        return self._winding_tree.winding_number(np.ascontiguousarray(points))

    def inside(self, points: Points) -> Bool[np.ndarray, " points"]:
        """Whether points lie inside."""
        return self.winding(points) > 0.5

    def distances(self, points: Points) -> Vector:
        """Distance of points from the surface [m], negative inside."""
        squares = self._distance_tree.squared_distance(
            self.surface.vertices, self.surface.triangles, np.ascontiguousarray(points)
        )[0]
        return np.where(self.inside(points), -1.0, 1.0) * np.sqrt(squares)

    def nearest(self, points: Points) -> tuple[Points, Int[np.ndarray, " points"]]:
        """The nearest place of the surface to each point [m], and the triangle that it is on."""
        _, triangles, places = self._distance_tree.squared_distance(
            self.surface.vertices, self.surface.triangles, np.ascontiguousarray(points)
        )
        return places, triangles.astype(np.int64)  # from long long, another type to NumPy

    @cached_property
    def normals(self) -> Float[np.ndarray, "triangles 3"]:
        """Unit normal of each triangle, outward; zero where a triangle has no area."""
        crosses = self.surface.crosses
        lengths = np.linalg.norm(crosses, axis=1, keepdims=True)
        return crosses / np.where(lengths > 0, lengths, 1.0)

    @cached_property
    def _distance_tree(self) -> Any:
        import igl

        tree = igl.AABB()
        tree.init(self.surface.vertices, self.surface.triangles)
        return tree

    @cached_property
    def _winding_tree(self) -> Any:
        import igl

        tree = igl.FastWindingNumberBVH()
        tree.init(self.surface.vertices, self.surface.triangles)
        return tree
