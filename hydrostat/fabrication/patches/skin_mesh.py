"""`SkinMesh`: the skin of a body in triangles, and which patch each belongs to; dividing it along a line."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hydrostat.arrays import Bool, Float, Int
from hydrostat.errors import InputError
from hydrostat.fabrication.solids.printed import TriangleMesh, number_groups
from hydrostat.geometry import Surface
from hydrostat.robot import Body


@dataclass(frozen=True, eq=False, kw_only=True)
class SkinMesh(TriangleMesh):
    """A closed surface cut into patches."""

    patch: Int[np.ndarray, " triangles"]  # number of the patch of each triangle

    @cached_property
    def edges(self) -> tuple[Int[np.ndarray, "edges 2"], Int[np.ndarray, "triangles 3"]]:
        """Every edge once, and the edges of each triangle: from its first corner to its second, and so on."""
        sides = ((0, 1), (1, 2), (2, 0))
        ends = np.sort(self.triangles[:, sides], axis=2).reshape(-1, 2)
        edges, index = np.unique(ends, axis=0, return_inverse=True)
        return edges, index.reshape(-1, 3)

    @cached_property
    def neighbors(self) -> Int[np.ndarray, "edges 2"]:
        """The two triangles at each edge."""
        edges, of = self.edges
        order = np.argsort(of.ravel(), kind="stable")
        return (order // 3).reshape(len(edges), 2)

    def pieces(self, label: Int[np.ndarray, " triangles"]) -> Int[np.ndarray, " triangles"]:
        """Number the connected groups of triangles with one label, in the order of their first triangles."""
        sides = self.neighbors
        same = sides[label[sides[:, 0]] == label[sides[:, 1]]]
        return number_groups(same, len(self.triangles))

    def relabel_patches(self, patch: Int[np.ndarray, " triangles"]) -> "SkinMesh":
        """Return the same triangles with other patch numbers."""
        return SkinMesh(vertices=self.vertices, triangles=self.triangles, patch=patch)

    def divide_edges(
        self, marked: Bool[np.ndarray, " edges"], share: Float[np.ndarray, " edges"]
    ) -> tuple["SkinMesh", Int[np.ndarray, " parts"]]:
        """Put a vertex on each marked edge, at a share of it, and divide triangles there.

        Returns the new mesh, its new vertices after the old ones in the order of the edges; and of each triangle the
        old one.
        """
        edges, of = self.edges
        ends = self.vertices[edges[marked]]
        along = share[marked, None]
        vertices = np.concatenate([self.vertices, (1 - along) * ends[:, 0] + along * ends[:, 1]])
        new = np.full(len(edges), -1)
        new[marked] = len(self.vertices) + np.arange(int(marked.sum()))
        parts, parents = [], []
        for index in range(len(self.triangles)):
            pieces = _divide_triangle(self.triangles[index].tolist(), new[of[index]].tolist(), vertices)
            parts += pieces
            parents += [index] * len(pieces)
        parent = np.array(parents, dtype=np.int64)
        mesh = SkinMesh(vertices=vertices, triangles=np.array(parts, dtype=np.int64), patch=self.patch[parent])
        return mesh, parent


def _divide_triangle(
    corners: list[int], middles: list[int], vertices: Float[np.ndarray, "vertices 3"]
) -> list[list[int]]:
    """A triangle with new vertices on its sides (-1: none), in triangles."""
    count = sum(middle >= 0 for middle in middles)
    if count == 0:
        return [corners]
    if count == 3:
        (a, b, c), (d, e, f) = corners, middles
        return [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
    first = next(
        side for side in range(3) if middles[side] >= 0 and (count == 1 or middles[(side + 1) % 3] >= 0)
    )  # of two new vertices in a row the first
    a, b, c = (corners[(first + step) % 3] for step in range(3))
    d, e = middles[first], middles[(first + 1) % 3]
    if count == 1:
        return [[a, d, c], [d, b, c]]
    across = np.linalg.norm(vertices[a] - vertices[e]) <= np.linalg.norm(vertices[d] - vertices[c])
    rest = [[a, d, e], [a, e, c]] if across else [[a, d, c], [d, e, c]]
    return [[d, b, e], *rest]


def skin_mesh(body: Body) -> SkinMesh:
    """The skin of a body as one patch of small triangles (InputError: flat, hollow, in pieces, or with a handle)."""
    if body.mesh.dim != 3:
        raise InputError("a flat body has a flat pattern of its own")
    return skin_of_surface(body.healing.surface if body.healing else _boundary(body))


def skin_of_surface(surface: Surface) -> SkinMesh:
    """A closed surface [m] as one patch of small triangles [mm] (InputError: hollow, in pieces, or with a handle)."""
    mesh = SkinMesh(
        vertices=1e3 * surface.vertices,
        triangles=surface.triangles.astype(np.int64),
        patch=np.zeros(len(surface.triangles), dtype=np.int64),
    )
    edges = mesh.edges[0]
    if mesh.pieces(mesh.patch).max() > 0:
        raise InputError("the body is hollow or in several pieces. A sewn skin needs one closed surface")
    if len(mesh.vertices) - len(edges) + len(mesh.triangles) != 2:
        raise InputError("a hole goes through the body, so its skin cannot be cut into flat patches. Cast it in a mold")
    share = 0.03  # longest edge, as a share of the diagonal of the body: fine enough for smooth seams
    return _fine(_coarse(mesh), share * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))))


def _boundary(body: Body) -> Surface:
    """The outer triangles of a mesh of tetrahedra."""
    used, triangles = np.unique(body.mesh.boundary, return_inverse=True)
    return Surface(body.mesh.nodes[used], triangles.reshape(-1, 3))


def _coarse(mesh: SkinMesh) -> SkinMesh:
    """The surface with fewer triangles if it has very many; by quadric errors (Garland, Heckbert 1997)."""
    import igl

    most, enough = 6000, 5000  # a surface of more triangles than the first is made coarser, to the second
    if len(mesh.triangles) <= most:
        return mesh
    found = igl.qslim(np.asfortranarray(mesh.vertices), np.asfortranarray(mesh.triangles), enough)
    triangles = np.asarray(found[1]).astype(np.int64)
    fewer = SkinMesh(vertices=np.array(found[0]), triangles=triangles, patch=np.zeros(len(triangles), dtype=np.int64))
    closed = len(fewer.vertices) - len(fewer.edges[0]) + len(fewer.triangles) == 2
    return fewer if closed and 3 * len(triangles) == 2 * len(fewer.edges[0]) else mesh


def _fine(mesh: SkinMesh, longest: float) -> SkinMesh:
    """The same surface with no edge longer than that [mm]: such edges are halved."""
    while True:
        ends = mesh.vertices[mesh.edges[0]]
        long = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > longest
        if not long.any():
            return mesh
        mesh, _ = mesh.divide_edges(long, np.full(len(long), 0.5))


def cut_at_zero(
    mesh: SkinMesh, field: Float[np.ndarray, " vertices"], inside: Bool[np.ndarray, " triangles"]
) -> tuple[SkinMesh, Int[np.ndarray, " parts"], Int[np.ndarray, " parts"]]:
    """The mesh divided at a field's zero; of each triangle the old one, and 1 above, -1 below, 0 outside the part."""
    edges = mesh.edges[0]
    touched = np.zeros(len(edges), dtype=bool)
    touched[mesh.edges[1][inside]] = True
    field = _snap_field(mesh, field, touched, inside)
    ends = field[edges]
    marked = touched & (ends[:, 0] * ends[:, 1] < 0)
    share = np.zeros(len(edges))
    share[marked] = ends[marked, 0] / (ends[marked, 0] - ends[marked, 1])
    divided, parent = mesh.divide_edges(marked, share)
    heights = np.concatenate([field, np.zeros(int(marked.sum()))])[divided.triangles]
    side = np.sign(heights[np.arange(len(heights)), np.abs(heights).argmax(axis=1)]).astype(np.int64)
    return divided, parent, np.where(inside[parent], side, 0)


def _snap_field(
    mesh: SkinMesh,
    field: Float[np.ndarray, " vertices"],
    touched: Bool[np.ndarray, " edges"],
    inside: Bool[np.ndarray, " triangles"],
) -> Float[np.ndarray, " vertices"]:
    """The field with zeros where its zero line passes close to a vertex, but never at all corners of a triangle."""
    edges = mesh.edges[0][touched]
    ends = field[edges]
    crossing = ends[:, 0] * ends[:, 1] < 0
    share = np.abs(ends[crossing]) / np.abs(ends[crossing]).sum(axis=1, keepdims=True)
    field = field.copy()
    least = 1e-9 * max(float(np.abs(field).max()), 1e-300)
    exact = np.where(field == 0, least, field)
    # a line that passes a corner nearer than this share of an edge goes through the corner: no slivers
    near = 0.05
    field[edges[crossing][share < near]] = 0.0
    while True:
        flat = inside & (field[mesh.triangles] == 0).all(axis=1)
        if not flat.any():
            return field
        field[mesh.triangles[flat]] = exact[mesh.triangles[flat]]
