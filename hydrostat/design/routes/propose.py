"""`propose`: networks with one cable more, along the paths that promise most."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from hydrostat.design.route_options import RouteOptions
from hydrostat.design.routes.bench import Bench, Trial
from hydrostat.design.routes.lay import lay
from hydrostat.design.routes.layout import Layout, Stand
from hydrostat.design.routes.mirror import mirrored
from hydrostat.design.routes.price import PathLimits, PricedPath, price_paths
from hydrostat.design.routes.refine import pushed_back
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.robot import Mount, Winch
from hydrostat.simulation import rig_slopes


@dataclass(frozen=True, eq=False)
class Proposals:
    """Where cables may be added.

    Attributes:
        bench: solves layouts.
        graph: of via points.
        options: of the search.
        spacing: of via points [m].
    """

    bench: Bench
    graph: RouteGraph
    options: RouteOptions
    spacing: float

    @cached_property
    def deepest(self) -> float:
        """How deep a winch can be in the body [m]."""
        inner = self.graph.points[~self.graph.world]
        return max(float(self.graph.region.depths(inner).max(initial=0.0)), 1e-9)

    def priced(self, trial: Trial, *, count: int, winches: Sequence[int] | None = None) -> list[PricedPath]:
        """Paths that promise most beside the network there is, at the equilibria where it is.

        What the present winches can do by themselves is taken out of residual and moves, as they are free to follow.
        """
        bench = self.bench
        moves, residuals, owners, ridges = [], [], [], []
        for index, pose in enumerate(trial.poses):
            slopes = rig_slopes(trial.simulation, pose, bench.markers[index])
            rows = len(bench.markers[index]) * trial.layout.dim
            fields = np.moveaxis(slopes.fields[:rows], 0, 2)
            own = bench.weights[index] * self.graph.edge_moves(pose.nodes, fields)
            residual = bench.residual(trial.simulation, index, pose.nodes)
            free = _span(bench.weights[index] * slopes.contractions[:rows])
            moves.append(own - (own @ free) @ free.T)
            residuals.append(residual - free @ (free.T @ residual))
            owners.append(np.full(rows, index))
            ridges.append((_EFFORT * float(np.linalg.norm(residual)) / bench.constraints.tension_limit) ** 2)
        constraints = bench.constraints
        return price_paths(
            self.graph,
            np.concatenate(moves, axis=1),
            np.concatenate(residuals),
            np.concatenate(owners),
            ridge=np.maximum(ridges, 1e-24),
            most=constraints.tension_limit,
            limits=PathLimits(hops=self.options.hops, turn=constraints.turn, longest=constraints.longest),
            count=count,
            lead_penalty=self.options.lead_penalty,
            leads=constraints.leads,
            winches=winches,
        )

    def grown(self, trial: Trial, *, winches: int, needed: int, count: int) -> list[Layout]:
        """Layouts with one cable more, that can be built, the most promising first.

        Args:
            trial: where the network is now.
            winches: most winches.
            needed: cables that are still to come, this one included.
            count: of layouts from new winches, and of those from winches that there are.
        """
        layout = trial.layout
        missing = winches - len(layout.stands)
        found = []
        if missing > 0:
            places = self._vacant(layout)
            found += [(path, None) for path in self.priced(trial, count=count, winches=places)] if len(places) else []
        if needed > missing:
            free = {
                self._near(stand): index for index, stand in enumerate(layout.stands) if self._has_room(layout, index)
            }
            if free:
                paths = self.priced(trial, count=count, winches=list(free))
                found += [(path, free[path.winch]) for path in paths]
        found.sort(key=lambda pair: -pair[0].gain)
        layouts = [self._with(layout, path, winch) for path, winch in found]
        return [layout for layout in layouts if layout is not None]

    def _has_room(self, layout: Layout, winch: int) -> bool:
        return sum(line.winch == winch for line in layout.lines) < layout.constraints.cables_per_winch

    def _near(self, stand: Stand) -> int:
        """The graph point at which a winch stands, or that is nearest to it."""
        places = self.graph.winch_places if stand.winch.mount is Mount.WORLD else np.flatnonzero(~self.graph.world)
        return int(places[np.argmin(np.linalg.norm(self.graph.points[places] - stand.winch.at, axis=1))])

    def _vacant(self, layout: Layout) -> list[int]:
        """Places where one more winch may stand."""
        places = self.graph.winch_places
        for stand in layout.stands:
            gap = 1e-6 if stand.winch.mount is Mount.WORLD else layout.constraints.winch_gap
            away = np.linalg.norm(self.graph.points[places] - stand.winch.at, axis=1)
            places = places[away > gap]
        return [int(place) for place in places]

    def _with(self, layout: Layout, path: PricedPath, winch: int | None) -> Layout | None:
        """A layout with a cable along a path, of a new winch if none is given; None if it cannot be built."""
        stands = layout.stands
        if winch is None:
            winch, stands = len(stands), (*stands, self._stand(layout, path.winch))
        place = np.array(stands[winch].winch.at)
        line = lay(path, self.graph, winch=winch, place=place, spacing=self.spacing)
        if line is None:
            return None
        added = replace(layout, stands=stands, lines=(*layout.lines, line))
        if layout.constraints.mirror is not None:
            added = mirrored(added)
        return pushed_back(added, self.graph.region, _REACH * self.graph.size)

    def _stand(self, layout: Layout, place: int) -> Stand:
        constraints = layout.constraints
        names = {stand.winch.name for stand in layout.stands}
        name = next(f"winch_{number}" for number in range(1, 99) if f"winch_{number}" not in names)
        world = bool(self.graph.world[place])
        if world:
            name = layout.source.winches[place - int((~self.graph.world).sum())].name
        return Stand(
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
    return left[:, values > _WEAK * max(values.max(initial=0.0), 1e-12)]


_EFFORT = 0.1
"""Share of the residual that the tension limit is worth."""

_WEAK = 0.02
"""Winches that move the rows less than this share of the strongest are not counted on."""


_REACH = 0.03
"""What is farther than this share of the body's size from a limit does not feel it."""
