"""`tetrahedralize`: good tetrahedra from a closed surface; `fit`: their distance from it."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Bool, Elements, Float, Int, Nodes, Points, Vector
from hydrostat.errors import InputError, SurfaceError
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.sizing import TooManyNodesError
from hydrostat.geometry.surface import Solid, Surface, covering_points
from hydrostat.geometry.tetrahedra.manifold import euler, manifold
from hydrostat.geometry.tetrahedra.small_holes import HOLE_SHARE, fill_small_holes
from hydrostat.geometry.tetrahedra.stuffing import (
    MEAN_EDGE,
    PAIRS,
    Places,
    Tetrahedra,
    bisect,
    find_bridges,
    lattice,
    signed_volumes,
    stuff,
)
from hydrostat.kernel import native

_SAMPLES = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6
"""Places of a facet that should lie on the surface, by their weights."""

_FACING = 0.3
"""Cosine of the angle between a facet and the surface near it, below which that is another part of the surface."""


@dataclass(frozen=True)
class ImproveStage:
    """Rounds of improvement under the same weights."""

    rounds: int  # number of projections of the outer faces onto the surface
    sweeps: int  # number of moves of every node in each round
    power: float  # exponent of the shape measure; the higher, the more the worst elements count
    pull: float  # weight of the surface distance relative to shape, at one element size


def improve(mesh: Mesh, solid: Solid, *, element_size: float, stages: tuple[ImproveStage, ...]) -> Mesh:
    """Mesh with its nodes moved; no element is ever turned over.

    Least of the sum, over tetrahedra, of shape^power and, over points of the outer faces, of their squared distance
    from the surface. shape = (sum of squared edges) / (6 (6 sqrt(2) V)^(2/3)), the inverse of the mean ratio (Liu and
    Joe 1994): 1 for a regular tetrahedron, infinite for a flat one, convex in each node. The distance is that along
    the normal (as in registration, Chen and Medioni 1991), so that faces slide on the surface, sharp edges draw
    edges, and the mean of the distances, and with it the error of the volume, is about zero.
    """
    nodes = mesh.nodes / element_size
    star = _stars(mesh.elements, len(nodes))
    ring = _stars(mesh.boundary, len(nodes))
    for stage in stages:
        for _ in range(stage.rounds):
            normals, offsets = _planes(nodes, mesh.boundary, solid, element_size)
            for _ in range(stage.sweeps):
                native.sweep(
                    nodes, mesh.elements, *star, mesh.boundary, *ring, normals, offsets, _SAMPLES,
                    stage.power, stage.pull / len(_SAMPLES),
                )  # fmt: skip
    return Mesh(nodes * element_size, mesh.elements)


def _stars(simplices: Elements, count: int) -> tuple[Int[np.ndarray, " _"], Int[np.ndarray, " _"]]:
    """Begin of the list of each node, and the lists: corners (corner count x simplex + corner) at the node."""
    start = np.concatenate([[0], np.cumsum(np.bincount(simplices.ravel(), minlength=count))])
    return start, np.argsort(simplices.ravel(), kind="stable")


def _planes(
    nodes: Nodes, facets: Elements, solid: Solid, element_size: float
) -> tuple[Float[np.ndarray, "facets samples 3"], Float[np.ndarray, "facets samples"]]:
    """Plane of the surface at each sample: normal and offset [element sizes]; normal 0 where none faces it.

    The normal is the way to the nearest place, outward as the facet is: so at an edge or a corner of the surface it is
    the one that a distance has there.
    """
    corners = nodes[facets]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    across = np.repeat(across / np.linalg.norm(across, axis=1, keepdims=True), len(_SAMPLES), axis=0)
    samples = np.einsum("sc,fcd->fsd", _SAMPLES, corners).reshape(-1, 3)
    places, triangles = solid.nearest(samples * element_size)
    places = places / element_size
    away = samples - places
    gaps = np.linalg.norm(away, axis=1)
    own = solid.normals[triangles]
    normals = np.where((gaps > 1e-6)[:, None], away / np.maximum(gaps, 1e-6)[:, None], own)
    along = np.einsum("nd,nd->n", normals, across)
    normals *= np.sign(along)[:, None]
    normals[(np.abs(along) < _FACING) | (np.einsum("nd,nd->n", own, across) < -_FACING)] = 0.0
    offsets = np.einsum("nd,nd->n", normals, places)
    return normals.reshape(len(facets), -1, 3), offsets.reshape(len(facets), -1)


BOUNDARY_TOLERANCE = 0.25  # the boundary of a mesh should be as near to the surface, in element sizes


@dataclass(frozen=True, eq=False)
class Fit:
    """Distances between a surface and the boundary of a mesh."""

    places: Points  # points of both, those of the mesh first [m]
    distances: Vector  # of each point from the other surface [m]
    volume: float  # enclosed by the mesh, as a fraction of what the surface encloses

    @property
    def largest(self) -> float:
        """Largest distance in either direction [m]."""
        return float(self.distances.max())


def fit(mesh: Mesh, solid: Solid, spacing: float) -> Fit:
    """Compare a mesh of tetrahedra with a solid, at points not farther apart than about `spacing` [m]."""
    outer = Solid(Surface(mesh.nodes, mesh.boundary))
    places, distances = [], []
    for one, other in ((outer, solid), (solid, outer)):
        points = covering_points(one.surface, spacing)
        places.append(points)
        distances.append(np.linalg.norm(other.nearest(points)[0] - points, axis=1))
    volume = float(mesh.volumes.sum()) / solid.surface.volume
    return Fit(np.concatenate(places), np.concatenate(distances), volume)


_STAGES = (
    ImproveStage(rounds=4, sweeps=3, power=1.0, pull=30.0),
    ImproveStage(rounds=6, sweeps=3, power=2.0, pull=300.0),
    ImproveStage(rounds=8, sweeps=3, power=4.0, pull=5000.0),
)
"""From free to firm: first the shapes, then the surface."""

_CRUMB = 0.01  # parts that break off with this share of the volume are no crumbs of a thin tip

_ADVICE = 0.7
"""Largest advised size, as a share of one that was too large; repeated advice then ends at a size that works."""


_CLOSE_ENOUGH = 0.5
_ENOUGH = ((2.5, _CLOSE_ENOUGH), (2.0, 0.35))
"""Multiples of the first number of nodes from which on a boundary as near as this suffices, in element sizes."""

_ALMOST, _GAIN = 0.3, 0.9
"""Distance [element sizes] that is kept where a round of finer elements leaves more than this share of it."""

_MIN_NODES, _MAX_NODES, _MAX_CELLS = 20, 400_000, 2_000_000
"""Elements, and cells of the lattice over the bounding box: what fits into memory."""


def tetrahedralize(
    surface: Surface, element_size: float, *, most_nodes: float = np.inf, most_lost: float = 1.0
) -> Mesh:
    """Fill a closed surface, oriented outward, with tetrahedra whose edges have about the element size [m] in the mean.

    A lattice is cut along the surface (`stuffing.py`), then its nodes move until the elements are well shaped and their
    outer faces lie on the surface (`improve.py`). Where that fails, as the body or a gap is thinner than the elements,
    they are made smaller, until the boundary is nearer than a quarter of an element; than half of one where that takes
    many nodes or smaller ones do not help. Holes narrower than `HOLE_SHARE` elements are filled. The same surface and
    size give the same mesh.

    Raises:
        InputError: so large that the body has too few elements, or so small that it has too many.
        TooManyNodesError: more nodes than `most_nodes`, because of places that need finer elements; or more than
            `most_lost` of the volume breaks off the lattice before it is refined there.
            With that limit it is a SurfaceError, too, if the boundary stays farther than half an element somewhere.
        SurfaceError: the body is much thinner than the elements; the message says where, and what to take.
    """
    _check_element_size(surface, element_size)
    surface = fill_small_holes(surface, HOLE_SHARE * element_size).surface
    solid = Solid(surface, clean=True)
    cell = element_size / MEAN_EDGE
    nodes, elements = _trim_elements(
        solid, *lattice(surface.box, cell, lambda middles: solid.distances(middles) < 2 * cell), cell
    )
    draft = first = _stuff_lattice(solid, nodes, elements, element_size, most_nodes)
    whole = 0.7  # if a lattice takes less of the volume, then finer elements in some places do not help
    if draft.whole < whole:
        raise SurfaceError(f"much of the body is thinner than {_advice(surface, element_size)}")
    if draft.lost > most_lost:
        raise TooManyNodesError(_describe_excess(element_size, len(draft.mesh.nodes), draft.places))
    finer = 4  # rounds of finer elements where the boundary is not close
    bisections = 2  # of the longest edges, in each round; three halve the elements
    for size in element_size / 2.0 ** (np.arange(finer) * bisections / 3):
        times = len(draft.mesh.nodes) / len(first.mesh.nodes)
        enough = max((far for many, far in _ENOUGH if times > many), default=0.0)
        if not len(draft.places) or (draft.is_alike and draft.farthest <= enough):
            break
        for _ in range(bisections):
            nodes, elements = bisect(nodes, elements, _too_long_near(nodes, elements, draft.places, size))
        before, draft = draft, _stuff_lattice(solid, nodes, elements, element_size, most_nodes, draft.places)
        if before.is_alike and _GAIN * before.farthest < min(draft.farthest, _GAIN * _ALMOST):
            draft = before  # finer elements do not help
            break
    if draft.lost > _CRUMB or (most_nodes < np.inf and draft.farthest > _CLOSE_ENOUGH):
        x, y, z = 1e3 * draft.places[0]
        raise SurfaceError(
            f"near ({x:.4g}, {y:.4g}, {z:.4g}) mm the body or a gap is thinner than {_advice(surface, element_size)}"
        )
    return draft.mesh


@dataclass(frozen=True, eq=False)
class _Filling:
    """Mesh of a solid from a lattice, and its missing volume."""

    mesh: Mesh  # its largest part; improved if no other is of any size
    whole: float  # volume of all parts, as a share of the solid's
    lost: float  # volume of the other parts, as a share of the solid's
    # where the lattice should be finer [m]: the body breaks, a gap is narrow, or its boundary is not close
    places: Points
    farthest: float = np.inf  # largest distance of its boundary from the surface [element sizes]
    is_alike: bool = False  # its boundary has as many handles as the surface


def _stuff_lattice(
    solid: Solid,
    nodes: Nodes,
    elements: Elements,
    element_size: float,
    most_nodes: float,
    refined: Points | None = None,
) -> _Filling:
    distances = solid.distances(nodes)
    inner = stuff(solid, nodes, elements, distances)
    if not len(inner[1]):
        return _Filling(Mesh(np.zeros((0, 3)), inner[1]), 0.0, 0.0, np.zeros((0, 3)))
    (mesh, breaks), gaps = manifold(*inner), np.zeros((0, 3))
    if euler(mesh.boundary) != euler(solid.surface.triangles):
        bridging, gaps = find_bridges(solid, nodes, elements, distances)
        if bridging.any():
            inner = stuff(solid, nodes, elements[~bridging], distances)
            mesh, breaks = manifold(*inner)
    if len(mesh.nodes) > most_nodes:
        raise TooManyNodesError(_describe_excess(element_size, len(mesh.nodes), refined), len(mesh.nodes))
    whole = float(signed_volumes(*inner).sum()) / solid.surface.volume
    lost = whole - float(mesh.volumes.sum()) / solid.surface.volume
    if lost > _CRUMB:
        return _Filling(mesh, whole, lost, np.concatenate([breaks, gaps]))
    mesh = improve(mesh, solid, element_size=element_size, stages=_STAGES)
    found = fit(mesh, solid, element_size / 3)
    far = found.places[found.distances > BOUNDARY_TOLERANCE * element_size]
    places = np.concatenate([far, gaps, *([breaks] if len(far) else [])])
    is_alike = euler(mesh.boundary) == euler(solid.surface.triangles)
    return _Filling(mesh, whole, lost, places, found.largest / element_size, is_alike)


def _describe_excess(element_size: float, count: int, refined: Points | None) -> str:
    """Complaint of too many nodes, with a place that needs finer elements."""
    fine = ""
    if refined is not None:
        nearest = refined[np.argmin(np.linalg.norm(refined - np.median(refined, axis=0), axis=1))]
        x, y, z = (f"{round(1e3 * value, 1) + 0.0:g}" for value in nearest)
        fine = f", as a wall or gap near ({x}, {y}, {z}) mm is thinner"
    need = int(float(f"{1.05 * count:.1e}"))
    return f"elements of {1e3 * element_size:.3g} mm make more than {count} nodes{fine}. Ask for {need} nodes or more"


def _advice(surface: Surface, element_size: float) -> str:
    """End of a complaint, with a size that a body as thick as this on average can be filled with."""
    size = min(2 * surface.volume / surface.area, _ADVICE * element_size)
    return f"elements of {1e3 * element_size:.4g} mm; take {1e3 * size:.2g} mm or less"


def _check_element_size(surface: Surface, element_size: float) -> None:
    """Refuse element sizes that make too few or too many elements."""
    if not 0.0 < element_size < np.inf:
        raise InputError(f"the element size must be positive, not {element_size} m")
    count = 8.5 * surface.volume / element_size**3
    size = f"elements of {1e3 * element_size:.4g} mm"
    if count < _MIN_NODES:
        most = 1e3 * min(0.9 * element_size * (count / _MIN_NODES) ** (1 / 3), 2 * surface.volume / surface.area)
        body = f"a body of {1e6 * surface.volume:.3g} cm^3"
        raise InputError(f"{size} are too large for {body}: take {most:.2g} mm or less")
    cells = float(np.prod(np.ptp(surface.box, axis=0) / element_size + 3))
    if count > _MAX_NODES or cells > _MAX_CELLS:
        least = 1.1e3 * element_size * max(count / _MAX_NODES, cells / _MAX_CELLS) ** (1 / 3)
        raise InputError(
            f"{size} would be about {count:.2g}, at most {_MAX_NODES} are made: take {least:.2g} mm or more"
        )


def _trim_elements(solid: Solid, nodes: Nodes, elements: Elements, cell: float) -> tuple[Places, Tetrahedra]:
    """Those elements of which some node is inside or near, and the nodes they have."""
    used, kept = np.unique(elements, return_inverse=True)
    nodes, elements = nodes[used], kept.reshape(-1, 4)
    near = solid.distances(nodes)
    used, kept = np.unique(elements[(near[elements] < cell).any(axis=1)], return_inverse=True)
    return nodes[used], kept.reshape(-1, 4)


def _too_long_near(nodes: Nodes, elements: Elements, places: Points, size: float) -> Bool[np.ndarray, " elements"]:
    """Find the elements about some places [m] that have an edge longer than 0.6 of a size [m]."""
    from scipy.spatial import KDTree

    corners = nodes[elements]
    middles = corners.mean(axis=1)
    longest = np.max([np.linalg.norm(corners[:, one] - corners[:, two], axis=1) for one, two in PAIRS], axis=0)
    distances = KDTree(places).query(middles, distance_upper_bound=size)[0]
    return (distances < size) & (longest > 0.6 * size)
