"""`Release`: which parts of a surface come out of a mold that is drawn off in a direction.

A spot comes out upwards if it does not face down and nothing of the body is straight above it; downwards likewise.
This is asked of a point just outside the middle of each triangle.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from manifold3d import Manifold

from hydrostat.arrays import Bool, Float, Vector
from hydrostat.fabrication.solids.printed import TriangleMesh, triangles_of
from hydrostat.kernel import native

_EDGE = 1 / 30  # longest edge of a triangle, in sizes of the body
_SIMPLIFICATION_ERROR = 4e-4  # maximum error of the simplified surface, in sizes of the body


class FineSurface(TriangleMesh):
    """Surface of a body in triangles so small that each is asked once."""

    @cached_property
    def normals(self) -> Float[np.ndarray, "triangles 3"]:
        """Unit normals, outward."""
        return self.crosses / np.maximum(2 * self.areas, 1e-300)[:, None]

    @cached_property
    def middles(self) -> Float[np.ndarray, "triangles 3"]:
        """Middle of each triangle [mm]."""
        return self.corners.mean(axis=1)

    @property
    def size(self) -> float:
        """Longest side of its box [mm]."""
        return float(np.ptp(self.vertices, axis=0).max())


def fine_surface(solid: Manifold) -> FineSurface:
    """The surface of a solid [mm] in triangles that are small, but not too many."""
    low, high = np.reshape(solid.bounding_box(), (2, 3))
    size = float((high - low).max())
    coarse, edge = _SIMPLIFICATION_ERROR, _EDGE
    fine = solid.simplify(coarse * size).refine_to_length(edge * size)
    most = 16_000  # triangles that are looked at, about
    while fine.num_tri() > most and edge < 1:
        coarse, edge = 2 * coarse, 1.5 * edge
        fine = solid.simplify(coarse * size).refine_to_length(edge * size)
    return FineSurface(*triangles_of(fine))


@dataclass(frozen=True, eq=False)
class Release:
    """Triangles that a pull along a direction sets free."""

    heights: Vector  # height of the middle of each triangle along the direction [mm]
    upward: Bool[np.ndarray, " triangles"]  # True for triangles that come out of a half drawn along the direction
    downward: Bool[np.ndarray, " triangles"]  # True for triangles that come out of a half drawn against it

    def undercut(self, height: float) -> Bool[np.ndarray, " triangles"]:
        """Triangles that hold when the halves part at a height [mm]."""
        return np.where(self.heights > height, ~self.upward, ~self.downward)


def release(surface: FineSurface, direction: Float[np.ndarray, "3"]) -> Release:
    """Find what comes out when the mold of a body is drawn off along a unit vector."""
    turned = axes_along(direction).T
    facing = surface.normals @ direction
    # distance of a test point from its triangle, in sizes of the body: shallower overhangs do not count
    out = 5e-4
    asked = (surface.middles + out * surface.size * surface.normals) @ turned
    above, below = np.empty(len(asked), dtype=bool), np.empty(len(asked), dtype=bool)
    native.find_covered(np.ascontiguousarray(asked), np.ascontiguousarray(surface.corners @ turned), above, below)
    # a wall may lean by this cosine and still count as parallel to the pull: rounding, not an overhang
    steep = 1e-3
    return Release(
        heights=surface.middles @ direction, upward=(facing > -steep) & ~above, downward=(facing < steep) & ~below
    )


def axes_along(direction: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """Three unit vectors as rows, right-handed, the last of them given."""
    side = np.zeros(3)
    side[int(np.argmin(np.abs(direction)))] = 1.0
    first = np.cross(side, direction)
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(direction, first), direction])
