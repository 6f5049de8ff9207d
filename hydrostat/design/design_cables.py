"""`design_cables`: from poses to winches and cables, as the thesis has it, judged by the pose error (R35 to R46)."""

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations, islice, product
from math import comb

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.design.activation import activate
from hydrostat.design.fibres import Fibres, edge_fibres, element_fibres
from hydrostat.design.judge import Progress, judge
from hydrostat.design.network import Activation, Network
from hydrostat.design.options import DesignOptions, FibreKind
from hydrostat.design.orientation import wanted_directions
from hydrostat.design.prune import prune
from hydrostat.design.region import Route, body_region
from hydrostat.design.routes import GrowthLimits, grow_routes, lay_route, length, sharpest_turn, strongest
from hydrostat.design.via_points import keep_apart
from hydrostat.design.winch_tree import Tree, WinchTrees
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Cable, Pose, Robot, Winch


def design_cables(
    robot: Robot,
    poses: Iterable[Pose],
    *,
    winches: int,
    cables: int,
    options: DesignOptions | None = None,
    progress: Progress | None = None,
) -> Network:
    """A network of exactly `winches` winches and at most `cables` cables for some poses.

    The thesis's way: muscle fibres reach each pose; the strongest are joined to routes; a winch is put where the
    routes it pulls score best; what it uses is removed and the next winch is placed (E25). This is done for every
    combination of thresholds, distances, weights and shares of the options, and of all these networks the one is
    returned that reaches the poses best by its own winches (E24) without pulling too hard, less the cables that it
    does as well without.
    Nothing is drawn at random.

    Args:
        robot: body, pins and markers; its own winches and cables are left aside.
        poses: what the network should reach.
        winches: how many.
        cables: how many in all, at least one a winch.
        options: see `DesignOptions`.
        progress: called as the work goes on.

    Raises:
        InputError: no pose, a pose of a marker that does not exist, counts that do not fit, or a body that is not flat
            or too thin.
        HydrostatError: no network can be built from the muscles that were found.
    """
    poses = list(poses)
    if not poses:
        raise InputError("there is no pose to design for; add a [[pose]] to the robot")
    if not 1 <= winches <= cables:
        raise InputError(
            f"{winches} winches and {cables} cables: there must be at least one winch, and a cable for each"
        )
    markers = [marker.name for marker in robot.markers]
    for pose in poses:
        for name in pose.targets:
            if name not in markers:
                known = f"its markers are: {', '.join(markers)}" if markers else "it has no markers"
                raise InputError(f'pose "{pose.name}": the robot has no marker "{name}"; {known}')
    return _Design(robot, poses, winches, cables, options or DesignOptions(), progress or _silent).run()


def _silent(stage: str, done: int, total: int) -> None:
    """No progress wanted."""


@dataclass(frozen=True, eq=False)
class _Plan:
    """Winch trees that were chosen from all that one set of candidates allows."""

    candidates: tuple[np.ndarray, ...]
    trees: WinchTrees
    chosen: list[Tree]

    @property
    def score(self) -> float:
        """Mean score of its winches (R43)."""
        return float(np.mean([tree.score for tree in self.chosen]))

    @property
    def key(self) -> object:
        """The same for two plans of the same network."""
        return tuple(
            (tree.place, tuple(self.trees.routes[index].tobytes() for index in tree.routes)) for tree in self.chosen
        )


class _Design:
    """One run."""

    def __init__(
        self, robot: Robot, poses: list[Pose], winches: int, cables: int, options: DesignOptions, progress: Progress
    ) -> None:
        self.robot, self.poses, self.options, self.progress = robot, poses, options, progress
        self.winches, self.cables = winches, cables
        self.mesh = robot.body.mesh
        self.region = body_region(robot.body, options.clearance)
        spans = np.diff(self.mesh.nodes[self.mesh.edges], axis=1)[:, 0]
        self.spacing = float(np.linalg.norm(spans, axis=1).mean())

    def run(self) -> Network:
        began = time.process_time()
        activations = self._activations()
        built = self._build_all(_shortlist(self._plans(activations)))
        if not built:
            raise HydrostatError(
                f"no network of {self.winches} winches and up to {self.cables} cables could be built: too few "
                "routes of strong muscles keep clear of one another and of the edge of the body; ask for fewer "
                "winches, lower the clearance, or choose a pose that bends the body more"
            )
        best, reached = judge(
            [robot for _, robot in built], self.poses, tension=self.options.tension, progress=self.progress
        )
        plan, designed = built[best]
        designed, reached = prune(designed, self.poses, reached, tension=self.options.tension, loss=self.options.loss)
        return Network(
            robot=designed,
            activations=activations,
            candidates=plan.candidates,
            trees=tuple(plan.trees.routes),
            reached=reached,
            score=plan.score,
            tried=len(built),
            seconds=time.process_time() - began,
        )

    def _build_all(self, plans: Iterable["_Plan"]) -> list[tuple["_Plan", Robot]]:
        """The first of the plans that can be built, with their robots."""
        robots = ((plan, self._build(plan.trees, plan.chosen)) for plan in plans)
        return list(islice(((plan, robot) for plan, robot in robots if robot), self.options.trials))

    def _plans(self, activations: tuple[Activation, ...]) -> list[list["_Plan"]]:
        """For each threshold, distance and phi, a plan for every share of cables among winches."""
        groups = []
        shares = list(islice(_shares(self.cables, self.winches), self.options.shares))
        variants = list(product(self.options.thresholds, self.options.distances))
        for done, (threshold, distance) in enumerate(variants):
            self.progress("Growing winch trees", done, len(variants))
            candidates, routes = self._routes(activations, threshold, distance)
            if not routes:
                continue
            posed = [activation.nodes for activation in activations]
            trees = WinchTrees(self.mesh, routes, posed, self.region, self.options)
            for phi in self.options.phis:
                plans = (_Plan(candidates, trees, self._plant(trees, share, phi)) for share in shares)
                groups.append([plan for plan in plans if len(plan.chosen) == self.winches])
        self.progress("Growing winch trees", len(variants), len(variants))
        return groups

    def _activations(self) -> tuple[Activation, ...]:
        found = []
        for index, pose in enumerate(self.poses):
            self.progress("Activating muscles", index, len(self.poses))
            found.append(activate(self.robot, pose, self._fibres(pose), self.options))
        self.progress("Activating muscles", len(self.poses), len(self.poses))
        return tuple(found)

    def _fibres(self, pose: Pose) -> Fibres:
        if self.options.fibres is FibreKind.EDGES:
            return edge_fibres(self.mesh)
        return element_fibres(self.mesh, wanted_directions(self.robot, pose))

    def _routes(
        self, activations: tuple[Activation, ...], threshold: int, distance: float
    ) -> tuple[tuple[np.ndarray, ...], list[Route]]:
        """Candidate fibres of each pose, and the routes laid through them."""
        limits = GrowthLimits(
            distance=distance * self.spacing,
            steps=self.options.growth_steps,
            turn=self.options.turn,
            spacing=self.spacing,
        )
        candidates, laid = [], []
        for activation in activations:
            kept = strongest(activation.tensions, threshold)
            ends = activation.fibres.ends(self.mesh.nodes)[kept]
            grown = grow_routes(ends, activation.tensions[kept], limits)
            laid += [lay_route(route, self.region, 2 * self.spacing) for route in grown]
            candidates.append(kept)
        shortest = self.options.shortest * self.spacing
        routes = [route for route in laid if route is not None and length(route) >= shortest]
        return tuple(candidates), _apart(routes, self.spacing)

    def _plant(self, trees: WinchTrees, share: tuple[int, ...], phi: float) -> list[Tree]:
        """Winch after winch, each with the routes that are left (E25)."""
        used, taken, chosen = set(), [], []
        for count in share:
            tree = trees.best(count, used, taken, phi)
            if tree is None:
                break
            used |= set(tree.routes)
            taken.append(tree.place)
            chosen.append(tree)
        return chosen

    def _build(self, trees: WinchTrees, chosen: list[Tree]) -> Robot | None:
        """The network as a robot; None if a cable leaves the body, turns too sharply, or cannot be kept apart."""
        pulled = [
            (index, *trees.cable_points(tree.place, route))
            for index, tree in enumerate(chosen)
            for route in tree.routes
        ]
        laid = keep_apart(
            [points for _, points, _ in pulled], gap=self.options.hole_gap, winch_gap=2 * self.options.spool_radius
        )
        if laid is None or not all(self.region.holds(points) for points in laid):
            return None
        if max(map(sharpest_turn, laid)) > self.options.bend:
            return None
        winches = [self._winch(index, tree) for index, tree in enumerate(chosen)]
        cables = []
        for (index, _, lead), points in zip(pulled, laid, strict=True):
            sheathed = ((0, lead),) if lead and self.options.sheathed_leads else ()
            cables.append(Cable(winch=winches[index].name, points=tuple(map(_point, points)), sheathed=sheathed))
        return self.robot.with_network(winches, cables)

    def _winch(self, index: int, tree: Tree) -> Winch:
        return Winch(
            name=f"winch_{index + 1}",
            at=_point(self.mesh.nodes[tree.place]),
            spool_radius=self.options.spool_radius,
            travel=self.options.travel,
            release=self.options.release,
        )


def _point(coordinates: Vector) -> tuple[float, ...]:
    """Coordinates to a hundredth of a millimetre, as nobody places a cable finer."""
    return tuple(round(float(value), 5) for value in coordinates)


def _shares(cables: int, winches: int) -> Iterator[tuple[int, ...]]:
    """Ways to share cables among winches, at least one each; the evenest first."""
    ways = combinations(range(1, cables), winches - 1) if comb(cables - 1, winches - 1) <= 5000 else ()
    shares = [tuple(np.diff([0, *cuts, cables]).tolist()) for cuts in ways]
    even = tuple(cables // winches + (index < cables % winches) for index in range(winches))
    yield from sorted({*shares, even}, key=lambda share: (max(share) - min(share), [-count for count in share]))


def _shortlist(groups: list[list["_Plan"]]) -> list["_Plan"]:
    """The best plan of every group, then every second best, and so on; each network once.

    Scores of one group compare, those of different phi do not.
    """
    ranked = [sorted(group, key=lambda plan: -plan.score) for group in groups]
    plans: dict[object, _Plan] = {}
    for rank in range(max(map(len, ranked), default=0)):
        for group in ranked:
            if rank < len(group):
                plans.setdefault(group[rank].key, group[rank])
    return list(plans.values())


def _apart(routes: list[Route], spacing: float) -> list[Route]:
    """Routes without those that run along an earlier one."""
    kept: list[Route] = []
    for route in routes:
        near = [np.linalg.norm(route[:, None] - other[None], axis=2).min(axis=1) < 0.6 * spacing for other in kept]
        if not any(close.mean() > 0.6 for close in near):
            kept.append(route)
    return kept
