"""`Proposals`: networks with one cable more, along the paths that promise most."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.design.polyline import Route, nearest_shares, resample
from hydrostat.design.request import RouteOptions
from hydrostat.design.routes.begin import add_mirror_image
from hydrostat.design.routes.evaluator import Evaluator, Trial
from hydrostat.design.routes.layout import CableRoute, Layout, WinchSite
from hydrostat.design.routes.price import PathLimits, PricedPath, PricingProblem, price_paths
from hydrostat.design.routes.refine import pushed_back
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.design.routes.search_rules import RULES
from hydrostat.robot import Mount, Winch


@dataclass(frozen=True, eq=False)
class Additions:
    """Paths for one more cable, the most promising first."""

    # each with the winch that pulls it, None for a new one, and True where it is wound the other way round
    paths: tuple[tuple[PricedPath, int | None, bool], ...]
    cables: int  # most cables that a layout may have

    @property
    def gain(self) -> float:
        """Largest decrease of half the squared error that a path promises [m^2]."""
        return max((path.gain for path, *_ in self.paths), default=0.0)


@dataclass(frozen=True, eq=False)
class Proposals:
    """Region that new cables may use."""

    evaluator: Evaluator  # solves layouts
    graph: RouteGraph  # of via points
    options: RouteOptions  # of the search
    spacing: float  # of via points [m]
    effort: float = 0.3  # share of the residual that the tension limit is worth where paths are priced

    @cached_property
    def deepest(self) -> float:
        """Largest depth of a winch in the body [m]."""
        inner = self.graph.points[~self.graph.world]
        return max(float(self.graph.region.depths(inner).max(initial=0.0)), 1e-9)

    def price_paths(
        self,
        trial: Trial,
        *,
        count: int,
        winches: Sequence[int] | None = None,
        shared: int | None = None,
        reverse: bool = False,
        free: RouteGraph | None = None,
    ) -> list[PricedPath]:
        """Find the most promising paths next to the present network, at its equilibria.

        What the present winches can do by themselves is taken out of residual and moves, as they are free to follow.
        A cable of its own winch has a tension for each pose; one of the `shared` winch is pulled in all of them as that
        winch is, in proportion to its contractions, or to its payouts if it is a `reverse` one. `free` is the graph
        without runs that meet cables, if it is known.
        """
        evaluator, graph = self.evaluator, self._free_of(trial.layout) if free is None else free
        moves, residuals, owners, ridges = [], [], [], []
        for index, pose in enumerate(trial.poses):
            sensitivities = trial.sensitivities[index]
            rows = len(evaluator.markers[index]) * trial.layout.dim
            fields = np.moveaxis(sensitivities.fields[:rows], 0, 2)
            own = evaluator.weights[index] * graph.edge_moves(pose.nodes, fields)
            residual = evaluator.residual(trial.simulation, index, pose.nodes)
            known = _span(evaluator.weights[index][:, None] * sensitivities.contractions[:rows])
            moves.append(own - (own @ known) @ known.T)
            residuals.append(residual - known @ (known.T @ residual))
            owners.append(np.full(rows, index))
            if graph.still.any():
                moves.append(RULES.forbidden_moves * np.abs(moves[-1]).max(initial=1e-12) * graph.still[:, None])
                residuals.append(np.zeros(1))
                owners.append(np.array([index]))
            ridges.append((self.effort * float(np.linalg.norm(residual)) / evaluator.constraints.tension_limit) ** 2)
        constraints, options = evaluator.constraints, self.options
        pulled = np.ones(len(ridges))
        way = -1.0 if reverse else 1.0
        taken = np.array([0.0 if shared is None else way * float(pose.contractions[shared]) for pose in trial.poses])
        idle, taken = taken > -RULES.idle_contraction, np.maximum(taken, 0.0)
        follows = float(taken.max()) > RULES.idle_contraction
        if follows:
            pulled = taken / taken.max()
            ridges = [float((pulled**2 * ridges).sum())]
        elif not idle.all():  # it is pulled alone where its winch does not turn the other way
            pulled = idle.astype(float)
        rows = np.concatenate(owners)
        missed = PricingProblem(
            residual=np.concatenate(residuals),
            moves=np.concatenate(moves, axis=1) * pulled[rows],
            pose_of_row=np.zeros_like(rows) if follows else rows,
            ridge=np.maximum(ridges, 1e-24),
            most=constraints.tension_limit,
        )
        limits = PathLimits(
            max_edges=options.max_edges,
            turn=self._turn,
            longest=constraints.max_length,
            leads=constraints.leads,
            lead_penalty=options.lead_penalty,
        )
        return price_paths(graph, missed, limits, count=count, winches=winches)

    @property
    def _turn(self) -> float:
        """The sharpest turn that via points at their spacing may have [degrees]."""
        constraints = self.evaluator.constraints
        turn = max(constraints.max_turn, RULES.coarse_turn)
        if constraints.bend_radius == 0.0:
            return turn
        return min(turn, float(np.degrees(2 * np.arctan(0.5 * self.spacing / constraints.bend_radius))))

    def _free_of(self, layout: Layout) -> RouteGraph:
        """The graph without the runs that would cross the cables there are, or come too near to them."""
        gap = self.evaluator.constraints.cable_gap
        if gap == 0.0:
            return self.graph
        runs = self.graph.points[self.graph.edges]
        free = self._one_side(runs, gap)
        for route in layout.routes:
            winch = layout.sites[route.winch].winch
            points = route.points[int(winch.mount is Mount.WORLD) :]
            for start, end in pairwise(points):
                near = np.flatnonzero(free & self._reaches(runs, start, end, gap))
                own = np.repeat(np.stack([start, end])[None], len(near), axis=0)
                share, other = nearest_shares(runs[near], own)
                here = runs[near, 0] + share[:, None] * (runs[near, 1] - runs[near, 0])
                there = start + other[:, None] * (end - start)
                beside = np.linalg.norm(there - winch.at, axis=1) <= RULES.crowded_radii * winch.spool_radius
                free[near] = beside | (np.linalg.norm(here - there, axis=1) >= gap)
        return replace(self.graph, edges=self.graph.edges[free], still=self.graph.still[free])

    def _one_side(self, runs: np.ndarray, gap: float) -> np.ndarray:
        """Runs that do not meet mirror images: they are on one side of the mirror, and none runs along it."""
        mirror = self.evaluator.constraints.mirror
        if mirror is None:
            return np.ones(len(runs), dtype=bool)
        off = runs[:, :, "xyz".index(mirror)]
        return (off.min(axis=1) > -RULES.on_mirror) & (off.max(axis=1) > 0.5 * gap)

    @staticmethod
    def _reaches(runs: np.ndarray, start: Vector, end: Vector, gap: float) -> np.ndarray:
        """Runs with a box that comes within a gap of a segment's."""
        low, high = np.minimum(start, end) - gap, np.maximum(start, end) + gap
        return ((runs.max(axis=1) >= low) & (runs.min(axis=1) <= high)).all(axis=1)

    def price_additions(self, trial: Trial, *, winches: int, needed: int, count: int) -> "Additions":
        """Find paths for one more cable, the most promising first.

        `needed` cables are still to come, this one included; `count` is of paths from new winches, and of those from
        winches that there are.
        """
        layout = trial.layout
        missing, free = winches - len(layout.sites), self._free_of(layout)
        found = []
        if missing > 0:
            places = self._vacant(layout, alone=missing == 1)
            paths = (
                self.price_paths(trial, count=RULES.priced_paths * count, winches=places, free=free) if places else []
            )
            deep = sorted(paths, key=lambda path: -path.gain * self._depth(path.winch))[:count]
            others = [path for path in paths if path not in deep][: count // 2]
            found += [(path, None, False) for path in (*deep, *others)]
        if needed > missing:
            roomy = [index for index in range(len(layout.sites)) if self._has_room(layout, index)]
            for index in roomy:
                place = [self._near(layout.sites[index])]
                share = -(-count // len(roomy))
                found += [
                    (path, index, back)
                    for back in ((False, True) if layout.constraints.two_way else (False,))
                    for path in self.price_paths(
                        trial, count=share, winches=place, shared=index, reverse=back, free=free
                    )
                ]
        found.sort(key=lambda path: -path[0].gain)
        return Additions(tuple(found), len(layout.routes) + needed)

    def build(self, trial: Trial, additions: "Additions", winches: int, *, most: int | None = None) -> list[Layout]:
        """Layouts with one cable more along these paths, but for those that cannot be built; at most `most`."""
        layouts: list[Layout] = []
        for path, winch, back in additions.paths:
            if len(layouts) == most:
                break
            added = self._with(trial.layout, path, winch, reverse=back)
            if added is not None and self._counts(added, winches, additions.cables):
                layouts.append(added)
        return layouts

    def _counts(self, layout: Layout, winches: int, cables: int) -> bool:
        """True if there are no more winches and cables than allowed: a mirrored cable brings another."""
        pulled = np.bincount([route.winch for route in layout.routes], minlength=len(layout.sites))
        fits = len(layout.sites) <= max(winches, 1) and len(layout.routes) <= cables
        return fits and bool(pulled.max() <= layout.constraints.cables_per_winch)

    def _depth(self, place: int) -> float:
        """Score of a winch's embedding at a graph point, up to 1 (R12)."""
        if self.graph.world[place]:
            return 1.0
        depth = float(self.graph.region.depths(self.graph.points[place : place + 1])[0])
        return RULES.edge_gain + (1 - RULES.edge_gain) * min(depth / self.deepest, 1.0)

    def _has_room(self, layout: Layout, winch: int) -> bool:
        return sum(route.winch == winch for route in layout.routes) < layout.constraints.cables_per_winch

    def _near(self, site: WinchSite) -> int:
        """The graph point at which a winch stands, or that is nearest to it."""
        places = self.graph.winch_places if site.winch.mount is Mount.WORLD else np.flatnonzero(~self.graph.world)
        return int(places[np.argmin(np.linalg.norm(self.graph.points[places] - site.winch.at, axis=1))])

    def _vacant(self, layout: Layout, *, alone: bool = False) -> list[int]:
        """Places where one more winch may stand; in the mirror, where there can be no second one on its other side."""
        places, mirror = self.graph.winch_places, layout.constraints.mirror
        if alone and mirror is not None:
            off = np.abs(self.graph.points[places, "xyz".index(mirror)])
            places = places[2 * off < layout.constraints.winch_gap]
        for site in layout.sites:
            gap = 1e-6 if site.winch.mount is Mount.WORLD else layout.constraints.winch_gap
            away = np.linalg.norm(self.graph.points[places] - site.winch.at, axis=1)
            places = places[away > gap]
        return [int(place) for place in places]

    def _with(self, layout: Layout, path: PricedPath, winch: int | None, *, reverse: bool) -> Layout | None:
        """A layout with a cable along a path, of a new winch if none is given; None if it cannot be built."""
        sites = layout.sites
        if winch is None:
            winch, sites = len(sites), (*sites, self._new_site(layout, path.winch))
        place = np.array(sites[winch].winch.at)
        route = route_along(path, self.graph, winch=winch, place=place, spacing=self.spacing)
        if route is None:
            return None
        route = replace(route, ratio=-1.0) if reverse else route
        added = replace(layout, sites=sites, routes=(*layout.routes, route)).turn_winches()
        if layout.constraints.mirror is not None:
            image = add_mirror_image(added)
            if image is None:
                return None
            added = image
        return pushed_back(added, self.graph.region, RULES.path_reach * self.graph.size)

    def with_line(self, layout: Layout, place: int, points: Route, *, reverse: bool = False) -> Layout:
        """A layout with a cable along given points [m], of the winch at a graph point, made if there is none."""
        at = self.graph.points[place]
        there = [
            number for number, site in enumerate(layout.sites) if np.linalg.norm(at - site.winch.at) < RULES.same_winch
        ]
        winch = there[0] if there else len(layout.sites)
        sites = layout.sites if there else (*layout.sites, self._new_site(layout, place))
        route = CableRoute(winch, points, ratio=-1.0 if reverse else 1.0)
        return replace(layout, sites=sites, routes=(*layout.routes, route)).turn_winches()

    def _new_site(self, layout: Layout, place: int) -> WinchSite:
        constraints = layout.constraints
        names = {site.winch.name for site in layout.sites}
        name = next(f"winch_{number}" for number in range(1, 99) if f"winch_{number}" not in names)
        world = bool(self.graph.world[place])
        if world:
            name = layout.source.winches[place - int((~self.graph.world).sum())].name
        return WinchSite(
            Winch(
                name=name,
                at=tuple(map(float, self.graph.points[place])),
                spool_radius=constraints.spool_radius,
                travel=constraints.travel,
                release=constraints.release,
                mount=Mount.WORLD if world else Mount.BODY,
            )
        )


def _span(moves: np.ndarray) -> np.ndarray:
    """Orthonormal directions that the winches move the rows in."""
    if not moves.size:
        return np.zeros((len(moves), 0))
    left, values, _ = np.linalg.svd(moves, full_matrices=False)
    return left[:, values > RULES.weak_winch * max(values.max(initial=0.0), 1e-12)]


def route_along(path: PricedPath, graph: RouteGraph, *, winch: int, place: Vector, spacing: float) -> CableRoute | None:
    """A via point about every `spacing` [m] along the bare path, as few as the body allows along the lead.

    The winch that pulls it stands at `place` [m], at or near the first point of the path. None for a path that is too
    short to have a via point.
    """
    bare, winch_point = graph.points[list(path.nodes)], path.winch
    lead = graph.points[list(path.lead)][:-1] if len(path.lead) > 1 else np.zeros((0, len(place)))
    if not len(lead):
        bare = np.vstack([place, bare[1:]])
    entry = 1 if graph.world[winch_point] and not len(lead) else 0
    run = np.vstack([bare[:entry], _smooth(bare[entry:], spacing)])
    if len(run) < 2 or np.linalg.norm(np.diff(run, axis=0), axis=1).min() < 1e-6:
        return None
    if not len(lead):
        return CableRoute(winch, run)
    way = np.vstack([place, lead[1:], run[:1]])
    keep = 2 if graph.world[winch_point] else 1
    straight = _straighten_route(way, graph, keep)
    return CableRoute(winch, np.vstack([straight, run]), lead=len(straight))


def _smooth(route: Route, spacing: float) -> Route:
    """At equal distances, less jagged than the graph."""
    fine = resample(route, spacing / 4)
    for _ in range(4):
        fine[1:-1] = 0.25 * fine[:-2] + 0.5 * fine[1:-1] + 0.25 * fine[2:]
    return resample(fine, spacing)


def _straighten_route(way: Route, graph: RouteGraph, keep: int) -> Route:
    """Keep the first `keep` points of a way, then as few as see one another; without its end."""
    kept = list(range(keep))
    while kept[-1] < len(way) - 1:
        ahead = np.arange(len(way) - 1, kept[-1], -1)
        seen = graph.region.sees(np.repeat(way[kept[-1] : kept[-1] + 1], len(ahead), axis=0), way[ahead])
        kept.append(int(ahead[np.argmax(seen)]) if seen.any() else kept[-1] + 1)
    return way[kept[:-1]]
