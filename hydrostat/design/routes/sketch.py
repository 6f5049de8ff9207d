"""`sketches`: networks as people draw them, two lines along each limb, from where a motor fits."""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from hydrostat.arrays import Int, Points, Vector
from hydrostat.design.polyline import Route, resample
from hydrostat.design.region import MARGIN, Region
from hydrostat.design.routes.evaluator import Trial
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.line_choice import Line, LineChoice
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.refine import pushed_back
from hydrostat.design.routes.search_rules import RULES
from hydrostat.given import Point


def sketches(
    proposals: Proposals, bare: Trial, *, winches: int, cables: int, count: int, lines: Sequence[Line] | None = None
) -> list[Layout]:
    """Layouts of lines that no other crosses, by a linear model at rest, the most promising first.

    Candidates run from a few winch places to every marker, along each side of the limb that it is on. For each of many
    sets of winch places lines are chosen greedily; the best sets are gone over line by line, each exchanged for another
    while that helps. `bare` is the trial of a layout without winches and cables; `lines` are those to choose from, if
    they are drawn already. Empty where some parts stay, or there should be mirror images.
    """
    if bare.layout.constraints.mirror is not None or bare.layout.sites:
        return []
    if lines is None:
        lines = list(draw_lines(proposals, [marker.at for marker in bare.layout.source.markers]))
    if not lines:
        return []
    choice = LineChoice(proposals, bare, lines, winches, cables)
    found = _choose(choice, bare, count)
    if bare.layout.constraints.two_way:  # a rough model finds other beginnings than one that knows the ways of winches
        found += [
            layout for turned in RULES.tried_ways for layout in _choose(choice.with_reversed(turned), bare, count // 2)
        ]
    return found


def _choose(choice: LineChoice, bare: Trial, count: int) -> list[Layout]:
    """Layouts of the best sets of lines."""
    begun = sorted((choice.fill_set([], places) for places in choice.place_sets()), key=choice.cost)
    found: dict[tuple[int, ...], float] = {}
    for chosen in begun[: RULES.improved_sets * count]:
        better = choice.exchange_lines(chosen)
        found[tuple(sorted(better))] = choice.cost(better)
    layouts = []
    seen: dict[tuple[int, ...], int] = {}

    def rank(chosen: tuple[int, ...]) -> float:
        places = tuple(sorted({choice.lines[index].place for index in chosen}))
        seen[places] = seen.get(places, 0) + 1
        return found[chosen] * (1.0 + RULES.same_place_penalty * (seen[places] - 1))

    ranks = {chosen: rank(chosen) for chosen in sorted(found, key=lambda one: found[one])}
    for chosen in sorted(ranks, key=lambda one: ranks[one]):
        layout = _layout(choice.proposals, bare.layout, [choice.lines[index] for index in chosen])
        layouts += [] if layout is None else [layout]
    return layouts[:count]


def _layout(proposals: Proposals, layout: Layout, lines: Sequence[Line]) -> Layout | None:
    """A layout with these lines; None if they cannot be built."""
    for line in lines:
        layout = proposals.with_line(layout, line.place, line.points, reverse=line.reverse)
    return pushed_back(layout, proposals.graph.region, RULES.sketch_reach * proposals.graph.size)


def draw_lines(proposals: Proposals, ends: Sequence[Point]) -> Iterator[Line]:
    """Draw lines from each of a few winch places to each end [m], on each side."""
    graph = proposals.graph
    places = _spread_points(graph.points[graph.winch_places], RULES.winch_places)
    costs = csr_array(
        (np.tile(graph.lengths * _shallow(proposals), 2), (np.append(*graph.edges.T), np.append(*graph.edges.T[::-1]))),
        shape=(len(graph.points),) * 2,
    )
    inner = np.flatnonzero(~graph.world)
    goals = np.unique([
        inner[np.argmin(np.linalg.norm(graph.points[inner] - end, axis=1))] for end in ends
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
    return (
        1.0 + RULES.rim_factor * np.maximum(1.0 - ends / proposals.deepest, 0.0) ** 2 + RULES.still_factor * graph.still
    )


def _spread_points(points: Points, count: int) -> Int[np.ndarray, " chosen"]:
    """Choose a few points far from one another, the middle one first."""
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
    ramp = np.minimum(0.5 * np.arange(len(middle)), RULES.max_side_spacings) * spacing
    for side in _sides(along):
        reach = _reach(middle, side, ramp, proposals.graph.region)
        wide = np.flatnonzero(reach >= RULES.side_gaps * proposals.evaluator.constraints.cable_gap)
        # At the thin end of a limb the lines of both sides would meet: they end before it.
        end = wide[-1] + 1 if len(wide) and wide[-1] > 1 else len(middle)
        for share, apart in RULES.sides:
            moved = (middle + (share * reach)[:, None] * side)[:end]
            points = _inside(resample(moved, apart * spacing), proposals.graph.region)
            if points is not None:
                yield np.vstack([outside, points])
                break


def _reach(middle: Route, side: Route, ramp: Vector, region: Region) -> Vector:
    """Distance that each point of a path can go to a side within the clearance, at most a ramp, smoothed [m]."""
    shares = np.linspace(1.0, 0.1, 10)
    places = middle + (shares[:, None] * ramp)[:, :, None] * side
    fits = region.depths(places.reshape(-1, middle.shape[1])).reshape(len(shares), -1) >= MARGIN * region.clearance
    reach = np.where(fits.any(axis=0), shares[fits.argmax(axis=0)], 0.0) * ramp
    return np.minimum(reach, _smooth(reach[:, None])[:, 0])


def _smooth(route: Route) -> Route:
    """A polyline, its ends kept, after some rounds of means of neighbors."""
    route = route.copy()
    for _ in range(RULES.smoothing_rounds):
        route[1:-1] = 0.25 * route[:-2] + 0.5 * route[1:-1] + 0.25 * route[2:]
    return route


def _inside(points: Route, region: Region) -> Route | None:
    """A line pushed to the clearance but for its first point; None where it cuts a corner or is too short."""
    points[1:] = region.push_inside(points[1:])
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return points if len(apart) and apart.min() > RULES.same_point and region.holds(points) else None


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
