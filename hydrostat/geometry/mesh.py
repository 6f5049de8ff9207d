"""`Mesh`: triangles in the plane or tetrahedra in space, and their quality."""

from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import combinations, product

import numpy as np

from hydrostat.arrays import Elements, Float, Int, Nodes, Points, Vector
from hydrostat.errors import InputError


def joined_groups(pairs: Int[np.ndarray, "2 joins"], count: int) -> Int[np.ndarray, " count"]:
    """Group of each of `count` items that are joined in pairs, numbered by first member.

    Each thing points to one of its group with a lower number, until all of a group point to its first. As
    `scipy.sparse.csgraph.connected_components`, which takes 0.06 s to import.
    """
    first = np.arange(count)
    while True:
        one, two = first[pairs]
        apart = one != two
        low, high = np.minimum(one, two)[apart], np.maximum(one, two)[apart]
        if not high.size:
            return np.unique(first, return_inverse=True)[1]
        np.minimum.at(first, high, low)
        while (first[first] != first).any():
            first = first[first]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Mesh of linear simplices: triangles (dim 2) or tetrahedra (dim 3), positively oriented.

    Raises InputError: wrong shapes, nodes that are not finite, indices out of range, or an element without positive
    volume.
    """

    nodes: Nodes  # rest positions [m], (nodes, dim); kept as a read-only copy
    elements: Elements  # node indices, (elements, dim + 1); kept as a read-only copy
    # nodes of quadratic elements: corners, then middles of edges in the order of `combinations`; each is 2^dim of
    # `elements`, one after the other; None for a mesh of linear elements
    quadratic: Int[np.ndarray, "quadratic _"] | None = None

    def __post_init__(self) -> None:
        nodes = np.array(self.nodes, dtype=float)
        elements = np.array(self.elements, dtype=np.int64)
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(self, "elements", elements)
        if nodes.ndim != 2 or nodes.shape[1] not in (2, 3) or not np.isfinite(nodes).all():
            raise InputError("a mesh needs finite nodes in the plane or in space, (nodes, 2) or (nodes, 3)")
        if elements.ndim != 2 or elements.shape[1] != self.dim + 1:
            raise InputError(
                f"a mesh of dimension {self.dim} needs {self.dim + 1} nodes an element, not {elements.shape[-1]}"
            )
        if elements.size and (elements.min() < 0 or elements.max() >= len(nodes)):
            raise InputError("the mesh names a node that it does not have")
        extent = float(np.abs(nodes).max(initial=0.0))
        bad = np.flatnonzero(~(self.volumes > 1e-20 * extent**self.dim))
        if bad.size:
            raise InputError(f"{bad.size} mesh elements have no positive volume, the first is number {bad[0]}")
        nodes.setflags(write=False)
        elements.setflags(write=False)
        if self.quadratic is not None:
            quadratic = np.array(self.quadratic, dtype=np.int64)
            if len(quadratic) << self.dim != len(elements):
                raise InputError(f"each quadratic element must be {2**self.dim} of the elements")
            object.__setattr__(self, "quadratic", quadratic)
            quadratic.setflags(write=False)

    @property
    def dim(self) -> int:
        """2 for triangles, 3 for tetrahedra."""
        return self.nodes.shape[1]

    def to_quadratic(self) -> "Mesh":
        """Return a mesh with a node in the middle of each edge; elements are cut into 4 triangles or 8 tetrahedra."""
        linear = self.to_linear()
        pairs = list(combinations(range(self.dim + 1), 2))
        count = len(linear.nodes)
        keys = linear.edges @ [count, 1]
        ends = [np.sort(linear.elements[:, pair], axis=1) @ [count, 1] for pair in pairs]
        middles = count + np.stack([np.searchsorted(keys, numbers) for numbers in ends], axis=1)
        nodes = np.concatenate([linear.nodes, linear.nodes[linear.edges].mean(axis=1)])
        quadratic = np.concatenate([linear.elements, middles], axis=1)
        return Mesh(nodes, _split_quadratic(nodes, quadratic), quadratic)

    def to_linear(self) -> "Mesh":
        """Return a mesh of linear elements with the same corners; itself if it is linear."""
        if self.quadratic is None:
            return self
        corners = self.quadratic[:, : self.dim + 1]
        return Mesh(self.nodes[: int(corners.max()) + 1], corners)

    @cached_property
    def parts(self) -> Int[np.ndarray, " nodes"]:
        """Index of the connected part that each node belongs to; elements that share a node are in one part."""
        ends = np.stack([self.elements[:, :-1].ravel(), self.elements[:, 1:].ravel()])
        return joined_groups(ends, len(self.nodes))

    @property
    def kind(self) -> str:
        """Name of the element shape."""
        return "triangles" if self.dim == 2 else "tetrahedra"

    def describe(self) -> str:
        """Return the numbers of nodes and elements as text."""
        if self.quadratic is None:
            return f"{len(self.nodes)} nodes, {len(self.elements)} {self.kind}"
        return f"{len(self.nodes)} nodes, {len(self.quadratic)} quadratic {self.kind}"

    @cached_property
    def volumes(self) -> Float[np.ndarray, " elements"]:
        """Signed area [m^2] of each triangle or volume [m^3] of each tetrahedron."""
        corners = self.nodes[self.elements]
        factorial = 2.0 if self.dim == 2 else 6.0
        return np.linalg.det(corners[:, 1:] - corners[:, :1]) / factorial

    @cached_property
    def boxes(self) -> tuple[Float[np.ndarray, "elements dim"], Float[np.ndarray, "elements dim"]]:
        """Lowest and highest corner of the box around each element, enlarged by a millionth of its longest side [m]."""
        corners = [self.nodes[corner] for corner in self.elements.T]
        low, high = reduce(np.minimum, corners), reduce(np.maximum, corners)
        margin = 1e-6 * (high - low).max(axis=1)[:, None]
        return low - margin, high + margin

    @cached_property
    def cells(self) -> tuple[tuple[np.ndarray, float, np.ndarray], np.ndarray, np.ndarray]:
        """Search grid for elements: lowest corner, side [m] and counts; where each cell begins; its elements.

        An element is listed in all cells that its box touches, in rising order; cells are as wide as the largest box.
        """
        low, high = self.boxes
        corner, size = low.min(axis=0), float((high - low).max()) * (1 + 1e-9)
        counts = np.floor((high.max(axis=0) - corner) / size).astype(np.int64) + 1
        first, last = (
            np.clip(np.floor((ends - corner) / size), 0, counts - 1).astype(np.int64) for ends in (low, high)
        )
        cells, owners = [], []
        for steps in product((0, 1, 2), repeat=self.dim):
            touched = np.flatnonzero((first + steps <= last).all(axis=1))
            cells.append(np.ravel_multi_index(tuple((first[touched] + steps).T), tuple(counts)))
            owners.append(touched)
        cell, owner = np.concatenate(cells), np.concatenate(owners)
        order = np.lexsort((owner, cell))
        starts = np.searchsorted(cell[order], np.arange(int(np.prod(counts)) + 1))
        return (corner, size, counts), starts, owner[order]

    @cached_property
    def inverse_spans(self) -> Float[np.ndarray, "elements dim dim"]:
        """Inverse of the matrix whose columns are the edges from the first corner of each element [1/m]."""
        corners = self.nodes[self.elements]
        return np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))

    @cached_property
    def facet_balls(self) -> tuple[Float[np.ndarray, "facets dim"], Float[np.ndarray, " facets"]]:
        """Center and radius of the bounding ball of each facet of `boundary` [m]."""
        corners = self.nodes[self.boundary]
        middles = corners.mean(axis=1)
        return middles, np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)

    @cached_property
    def edges(self) -> Int[np.ndarray, "edges 2"]:
        """Every edge once, lower node first, sorted."""
        count = max(len(self.nodes), 1)  # each pair as one number: far quicker to sort than rows
        pairs = [(self.elements[:, one], self.elements[:, two]) for one, two in combinations(range(self.dim + 1), 2)]
        numbers = np.concatenate([np.minimum(*pair) * count + np.maximum(*pair) for pair in pairs])
        return np.stack(np.divmod(np.unique(numbers), count), axis=1)

    @cached_property
    def boundary(self) -> Int[np.ndarray, "facets dim"]:
        """Facets that belong to only one element, oriented with the body inside (left in the plane)."""
        return self._outer_facets[0]

    @cached_property
    def boundary_elements(self) -> Int[np.ndarray, " facets"]:
        """Element that each facet of `boundary` belongs to."""
        return self._outer_facets[1]

    @cached_property
    def element_groups(self) -> Int[np.ndarray, " elements"]:
        """Group of each element; elements of a group are connected through facets, not only at nodes."""
        _, order, again = self._ordered_facets
        joins = np.stack([order[:-1][again], order[1:][again]])
        return joined_groups(joins % max(len(self.elements), 1), len(self.elements))

    @cached_property
    def _outer_facets(self) -> tuple[np.ndarray, np.ndarray]:
        """Boundary facets and their elements."""
        facets, order, again = self._ordered_facets
        outer = np.sort(order[~(np.append(again, False) | np.append(False, again))[: len(order)]])
        return facets[outer], outer % max(len(self.elements), 1)

    @cached_property
    def _ordered_facets(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Facets of all elements, an order that puts equal ones together, and a mask of those that equal the next.

        Leaving out an odd corner turns the rest over.
        """
        corners = range(self.dim + 1)
        facets = np.concatenate([np.delete(self.elements, corner, axis=1) for corner in corners])
        odd = np.repeat([corner % 2 == 1 for corner in corners], len(self.elements))
        facets[odd, :2] = facets[odd, 1::-1]
        risen = np.sort(facets, axis=1)
        order = np.lexsort((risen[:, 1], risen[:, 0] * len(self.nodes) + risen[:, -1]))
        return facets, order, (risen[order[1:]] == risen[order[:-1]]).all(axis=1)

    @cached_property
    def boundary_nodes(self) -> Int[np.ndarray, " nodes"]:
        """Nodes on the boundary, sorted."""
        return np.unique(self.boundary)

    def cavity(self, point: Float[np.ndarray, " dim"]) -> Int[np.ndarray, "facets dim"]:
        """Return the facets of `boundary` that close a hole around a point [m]; none if it is in no hole."""
        facets = self.boundary
        group = joined_groups(facets[:, [0, -1]].T, len(self.nodes))
        if self.dim == 3:
            group = joined_groups(np.concatenate([facets[:, :2], facets[:, 1:]]).T, len(self.nodes))
        turns = np.bincount(group[facets[:, 0]], _angles_seen(self.nodes[facets] - point), int(group.max()) + 1)
        around = np.flatnonzero(turns < -0.5)  # the outer rim turns the other way
        return facets[np.isin(group[facets[:, 0]], around)]

    @cached_property
    def size(self) -> float:
        """Longest side of the bounding box [m]."""
        return float(np.ptp(self.nodes, axis=0).max())

    @cached_property
    def edge_lengths(self) -> Float[np.ndarray, " edges"]:
        """Length of each edge at rest [m]."""
        return np.linalg.norm(np.diff(self.nodes[self.edges], axis=1)[:, 0], axis=1)

    def smallest_angle(self) -> float:
        """Smallest angle of any triangle [degrees]; 60 at best (InputError: the mesh is not flat)."""
        if self.dim != 2:
            raise InputError(f"angles are those of a flat mesh, this one has dimension {self.dim}")
        return float(angles(self.nodes, self.elements).min())

    @property
    def spacings(self) -> Float[np.ndarray, " elements"]:
        """Edge length [m] of the regular triangle or tetrahedron with the size of each element."""
        return (_REGULAR[self.dim] * self.volumes) ** (1 / self.dim)

    def dihedral_angles(self) -> Float[np.ndarray, " elements"]:
        """Smallest angle between two faces of each tetrahedron [degrees]: at best 70.5, 0 for a flat one."""
        return dihedral_angles(self.nodes, self.elements)

    def facet_areas(self) -> tuple[Vector, Vector]:
        """Area (length in the plane) of each boundary facet at rest, and of each node's share of it [m^dim-1]."""
        corners = self.nodes[self.boundary]
        spans = corners[:, 1:] - corners[:, :1]
        if self.dim == 2:
            areas = np.linalg.norm(spans[:, 0], axis=1)
        else:
            areas = 0.5 * np.linalg.norm(np.cross(spans[:, 0], spans[:, 1]), axis=1)
        shares = np.repeat(areas / self.dim, self.dim)
        return areas, np.bincount(self.boundary.ravel(), shares, len(self.nodes))


def _angles_seen(corners: Float[np.ndarray, "facets dim dim"]) -> Float[np.ndarray, " facets"]:
    """Share of the full angle under which facets are seen from the origin (van Oosterom and Strackee 1983)."""
    if corners.shape[1] == 2:
        one, two = corners[:, 0], corners[:, 1]
        crossed = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        return np.arctan2(crossed, (one * two).sum(axis=1)) / (2 * np.pi)
    lengths = np.linalg.norm(corners, axis=2)
    below = lengths.prod(axis=1)
    for one, two, third in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        below = below + (corners[:, one] * corners[:, two]).sum(axis=1) * lengths[:, third]
    return np.arctan2(np.linalg.det(corners), below) / (2 * np.pi)


def _split_quadratic(nodes: Nodes, quadratic: Int[np.ndarray, "quadratic _"]) -> Elements:
    """Parts of quadratic elements: one at each corner, then what is between, in space about its shortest diagonal."""
    if nodes.shape[1] == 2:
        return quadratic[:, [0, 3, 4, 3, 1, 5, 4, 5, 2, 3, 5, 4]].reshape(-1, 3)
    corners = [[0, 4, 5, 6], [4, 1, 7, 8], [5, 7, 2, 9], [6, 8, 9, 3]]
    # middles: 4 of corners 01, 5 of 02, 6 of 03, 7 of 12, 8 of 13, 9 of 23; diagonals with the ring about each
    inner = np.array([_about((4, 9), (5, 6, 8, 7)), _about((5, 8), (4, 7, 9, 6)), _about((6, 7), (4, 5, 9, 8))])
    ends = nodes[quadratic[:, [[4, 9], [5, 8], [6, 7]]]]
    shortest = np.argmin(np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2).round(12), axis=1)
    places = np.concatenate([np.broadcast_to(corners, (len(quadratic), 4, 4)), inner[shortest]], axis=1)
    elements = np.take_along_axis(quadratic, places.reshape(len(quadratic), -1), axis=1).reshape(-1, 4)
    spans = nodes[elements[:, 1:]] - nodes[elements[:, :1]]
    turned = np.linalg.det(spans) < 0
    elements[turned, :2] = elements[turned, 1::-1]
    return elements


def _about(diagonal: tuple[int, int], ring: tuple[int, ...]) -> list[tuple[int, ...]]:
    return [(*diagonal, one, two) for one, two in zip(ring, ring[1:] + ring[:1], strict=True)]


def angles(points: Points, triangles: Elements) -> Float[np.ndarray, " triangles"]:
    """Smallest angle of each triangle [degrees]."""
    corners = points[triangles]
    sides = np.sort(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2), axis=1)
    cosine = (sides[:, 1] ** 2 + sides[:, 2] ** 2 - sides[:, 0] ** 2) / (2.0 * sides[:, 1] * sides[:, 2])
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def dihedral_angles(nodes: Nodes, elements: Elements) -> Float[np.ndarray, " elements"]:
    """Smallest angle between two faces of each tetrahedron [degrees]: 70.5 at best, 0 where it is flat or inverted."""
    corners = nodes[elements]
    spans = corners[:, 1:] - corners[:, :1]
    sizes = np.abs(spans).max(axis=(1, 2), initial=0.0)
    upright = np.linalg.det(spans) > 1e-14 * sizes**3  # below that the inverse is only rounding
    inverse = np.linalg.inv(np.where(upright[:, None, None], spans, np.eye(3)))
    normals = np.concatenate([-inverse.sum(axis=2, keepdims=True), inverse], axis=2)
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    cosines = [-(normals[:, :, one] * normals[:, :, two]).sum(axis=1) for one, two in combinations(range(4), 2)]
    angles = np.degrees(np.arccos(np.clip(np.max(cosines, axis=0), -1.0, 1.0)))
    return np.where(upright, angles, 0.0)


_REGULAR = {2: 4 / 3**0.5, 3: 6 * 2**0.5}  # (Edge of a regular simplex)^dim over its size
