"""The lines of a solid that a draughtsman draws: sharp edges (creases), and the rims of round sides (silhouettes)."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from hydrostat.arrays import Float, Int
from hydrostat.geometry import sides_of
from hydrostat.kernel import native

Segments = Float[np.ndarray, "segments 2 3"]  # straight pieces of lines by both ends [mm]


@dataclass(frozen=True, eq=False, kw_only=True)
class Facets:
    """Triangles with a normal at each corner: one for both sides of an edge that is not sharp."""

    vertices: Float[np.ndarray, "vertices 3"]  # [mm], none twice
    triangles: Int[np.ndarray, "triangles 3"]  # seen from outside they turn counter-clockwise; none without area
    normals: Float[np.ndarray, "triangles 3"]  # unit normals of the triangles
    corners: Float[np.ndarray, "triangles 3 3"]  # unit normals at the corners of each triangle, (triangles, 3, 3)
    sharpest: float  # cosine of the angle between two normals from which an edge is sharp
    source: Int[np.ndarray, " triangles"]  # indices of these triangles in the mesh

    @classmethod
    def of(
        cls, vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"], *, sharp: float
    ) -> Self:
        """Facets of a mesh; an edge is sharp where its sides turn by more than `sharp` [degrees]."""
        scale = max(float(np.ptp(vertices, axis=0).max()), 1e-12)
        _, kept, names = np.unique(np.round(vertices / scale, 9), axis=0, return_index=True, return_inverse=True)
        vertices, triangles = vertices[kept], names.reshape(-1)[triangles]
        crosses, areas = _crosses(vertices[triangles])
        thick = areas > 1e-12 * scale**2
        triangles, normals = triangles[thick], crosses[thick] / areas[thick, None]
        angles = np.empty(triangles.shape)
        native.corner_angles(np.ascontiguousarray(vertices), np.ascontiguousarray(triangles), angles)
        return cls(
            vertices=vertices,
            triangles=triangles,
            normals=normals,
            corners=_mean_normals(triangles, normals, angles, sharp),
            sharpest=float(np.cos(np.radians(sharp))),
            source=np.flatnonzero(thick),
        )

    def sharp_edges(self) -> Segments:
        """Edges where sides meet at an angle, and those with one side only."""
        sides = sides_of(self.triangles)
        owners = np.argsort(sides.of.ravel(), kind="stable") // 3
        paired = sides.counts == 2
        first = (np.cumsum(sides.counts) - sides.counts)[paired]
        cosines = np.einsum("ij,ij->i", self.normals[owners[first]], self.normals[owners[first + 1]])
        chosen = ~paired
        chosen[paired] = cosines < self.sharpest
        return self.vertices[sides.ends[chosen]]

    def rims(self, near: Float[np.ndarray, " 3"]) -> Segments:
        """Lines where round sides turn away from an eye in the direction `near` (Hertzmann and Zorin, 2000)."""
        facing = self.corners @ near
        seen = facing >= 0
        turning = np.flatnonzero(seen.any(axis=1) & ~seen.all(axis=1))
        odd = np.where(seen[turning].sum(axis=1) == 1, seen[turning].argmax(axis=1), (~seen[turning]).argmax(axis=1))
        ends = []
        for step in (1, 2):
            other = (odd + step) % 3
            here, there = facing[turning, odd], facing[turning, other]
            share = (here / (here - there))[:, None]
            start, end = (self.vertices[self.triangles[turning, corner]] for corner in (odd, other))
            ends.append((1 - share) * start + share * end)
        return np.stack(ends, axis=1)


def smooth_normals(
    corners: Float[np.ndarray, "triangles 3 3"], triangles: Int[np.ndarray, "triangles 3"], *, sharp: float
) -> Float[np.ndarray, "triangles 3 3"]:
    """Unit normals at the corners of triangles, smooth but for edges that turn by more than `sharp` [degrees].

    Each is the mean over the triangles about its vertex, weighted by area; 0 at a triangle without area.
    """
    crosses, areas = _crosses(corners)
    weights = np.repeat(areas[:, None], 3, axis=1)
    return _mean_normals(triangles, crosses / np.maximum(areas, 1e-300)[:, None], weights, sharp)


def _crosses(
    corners: Float[np.ndarray, "triangles 3 3"],
) -> tuple[Float[np.ndarray, "triangles 3"], Float[np.ndarray, " triangles"]]:
    """Cross products of the triangles' sides, and their lengths: twice the areas."""
    one, two, three = (corners[:, corner] for corner in range(3))
    crosses = np.cross(two - one, three - one)
    return crosses, np.linalg.norm(crosses, axis=1)


def _mean_normals(
    triangles: Int[np.ndarray, "triangles 3"],
    normals: Float[np.ndarray, "triangles 3"],
    weights: Float[np.ndarray, "triangles 3"],
    sharp: float,
) -> Float[np.ndarray, "triangles 3 3"]:
    """Mean of the normals about each corner, weighted, of those that are not beyond a sharp edge [degrees]."""
    order = np.argsort(triangles.reshape(-1), kind="stable")
    counts = np.bincount(triangles.reshape(-1))
    starts = np.concatenate([[0], np.cumsum(counts)])
    corners, sharpest = np.empty((*triangles.shape, 3)), float(np.cos(np.radians(sharp)))
    native.corner_normals(*map(np.ascontiguousarray, (triangles, normals, weights, starts, order)), sharpest, corners)
    return corners
