"""`price_paths`: the paths through a route graph along which one more cable lowers the pose error most."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Vector
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.design.routes.search_rules import RULES
from hydrostat.kernel import native

MarkerJacobian = Float[np.ndarray, "edges rows"]


@dataclass(frozen=True, kw_only=True)
class PathLimits:
    """Limits of a path."""

    max_edges: int  # most edges of its bare part
    turn: float  # sharpest turn at a via point, lead included, in the rest shape [degrees]
    longest: float | None = None  # greatest rest length, lead included [m]; None: any
    leads: bool = True  # whether it may begin with a sheathed lead from its winch, which moves nothing
    lead_penalty: float = 0.0  # share of the gain that a lead as long as the body costs


@dataclass(frozen=True, kw_only=True, eq=False)
class PricingProblem:
    """Residual of each row, and its change by 1 N along each edge of a route graph."""

    residual: Float[np.ndarray, " rows"]  # target less marker of each row [m]
    moves: MarkerJacobian  # what 1 N along each edge adds to each row [m/N]
    pose_of_row: Int[np.ndarray, " rows"]  # 0, 1, ...
    ridge: Float[np.ndarray, " poses"]  # added to |J|^2 of each pose, above 0
    most: float  # largest tension [N]


@dataclass(frozen=True, kw_only=True, eq=False)
class PricedPath:
    """A cable that would help."""

    nodes: tuple[int, ...]  # graph points of its bare part, from where the lead ends
    # graph points from its winch to the first of `nodes`; just that one where the winch stands there
    lead: tuple[int, ...]
    gain: float  # decrease of half the squares of the residual that it promises, less what its lead costs
    moves: Vector  # of the rows, by a tension of 1 N
    tensions: Vector  # that promise it in each pose [N]

    @property
    def winch(self) -> int:
        """The graph point at which its winch stands."""
        return self.lead[0]


def price_paths(
    graph: RouteGraph,
    missed: PricingProblem,
    limits: PathLimits,
    *,
    count: int,
    winches: Sequence[int] | None = None,
    slots: int = 4,
) -> list[PricedPath]:
    """Paths along which a cable lowers the residual most, the best first, unlike one another.

    A path moves the rows by J, the sum over its edges. By Gauss and Newton it lowers half the squares of the residual r
    (target less marker) by

        D(J) = sum over poses of max over t in [0, most] of t r.J - t^2 (|J|^2 + ridge) / 2.

    That is not additive, so a dynamic program over directed edges and hops keeps a few paths for each (`slots`): those
    of the largest D, and those of the largest r.J, which become good when they are longer. Two passes, one from the
    winches and one towards them, see different paths; the better ones of both are returned. Exact for one and two
    edges, else a heuristic: how near it comes to the best of all paths is tested. `winches` are the points of the graph
    where one may stand; all its winch places if left out.
    """
    places = graph.winch_places if winches is None else np.asarray(winches, dtype=np.int64)
    search = _PathSearch(graph, missed, limits, slots)
    starts = _LeadStarts(graph, places, limits)
    candidates = [*search.from_winches(starts), *search.to_winches(starts)]
    gains = np.concatenate([gain for gain, _ in candidates])
    paths = np.concatenate([path for _, path in candidates])
    order = np.argsort(-gains, kind="stable")
    order = order[gains[order] > 0.0]
    picked = _pick(graph, starts, paths[order], count)
    return [search.price_path(paths[order[index]], lead, float(gains[order[index]])) for index, lead in picked]


_LANES = 4  # numbers that a vector register holds


class _LeadStarts:
    """Starts of bare parts: for each directed edge the shortest lead to its start."""

    def __init__(self, graph: RouteGraph, places: Int[np.ndarray, " places"], limits: PathLimits) -> None:
        self.graph, penalty = graph, limits.lead_penalty
        self.longest = math.inf if limits.longest is None else limits.longest
        self.leads = np.where(np.isin(graph.sources, places), 0.0, np.inf)
        self.origins = np.full(len(graph.sources), -1, dtype=np.int64)
        if limits.leads:
            turns, before = _turns(graph, limits.turn)
            reach = min(self.longest, graph.size / penalty if penalty > 0 else math.inf)
            native.spread_leads(turns, before, graph.lengths[graph.edge_of], self.leads, self.origins, reach)
        reached = np.isfinite(self.leads)
        lengths = np.where(reached, self.leads, 0.0)
        self.rooms = np.where(reached, self.longest - lengths, -1.0)
        self.factors = np.where(reached, np.maximum(0.0, 1.0 - penalty * lengths / graph.size), 0.0)

    def winches(self, paths: Int[np.ndarray, "paths points"]) -> Int[np.ndarray, " paths"]:
        """Graph points at which the winches of bare parts stand."""
        sources, targets = self.graph.sources, self.graph.targets
        count = len(self.graph.points)
        keys = sources * count + targets
        order = np.argsort(keys)
        ends = order[np.searchsorted(keys, paths[:, 0] * count + paths[:, 1], sorter=order)]
        while (origins := self.origins[ends]).max(initial=-1) >= 0:
            ends = np.where(origins >= 0, origins, ends)
        return sources[ends]

    def lead(self, path: Int[np.ndarray, " points"]) -> tuple[int, ...]:
        """Graph points of the lead to a bare part."""
        first = self.graph.offsets[path[0]]
        edge = first + int(np.flatnonzero(self.graph.targets[first : self.graph.offsets[path[0] + 1]] == path[1])[0])
        points = [int(path[0])]
        while (edge := int(self.origins[edge])) >= 0:
            points.append(int(self.graph.sources[edge]))
        return tuple(reversed(points))


class _PathSearch:
    """The two passes over one residual."""

    def __init__(self, graph: RouteGraph, missed: PricingProblem, limits: PathLimits, slots: int) -> None:
        self.graph, self.ridge, self.most = graph, missed.ridge, float(missed.most)
        self.max_edges, self.slots = limits.max_edges, slots
        self.turns, self.before = _turns(graph, limits.turn)
        poses = len(missed.ridge)
        moves, residual, pose_of_row = _compress_rows(missed)
        self.moves = _by_pose(moves, pose_of_row, poses)
        self.residual = _by_pose(residual[None], pose_of_row, poses)
        self.plain, self.pulls = missed.moves, np.empty((len(missed.moves), poses))
        self.squares = np.empty_like(self.pulls)
        native.edge_products(self.moves, self.residual, self.pulls, self.squares)

    def from_winches(self, starts: _LeadStarts) -> Iterator[tuple[Vector, Int[np.ndarray, "paths points"]]]:
        """Gains and points of the best path that ends with each directed edge."""
        blocked = self.graph.world[self.graph.targets]
        begins = np.where(blocked, 0.0, starts.factors)
        none = np.zeros(len(begins))
        for gains, paths in self._grow(begins, starts.rooms, blocked, none + 1.0, none):
            yield gains, _reverse_paths(paths)

    def to_winches(self, starts: _LeadStarts) -> Iterator[tuple[Vector, Int[np.ndarray, "paths points"]]]:
        """Gains and points of the best path that begins with each directed edge."""
        graph = self.graph
        blocked = graph.world[graph.sources]
        begins = np.where(blocked, 0.0, 1.0)
        rooms = np.full(len(begins), starts.longest)
        yield from self._grow(begins, rooms, blocked, starts.factors[graph.reverses], starts.leads[graph.reverses])

    def _grow(
        self, begins: Vector, rooms: Vector, blocked: Bool[np.ndarray, " directed"], factors: Vector, left: Vector
    ) -> Iterator[tuple[Vector, Int[np.ndarray, "paths points"]]]:
        """Labels of all hops; then for each directed edge the best that ends with it and has some length left."""
        graph, size = self.graph, len(self.graph.sources) * self.slots
        labels, longer = np.empty((2, size, *self.moves.shape[1:]))
        sums, longer_sums = np.empty((2, size, 2 * len(self.ridge) + 2))
        marks, longer_marks = np.empty((2, size), dtype=np.int64)
        values, parents = np.empty((self.max_edges, size)), np.empty((self.max_edges, size), dtype=np.int64)
        lengths, edge_of = graph.lengths, graph.edge_of
        best, ranked = np.empty((2, self.slots))
        chosen = np.empty(self.slots, dtype=np.int64)
        gains = np.full((self.max_edges, size), -np.inf)
        given = (self.moves, self.pulls, self.squares, self.ridge, self.most)
        for hop in range(self.max_edges):
            if hop == 0:
                native.first_labels(
                    graph.sources, graph.targets, edge_of, lengths, begins, rooms, self.moves, self.pulls, self.squares,
                    self.ridge, self.most, longer, longer_sums, longer_marks, values[0], parents[0],
                )  # fmt: skip
            else:
                native.grow_labels(
                    self.turns, self.before, graph.sources, graph.targets, edge_of, blocked, lengths, *given, hop,
                    labels, sums, marks, values, parents, longer, longer_sums, longer_marks, best, ranked, chosen,
                )  # fmt: skip
            good = np.isfinite(values[hop]) & (longer_sums[:, -2] >= np.repeat(left, self.slots))
            gains[hop, good] = values[hop, good] * np.repeat(factors, self.slots)[good]
            labels, longer, sums, longer_sums = longer, labels, longer_sums, sums
            marks, longer_marks = longer_marks, marks
        flat = gains.reshape(self.max_edges, -1, self.slots).transpose(1, 0, 2).reshape(len(edge_of), -1)
        which = flat.argmax(axis=1)
        hops, slots = np.divmod(which, self.slots)
        paths = np.empty((len(which), self.max_edges + 1), dtype=np.int64)
        ends = np.arange(len(which)) * self.slots + slots
        native.walk_back(parents, graph.sources, graph.targets, self.slots, hops, ends, paths)
        yield flat[np.arange(len(which)), which], paths

    def price_path(self, path: Int[np.ndarray, " points"], lead: tuple[int, ...], gain: float) -> PricedPath:
        """Return the record of a path."""
        points = path[path >= 0]
        edges = _edges(self.graph, points)
        moves = self.moves[edges].sum(axis=0)
        pulls, squares = (self.residual[0] * moves).sum(axis=1), (moves**2).sum(axis=1)
        return PricedPath(
            nodes=tuple(points.tolist()),
            lead=lead,
            gain=gain,
            moves=self.plain[edges].sum(axis=0),
            tensions=np.clip(pulls / (squares + self.ridge), 0.0, self.most),
        )


def _pick(
    graph: RouteGraph, starts: _LeadStarts, paths: Int[np.ndarray, "paths points"], count: int
) -> list[tuple[int, tuple[int, ...]]]:
    """Numbers and leads of the first paths that are unlike one another; of like ones only if there are not enough."""
    reach = 2.0 * float(np.median(graph.lengths))
    quota = max(2, -(-count // RULES.region_share))
    picked: dict[int, tuple[int, ...]] = {}
    stands = graph.points[starts.winches(paths)]
    near = np.zeros(len(paths), dtype=np.int64)  # picked ones in the region of winches of each
    usable = np.ones(len(paths), dtype=bool)
    for alike, crowd in ((RULES.shared_edges, quota), (RULES.shared_edges, count), (1.0, count)):
        index = -1
        while len(picked) < count:
            others = paths[list(picked)]
            index = native.next_unlike(paths, index + 1, others, usable & (near < crowd), alike)
            if index == len(paths):
                break
            path = paths[index]
            lead = starts.lead(path)
            if len({*lead, *path[path >= 0].tolist()}) < len(lead) - 1 + (path >= 0).sum():
                usable[index] = False  # its lead runs into it
                continue
            picked[index] = lead
            usable[index] = False
            near += np.linalg.norm(stands - stands[index], axis=1) < reach
    return sorted(picked.items())


def _compress_rows(missed: PricingProblem) -> tuple[MarkerJacobian, Vector, Int[np.ndarray, " rows"]]:
    """Moves, residual and poses of fewer rows with nearly the same r.J and |J|: bodies move in few patterns.

    The rows of a pose are turned such that the first one is along the residual, whose products stay exact. Of the
    others the principal components are kept. Edges that move far more than others, as in still zones, count as ten.
    """
    moves, residuals, owners = [], [], []
    for pose in range(len(missed.ridge)):
        rows = missed.pose_of_row == pose
        own, residual = missed.moves[:, rows], missed.residual[rows]
        size = float(np.linalg.norm(residual))
        along = residual / size if size > 0 else residual
        pulls = own @ along
        rest = own - pulls[:, None] * along
        norms = np.linalg.norm(own, axis=1)
        capped = np.minimum(1.0, RULES.capped_moves * np.median(norms) / np.maximum(norms, 1e-300))[:, None] * rest
        powers, axes = np.linalg.eigh(capped.T @ capped)
        kept = axes[:, np.cumsum(powers) > RULES.lost_moves * float(powers.sum())]
        if kept.shape[1] + 1 < own.shape[1]:
            own, residual = np.column_stack([pulls, rest @ kept]), np.append(size, np.zeros(kept.shape[1]))
        moves.append(own)
        residuals.append(residual)
        owners.append(np.full(len(residual), pose))
    return np.hstack(moves), np.concatenate(residuals), np.concatenate(owners)


def _by_pose(
    table: Float[np.ndarray, "things rows"], pose_of_row: Int[np.ndarray, " rows"], poses: int
) -> Float[np.ndarray, "things poses width"]:
    """Columns sorted into poses, with noughts behind the shorter ones; the width fills vector registers."""
    counts = np.bincount(pose_of_row, minlength=poses)
    width = -(-int(counts.max(initial=1)) // _LANES) * _LANES
    split = np.zeros((len(table), poses, width))
    for pose, count in enumerate(counts):
        split[:, pose, :count] = table[:, pose_of_row == pose]
    return split


def _reverse_paths(paths: Int[np.ndarray, "paths points"]) -> Int[np.ndarray, "paths points"]:
    """Reverse each path; entries beyond its end stay there."""
    counts = (paths >= 0).sum(axis=1)
    places = counts[:, None] - 1 - np.arange(paths.shape[1])
    return np.where(places >= 0, np.take_along_axis(paths, np.maximum(places, 0), axis=1), -1)


def _edges(graph: RouteGraph, points: Int[np.ndarray, " points"]) -> Int[np.ndarray, " edges"]:
    """Undirected edges along a path."""
    count = len(graph.points)
    keys = graph.edges[:, 0] * count + graph.edges[:, 1]
    ends = np.sort(np.column_stack([points[:-1], points[1:]]), axis=1)
    return np.searchsorted(keys, ends[:, 0] * count + ends[:, 1])


@lru_cache(maxsize=4)
def _turns(graph: RouteGraph, turn: float) -> tuple[Int[np.ndarray, " _"], Int[np.ndarray, " turns"]]:
    """Directed edges that may follow each of them, as a compressed list; no path runs through a point in the world."""
    counts = np.empty(len(graph.sources) + 1, dtype=np.int64)
    least = math.cos(math.radians(min(turn, 180.0))) - 1e-9
    given = (graph.points, graph.offsets, graph.sources, graph.targets, graph.reverses, graph.world, least, counts)
    total = native.count_turns(*given, np.empty(0, dtype=np.int64))
    before = np.empty(total, dtype=np.int64)
    native.count_turns(*given, before)
    return counts, before
