"""`sketches`: networks as people draw them, two lines along each limb, from where a motor fits."""

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import nnls
from scipy.sparse import csc_array, csr_array, hstack
from scipy.sparse.csgraph import dijkstra
from scipy.spatial.distance import cdist

from hydrostat.arrays import Points, Vector
from hydrostat.design.polyline import Route, resample
from hydrostat.design.region import MARGIN, Region
from hydrostat.design.routes.bench import Trial
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.refine import pushed_back
from hydrostat.geometry import locate
from hydrostat.robot import Cable


@dataclass(frozen=True, eq=False)
class Line:
    """A cable that a person might draw: from a winch along a limb to a marker, on one side of it."""

    place: int  # graph point of its winch
    points: Route  # [m]


def sketches(proposals: Proposals, bare: Trial, *, winches: int, cables: int, count: int) -> list[Layout]:
    """Layouts of lines that no other crosses, by a linear model at rest, the most promising first.

    Candidates run from a few winch places to every marker, along each side of the limb that it is on. For each of many
    sets of winch places lines are chosen greedily; the best sets are gone over line by line, each exchanged for another
    while that helps. `bare` is the trial of a layout without winches and cables. Empty where some stay, or there
    should be mirror images.
    """
    mirrored = bare.layout.constraints.mirror is not None
    lines = [] if mirrored or bare.layout.sites else list(_lines(proposals, bare))
    if not lines:
        return []
    choice = _Choice(proposals, bare, lines, winches, cables)
    begun = sorted((choice.filled([], places) for places in choice.places()), key=choice.cost)
    found: dict[tuple[int, ...], float] = {}
    for chosen in begun[: _BEGUN * count]:
        better = choice.exchanged(chosen)
        found[tuple(sorted(better))] = choice.cost(better)
    layouts = []
    for chosen in sorted(found, key=lambda one: found[one]):
        layout = _layout(proposals, bare.layout, [lines[index] for index in chosen])
        layouts += [] if layout is None else [layout]
    return layouts[:count]


def _layout(proposals: Proposals, layout: Layout, lines: Sequence[Line]) -> Layout | None:
    """A layout with these lines; None if they cannot be built."""
    for line in lines:
        layout = proposals.with_line(layout, line.place, line.points)
    return pushed_back(layout, proposals.graph.region, _REACH * proposals.graph.size)


def _lines(proposals: Proposals, bare: Trial) -> Iterator[Line]:
    """Lines from each of a few winch places to each marker, on each side."""
    graph = proposals.graph
    places = _spread(graph.points[graph.winch_places], _PLACES)
    costs = csr_array(
        (np.tile(graph.lengths * _shallow(proposals), 2), (np.append(*graph.edges.T), np.append(*graph.edges.T[::-1]))),
        shape=(len(graph.points),) * 2,
    )
    inner = np.flatnonzero(~graph.world)
    goals = np.unique([
        inner[np.argmin(np.linalg.norm(graph.points[inner] - marker.at, axis=1))]
        for marker in bare.layout.source.markers
    ])  # fmt: skip
    for place in graph.winch_places[places]:
        _, before = dijkstra(costs, indices=place, return_predecessors=True)
        for goal in goals:
            path = [int(goal)]
            while path[-1] != place and before[path[-1]] >= 0:
                path.append(int(before[path[-1]]))
            if path[-1] != place or len(path) < 3:
                continue
            for points in _beside(graph.points[path[::-1]], proposals, world=bool(graph.world[place])):
                yield Line(int(place), points)


def _shallow(proposals: Proposals) -> Vector:
    """Length factor of each edge for not being in the middle of a limb, or for moving nothing."""
    graph = proposals.graph
    depths = np.zeros(len(graph.points))
    depths[~graph.world] = graph.region.depths(graph.points[~graph.world])
    ends = np.maximum(depths[graph.edges].min(axis=1), 0.0)
    return 1.0 + _INWARD * np.maximum(1.0 - ends / proposals.deepest, 0.0) ** 2 + _STILL * graph.still


def _spread(points: Points, count: int) -> Int[np.ndarray, " chosen"]:
    """A few points far from one another, the middle one first."""
    chosen = [int(np.argmin(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    away = np.linalg.norm(points - points[chosen[0]], axis=1)
    while len(chosen) < min(count, len(points)) and away.max() > 0:
        chosen.append(int(np.argmax(away)))
        away = np.minimum(away, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.array(chosen)


def _beside(path: Route, proposals: Proposals, *, world: bool) -> Iterator[Route]:
    """A path moved to each side of the limb, as far as the clearance lets it, gently; those that stay inside."""
    spacing = proposals.spacing
    outside, inner = path[: int(world)], path[int(world) :]
    middle = _smooth(resample(inner, 0.5 * spacing))
    along = np.gradient(middle, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    ramp = np.minimum(0.5 * np.arange(len(middle)), _FULL) * spacing
    for side in _sides(along):
        reach = _reach(middle, side, ramp, proposals.graph.region)
        wide = np.flatnonzero(reach >= _BESIDE * proposals.bench.constraints.cable_gap)
        # At the thin end of a limb the lines of both sides would meet: they end before it.
        end = wide[-1] + 1 if len(wide) and wide[-1] > 1 else len(middle)
        for share, apart in _WAYS:
            moved = (middle + (share * reach)[:, None] * side)[:end]
            points = _inside(resample(moved, apart * spacing), proposals.graph.region)
            if points is not None:
                yield np.vstack([outside, points])
                break


def _reach(middle: Route, side: Route, ramp: Vector, region: Region) -> Vector:
    """Distance that each point of a path can go to a side within the clearance, at most a ramp, smoothed [m]."""
    reach = np.zeros(len(middle))
    for share in np.linspace(1.0, 0.1, 10):
        fits = (reach == 0) & (region.depths(middle + (share * ramp)[:, None] * side) >= MARGIN * region.clearance)
        reach[fits] = share * ramp[fits]
    return np.minimum(reach, _smooth(reach[:, None])[:, 0])


def _smooth(route: Route) -> Route:
    """A polyline, its ends kept, after some rounds of means of neighbours."""
    route = route.copy()
    for _ in range(_ROUNDS):
        route[1:-1] = 0.25 * route[:-2] + 0.5 * route[1:-1] + 0.25 * route[2:]
    return route


def _inside(points: Route, region: Region) -> Route | None:
    """A line pushed to the clearance but for its first point; None where it cuts a corner or is too short."""
    points[1:] = region.push_inside(points[1:])
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return points if len(apart) and apart.min() > _SHORT and region.holds(points) else None


def _sides(along: Route) -> list[Route]:
    """Unit vectors across a path: two in the plane, four in space."""
    if along.shape[1] == 2:
        left = np.column_stack([-along[:, 1], along[:, 0]])
        return [left, -left]
    first = np.zeros_like(along)
    across = np.eye(3)[np.argmin(np.abs(along[0]))]
    for index, way in enumerate(along):  # carried along without turning about the path
        across = across - (across @ way) * way
        across /= np.linalg.norm(across)
        first[index] = across
    second = np.cross(along, first)
    return [first, -first, second, -second]


@dataclass(eq=False)
class _Choice:
    """Sets of lines, judged by what they would do at rest if the body were linear."""

    proposals: Proposals
    bare: Trial
    lines: list[Line]
    winches: int
    cables: int

    def __post_init__(self) -> None:
        bench, simulation = self.proposals.bench, self.bare.simulation
        mesh = bench.source.body.mesh
        slopes = csc_array(hstack([csc_array(self._pull(line)[:, None]) for line in self.lines]))
        self.gives = np.eye(len(self.lines)) / Cable.stiffness
        for first in range(0, len(self.lines), _AT_ONCE):
            some = slice(first, first + _AT_ONCE)
            self.gives[:, some] += slopes.T @ simulation.response(self.bare.poses[0], slopes[:, some].toarray())
        self.moves, self.missed, self.ridges = [], [], []
        for index, pose in enumerate(self.bare.poses):
            rows = len(bench.markers[index]) * mesh.dim
            fields = self.bare.slopes[index].fields[:rows].reshape(rows, -1)
            self.moves.append(-bench.weights[index][:, None] * (slopes.T @ fields.T).T)
            self.missed.append(bench.residual(simulation, index, pose.nodes))
            self.ridges.append(_EFFORT * float(np.linalg.norm(self.missed[-1])) / bench.constraints.tension_limit)
        self.scale = float(np.linalg.norm(np.concatenate(self.missed)))
        self.known: dict[tuple[int, ...], float] = {}

    def _pull(self, line: Line) -> Vector:
        """Slope of its length by the nodes."""
        mesh = self.proposals.bench.source.body.mesh
        world = bool(self.proposals.graph.world[line.place])
        spans = np.diff(line.points, axis=0)
        units = spans / np.linalg.norm(spans, axis=1)[:, None]
        ways = np.vstack([np.zeros(mesh.dim), units]) - np.vstack([units, np.zeros(mesh.dim)])
        anchors = locate(mesh, line.points[int(world) :])
        slope = np.zeros(mesh.nodes.shape)
        for corner, weights in zip(anchors.stencils.T, anchors.weights.T, strict=True):
            np.add.at(slope, corner, weights[:, None] * ways[int(world) :])
        return slope.ravel()

    def cost(self, chosen: Sequence[int]) -> float:
        """Error of a set of lines, with its effort [m]."""
        key = tuple(sorted(chosen))
        if key not in self.known:
            self.known[key] = self._cost(list(key)) * (1.0 + _SIMPLE * len(key))
        return self.known[key]

    def _cost(self, chosen: list[int]) -> float:
        if not chosen:
            return self.scale
        return float(np.linalg.norm([self._misses(chosen, pose) for pose in range(len(self.moves))]))

    def _misses(self, chosen: list[int], pose: int) -> float:
        """Error of a pose; lines that would have to push are left slack, in a few rounds."""
        moves, missed, ridge = self.moves[pose], self.missed[pose], self.ridges[pose]
        places = [self.lines[index].place for index in chosen]
        by_winch = np.equal.outer(places, sorted(set(places))).astype(float)
        taut = np.ones(len(chosen), dtype=bool)
        left = float(np.linalg.norm(missed))
        for _ in range(_SLACK):
            own = np.array(chosen)[taut]
            tensions = np.linalg.solve(self.gives[np.ix_(own, own)], by_winch[taut])
            matrix = np.vstack([moves[:, own] @ tensions, ridge * tensions])
            pulled, found = nnls(matrix, np.append(missed, np.zeros(len(own))))
            pulls = tensions @ pulled
            pushes = pulls < -1e-6 * max(float(pulls.max()), 0.0)
            if not pushes.any():
                return float(found)
            if pushes.all():
                return left
            taut[np.flatnonzero(taut)[pushes]] = False
        return left

    def places(self) -> list[tuple[int, ...]]:
        """Sets of places of winches: all of them, or many at random."""
        known = sorted({line.place for line in self.lines})
        chance = np.random.default_rng(0)
        count = min(self.winches, len(known))
        if math.comb(len(known), count) <= _SETS:
            return list(combinations(known, count))
        return [tuple(chance.choice(known, count, replace=False).tolist()) for _ in range(_SETS)]

    def filled(self, chosen: list[int], places: Collection[int] | None = None) -> list[int]:
        """With one line more after the other, of winches at some places, while that helps."""
        own = [index for index, line in enumerate(self.lines) if places is None or line.place in places]
        while len(chosen) < self.cables:
            more = [[*chosen, index] for index in own if self._fits(chosen, index)]
            best = min(more, key=self.cost, default=None)
            if best is None or self.cost(best) >= self.cost(chosen):
                break
            chosen = best
        return chosen

    def exchanged(self, chosen: list[int]) -> list[int]:
        """With lines exchanged for others, while that helps."""
        for _ in range(_EXCHANGES):
            before = self.cost(chosen)
            for number in range(len(chosen)):
                rest = [index for index in chosen if index != chosen[number]] if number < len(chosen) else chosen
                more = [[*rest, index] for index in range(len(self.lines)) if self._fits(rest, index)]
                best = min(more, key=self.cost, default=chosen)
                if self.cost(best) < self.cost(chosen):
                    chosen = best
            chosen = self.filled(chosen)
            if self.cost(chosen) >= before:
                break
        return chosen

    def _fits(self, chosen: Sequence[int], index: int) -> bool:
        """True if a line can be built beside others."""
        if index in chosen or self._meets[index][list(chosen)].any():
            return False
        constraints, graph = self.proposals.bench.constraints, self.proposals.graph
        place = self.lines[index].place
        places = [self.lines[other].place for other in chosen]
        if place in places:
            return places.count(place) < constraints.cables_per_winch
        if len(set(places)) >= self.winches:
            return False
        gap = 1e-6 if graph.world[place] else constraints.winch_gap
        return all(np.linalg.norm(graph.points[place] - graph.points[other]) >= gap for other in set(places))

    @cached_property
    def _meets(self) -> Float[np.ndarray, "lines lines"]:
        """Lines that come too near to one another, but about a winch that both have."""
        constraints, graph = self.proposals.bench.constraints, self.proposals.graph
        near = _MEETS * constraints.cable_gap
        fine = [resample(line.points[int(graph.world[line.place]) :], max(near, 1e-3)) for line in self.lines]
        meets = np.zeros((len(fine),) * 2, dtype=bool)
        if near == 0.0:
            return meets
        ends = np.cumsum([0, *map(len, fine)])[:-1]
        every = np.concatenate(fine)
        spots = np.repeat([line.place for line in self.lines], [len(one) for one in fine])
        beside = _ROOM * constraints.spool_radius
        for index, line in enumerate(self.lines):
            close = cdist(fine[index], every) < near
            winch = graph.points[line.place]
            own = np.linalg.norm(fine[index] - winch, axis=1) < beside
            close &= ~(own[:, None] & (spots == line.place))
            if not graph.world[line.place]:  # the winch needs room
                close |= (np.linalg.norm(every - winch, axis=1) < 2 * constraints.spool_radius) & (spots != line.place)
            meets[index] = np.logical_or.reduceat(close.any(axis=0), ends)
        return meets | meets.T


_PLACES = 24  # places where winches are thought of
_SETS = 100  # sets of winch places that are tried
_BEGUN = 3  # sets that are gone over for each that is wanted
_INWARD = 3.0  # how much longer an edge at the rim counts
_STILL = 100.0  # how much longer one in a still zone
_ROUNDS = 6  # of smoothing
_BESIDE = 0.7  # gaps between cables that a line is at least beside the middle where it ends
_FULL = 2.0  # spacings that a line is moved beside the middle at most
_SHORT = 1e-6  # points nearer than this [m] are one
# shares of the way to the clearance, and of the spacing, the first of which does: finer where a corner is cut
_WAYS = ((0.85, 1.0), (0.85, 0.5), (0.4, 0.5))
_EFFORT = 0.5  # share of the residual that the tension limit is worth
_SIMPLE = 0.01  # what each line more must gain
_SLACK = 6  # rounds in which slack cables are left out
_EXCHANGES = 3  # rounds
_AT_ONCE = 64  # lines whose response is found at a time, so that large bodies need little memory
_MEETS = 0.6  # share of the gap between cables at which they meet; what is nearer than the gap is pushed apart
_ROOM = 2.5  # within so many spool radii of a winch its cables may meet
_REACH = 0.03  # what is farther than this share of the body's size from a limit does not feel it
