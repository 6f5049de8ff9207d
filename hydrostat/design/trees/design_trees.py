"""`design_trees`: from poses to winches and cables as in the thesis, judged by the pose error (R35 to R46, E24)."""

import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, islice, product
from math import comb

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.design.buildable import violations
from hydrostat.design.built_error import expected_error
from hydrostat.design.muscles.activation import (
    Activation,
    FibreKind,
    Fibres,
    activate,
    edge_fibres,
    element_fibres,
    wanted_directions,
)
from hydrostat.design.network import Network, StageCallback, TreeTrace, ignore_stage
from hydrostat.design.polyline import Route, length, sharpest_turn
from hydrostat.design.region import Region
from hydrostat.design.request import DesignRequest
from hydrostat.design.trees.grow_routes import GrowthLimits, grow_routes, keep_apart, lay_route, strongest
from hydrostat.design.trees.judge_robots import judge, prune
from hydrostat.design.trees.lead_paths import find_lead_paths
from hydrostat.design.trees.winch_trees import WinchTree, WinchTrees
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.errors import HydrostatError
from hydrostat.progress import Progress, no_progress
from hydrostat.robot import Cable, Mount, PoseTarget, Robot, Winch
from hydrostat.simulation import BodyPhysics, Simulation
from hydrostat.units import plural


def design_trees(
    robot: Robot,
    request: DesignRequest,
    *,
    progress: Progress,
    watch: StageCallback = ignore_stage,
    body: BodyPhysics | None = None,
) -> Network:
    """Winch trees: the network of the thesis's method that reaches the poses best.

    Muscle fibres reach each pose; the strongest are joined to routes; a winch is put where the routes it pulls score
    best; what it uses is removed and the next winch is placed (E25). This is done for every combination of thresholds,
    distances, weights and shares of the options, and of all these networks the one is returned that reaches the poses
    best by its own winches (E24) without pulling too hard, less the cables that it does as well without. Nothing is
    drawn at random. `body` is the physics of the body, if it is made already.

    Raises:
        InputError: a body that is too thin.
        HydrostatError: no network can be built from the muscles that were found.
    """
    return _TreeDesign(robot, request, progress, watch, body or BodyPhysics(robot)).run()


def propose_trees(
    robot: Robot, request: DesignRequest, activations: Sequence[Activation], *, body: BodyPhysics | None = None
) -> Robot:
    """The best winch trees by their score alone, of muscles that are known already (X1).

    No pose is solved, so it takes a fraction of a second; what the network reaches is for others to find out. `body` is
    the physics of the body, if it is made already. Raises as `design_trees` does.
    """
    design = _TreeDesign(robot, request, no_progress, ignore_stage, body or BodyPhysics(robot))
    found = design.propose(tuple(activations))
    if found is None:
        raise HydrostatError(design.refusal)
    return found[1]


@dataclass(frozen=True, eq=False)
class _TreePlan:
    """Winch trees that were chosen from all that one set of candidates allows."""

    candidates: tuple[np.ndarray, ...]
    trees: WinchTrees
    chosen: list[WinchTree]

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


class _TreeDesign:
    """One run."""

    def __init__(
        self, robot: Robot, request: DesignRequest, progress: Progress, watch: StageCallback, body: BodyPhysics
    ) -> None:
        self.robot, self.request, self.progress, self.watch = robot, request, progress, watch
        self.options = request.tree_options
        # The thesis knows no distance between cables, and its routes turn as its options say.
        self.constraints = replace(request.constraints, cable_gap=0.0, max_turn=self.options.turn)
        self.winches, self.cables = int(request.winches), request.cables
        self.body, self.mesh = body, robot.body.mesh
        self.region = Region.of_body(robot.body, self.constraints.clearance)
        self.ways = find_lead_paths(robot, self.region, self.constraints)
        self.spacing = float(self.mesh.edge_lengths.mean())
        self.rejected: Counter[str] = Counter()  # routes and networks that cannot be built, by the limit in the way

    def run(self) -> Network:
        began = time.process_time()
        activations = self._activations()
        built = self._build_all(_shortlist(self._plans(activations)))
        if not built:
            raise HydrostatError(self.refusal)
        best, reached = judge(
            [robot for _, robot in built],
            self.request.poses,
            tension=self.constraints.tension,
            body=self.body,
            progress=self.progress,
            watch=self.watch,
        )
        plan, designed = built[best]
        designed, reached = prune(
            designed,
            self.request.poses,
            reached,
            tension=self.constraints.tension,
            body=self.body,
            loss=self.options.loss,
        )
        return Network(
            robot=designed,
            source=self.robot,
            request=self.request,
            ik_results=reached,
            expected_error=expected_error(Simulation(designed, body=self.body), reached, self._uncertainty),
            trace=TreeTrace(
                activations=activations, candidates=plan.candidates, trees=tuple(plan.trees.routes), score=plan.score
            ),
            num_evaluated=len(built),
            seconds=time.process_time() - began,
        )

    def propose(self, activations: tuple[Activation, ...]) -> tuple["_TreePlan", Robot] | None:
        """Propose the first of the best plans that can be built, with its robot, without solving its poses."""
        robots = ((plan, self._build(plan.trees, plan.chosen)) for plan in _shortlist(self._plans(activations)))
        return next(((plan, robot) for plan, robot in robots if robot is not None), None)

    @property
    def refusal(self) -> str:
        """Why no network can be built."""
        return (
            f"no network of {plural(self.winches, 'winch')} and up to {plural(self.cables, 'cable')} can be built. "
            f"Rejected: {self._reasons}. "
            "Ask for fewer winches, lower that limit, or choose a pose that bends the body more."
        )

    @property
    def _reasons(self) -> str:
        """Rejections with their counts, the most frequent first."""
        found = [f"{words} ({count})" for words, count in self.rejected.most_common() if count]
        return ", ".join(found) or "no route grew from the strongest muscles"

    @property
    def _uncertainty(self) -> BuildTolerances:
        return self.request.uncertainty or BuildTolerances.of(self.robot.body)

    def _build_all(self, plans: Iterable["_TreePlan"]) -> list[tuple["_TreePlan", Robot]]:
        """The first of the plans that can be built, with their robots."""
        robots = ((plan, self._build(plan.trees, plan.chosen)) for plan in plans)
        return list(islice(((plan, robot) for plan, robot in robots if robot), self.options.trials))

    def _plans(self, activations: tuple[Activation, ...]) -> list[list["_TreePlan"]]:
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
            trees = WinchTrees(self.mesh, routes, posed, self.ways, self.constraints, self.options)
            for phi in self.options.phis:
                plans = (_TreePlan(candidates, trees, self._plant(trees, share, phi)) for share in shares)
                whole = [plan for plan in plans if len(plan.chosen) == self.winches]
                self.rejected["networks with too few routes for their winches"] += len(shares) - len(whole)
                groups.append(whole)
        self.progress("Growing winch trees", len(variants), len(variants))
        return groups

    def _activations(self) -> tuple[Activation, ...]:
        found = []
        for index, pose in enumerate(self.request.poses):
            self.progress("Activating muscles", index, len(self.request.poses))
            found.append(self._activation(pose))
        self.progress("Activating muscles", len(self.request.poses), len(self.request.poses))
        return tuple(found)

    def _activation(self, pose: PoseTarget) -> Activation:
        return activate(
            self.robot, pose, self._fibres(pose), effort=self.options.effort, stages=self.options.stages, body=self.body
        )

    def _fibres(self, pose: PoseTarget) -> Fibres:
        if self.options.fibres is FibreKind.EDGES:
            return edge_fibres(self.mesh)
        return element_fibres(self.mesh, wanted_directions(self.robot, pose, body=self.body))

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
        inside = [route for route in laid if route is not None]
        routes = [route for route in inside if length(route) >= shortest]
        clearance = 1e3 * self.constraints.clearance
        self.rejected[f"routes within the clearance of {clearance:g} mm"] += len(laid) - len(inside)
        self.rejected[f"routes shorter than {1e3 * shortest:.3g} mm"] += len(inside) - len(routes)
        return tuple(candidates), _apart(routes, self.spacing)

    def _plant(self, trees: WinchTrees, share: tuple[int, ...], phi: float) -> list[WinchTree]:
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

    def _build(self, trees: WinchTrees, chosen: list[WinchTree]) -> Robot | None:
        """The network as a robot; None if a cable leaves the body, turns too sharply, or cannot be kept apart."""
        pulled = [
            (index, *trees.cable_points(tree.place, route))
            for index, tree in enumerate(chosen)
            for route in tree.routes
        ]
        laid = keep_apart(
            [points for _, points, _ in pulled],
            gap=self.constraints.hole_gap,
            winch_gap=2 * self.constraints.spool_radius,
        )
        if laid is None:
            self.rejected[f"networks with holes nearer than {1e3 * self.constraints.hole_gap:g} mm"] += 1
            return None
        # Where a cable comes from the world its tube hangs as it likes.
        bodily = [
            points[int(self.ways.outside(chosen[index].place)) :]
            for (index, _, _), points in zip(pulled, laid, strict=True)
        ]
        if not all(map(self.region.holds, bodily)):
            self.rejected[f"networks within the clearance of {1e3 * self.constraints.clearance:g} mm"] += 1
            return None
        if max(map(sharpest_turn, bodily)) > self.options.turn:
            self.rejected[f"networks that turn by more than {self.options.turn:g} degrees"] += 1
            return None
        winches = [self._winch(index, tree) for index, tree in enumerate(chosen)]
        cables = []
        for (index, _, lead), points in zip(pulled, laid, strict=True):
            sheathed = ((0, lead),) if lead and self.constraints.leads else ()
            cables.append(Cable(winch=winches[index].name, points=tuple(map(_point, points)), sheathed=sheathed))
        robot = self.constraints.limit_robot(self.robot.with_network(winches, cables))
        broken = violations(robot, self.constraints, self.region)
        self.rejected["networks that break a limit of winches or holes"] += bool(broken)
        return None if broken else robot

    def _winch(self, index: int, tree: WinchTree) -> Winch:
        return Winch(
            name=f"winch_{index + 1}",
            at=_point(self.ways.points[tree.place]),
            mount=Mount.WORLD if self.ways.outside(tree.place) else Mount.BODY,
            spool_radius=self.constraints.spool_radius,
            travel=self.constraints.travel,
            release=self.constraints.release,
        )


def _point(coordinates: Vector) -> tuple[float, ...]:
    """Coordinates to a hundredth of a millimeter, as nobody places a cable finer."""
    return tuple(round(float(value), 5) for value in coordinates)


def _shares(cables: int, winches: int) -> Iterator[tuple[int, ...]]:
    """Ways to share cables among winches, at least one each; the evenest first."""
    ways = combinations(range(1, cables), winches - 1) if comb(cables - 1, winches - 1) <= 5000 else ()
    shares = [tuple(np.diff([0, *cuts, cables]).tolist()) for cuts in ways]
    even = tuple(cables // winches + (index < cables % winches) for index in range(winches))
    yield from sorted({*shares, even}, key=lambda share: (max(share) - min(share), [-count for count in share]))


def _shortlist(groups: list[list["_TreePlan"]]) -> list["_TreePlan"]:
    """The best plan of every group (its phi alone compares), then every second best, and so on; each network once."""
    ranked = [sorted(group, key=lambda plan: -plan.score) for group in groups]
    plans: dict[object, _TreePlan] = {}
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
