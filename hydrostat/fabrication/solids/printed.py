"""`Printed`: a solid that comes from a 3D printer, and its triangles as files carry them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from manifold3d import Manifold

from hydrostat.arrays import Bool, Float, Int, Vector
from hydrostat.fabrication.solids.construct import Construction, solid_of

_STEP = 2e-5  # minimum distance of vertices that would otherwise coincide [mm]

FileMesh = tuple[Float[np.ndarray, "kept 3"], Int[np.ndarray, "faces 3"]]
"""Vertices [mm], each a number that 32 bits hold, and triangles, counter-clockwise from outside."""


def file_mesh(solid: Manifold) -> FileMesh:
    """The triangles of a solid as STL and 3MF hold them: 32-bit numbers, no vertex twice, none without three corners.

    Vertices that rounding puts in one place become one; triangles that lose a corner by this go, as do two that then
    lie back to back. Where this would open the surface (booleans leave slivers thinner than 32 bits can tell, and
    bodies may touch in an edge), such vertices are instead put beside each other, some 0.00002 mm apart: then files
    that know vertices by their place alone, as STL does, have the very neighbors of the solid.
    """
    mesh = solid.to_mesh64()
    corners = _round_corners(np.asarray(mesh.vert_properties, dtype=float)[:, :3])
    triangles = np.asarray(mesh.tri_verts, dtype=np.int64)
    merged = _merge_corners(corners, triangles)
    return merged if loose_edges(merged[1]) == 0 else _merge_corners(_apart(corners), triangles)


def loose_edges(triangles: Int[np.ndarray, "triangles 3"]) -> int:
    """Return the number of edges that are not used exactly twice, once in each direction."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    forward = edges[:, 0] < edges[:, 1]
    different, which = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    which = which.reshape(-1)
    there = np.bincount(which[forward], minlength=len(different))
    back = np.bincount(which[~forward], minlength=len(different))
    return int(np.count_nonzero((there != 1) | (back != 1)))


def _round_corners(corners: Float[np.ndarray, "corners 3"]) -> Float[np.ndarray, "corners 3"]:
    """The nearest numbers that 32 bits hold, with few decimals; no -0."""
    decimals = 5  # decimals of a coordinate [mm]: the limit of 32-bit numbers for parts up to 128 mm
    return np.round(corners, decimals).astype(np.float32).astype(float) + 0.0


def _merge_corners(corners: Float[np.ndarray, "corners 3"], triangles: Int[np.ndarray, "triangles 3"]) -> FileMesh:
    vertices, which = np.unique(corners, axis=0, return_inverse=True)
    triangles = which.reshape(-1)[triangles]
    first, second, third = triangles.T
    triangles = triangles[(first != second) & (second != third) & (third != first)]
    triangles = triangles[~_flaps(triangles)]
    kept, numbers = np.unique(triangles, return_inverse=True)
    return vertices[kept], numbers.reshape(-1, 3)


def _flaps(triangles: Int[np.ndarray, "triangles 3"]) -> Bool[np.ndarray, " triangles"]:
    """Return True for each triangle back to back with another on the same corners: the two enclose nothing."""
    _, which, used = np.unique(np.sort(triangles, axis=1), axis=0, return_inverse=True, return_counts=True)
    which = which.reshape(-1)
    first, second, third = triangles.T
    rises = ((first < second).astype(int) + (second < third) + (third < first)) == 2
    flaps = np.zeros(len(triangles), dtype=bool)
    for corners in np.flatnonzero(used > 1):
        alike = np.flatnonzero(which == corners)
        one, other = alike[rises[alike]], alike[~rises[alike]]
        pairs = min(len(one), len(other))
        flaps[one[:pairs]] = flaps[other[:pairs]] = True
    return flaps


def _apart(corners: Float[np.ndarray, "corners 3"]) -> Float[np.ndarray, "corners 3"]:
    """The corners with those in one place put next to each other, along x and y in turn so that a flat bottom stays."""
    corners = corners.copy()
    step = max(_STEP, 2 * float(np.spacing(np.float32(np.abs(corners).max(initial=0.0)))))
    for turn in range(100):
        _, first = np.unique(corners, axis=0, return_index=True)
        again = np.setdiff1d(np.arange(len(corners)), first)
        if len(again) == 0:
            break
        corners[again, turn % 2] += step
        corners = _round_corners(corners)
    return corners


SHELL = 1.2  # thickness of the shell that slicers print whole by themselves [mm]: three lines of 0.4 mm


@dataclass(frozen=True, eq=False, kw_only=True)
class Printed:
    """A solid as it lies on the print bed, in millimeters: z up, its lowest point at z = 0."""

    name: str  # stem of its files, of letters, digits and underscores
    title: str  # title for a person
    solid: Manifold  # watertight
    count: int = 1  # number of pieces
    note: str = ""  # instruction to print it
    model: Construction | None = None  # sum of shapes that it is made of, for STEP; None if there is none
    kind: str = ""  # its title without winches or the number of a piece; empty if the title says neither
    winches: tuple[str, ...] = ()  # names of the winches it is for; empty if all share it, or it is of no winch

    @classmethod
    def of(cls, model: Construction, *, name: str, title: str, note: str, count: int = 1) -> "Printed":
        """Part that is made of simple shapes."""
        return cls(name=name, title=title, solid=solid_of(model), count=count, note=note, model=model)

    @cached_property
    def volume(self) -> float:
        """Volume of one, filled [mm^3]."""
        return float(self.solid.volume())

    @cached_property
    def mass(self) -> float:
        """Mass of one in PLA [g], estimated: a whole shell under its surface, little inside; at most all plastic."""
        shell = min(SHELL * float(self.solid.surface_area()), self.volume)
        pla = 1.24e-3  # density of PLA [g/mm^3]
        infill = 0.15  # share of what is inside the shell that is plastic, as slicers have it by themselves
        return pla * (shell + infill * (self.volume - shell))

    @property
    def size(self) -> tuple[float, float, float]:
        """Sides of its box [mm]."""
        low_x, low_y, low_z, high_x, high_y, high_z = self.solid.bounding_box()
        return high_x - low_x, high_y - low_y, high_z - low_z

    def fits(self, bed: tuple[float, float, float]) -> bool:
        """Return True if it fits on a bed [mm]; it may be rotated there, not tilted."""
        (*sides, tall), (*room, high) = self.size, bed
        return tall <= high + 1e-6 and all(a <= b + 1e-6 for a, b in zip(sorted(sides), sorted(room), strict=True))

    @cached_property
    def mesh(self) -> tuple[Float[np.ndarray, "vertices 3"], Int[np.ndarray, "triangles 3"]]:
        """Its vertices [mm] and triangles, as computed."""
        return triangles_of(self.solid)

    @cached_property
    def file_mesh(self) -> FileMesh:
        """Its vertices [mm] and triangles, as every file lists them."""
        return file_mesh(self.solid)


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Surface in triangles."""

    vertices: Float[np.ndarray, "vertices 3"]  # places [mm]
    triangles: Int[np.ndarray, "triangles 3"]  # three vertices each; seen from outside they turn counter-clockwise

    @cached_property
    def corners(self) -> Float[np.ndarray, "triangles 3 3"]:
        """Corners of each triangle [mm]."""
        return self.vertices[self.triangles]

    @cached_property
    def crosses(self) -> Float[np.ndarray, "triangles 3"]:
        """Normal of each triangle, outward, twice as long as its area [mm^2]."""
        corners = self.corners
        return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])

    @cached_property
    def areas(self) -> Vector:
        """Area of each triangle [mm^2]."""
        return np.linalg.norm(self.crosses, axis=1) / 2

    @property
    def facing(self) -> Float[np.ndarray, "vertices 3"]:
        """Outward direction at each vertex, of any length: the sum of its triangles' normals."""
        facing = np.zeros(self.vertices.shape)
        for corner in range(3):
            np.add.at(facing, self.triangles[:, corner], self.crosses)
        return facing


def number_groups(links: Int[np.ndarray, "links 2"], count: int) -> Int[np.ndarray, " count"]:
    """Number the groups of so many things that links join, in the order of their first members."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components  # Imported here: not every command needs it.

    graph = coo_array((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(count, count))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def root_of(parent: list[int], member: int) -> int:
    """The root of a member's group, given the parent of each, which is brought nearer to the root on the way."""
    while parent[member] != member:
        parent[member] = parent[parent[member]]
        member = parent[member]
    return member


def triangles_of(solid: Manifold) -> tuple[Float[np.ndarray, "vertices 3"], Int[np.ndarray, "triangles 3"]]:
    """Vertices [mm] and triangles of a solid; seen from outside these turn counter-clockwise."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3], dtype=float), np.array(mesh.tri_verts, dtype=np.int64)
