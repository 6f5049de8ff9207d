"""`FlatSkin`: the smooth boundary of a flat body, stuck to its mesh so that it follows every pose."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from weakref import WeakKeyDictionary

import numpy as np
import shapely
from shapely import MultiPolygon, Polygon

from hydrostat.arrays import Nodes
from hydrostat.errors import InputError
from hydrostat.geometry import Anchors, Mesh, Outline
from hydrostat.plot.sheet import Places, Spread
from hydrostat.robot import Body


@dataclass(frozen=True, eq=False)
class FlatSkin:
    """Rings of points on and inside the boundary of a body."""

    anchors: Anchors  # all points of all rings
    rings: tuple[slice, ...]  # the rings of the boundary, as slices of the anchors; the outer ring first
    stitches: tuple[slice, ...]  # the rings of the seam, a little inside

    @classmethod
    def of(cls, body: Body) -> "FlatSkin":
        """The skin of a flat body: its drawing where there is one, else its mesh's boundary (InputError: in space)."""
        if body.mesh.dim != 2:
            raise InputError("only a flat body has a skin of rings; this one is in space")
        if (known := _SKINS.get(body.mesh)) is not None and known[0] is body.outline:
            return known[1]
        skin = cls._make(body)
        _SKINS[body.mesh] = body.outline, skin
        return skin

    @classmethod
    def _make(cls, body: Body) -> "FlatSkin":
        shape = _shape(body)
        inset = shape.buffer(-0.016 * body.mesh.size, join_style="round")
        edges, seams = _rings(shape, shape.length), _rings(inset, shape.length)
        ends = np.cumsum([0, *map(len, [*edges, *seams])])
        slices = [slice(int(start), int(end)) for start, end in pairwise(ends)]
        points = np.concatenate([*edges, *seams])
        return cls(_stick(body.mesh, points), tuple(slices[: len(edges)]), tuple(slices[len(edges) :]))

    def shape(self, nodes: Nodes) -> list[Places]:
        """The rings of the boundary [m] when the nodes are at `nodes` [m]."""
        return self._at(nodes, self.rings)

    def seam(self, nodes: Nodes) -> list[Places]:
        """The rings of the seam [m] when the nodes are at `nodes` [m]."""
        return self._at(nodes, self.stitches)

    def _at(self, nodes: Nodes, rings: tuple[slice, ...]) -> list[Places]:
        positions = self.anchors.positions(nodes)
        return [_soften(positions[ring]) for ring in rings]


def outer_points(body: Body, shapes: Sequence[Nodes]) -> list[Spread]:
    """Points all along the boundary of a body, for each of its shapes: its nodes [m]; of a flat one on its skin."""
    if body.mesh.dim == 3:
        return [nodes[body.mesh.boundary_nodes] for nodes in shapes]
    skin = FlatSkin.of(body)
    return [skin.shape(nodes)[0] for nodes in shapes]


def _shape(body: Body) -> Polygon | MultiPolygon:
    if body.outline is not None:
        return body.outline.polygon
    triangles = shapely.polygons(body.mesh.nodes[body.mesh.elements])
    return shapely.union_all(triangles)  # pyright: ignore[reportReturnType]


def _rings(shape: Polygon | MultiPolygon, length: float) -> list[Places]:
    """Every ring of a shape as evenly spaced points, the first not repeated."""
    rings = []
    ring_points = 320  # points on a ring as long as the body's whole boundary
    for part in getattr(shape, "geoms", [shape]):
        for ring in (part.exterior, *part.interiors):
            if ring.length > 0:
                count = max(12, round(ring_points * ring.length / length))
                places = np.arange(count) / count * ring.length
                rings.append(shapely.get_coordinates(shapely.line_interpolate_point(ring, places)))
    return rings


def _stick(mesh: Mesh, points: Places) -> Anchors:
    """Stick points to the element that they lie in, or nearly lie in.

    Other than `locate`, a point a little outside is not moved onto the mesh but keeps its place beside the element:
    a smooth drawing stays smooth though its mesh has corners.
    """
    corners = mesh.nodes[mesh.elements]
    inverse = np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
    x, y = points.T[:, :, None] - corners[:, 0].T[:, None]
    second, third = (inverse[:, row, 0] * x + inverse[:, row, 1] * y for row in (0, 1))
    first = 1.0 - (second + third)
    best = np.minimum(first, np.minimum(second, third)).argmax(axis=1)
    rows = np.arange(len(points))
    weights = np.column_stack([weight[rows, best] for weight in (first, second, third)])
    return Anchors(mesh.elements[best], weights, np.zeros(len(points)))


def _soften(ring: Places) -> Places:
    """A closed ring with the small kinks between elements evened out."""
    before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
    smooth = 0.25 * before + 0.5 * ring + 0.25 * after
    return 0.5 * ring + 0.5 * smooth


_SKINS: WeakKeyDictionary[Mesh, tuple[Outline | None, FlatSkin]] = WeakKeyDictionary()
"""The skin of each mesh with its outline: a report draws the same body twenty times."""
