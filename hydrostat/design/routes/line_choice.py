"""`LineChoice`: sets of lines that could be cables, judged on a linear body."""

import math
from collections.abc import Collection, Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, product

import numpy as np
from scipy.sparse import csc_array, hstack

from hydrostat.arrays import Bool, Vector
from hydrostat.design.polyline import Route, resample
from hydrostat.design.routes.evaluator import Trial
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.search_rules import RULES
from hydrostat.geometry import build_point_tree, locate
from hydrostat.kernel import native
from hydrostat.robot import Cable


@dataclass(frozen=True, eq=False)
class Line:
    """A cable that a person might draw: from a winch along a limb to a marker, on one side of it."""

    place: int  # graph point of its winch
    points: Route  # [m]
    reverse: bool = False  # wound the other way round


class LineChoice:
    """Sets of lines, judged by what they would do at rest if the body were linear."""

    def __init__(self, proposals: Proposals, bare: Trial, lines: Sequence[Line], winches: int, cables: int) -> None:
        """Find what each line does: `bare` is the trial of a layout without winches and cables."""
        self.proposals, self.lines, self.winches, self.cables = proposals, lines, winches, cables
        evaluator, simulation = proposals.evaluator, bare.simulation
        sensitivities = csc_array(hstack([csc_array(self._pull(line)[:, None]) for line in lines]))
        self.gives = np.eye(len(lines)) / Cable.stiffness  # contraction of each line by the tension of each [m/N]
        for first in range(0, len(lines), RULES.lines_at_once):
            some = slice(first, first + RULES.lines_at_once)
            self.gives[:, some] += sensitivities.T @ simulation.response(
                bare.poses[0], sensitivities[:, some].toarray()
            )
        missed = [evaluator.residual(simulation, index, pose.nodes) for index, pose in enumerate(bare.poses)]
        self.moves: list[np.ndarray] = []  # of the markers by the tension of each line, of each pose [m/N]
        for index in range(len(missed)):
            rows = len(evaluator.markers[index]) * bare.layout.dim
            fields = bare.sensitivities[index].fields[:rows].reshape(rows, -1)
            self.moves.append(-evaluator.weights[index][:, None] * (sensitivities.T @ fields.T).T)
        self._grams = np.array([move.T @ move for move in self.moves])
        self._aims = np.array([move.T @ miss for move, miss in zip(self.moves, missed, strict=True)])
        self._squares = np.array([float(miss @ miss) for miss in missed])
        self._ridges = RULES.line_effort * np.sqrt(self._squares) / evaluator.constraints.tension_limit
        self._places = np.array([line.place for line in lines], dtype=np.int64)
        self._reverse = np.zeros(len(lines), dtype=bool)
        self._turned = 0  # maximum number of winches whose ways are all tried

    def with_reversed(self, turned: int) -> "LineChoice":
        """The same lines, then each once more, wound the other way round.

        Of sets with more than `turned` winches that turn both ways, each winch may do both at a time in the model.
        """
        other = copy(self)
        other.__dict__ = {name: value for name, value in vars(self).items() if name not in ("_meets", "_crowded_pairs")}
        other.lines = [*self.lines, *(replace(line, reverse=True) for line in self.lines)]
        compliance = np.eye(len(self.lines)) / Cable.stiffness
        other.gives = np.tile(self.gives - compliance, (2, 2)) + np.eye(len(other.lines)) / Cable.stiffness
        other.moves = [np.tile(move, 2) for move in self.moves]
        other._grams, other._aims = np.tile(self._grams, (1, 2, 2)), np.tile(self._aims, 2)
        other._places = np.tile(self._places, 2)
        other._turned = turned
        other._reverse = np.repeat([False, True], len(self.lines))
        return other

    def _pull(self, line: Line) -> Vector:
        """Sensitivity of its length by the nodes."""
        mesh = self.proposals.evaluator.source.body.mesh
        world = bool(self.proposals.graph.world[line.place])
        spans = np.diff(line.points, axis=0)
        units = spans / np.linalg.norm(spans, axis=1)[:, None]
        ways = np.vstack([np.zeros(mesh.dim), units]) - np.vstack([units, np.zeros(mesh.dim)])
        anchors = locate(mesh, line.points[int(world) :])
        sensitivity = np.zeros(mesh.nodes.shape)
        for corner, weights in zip(anchors.stencils.T, anchors.weights.T, strict=True):
            np.add.at(sensitivity, corner, weights[:, None] * ways[int(world) :])
        return sensitivity.ravel()

    def cost(self, chosen: Sequence[int]) -> float:
        """Error of a set of lines, with its effort [m]; lines that would have to push are left slack."""
        return float(self._costs(np.array([chosen], dtype=np.int64).reshape(1, -1))[0])

    def _costs(self, sets: np.ndarray) -> Vector:
        """The same of several sets of as many lines."""
        errors = np.empty(len(sets))
        pulled = self._places + self._reverse * len(self.proposals.graph.points)  # one number for each way of a winch
        model = (self.gives, self._grams, self._aims, self._squares, self._ridges)
        if self._reverse[sets].any():
            squares = np.full((len(sets), len(self.moves)), np.inf)
            for kept in self._one_way_sets(sets):
                for pose in range(len(self.moves)):
                    one = (self.gives, *(part[pose : pose + 1] for part in model[1:]), pulled)
                    native.line_errors(*one, kept, RULES.slack_rounds, errors)
                    squares[:, pose] = np.minimum(squares[:, pose], errors**2)
            errors = np.sqrt(squares.sum(axis=1))
        else:
            native.line_errors(*model, pulled, np.ascontiguousarray(sets), RULES.slack_rounds, errors)
        return errors * (1.0 + RULES.line_gain * sets.shape[1])

    def _one_way_sets(self, sets: np.ndarray) -> Iterator[np.ndarray]:
        """Yield the same sets, each winch turning one of its ways: lines that this leaves slack are -1, at the end."""
        places, back = self._places[sets], self._reverse[sets]
        both = [place for place in np.unique(places[back]) if np.any((places == place) & ~back)]
        for ways in product((False, True), repeat=len(both)) if len(both) <= self._turned else ():
            out = np.zeros(sets.shape, dtype=bool)
            for place, way in zip(both, ways, strict=True):
                out |= (places == place) & (back != way)
            order = np.argsort(out, axis=1, kind="stable")
            yield np.take_along_axis(np.where(out, -1, sets), order, axis=1)
        if len(both) > self._turned:
            yield np.ascontiguousarray(sets)

    def place_sets(self) -> list[tuple[int, ...]]:
        """Sets of places of winches: all of them, or many at random."""
        known = sorted({line.place for line in self.lines})
        chance = np.random.default_rng(0)
        count = min(self.winches, len(known))
        if math.comb(len(known), count) <= RULES.winch_sets:
            return list(combinations(known, count))
        return [tuple(chance.choice(known, count, replace=False).tolist()) for _ in range(RULES.winch_sets)]

    def fill_set(self, chosen: list[int], places: Collection[int] | None = None) -> list[int]:
        """With one line more after the other, of winches at some places, while that helps."""
        cost = self.cost(chosen)
        while len(chosen) < self.cables:
            best, least = self._best_added(chosen, places)
            if not least < cost:
                break
            chosen, cost = best, least
        return chosen

    def exchange_lines(self, chosen: list[int]) -> list[int]:
        """With lines exchanged for others, while that helps."""
        cost = self.cost(chosen)
        for _ in range(RULES.line_exchanges):
            before = cost
            for number in range(len(chosen)):
                rest = [index for index in chosen if index != chosen[number]] if number < len(chosen) else chosen
                best, least = self._best_added(rest)
                if least < cost:
                    chosen, cost = best, least
            chosen = self.fill_set(chosen)
            cost = self.cost(chosen)
            if cost >= before:
                break
        return chosen

    def _best_added(self, chosen: list[int], places: Collection[int] | None = None) -> tuple[list[int], float]:
        """The best set with one line more that can be built, and its cost; infinite where there is none."""
        fits = self._fitting(chosen)
        if places is not None:
            fits &= np.isin(self._places, list(places))
        added = np.flatnonzero(fits)
        if not len(added):
            return chosen, math.inf
        sets = np.column_stack([np.tile(np.array(chosen, dtype=np.int64), (len(added), 1)), added])
        costs = self._costs(sets)
        return [*chosen, int(added[costs.argmin()])], float(costs.min())

    def _fitting(self, chosen: Sequence[int]) -> Bool[np.ndarray, " lines"]:
        """True for lines that can be built beside others."""
        own, most = list(chosen), self.proposals.evaluator.constraints.cables_per_winch
        fits: np.ndarray = np.logical_not(self._meets[own].any(axis=0))
        fits[own] = False
        places, counts = np.unique(self._places[own], return_counts=True)
        there = np.isin(self._places, places)
        fits &= ~np.isin(self._places, places[counts >= most])
        if len(places) >= self.winches:
            return fits & there
        crowded: np.ndarray = np.any(self._crowded_pairs[:, self._places[own]], axis=1)
        return fits & (there | ~crowded[self._places])

    @cached_property
    def _crowded_pairs(self) -> Bool[np.ndarray, "points points"]:
        """Graph points too near to one another for two winches."""
        graph = self.proposals.graph
        used = np.unique(self._places)
        gaps = np.where(graph.world[used], 1e-6, self.proposals.evaluator.constraints.winch_gap)
        away = np.linalg.norm(graph.points[used, None] - graph.points[None, used], axis=2)
        crowded = np.zeros((len(graph.points),) * 2, dtype=bool)
        crowded[np.ix_(used, used)] = away < gaps[:, None]
        return crowded

    @cached_property
    def _meets(self) -> Bool[np.ndarray, "lines lines"]:
        """Lines that come too near to one another, but about a winch that both have."""
        constraints, graph = self.proposals.evaluator.constraints, self.proposals.graph
        near = RULES.meeting_gap * constraints.cable_gap
        meets = np.zeros((len(self.lines),) * 2, dtype=bool)
        if near == 0.0:
            return meets
        fine = [resample(line.points[int(graph.world[line.place]) :], max(near, 1e-3)) for line in self.lines]
        owners = np.repeat(np.arange(len(fine)), [len(points) for points in fine])
        points, places = np.concatenate(fine), self._places[owners]
        away = np.linalg.norm(points - graph.points[places], axis=1)
        tree = build_point_tree(points)
        one, other = tree.query_pairs(np.nextafter(near, 0.0), output_type="ndarray").T
        beside = RULES.meeting_radii * constraints.spool_radius
        both = (places[one] == places[other]) & ((away[one] < beside) | (away[other] < beside))
        meets[owners[one[~both]], owners[other[~both]]] = True
        for place in np.unique(self._places[~graph.world[self._places]]):  # a winch needs room
            close = tree.query_ball_point(graph.points[place], np.nextafter(2 * constraints.spool_radius, 0.0))
            foreign = np.array(close, dtype=np.int64)[places[close] != place]
            meets[np.ix_(self._places == place, np.isin(np.arange(len(fine)), owners[foreign]))] = True
        meets |= meets.T
        np.fill_diagonal(meets, val=False)
        return meets
