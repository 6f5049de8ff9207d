"""`WinchTrees`: where winches stand, and which routes they pull (R40 to R44, E22, E23, E25)."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from hydrostat.arrays import Bool, Float, Int, Nodes
from hydrostat.design.constraints import Constraints
from hydrostat.design.polyline import Route, length
from hydrostat.design.request import TreeOptions
from hydrostat.design.trees.lead_paths import LeadPaths
from hydrostat.geometry import Mesh, locate


@dataclass(frozen=True, eq=False)
class WinchTree:
    """One winch and the routes it pulls."""

    place: int  # point of the `LeadPaths` at which the winch stands
    routes: tuple[int, ...]  # indices of its routes
    score: float  # phi mean - (1 - phi) std, less the penalty for leads


class WinchTrees:
    """All routes of one body with the lead from every winch place to each of them."""

    def __init__(
        self,
        mesh: Mesh,
        routes: list[Route],
        posed: list[Nodes],
        ways: LeadPaths,
        constraints: Constraints,
        options: TreeOptions,
    ) -> None:
        """Routes at rest, and the node positions of each activated pose `posed` [m]."""
        self.mesh, self.routes, self.ways = mesh, routes, ways
        self.constraints, self.options = constraints, options
        self.places = ways.places
        self.leads, self.reversed = self._leads()
        self.shortenings = np.array([[_shortening(mesh, route, nodes) for nodes in posed] for route in routes])

    def best(self, count: int, used: set[int], taken: list[int], phi: float) -> WinchTree | None:
        """Best winch with `count` of the routes not yet used, over all places not too near winches `taken` (R41)."""
        points = self.ways.points
        rows = np.arange(len(self.places))
        for other in taken:
            gap = _PLACE_TOLERANCE if self.ways.outside(other) else self.constraints.winch_gap
            rows = rows[np.linalg.norm(points[self.places[rows]] - points[other], axis=1) >= gap]
        order = np.argsort(self.shortenings.mean(axis=1), kind="stable")
        order = order[~np.isin(order, list(used))]
        reached = np.isfinite(self.leads[np.ix_(rows, order)])
        found: WinchTree | None = None
        for pattern in np.unique(reached, axis=0):
            same = rows[(reached == pattern).all(axis=1)]
            if pattern.any():
                tree = self._best_run(same, order[pattern], count, phi)
                if found is None or tree.score > found.score:
                    found = tree
        return found

    def _best_run(
        self, rows: Int[np.ndarray, " places"], order: Int[np.ndarray, " routes"], count: int, phi: float
    ) -> WinchTree:
        """Best of places that reach the same routes, with `count` of these that follow one another in `order`."""
        size = min(count, len(order))
        scale = max(float(self.shortenings.max(initial=0.0)), 1e-9)
        runs = sliding_window_view(self.shortenings[order] / scale, size, axis=0).swapaxes(1, 2)
        leads = sliding_window_view(self.leads[np.ix_(rows, order)], size, axis=1).mean(axis=2) / self.mesh.size
        scores = np.array([tree_score(run, phi) for run in runs]) - self.options.lead_penalty * leads
        row, first = np.unravel_index(np.argmax(np.round(scores, 12)), scores.shape)
        chosen = order[first : first + size].tolist()
        return WinchTree(int(self.places[rows[row]]), tuple(sorted(chosen)), float(scores[row, first]))

    def cable_points(self, place: int, route: int) -> tuple[Route, int]:
        """Points of the cable from a winch along its lead and its route, and how many of them are the lead.

        A route that begins less than a spool's diameter from the winch has no lead: it begins at the winch.
        """
        row = int(np.flatnonzero(self.places == place)[0])
        points = self.routes[route][:: -1 if self.reversed[row, route] else 1]
        winch = self.ways.points[place]
        beside = np.linalg.norm(points[0] - winch) < 2 * self.constraints.spool_radius
        if beside and not self.ways.outside(place):
            return np.vstack([winch, points[1:]]), 0
        lead = self.ways.path(place, points[0])
        return np.vstack([lead, points]), len(lead)

    def _leads(self) -> tuple[Float[np.ndarray, "places routes"], Bool[np.ndarray, "places routes"]]:
        """Length of the way inside the body from every place to the better end of every route; is that its last?

        Where a cable that comes straight from the winch would turn too sharply, the end counts as farther away by
        the size of the body.
        """
        ends = np.array([[route[0], route[-1]] for route in self.routes]).reshape(-1, self.mesh.dim)
        away = self.ways.lengths(ends).T
        onward = np.array([[route[1] - route[0], route[-2] - route[-1]] for route in self.routes]).reshape(ends.shape)
        arriving = ends - self.ways.points[self.places][:, None]
        lengths = np.linalg.norm(arriving, axis=2) * np.linalg.norm(onward, axis=1)
        back = (arriving * onward).sum(axis=2) < np.cos(np.radians(self.constraints.max_turn)) * lengths
        away += np.where(back, self.mesh.size, 0.0)
        pairs = away.reshape(len(self.places), len(self.routes), 2)
        return pairs.min(axis=2), pairs[:, :, 1] < pairs[:, :, 0]


_PLACE_TOLERANCE = 1e-6  # winches in the world nearer than this stand at one place [m]


def tree_score(contractions: Float[np.ndarray, "cables poses"], phi: float) -> float:
    """Phi mean - (1 - phi) std of the contraction that each cable of one winch needs (R42, R43).

    The thesis adds a variance, and sums tensions; what cables of one winch share is contraction, so contractions are
    scored, and their spread, in the same unit, is subtracted (E22, E23). Over poses the scores are averaged (E28).
    """
    return float(phi * contractions.mean() - (1.0 - phi) * contractions.std(axis=0).mean())


def _shortening(mesh: Mesh, route: Route, nodes: Nodes) -> float:
    """By how much a route is shorter in an activated pose than at rest [m]."""
    posed = locate(mesh, route).positions(nodes)
    return float(length(route) - length(posed))
