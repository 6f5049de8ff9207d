"""The lines of a solid that a draughtsman draws: sharp edges, and the rims of round sides."""

from dataclasses import dataclass
from typing import Self, no_type_check

import numpy as np
from jaxtyping import Float, Int
from numba import njit

from hydrostat.kernel import KERNEL

Segments = Float[np.ndarray, "segments 2 3"]
"""Straight pieces of lines by both ends [mm]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Facets:
    """Triangles with a normal at each corner: one for both sides of an edge that is not sharp.

    Attributes:
        vertices: [mm], none twice.
        triangles: seen from outside they turn counter-clockwise; none without area.
        normals: of the triangles, unit vectors.
        corners: unit normals at the corners of each triangle, (triangles, 3, 3).
        sharpest: cosine of the angle between two normals from which an edge is sharp.
        source: which triangles of the mesh they are.
    """

    vertices: Float[np.ndarray, "vertices 3"]
    triangles: Int[np.ndarray, "triangles 3"]
    normals: Float[np.ndarray, "triangles 3"]
    corners: Float[np.ndarray, "triangles 3 3"]
    sharpest: float
    source: Int[np.ndarray, " triangles"]

    @classmethod
    def of(
        cls, vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"], *, sharp: float
    ) -> Self:
        """Facets of a mesh; an edge is sharp where its sides turn by more than `sharp` [degrees]."""
        scale = max(float(np.ptp(vertices, axis=0).max()), 1e-12)
        _, kept, names = np.unique(np.round(vertices / scale, 9), axis=0, return_index=True, return_inverse=True)
        vertices, triangles = vertices[kept], names.reshape(-1)[triangles]
        one, two, three = (vertices[corner] for corner in triangles.T)
        crosses = np.cross(two - one, three - one)
        areas = np.linalg.norm(crosses, axis=1)
        thick = areas > 1e-12 * scale**2
        triangles, normals = triangles[thick], crosses[thick] / areas[thick, None]
        sharpest = float(np.cos(np.radians(sharp)))
        corners = smooth_normals(vertices, triangles, normals, *_stars(len(vertices), triangles), sharpest)
        return cls(
            vertices=vertices,
            triangles=triangles,
            normals=normals,
            corners=corners,
            sharpest=sharpest,
            source=np.flatnonzero(thick),
        )

    def sharp_edges(self) -> Segments:
        """Edges where sides meet at an angle, and those with one side only."""
        sides = np.sort(self.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        owners = np.repeat(np.arange(len(self.triangles)), 3)
        order = np.lexsort((owners, sides[:, 1], sides[:, 0]))
        sides, owners = sides[order], owners[order]
        starts = np.flatnonzero(np.r_[True, (np.diff(sides, axis=0) != 0).any(axis=1)])
        counts = np.diff(np.r_[starts, len(sides)])
        paired = starts[counts == 2]
        cosines = np.einsum("ij,ij->i", self.normals[owners[paired]], self.normals[owners[paired + 1]])
        chosen = np.sort(np.r_[starts[counts != 2], paired[cosines < self.sharpest]])
        return self.vertices[sides[chosen]]

    def rims(self, near: Float[np.ndarray, " 3"]) -> Segments:
        """Where round sides turn away from an eye in the direction `near` (Hertzmann and Zorin, 2000)."""
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


def _stars(count: int, triangles: Int[np.ndarray, "triangles 3"]) -> tuple[np.ndarray, np.ndarray]:
    """Triangles round each vertex: where its list begins, and the lists."""
    order = np.argsort(triangles.reshape(-1), kind="stable")
    return np.searchsorted(triangles.reshape(-1)[order], np.arange(count + 1)), order // 3


@njit(**KERNEL)
@no_type_check
def smooth_normals(vertices, triangles, normals, starts, stars, sharpest):
    """Mean normal, weighted by angle, of the triangles round each corner that are not beyond a sharp edge."""
    corners = np.empty((len(triangles), 3, 3))
    angles = np.empty((len(triangles), 3))
    for index in range(len(triangles)):
        for corner in range(3):
            here = vertices[triangles[index, corner]]
            one = vertices[triangles[index, (corner + 1) % 3]] - here
            two = vertices[triangles[index, (corner + 2) % 3]] - here
            cosine = (one @ two) / np.sqrt((one @ one) * (two @ two))
            angles[index, corner] = np.arccos(min(max(cosine, -1.0), 1.0))
    for index in range(len(triangles)):
        for corner in range(3):
            vertex = triangles[index, corner]
            mean = np.zeros(3)
            for place in range(starts[vertex], starts[vertex + 1]):
                other = stars[place]
                if normals[index] @ normals[other] > sharpest:
                    for side in range(3):
                        if triangles[other, side] == vertex:
                            mean += angles[other, side] * normals[other]
            length = np.sqrt(mean @ mean)
            corners[index, corner] = mean / length if length > 1e-12 else normals[index]
    return corners
