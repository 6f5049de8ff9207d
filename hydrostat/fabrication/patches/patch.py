"""`Patch`: a disc of the skin with its own vertices, and where they lie once it is flat."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from shapely import Polygon

from hydrostat.arrays import Float, Int
from hydrostat.fabrication.patches.skin_mesh import SkinMesh
from hydrostat.fabrication.solids.printed import TriangleMesh, number_groups


@dataclass(frozen=True, eq=False, kw_only=True)
class Disc(TriangleMesh):
    """A patch in space, with vertices of its own."""

    rim: Int[np.ndarray, " rim"]  # its boundary, counter-clockwise from outside
    of: Int[np.ndarray, " vertices"]  # number of each vertex in the skin


@dataclass(frozen=True, eq=False, kw_only=True)
class Patch:
    """A disc with its flat image."""

    disc: Disc  # in space
    flat: Float[np.ndarray, "vertices 2"]  # positions of its vertices [mm], seen from outside

    @property
    def outline(self) -> Polygon:
        """The seam line [mm]."""
        return Polygon(self.flat[self.disc.rim])

    @cached_property
    def flat_areas(self) -> Float[np.ndarray, " triangles"]:
        """Areas of the flat triangles [mm^2], below 0 where one lies on its back."""
        corners = self.flat[self.disc.triangles]
        one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        return (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2


def disc_of(mesh: SkinMesh, number: int) -> Disc:
    """The patch of this number, which has to be a disc.

    Where it touches itself in one vertex only, that becomes two: corners are one vertex if an edge joins them.
    """
    inside = np.flatnonzero(mesh.patch == number)
    corners, ends = mesh.triangles[inside].ravel(), mesh.neighbors
    place = np.full(len(mesh.triangles), -1)
    place[inside] = np.arange(len(inside))
    shared = (mesh.patch[ends] == number).all(axis=1)
    links = [
        [3 * place[side] + (mesh.triangles[side] == vertex[:, None]).argmax(axis=1) for side in ends[shared].T]
        for vertex in mesh.edges[0][shared].T
    ]
    groups = number_groups(np.concatenate(links, axis=1).T, len(corners))
    of = np.zeros(int(groups.max()) + 1, dtype=np.int64)
    of[groups] = corners
    triangles = groups.reshape(-1, 3)
    return Disc(vertices=mesh.vertices[of], triangles=triangles, rim=rim_of(triangles), of=of)


def rim_of(triangles: Int[np.ndarray, "triangles 3"]) -> Int[np.ndarray, " rim"]:
    """The one boundary of a disc, counter-clockwise from outside, from its vertex with the least number."""
    sides = {(a, b) for a, b in triangles[:, ((0, 1), (1, 2), (2, 0))].reshape(-1, 2).tolist()}
    after = {a: b for a, b in sides if (b, a) not in sides}
    rim = [min(after)]
    while (following := after[rim[-1]]) != rim[0]:
        rim.append(following)
    if len(rim) != len(after):
        raise ValueError("this part of the skin is no disc")
    return np.array(rim, dtype=np.int64)
