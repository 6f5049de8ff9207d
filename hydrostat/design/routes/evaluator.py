"""`Evaluator`: what a network in the making does to every pose."""

from collections.abc import Callable, Generator, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.design.constraints import Constraints
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.layout_values import Values, layout_values, read_layout
from hydrostat.design.routes.reach_from_rest import reach_from_rest
from hydrostat.design.routes.search_record import SearchRecord, Step
from hydrostat.design.routes.search_rules import RULES
from hydrostat.design.routes.shared_work import map_in_order
from hydrostat.design.spread import Columns, spread_columns
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik import IKOptions, solve_ik, spool_arms, usable_spans, workspace_extent
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import BodyPhysics, CableSensitivities, Equilibrium, Simulation, cable_sensitivities

Found = TypeVar("Found", bound="Trial | None")
Item = TypeVar("Item")
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False)
class Trial:
    """A layout with an equilibrium for every pose."""

    layout: Layout  # winches and cables
    simulation: Simulation  # of the robot with them
    poses: tuple[Equilibrium, ...]  # at equilibrium, one for each target
    sensitivities: tuple[CableSensitivities, ...]  # of the markers of each pose and of all tensions there
    columns: tuple[Columns, ...]  # what each tolerance does to the markers of each pose: see `spread_columns` [m]
    error: float  # root of the mean squared marker error over all poses [m]
    spread: float  # root of the mean variance of the markers as built, over all poses [m]
    pull: float  # the largest tension or torque, as a share of its limit
    from_rest: bool = False  # whether its poses were found from rest, to the end
    near: float = 1.0  # factor of the cost, at least 1: the less its markers reach elsewhere, the more

    @property
    def built_error(self) -> float:
        """Error expected of a robot as it is built: root of the mean square, to second moments [m]."""
        return float(np.hypot(self.error, self.spread))

    @property
    def as_values(self) -> Values:
        """Plain values, from which an evaluator computes it again."""
        return {
            "layout": layout_values(self.layout),
            "poses": [{"contractions": pose.contractions, "nodes": pose.nodes} for pose in self.poses],
            "from_rest": self.from_rest,
            "failed": not np.isfinite(self.error),
            "built_error": self.built_error if np.isfinite(self.error) else None,
        }

    @property
    def cost(self) -> float:
        """The error as built, more where cables bear too much, and where little else is in reach [m]."""
        return self.built_error * max(self.pull, 1.0) * self.near


@dataclass(eq=False)
class Evaluator:
    """Solves layouts for some poses."""

    source: Robot  # the robot that is designed for
    targets: Sequence[PoseTarget]  # poses to reach
    constraints: Constraints  # limits on tensions and contractions
    uncertainty: BuildTolerances = field(default_factory=BuildTolerances.none)  # what differs in a robot as it is built
    body: BodyPhysics | None = None  # physics of the body, which all layouts share; each has its own if left out
    reach: float = 0.0  # what reach beyond the poses is worth: see `RouteOptions`
    solves: int = field(default=0)  # layouts tried
    cores: int = 1  # that independent layouts are shared by
    look: Callable[[], None] = lambda: None  # called before each pose is solved; what it raises ends the search
    time_left: Callable[[], float | None] = lambda: None  # seconds that a solve may take; None for no limit
    record: SearchRecord | None = None  # steps of the search, if they are kept

    def keep(self, words: str, work: Callable[[], Sequence[Found]]) -> list[Found]:
        """Networks of a step of the search: those of the record if it is known, else of some work, which is added.

        Networks are computed again from the values of the record, also where these are new. So they have the same bits
        in a search that was stopped and in one that was not.
        """
        if self.record is None or self.record.is_paused:
            return list(work())
        found = self._read_step(words)
        if found is None:
            found, step = self._carry_out(words, work)
            self.record.add(step)
        return found

    def keep_each(
        self, words: str, work: Callable[[Item], Found], items: Sequence[Item]
    ) -> Generator[Found, None, None]:
        """Yield the networks of work on independent items, shared by the cores, each a step as in `keep`."""
        if self.record is None or self.record.is_paused:
            yield from self.map(work, items)
            return
        for number, _ in enumerate(items):
            found = self._read_step(words)
            if found is None:
                left = items[number:]
                break
            if len(found) != 1:
                raise InputError(f"record of the search: {words}: {len(found)} networks instead of 1")
            yield found[0]
        else:
            return
        with closing(self.map(lambda item: self._carry_out(words, lambda: [work(item)]), left)) as results:
            for (trial,), step in results:
                self.record.add(step)
                yield trial

    def _read_step(self, words: str) -> list[Any] | None:
        """Networks of the next step of the record; None if they must be computed."""
        assert self.record is not None
        step = self.record.take(words)
        if step is None or step["networks"] is None:
            return None
        try:
            found = [None if values is None else self._read_trial(values) for values in step["networks"]]
        except (LookupError, TypeError, ValueError, NotConvergedError) as error:
            raise InputError(f"record of the search: a network cannot be read ({error!r:.80})") from None
        self.solves += step["tried"]
        self.record.add(step)
        return found

    def _carry_out(self, words: str, work: Callable[[], Sequence[Trial | None]]) -> tuple[list[Any], Step]:
        """Networks of some work, computed again from their values, and the step with these."""
        assert self.record is not None
        before = self.solves
        with self.record.pause():
            found = list(work())
        tried = self.solves - before
        values = [None if trial is None else trial.as_values for trial in found]
        try:
            found = [None if one is None else self._read_trial(one) for one in values]
        except NotConvergedError:  # about to snap
            return found, {"step": words, "tried": tried, "networks": None}
        return found, {"step": words, "tried": tried, "networks": values}

    def _read_trial(self, values: Values) -> Trial:
        """The trial of some values; its poses begin where they are."""
        layout = read_layout(values["layout"], self.source, self.constraints)
        simulation = Simulation(layout.robot(limited=True), body=self.body)
        poses = []
        for pose in values["poses"]:
            pulled = np.array(pose["contractions"], dtype=float)
            result = simulation.solver.relax(np.array(pose["nodes"], dtype=float), pulled, iterations=15)
            poses.append(simulation.make_pose(pulled, result))
        trial = replace(self.trial(layout, simulation, poses), from_rest=values["from_rest"])
        return replace(trial, error=np.inf) if values["failed"] else trial

    def map(
        self, work: Callable[[Item], Result], items: Sequence[Item], *, known: Sequence[object] = ()
    ) -> Generator[Result, None, None]:
        """Yield the results of work on independent items in their order, shared by the cores.

        `known` are large objects that results refer to, in addition to those of the body.
        """

        def count(item: Item) -> tuple[Result, int]:
            before = self.solves
            result = work(item)
            return result, self.solves - before

        results = map_in_order(count, items, cores=self.cores, known=[*self._known, *known])
        try:
            while True:
                before = self.solves
                result, solves = next(results)
                self.solves = before + solves
                yield result
        except StopIteration:
            return
        finally:
            results.close()

    @cached_property
    def _known(self) -> list[object]:
        """Large objects that trials refer to."""
        if self.body is None:
            return [self.source, self.source.body, self.source.body.mesh]
        assembly, mesh = self.body.assembly, self.source.body.mesh
        pattern = assembly.pattern
        return [self.source, self.source.body, mesh, self.constraints, self.body, assembly, *assembly.energies, pattern]

    @cached_property
    def markers(self) -> list[list[int]]:
        """Numbers of the markers of each pose: those that it names, then all others, which should rather stay."""
        names = [marker.name for marker in self.source.markers]
        named = [[names.index(name) for name in pose.targets] for pose in self.targets]
        return [[*own, *(index for index in range(len(names)) if index not in own)] for own in named]

    @cached_property
    def goals(self) -> list[np.ndarray]:
        """Target positions of these markers, (markers, dim) [m]."""
        rests = [marker.at for marker in self.source.markers]
        return [
            np.array([*pose.targets.values(), *(rests[index] for index in markers[len(pose.targets) :])], dtype=float)
            for pose, markers in zip(self.targets, self.markers, strict=True)
        ]

    @cached_property
    def weights(self) -> list[Vector]:
        """Weights of the residuals of each pose, one for each row.

        Where poses name all markers the sum of squares is the squared rms error. A marker that a pose does not name
        counts a hundredth of one that it names, so that it wanders only for a good reason.
        """
        dim, weights = self.source.body.mesh.dim, []
        for pose, markers in zip(self.targets, self.markers, strict=True):
            shares = np.where(np.arange(len(markers)) < len(pose.targets), 1.0, RULES.free_marker_weight)
            weights.append(np.repeat(shares, dim) / np.sqrt(len(self.targets) * len(pose.targets)))
        return weights

    def residual(self, simulation: Simulation, pose: int, nodes: Nodes) -> Vector:
        """Target less marker of one pose, weighted [m]."""
        places = simulation.marker_anchors.positions(nodes)[self.markers[pose]]
        return self.weights[pose] * (self.goals[pose] - places).ravel()

    def reach_poses(
        self,
        layout: Layout,
        before: Trial | None,
        *,
        iterations: int = 30,
        worst: float = np.inf,
        hoped: Trial | None = None,
        kept: Sequence[int] | None = None,
        rough: bool = False,
    ) -> Trial | None:
        """Bring a layout nearest to every pose, from a trial whose winches are its first.

        If some winches are gone, `kept` are the numbers that the others have in that trial.
        Where a pose misses more than in a trial `hoped` for, it is sought from other beginnings too.
        If it is `rough`, poses from rest are not checked by playing their contractions.
        None: no equilibrium, or an error above `worst` [m]; poses that are left when it is sure of that are not solved.
        """
        self.solves += 1
        simulation = Simulation(layout.robot(limited=True), body=self.body)
        options = IKOptions(restarts=0, min_tension=False, iterations=iterations, tolerance=1e-5, progress=1e-5)
        limits = self.constraints.limits
        found = []
        for index, target in enumerate(self.targets):
            self.look()
            start = None if before is None else self._relax_start(simulation, before, index, kept)
            try:
                if start is None and layout.two_way:
                    begin = None if hoped is None else simulation.solve(hoped.poses[index].contractions)
                    pose = self._reach_either_way(layout, simulation, index, options, begin)
                elif start is None and not rough:
                    pose = reach_from_rest(simulation, target, limits, options, seconds=self.time_left).pose
                else:
                    left = self.time_left()
                    pose = solve_ik(simulation, target, start=start, limits=limits, options=options, seconds=left).pose
                if hoped is not None and self._pose_error(simulation, index, pose) > self._short_of(hoped, index):
                    more = replace(options, restarts=RULES.pose_restarts)
                    with suppress(NotConvergedError):  # then the first one stands
                        pose = reach_from_rest(
                            simulation, target, limits, more, start=start, seconds=self.time_left
                        ).pose
                found.append(pose)
            except NotConvergedError:
                return None
            if self._error(simulation, found) > worst:
                return None
        return self._within(layout, simulation, found, worst)

    def _reach_either_way(
        self, layout: Layout, simulation: Simulation, index: int, options: IKOptions, begin: Equilibrium | None
    ) -> Equilibrium:
        """Pose nearest to a target, of winches that turn both ways; without a beginning each is tried either way."""
        target, limits = self.targets[index], self.constraints.limits
        best = reach_from_rest(simulation, target, limits, options, start=begin).pose
        for winch in layout.two_way if begin is None else ():
            ranges = layout.sites[winch].winch
            turned = best.contractions.copy()
            turned[winch] = (
                -RULES.opposite_turn * ranges.release if turned[winch] > 0 else RULES.opposite_turn * ranges.travel
            )
            with suppress(NotConvergedError):
                start = simulation.solve(turned)
                found = reach_from_rest(simulation, target, limits, options, start=start).pose
                best = min(best, found, key=lambda pose: self._pose_error(simulation, index, pose))
        return best

    def hold_contractions(
        self, layout: Layout, contractions: Sequence[Vector], before: Trial, *, worst: float = np.inf
    ) -> Trial | None:
        """Solve a layout at given contractions of each pose [m].

        None where Newton does not find an equilibrium directly, or the error is above `worst` [m].
        """
        self.look()
        self.solves += 1
        simulation = Simulation(layout.robot(limited=True), body=self.body)
        found = []
        for pulled, pose in zip(contractions, before.poses, strict=True):
            result = simulation.solver.relax(pose.nodes, pulled, iterations=15)
            if not (result.converged and result.stable):
                return None
            found.append(simulation.make_pose(pulled, result))
            if self._error(simulation, found) > worst:
                return None
        return self._within(layout, simulation, found, worst)

    def _within(
        self, layout: Layout, simulation: Simulation, poses: Sequence[Equilibrium], worst: float
    ) -> Trial | None:
        self.look()
        try:
            trial = self.trial(layout, simulation, poses)
        except NotConvergedError:  # about to snap
            return None
        return trial if trial.built_error <= worst else None

    def solve_variation(
        self, layout: Layout, near: Equilibrium, contractions: Vector, index: int
    ) -> tuple[Simulation, Nodes, CableSensitivities] | None:
        """Solve another layout near a pose: nodes [m] and sensitivities of markers; None without equilibrium."""
        self.look()
        try:
            simulation = Simulation(layout.robot(limited=True), body=self.body)
            result = simulation.solver.relax(near.nodes, contractions, iterations=15)
            if not (result.converged and result.stable):
                return None
            pose = simulation.make_pose(contractions, result)
            sensitivities = cable_sensitivities(simulation, pose, self.markers[index], tensions=False)
            return simulation, pose.nodes, sensitivities
        except (InputError, NotConvergedError):  # a hole outside the body, or about to snap
            return None

    def _pose_error(self, simulation: Simulation, index: int, pose: Equilibrium) -> float:
        return float(np.linalg.norm(self.residual(simulation, index, pose.nodes)))

    def _short_of(self, hoped: Trial, index: int) -> float:
        """Error that a pose may have to be as good as in another trial, but for a share of the error of all [m]."""
        return self._pose_error(hoped.simulation, index, hoped.poses[index]) + RULES.pose_shortfall * hoped.error

    def _relax_start(
        self, simulation: Simulation, before: Trial, index: int, kept: Sequence[int] | None
    ) -> Equilibrium | None:
        """Relax the new robot from a pose of the old; None where that finds no equilibrium."""
        pose = before.poses[index]
        pulled = np.zeros(len(simulation.robot.winches))
        known = pose.contractions if kept is None else pose.contractions[list(kept)]
        shared = min(len(pulled), len(known))
        pulled[:shared] = known[:shared]
        result = simulation.solver.relax(pose.nodes, pulled, iterations=15)
        return simulation.make_pose(pulled, result) if result.converged and result.stable else None

    def trial(self, layout: Layout, simulation: Simulation, poses: Sequence[Equilibrium]) -> Trial:
        """The trial of poses that were solved."""
        pull = max(self.pull(simulation.robot, pose.tensions) for pose in poses)
        sensitivities = tuple(
            cable_sensitivities(simulation, pose, markers) for pose, markers in zip(poses, self.markers, strict=True)
        )
        columns = tuple(
            spread_columns(simulation, pose, sensitivity, self.uncertainty, len(markers) * layout.dim)
            for pose, sensitivity, markers in zip(poses, sensitivities, self.markers, strict=True)
        )
        variances = [((w[:, None] * one) ** 2).sum() for w, one in zip(self.weights, columns, strict=True)]
        spread = np.sqrt(sum(variances, 0.0))
        error = self._error(simulation, poses)
        near = self.nearness(simulation.robot, sensitivities)
        return Trial(layout, simulation, tuple(poses), sensitivities, columns, error, float(spread), pull, near=near)

    def pull(self, robot: Robot, tensions: Vector) -> float:
        """The largest tension or torque, as a share of its limit."""
        share = float(tensions.max(initial=0.0)) / self.constraints.tension
        if self.constraints.torque is None:
            return share
        return max(share, float(np.abs(spool_arms(robot) @ tensions).max(initial=0.0)) / self.constraints.torque)

    def nearness(self, robot: Robot, sensitivities: Sequence[CableSensitivities]) -> float:
        """Factor of the cost of a network by its reach at some poses: (size / reach)^weight, at least 1."""
        if not self.reach:
            return 1.0
        mesh, limit = robot.body.mesh, self.constraints.tension_limit
        ranges = np.array([winch.travel + winch.release for winch in robot.winches])
        lengths = []
        for one in sensitivities:
            moves, pulls = np.split(one.contractions, [len(one.contractions) - len(robot.cables)])
            spans = usable_spans(pulls, ranges, limit)
            lengths.append(workspace_extent(moves, spans, dim=mesh.dim, floor=RULES.min_reach * mesh.size))
        return max(mesh.size / float(np.exp(np.mean(np.log(lengths)))), 1.0) ** self.reach

    def _error(self, simulation: Simulation, poses: Sequence[Equilibrium]) -> float:
        """Root of the mean squared marker error [m], of the first poses as if the others were reached."""
        squares = [float((self.residual(simulation, index, pose.nodes) ** 2).sum()) for index, pose in enumerate(poses)]
        return float(np.sqrt(sum(squares)))
