"""`design_cables`: from poses to winches and cables, as the thesis has it, judged by the pose error (R35 to R46)."""

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from hydrostat.arrays import Points
from hydrostat.design.activation import activate
from hydrostat.design.fibres import Fibres, edge_fibres, element_fibres
from hydrostat.design.network import Activation, Network
from hydrostat.design.options import DesignOptions, FibreKind
from hydrostat.design.orientation import wanted_directions
from hydrostat.design.region import body_region
from hydrostat.design.routes import GrowthLimits, grow_routes, lay_route, strongest
from hydrostat.design.winch_tree import Tree, WinchTrees
from hydrostat.errors import HydrostatError, InputError
from hydrostat.ik import solve_ik
from hydrostat.robot import Cable, Pose, Robot, Winch
from hydrostat.simulation import Simulation

Progress = Callable[[str, int, int], None]
"""Told the stage, how much of it is done, and how much there is."""


def design_cables(
    robot: Robot,
    poses: Iterable[Pose],
    *,
    winches: int,
    cables: int,
    options: DesignOptions | None = None,
    progress: Progress | None = None,
) -> Network:
    """A network of `winches` winches and at most `cables` cables for some poses.

    The thesis's way: muscle fibres reach each pose; the strongest are joined to routes; a winch is put where the
    routes it pulls score best; what it uses is removed and the next winch is placed (E25). This is done for every
    combination of thresholds, distances, weights and shares of the options, and of all these networks the one is
    returned that reaches the poses best by its own winches (E24). Nothing is drawn at random.

    Args:
        robot: body, pins and markers; its own winches and cables are left aside.
        poses: what the network should reach.
        winches: how many.
        cables: how many in all, at least one a winch.
        options: see `DesignOptions`.
        progress: called as the work goes on.

    Raises:
        InputError: no pose, or counts that do not fit.
        HydrostatError: no network can be built from the muscles that were found.
    """
    poses = list(poses)
    if not poses:
        raise InputError("there is no pose to design for; add a [[pose]] to the robot")
    if not 1 <= winches <= cables:
        raise InputError(
            f"{winches} winches and {cables} cables: there must be at least one winch, and a cable for each"
        )
    return _Design(robot, poses, winches, cables, options or DesignOptions(), progress or _silent).run()


def _silent(stage: str, done: int, total: int) -> None:
    """No progress wanted."""


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
        best: Network | None = None
        seen: set[object] = set()
        variants = list(product(self.options.thresholds, self.options.distances))
        shares = list(_shares(self.cables, self.winches))
        total = len(variants) * len(shares) * len(self.options.phis)
        done = 0
        for threshold, distance in variants:
            candidates, routes = self._routes(activations, threshold, distance)
            trees = self._trees(routes, activations)
            if trees is None:
                continue
            for share, phi in product(shares, self.options.phis):
                done += 1
                self.progress("Judging networks", done, total)
                chosen = self._plant(trees, share, phi)
                key = tuple(
                    (tree.place, tuple(map(bytes, (routes[index] for index in tree.routes)))) for tree in chosen
                )
                if not chosen or key in seen:
                    continue
                seen.add(key)
                network = self._judge(trees, chosen, activations, candidates)
                if network and (best is None or network.rms_error < best.rms_error):
                    best = network
        if best is None:
            raise HydrostatError(
                "no network could be built: no route of strong muscles keeps clear of the edge of the body; "
                "lower the clearance, or choose a pose that bends the body more"
            )
        return replace(best, tried=len(seen), seconds=time.process_time() - began)

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
    ) -> tuple[tuple[np.ndarray, ...], list[Points]]:
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
        return tuple(candidates), _apart([route for route in laid if route is not None], self.spacing)

    def _trees(self, routes: list[Points], activations: tuple[Activation, ...]) -> WinchTrees | None:
        """The routes, ready to be given winches; None if there are none."""
        if not routes:
            return None
        return WinchTrees(
            self.mesh, routes, [activation.nodes for activation in activations], self.region, self.options
        )

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

    def _judge(
        self,
        trees: WinchTrees,
        chosen: list[Tree],
        activations: tuple[Activation, ...],
        candidates: tuple[np.ndarray, ...],
    ) -> Network | None:
        """The network as a robot, and what its own winches reach of every pose; None if a cable leaves the body."""
        robot = self._build(trees, chosen)
        if not all(self.region.holds(np.array(cable.points)) for cable in robot.cables):
            return None
        simulation = Simulation(robot)
        return Network(
            robot=robot,
            activations=activations,
            candidates=candidates,
            trees=tuple(trees.routes),
            reached=tuple(solve_ik(simulation, pose) for pose in self.poses),
            score=float(np.mean([tree.score for tree in chosen])),
            tried=0,
            seconds=0.0,
        )

    def _build(self, trees: WinchTrees, chosen: list[Tree]) -> Robot:
        winches, cables = [], []
        for index, tree in enumerate(chosen):
            name = f"winch_{index + 1}"
            winches.append(
                Winch(
                    name=name,
                    at=_point(self.mesh.nodes[tree.place]),
                    spool_radius=self.options.spool_radius,
                    travel=self.options.travel,
                    release=self.options.release,
                )
            )
            for route in tree.routes:
                points, lead = trees.cable_points(tree.place, route)
                sheathed = ((0, lead),) if lead and self.options.sheathed_leads else ()
                cables.append(Cable(winch=name, points=tuple(map(_point, points)), sheathed=sheathed))
        return self.robot.with_network(winches, cables)


def _point(coordinates: Points) -> tuple[float, ...]:
    """Coordinates to a hundredth of a millimetre, as nobody places a cable finer."""
    return tuple(round(float(value), 5) for value in coordinates)


def _shares(cables: int, winches: int) -> Iterator[tuple[int, ...]]:
    """All ways to share cables among winches, at least one each."""
    if winches == 1:
        yield (cables,)
        return
    for first in range(1, cables - winches + 2):
        for rest in _shares(cables - first, winches - 1):
            yield (first, *rest)


def _apart(routes: list[Points], spacing: float) -> list[Points]:
    """Routes without those that run along an earlier one."""
    kept: list[Points] = []
    for route in routes:
        near = [np.linalg.norm(route[:, None] - other[None], axis=2).min(axis=1) < 0.6 * spacing for other in kept]
        if not any(close.mean() > 0.6 for close in near):
            kept.append(route)
    return kept
