"""`RouteGraph`: the via points that cables may have, and the straight runs between them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Nodes, Points
from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.design.zone import Zone
from hydrostat.errors import InputError
from hydrostat.geometry import Anchors, build_point_tree, locate
from hydrostat.given import Point
from hydrostat.robot import Mount, Robot

Pairs = Int[np.ndarray, "_ 2"]


@dataclass(frozen=True, eq=False)
class RouteGraph:
    """Places where cables may turn, joined where a straight run between them keeps all constraints.

    Directed edges are numbered by their start, then by their end: those from point p are `offsets[p]` to
    `offsets[p + 1]`.
    """

    points: Points  # rest places [m]: those in the body, then winches fixed in the world
    anchors: Anchors  # what holds the points in the body
    edges: Int[np.ndarray, "edges 2"]  # undirected, lower point first, sorted
    # which edges lie in a still zone: a cable runs there in a sheath and moves nothing (R14)
    still: Bool[np.ndarray, " edges"]
    winch_places: Int[np.ndarray, " places"]  # points where a winch may stand
    size: float  # of the body, the longest side of its bounding box [m]
    region: Region  # that the edges keep to

    @property
    def world(self) -> Bool[np.ndarray, " points"]:
        """Points that are fixed in the world."""
        return np.arange(len(self.points)) >= len(self.anchors.stencils)

    @cached_property
    def lengths(self) -> Float[np.ndarray, " edges"]:
        """Rest length of each edge [m]."""
        return np.linalg.norm(self.points[self.edges[:, 1]] - self.points[self.edges[:, 0]], axis=1)

    @cached_property
    def offsets(self) -> Int[np.ndarray, " _"]:
        """Index of the first directed edge from each point; the number of edges at the end."""
        counts = np.bincount(self.edges.ravel(), minlength=len(self.points))
        return np.concatenate([[0], np.cumsum(counts)])

    @cached_property
    def sources(self) -> Int[np.ndarray, " directed"]:
        """Start of each directed edge."""
        return np.concatenate([self.edges[:, 0], self.edges[:, 1]])[self._order]

    @cached_property
    def targets(self) -> Int[np.ndarray, " directed"]:
        """End of each directed edge."""
        return np.concatenate([self.edges[:, 1], self.edges[:, 0]])[self._order]

    @cached_property
    def edge_of(self) -> Int[np.ndarray, " directed"]:
        """The undirected edge of each directed one."""
        return self._order % max(len(self.edges), 1)

    @cached_property
    def reverses(self) -> Int[np.ndarray, " directed"]:
        """The same edge the other way."""
        count = len(self.edges)
        place = np.argsort(self._order)
        return place[(self._order + count) % max(2 * count, 1)]

    @cached_property
    def _order(self) -> Int[np.ndarray, " directed"]:
        """Edges, then the same reversed, sorted by start and end."""
        starts = np.concatenate([self.edges[:, 0], self.edges[:, 1]])
        ends = np.concatenate([self.edges[:, 1], self.edges[:, 0]])
        return np.lexsort((ends, starts))

    def edge_moves(self, posed: Nodes, fields: Float[np.ndarray, "nodes dim rows"]) -> Float[np.ndarray, "edges rows"]:
        """Change of each row by a tension of 1 N along each edge, at an equilibrium of the nodes [m]: in m/N.

        The ends of the edge are pulled together, so it is (field at the first - field at the second) . direction, and a
        cable moves the rows by the sum over its edges. Still edges move nothing; a point in the world neither moves nor
        has a field. Fields are H^-1 of each row's sensitivity by the nodes, H being the full Hessian there [m/N].
        """
        held = len(self.anchors.stencils)
        places, priced = self.points.copy(), np.zeros((len(self.points), *fields.shape[1:]))
        places[:held] = self.anchors.positions(posed)
        for corner, weights in zip(self.anchors.stencils.T, self.anchors.weights.T, strict=True):
            priced[:held] += weights[:, None, None] * fields[corner]
        first, second = self.edges.T
        spans = places[second] - places[first]
        directions = spans / np.maximum(np.linalg.norm(spans, axis=1), np.finfo(float).tiny)[:, None]
        directions[self.still] = 0.0
        return np.einsum("edr,ed->er", priced[first] - priced[second], directions)

    @staticmethod
    def build(robot: Robot, region: Region, constraints: Constraints, *, spacing: float) -> "RouteGraph":
        """The graph of a body: mesh nodes moved inside the clearance, each joined to those around it that it sees.

        Winches of the robot matter only where they stand in the world. The spacing [m] is a rough distance between via
        points, such as the element size. Raises InputError if there is no place for a via point or for a winch.
        """
        mesh = robot.body.mesh
        whole = _with_zones(mesh.nodes, robot, constraints)
        nodes, points = _via_points(whole, region, constraints, spacing, first=len(whole) - len(mesh.nodes))
        if len(points) < 2:
            raise InputError(
                f"there is no room for cables {1e3 * constraints.clearance:g} mm inside the edge; lower the "
                f"clearance or make the keep-out zones smaller"
            )
        edges = _join_points(points, _near(points, nodes, mesh.edges, spacing), region, constraints)
        anchors = locate(mesh, points)
        if _in_world(robot, constraints):
            winches = np.array([winch.at for winch in robot.winches], dtype=float)
            entries = _entries(robot, points, winches, constraints, spacing)
            places = np.arange(len(points), len(points) + len(winches))
            points, edges = np.concatenate([points, winches]), np.concatenate([edges, entries])
        else:
            places = _winch_places(points, region, constraints)
        edges = edges[np.lexsort((edges[:, 1], edges[:, 0]))]
        return RouteGraph(
            points=points,
            anchors=anchors,
            edges=edges,
            still=_meets(points, edges, constraints.passive_zones),
            winch_places=places,
            size=mesh.size,
            region=region,
        )


_CROWDED = 0.35  # points nearer than this share of the spacing are one
_REACH = 2.0  # points are joined up to so many spacings away

_NEIGHBORS = {2: 12, 3: 18}
"""So many of the nearest points is each joined to, by dimension: enough directions for a cable to follow the field."""


def _via_points(
    nodes: Nodes, region: Region, constraints: Constraints, spacing: float, *, first: int = 0
) -> tuple[Int[np.ndarray, " points"], Points]:
    """Mesh nodes that cables may turn at, and their places inside the clearance.

    The last nodes come first, as many as are said, then those that lie inside already; of all others, only what is not
    crowded. A node that no place near it can hold, as in a thin part, is left out.
    """
    moved = region.push_inside(nodes)
    shifts = np.linalg.norm(moved - nodes, axis=1)
    good = region.fits(moved) & (shifts <= 2 * region.clearance + spacing)
    good &= _outside(moved, constraints.keep_out)
    order = np.flatnonzero(good)
    order = order[np.lexsort((order, shifts[order] > 1e-12, order < len(nodes) - first))]
    kept: list[int] = []
    for node in order.tolist():
        if not kept or np.linalg.norm(moved[kept] - moved[node], axis=1).min() >= _CROWDED * spacing:
            kept.append(node)
    chosen = np.array(sorted(kept), dtype=np.int64)
    return chosen, moved[chosen]


def _with_zones(nodes: Nodes, robot: Robot, constraints: Constraints) -> Nodes:
    """The nodes, and a point in each zone that is too small to hold one but may hold a winch."""
    if constraints.stand_outside(robot):
        return nodes
    middles = [_point_in(zone) for zone in constraints.winch_zones if zone.distances(nodes).min() > 0]
    return np.concatenate([nodes, np.array(middles, dtype=float).reshape(-1, nodes.shape[1])])


def _point_in(zone: Zone) -> Point:
    """The middle of a ball or box, or a point well inside a polygon [m]."""
    if zone.at is not None:
        return zone.at
    if zone.box is not None:
        return tuple(np.mean(zone.box, axis=0).tolist())
    from shapely import Polygon, get_coordinates  # Imported here: only narrow rooms need it.

    return tuple(get_coordinates(Polygon(zone.outline).representative_point())[0].tolist())


def _near(points: Points, nodes: Int[np.ndarray, " points"], mesh_edges: Pairs, spacing: float) -> Pairs:
    """Pairs of points that are close by, or were joined in the mesh."""
    count = min(_NEIGHBORS[points.shape[1]] + 1, len(points))
    away, near = map(np.asarray, build_point_tree(points).query(points, k=count, distance_upper_bound=_REACH * spacing))
    rows, columns = np.nonzero(np.isfinite(away))
    pairs = np.column_stack([rows, near[rows, columns]])
    number = np.full(max(int(mesh_edges.max(initial=0)), int(nodes.max())) + 1, -1)
    number[nodes] = np.arange(len(nodes))
    meshed = number[mesh_edges]
    pairs = np.concatenate([pairs, meshed[(meshed >= 0).all(axis=1)]])
    return np.unique(np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1), axis=0).astype(np.int64)


def _join_points(points: Points, pairs: Pairs, region: Region, constraints: Constraints) -> Pairs:
    """Return the pairs between which a cable may run."""
    pairs = pairs[~_meets(points, pairs, constraints.keep_out)]
    return pairs[region.sees(points[pairs[:, 0]], points[pairs[:, 1]])]


def _in_world(robot: Robot, constraints: Constraints) -> bool:
    """True if winches stand in the world (InputError: they should, but the robot has none that says where)."""
    if constraints.mount is Mount.WORLD and not robot.winches:
        raise InputError("winches in the world stand where the robot's own do, but it has none; give it [[winch]]")
    return constraints.stand_outside(robot)


def _winch_places(points: Points, region: Region, constraints: Constraints) -> Int[np.ndarray, " places"]:
    """Points that are deep enough for a winch, and in one of its zones."""
    allowed = region.depths(points) >= constraints.winch_clearance - 1e-9
    if constraints.winch_zones:
        allowed &= ~_outside(points, constraints.winch_zones)
    if not allowed.any():
        where = " in its zones" if constraints.winch_zones else ""
        raise InputError(
            f"no place{where} holds a winch {1e3 * constraints.winch_clearance:g} mm inside the edge; lower "
            f"winch_clearance or widen winch_zones"
        )
    return np.flatnonzero(allowed)


def _entries(
    robot: Robot, points: Points, winches: Float[np.ndarray, "winches dim"], constraints: Constraints, spacing: float
) -> Pairs:
    """From each winch in the world to the via points in the part that is held: there a cable enters the body."""
    mesh = robot.body.mesh
    held = np.concatenate([pin.anchors(mesh).positions(mesh.nodes) for pin in robot.pins])
    away = np.linalg.norm(points[:, None] - held[None], axis=2).min(axis=1)
    near = np.flatnonzero(away <= max(spacing, float(away.min())) * (1 + 1e-9))
    numbers = np.arange(len(points), len(points) + len(winches))
    pairs = np.column_stack([np.tile(near, len(winches)), np.repeat(numbers, len(near))])
    return pairs[~_meets(np.concatenate([points, winches]), pairs, constraints.keep_out)]


def _outside(points: Points, zones: Sequence[Zone]) -> Bool[np.ndarray, " points"]:
    """Points that lie in none of the zones."""
    outside = np.ones(len(points), dtype=bool)
    for zone in zones:
        outside &= zone.distances(points) > 0
    return outside


def _meets(points: Points, pairs: Pairs, zones: Sequence[Zone]) -> Bool[np.ndarray, " _"]:
    """Segments that pass through a zone."""
    meets = np.zeros(len(pairs), dtype=bool)
    for zone in zones:
        meets |= zone.least(points[pairs[:, 0]], points[pairs[:, 1]]) < 0
    return meets
