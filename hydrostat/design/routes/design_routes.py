"""`design_routes`: routes priced by the pose error, added one by one, and moved to where it is least (F1, F2)."""

import math
import os
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cached_property

from hydrostat.design.buildable import violations
from hydrostat.design.constraints import Constraints
from hydrostat.design.network import (
    Alternative,
    Certificate,
    DesignStage,
    Network,
    RouteTrace,
    StageCallback,
    ignore_stage,
)
from hydrostat.design.region import Region
from hydrostat.design.request import DesignRequest
from hydrostat.design.routes.begin import layout_of
from hydrostat.design.routes.certificate import certify
from hydrostat.design.routes.deadline import Deadline, TimeUpError
from hydrostat.design.routes.evaluator import Evaluator, Trial
from hydrostat.design.routes.exchange import Exchanges
from hydrostat.design.routes.final_judgement import FinalJudgement
from hydrostat.design.routes.finalists import DIGITS, Finalists
from hydrostat.design.routes.growth import Growth
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.refine import pushed_back
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.design.routes.screen import screen_sketches
from hydrostat.design.routes.search_record import SearchRecord
from hydrostat.design.routes.search_rules import RULES
from hydrostat.design.routes.sketch import sketches
from hydrostat.design.routes.thin import remove_via_points
from hydrostat.design.skin_region import cable_region
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.design.winch_room import built_in, limit_torque
from hydrostat.errors import HydrostatError, InputError
from hydrostat.kernel import THREADS
from hydrostat.progress import Progress
from hydrostat.robot import Robot
from hydrostat.simulation import BodyPhysics, Simulation

FirstRobots = Callable[[BodyPhysics], Iterable[Robot]]
"""Finds networks to begin with, when it is their turn, by the physics of the body."""


def design_routes(
    robot: Robot,
    request: DesignRequest,
    *,
    progress: Progress,
    watch: StageCallback = ignore_stage,
    hints: FirstRobots = lambda _: (),
    body: BodyPhysics | None = None,
    record: SearchRecord | None = None,
) -> Network:
    """Cables added where the adjoint of the pose error prices them best, and moved to where it is least.

    At the equilibria of all poses the adjoint field prices every run between two via points; a dynamic program finds
    the paths along which one more cable lowers the error most. Networks begin from sketches along the limbs
    (`sketches`); the one that promises most gets a cable, all via points are moved downhill, and so on (column
    generation). The best are refined, and the best one's cables exchanged one by one where another path does better.

    `hints` finds robots with networks of the same body, which are refined with those that are grown; `body` has the
    energies of that body if they are made already; `record` keeps the steps. Interrupted
    (KeyboardInterrupt), it returns the best network so far.

    Raises:
        InputError: a body too thin for the constraints.
        HydrostatError: no network can be built.
    """
    deadline = Deadline.after(request.seconds)
    return RouteSearch(robot, request, body or BodyPhysics(robot), progress, watch, hints, deadline, record).run()


class RouteSearch:
    """One search for a network of a given number of winches.

    Attributes:
        evaluator: solves the poses of layouts.
        stages: networks on the way, as they are shown.
        passed: cost and layout of each of them.
        sizes: the best network of each size, by its numbers of winches and cables.
    """

    def __init__(
        self,
        robot: Robot,
        request: DesignRequest,
        body: BodyPhysics,
        progress: Progress,
        watch: StageCallback = ignore_stage,
        hints: FirstRobots = lambda _: (),
        deadline: Deadline | None = None,
        record: SearchRecord | None = None,
    ) -> None:
        self.deadline = deadline or Deadline.after(request.seconds)
        self.robot, self.request, self.progress, self.watch = robot, request, progress, watch
        self.hints, self.physics = hints, body
        self.winches, self.cables = int(request.winches), request.cables
        self.constraints, self.options = limit_torque(request.constraints), request.route_options
        if self.constraints.built_in and not request.warm_start and not self.constraints.stand_outside(robot):
            self.constraints = built_in(robot, self.constraints, winches=self.winches, cables=self.cables)
        self.evaluator = Evaluator(
            robot,
            request.poses,
            self.constraints,
            request.uncertainty or BuildTolerances.none(),
            body,
            self.options.workspace_weight,
        )
        self.evaluator.look, self.evaluator.time_left = self._look, self._time_left
        if robot.contact is None and not robot.obstacles:  # parts that touch are remembered, and not sent
            self.evaluator.cores = min(THREADS, RULES.processes)
            self.evaluator.record = record  # nor kept
        self.stages: list[DesignStage] = []
        self.passed: list[tuple[float, Layout]] = []
        self.found: list[Trial] = []
        self.thinner: Trial | None = None
        self.best: Trial | None = None
        self.sizes: dict[tuple[int, int], Trial] = {}
        self.grown = 0

    def run(self) -> Network:
        """Search, evaluate the finalists, and return the network with its trace."""
        began = _measure_cpu_time()
        complete = True
        try:
            self._search()
        except (KeyboardInterrupt, TimeUpError):
            complete = False
            if self.best is None:
                raise
        self.evaluator.record = None  # networks are judged again
        timed_out = not complete and self.deadline.is_over
        self.deadline = self.deadline.with_grace()
        judgement = self._judgement(complete)
        certificate = None
        try:
            judgement.judge_networks()
            certificate = self._certificate(judgement.networks[0]) if complete else None
        except (KeyboardInterrupt, TimeUpError) as stop:
            complete, timed_out = False, timed_out or isinstance(stop, TimeUpError)
            if not judgement.networks:
                self.deadline = Deadline()
                judgement = self._judgement(complete)
                judgement.judge_networks()
        network, *alternatives = judgement.networks
        self.constraints = judgement.finalists.constraints
        return Network(
            robot=network.robot,
            source=self.robot,
            request=replace(self.request, constraints=self._fitting_constraints),
            ik_results=network.ik_results,
            expected_error=network.expected_error,
            alternatives=tuple(alternatives),
            trace=RouteTrace(stages=tuple(self.stages), certificate=certificate),
            num_evaluated=self.evaluator.solves,
            seconds=_measure_cpu_time() - began,
            complete=complete,
            timed_out=timed_out,
        )

    def _look(self) -> None:
        """End the search when its time is up and there is a network."""
        if self.best is not None and self.deadline.is_over:
            raise TimeUpError

    def _time_left(self) -> float | None:
        """Return the seconds that are left once there is a network; None for no limit."""
        left = self.deadline.left
        return None if self.best is None or left == math.inf else max(left, RULES.min_seconds)

    def _judgement(self, complete: bool) -> FinalJudgement:
        found = self.found if complete else [trial for trial in (self.best,) if trial is not None]
        finalists = self.finalists if complete else replace(self.finalists, restarts=0)
        return FinalJudgement(self.growth, finalists, found, self.passed, self.sizes, self.thinner, complete=complete)

    def _search(self) -> None:
        if self.constraints.mirror is not None and self.cables < 2:
            raise InputError("1 cable: a mirrored network has its cables in pairs; ask for at least 2 cables")
        spacing = float(self.robot.body.mesh.edge_lengths.mean())
        graph = RouteGraph.build(self.robot, self.region, self.constraints, spacing=spacing)
        self.proposals = Proposals(self.evaluator, graph, self.options, self.options.spacing * spacing)
        self.growth = growth = Growth(self.proposals, self._note_network)
        self.progress("Growing networks", 0, self._total)
        begun = growth.evaluate(self._beginning())
        if begun is None:
            raise HydrostatError("the network to begin with has no equilibrium in reach of its poses; start without it")
        if begun.layout.routes:
            self._note_network("as it was", begun)
        grown = self._sketch_networks(growth, begun)
        if not grown:
            grown = growth.grow_networks([begun], winches=self.winches, cables=self.cables)
            if not any(growth.enough(trial, self.winches) for trial in grown):
                grown += [*self._by_force(growth, begun), *self._refine_hints(growth)]
        self.found = self._refine_best(growth, grown)
        if not self.found:
            raise HydrostatError(
                "no network could be built: no cable keeps clear of the edge, of forbidden zones and of other cables; "
                "lower the clearance, or allow sharper turns"
            )
        best = self.found[0]
        if self.options.exchanges and not growth.enough(best, self.winches):
            self.progress("Exchanging cables", 0, 1)
            exchanges = Exchanges(growth, self.winches)
            better = exchanges.prune_cables(exchanges.exchange_cables(best, self.options.exchanges))
            if better is not best:
                self.found.insert(0, growth.refine(better))
                self._note_network("cables exchanged, via points moved", self.found[0])
                self.found.sort(key=lambda trial: trial.cost)
        self.progress("Exchanging cables", 1, 1)
        self.thinner = self._thin_network(growth, self.found[0])
        if self.thinner is not None:
            self.found.insert(0, self.thinner)  # before the network with all holes, which is judged too
            self._note_network("holes left out", self.thinner)

    def _sketch_networks(self, growth: Growth, bare: Trial) -> list[Trial]:
        """Draw networks along the limbs, and grow the best of them by further cables that help."""
        count = RULES.sketches_each * (self.options.starts + 1)
        drawn = sketches(self.proposals, bare, winches=self.winches, cables=self.cables, count=count)
        worse = (1 - RULES.sketch_gain) * bare.cost

        def note(trial: Trial) -> None:
            self.progress("Drawing networks", min(len(self.stages), count), count)
            if trial.cost < worse:
                self._note_network("drawn along the limbs", trial, is_begun=True)

        screened: list[Trial] = []  # reversed cables gain by refinement only: they are screened by themselves
        for back in (False, True):
            own = [each for each in drawn if each.routes and any(route.ratio < 0 for route in each.routes) == back]
            screened += screen_sketches(growth, own, found=note, count=self.options.starts + RULES.spare_sketches)
        screened.sort(key=lambda trial: trial.cost)
        self.progress("Drawing networks", count, count)
        helpful = [trial for trial in screened if trial.cost < worse]
        return growth.grow_networks(helpful, winches=self.winches, cables=self.cables)

    def _refine_best(self, growth: Growth, grown: list[Trial]) -> list[Trial]:
        """Refine the best networks to the end, and the next only if it is nearly as good from rest."""
        grown.sort(key=lambda trial: trial.cost)
        whole = [trial for trial in grown if len(trial.layout.sites) >= self.winches] or grown
        rested = list(self.evaluator.keep_each("from rest", growth.resolve_from_rest, whole[: RULES.refined + 1]))
        rested.sort(key=lambda trial: trial.cost)
        refined: list[Trial] = []
        for rank, trial in enumerate(rested[: RULES.refined]):
            if refined and trial.cost > RULES.second_refined * refined[0].cost:
                break
            self.progress("Refining", rank, RULES.refined)
            refined.append(growth.refine(trial))
            self._note_network("via points moved", refined[-1])
        return sorted([*refined, *rested[len(refined) :]], key=lambda trial: trial.cost)

    def _by_force(self, growth: Growth, begun: Trial) -> list[Trial]:
        """Networks grown along stronger paths, where none can be drawn."""
        strong = Growth(replace(growth.proposals, effort=RULES.strong_effort), self._note_network)
        return strong.grow_networks([begun], winches=self.winches, cables=self.cables)

    def _refine_hints(self, growth: Growth) -> list[Trial]:
        """Move networks that others found to where they can be built, and refine them."""
        trials = []
        for hint in (
            self.hints(self.physics)
            if not self.request.warm_start and not any(self.constraints.staying(self.robot))
            else ()
        ):
            pushed = pushed_back(layout_of(hint, self.constraints), self.region, 0.03 * self.robot.body.mesh.size)
            fits = len(hint.winches) <= self.winches and len(hint.cables) <= self.cables
            if not fits or pushed is None or violations(pushed.robot(digits=DIGITS), self.constraints, self.region):
                continue
            trial = self.evaluator.reach_poses(pushed, None)
            if trial is not None:
                trials.append(growth.refine(trial))
                self._note_network("winch trees, their via points moved", trials[-1], is_begun=True)
        return trials

    @staticmethod
    def _thin_network(growth: Growth, trial: Trial) -> Trial | None:
        """Leave out holes that a network does not need, and refine it once more; None if it keeps its holes."""
        thinner = remove_via_points(growth, trial)
        if thinner is trial:
            return None
        thinner = growth.refine(thinner)
        return thinner if thinner.cost < (1 + RULES.thinner_cost) * trial.cost else None

    @cached_property
    def finalists(self) -> Finalists:
        """Judges networks as their user will find them."""
        return Finalists(self.robot, self.request, self.constraints, self.evaluator, self.region)

    @cached_property
    def region(self) -> Region:
        """Region that cables may use."""
        return cable_region(self.robot.body, self.constraints)

    @property
    def _total(self) -> int:
        return (2 * self.options.starts + 1) * self.cables

    def _beginning(self) -> Layout:
        """Return the layout at the start of the search: empty, the locked parts, or the whole network."""
        whole = layout_of(self.robot, self.constraints)
        if self.request.warm_start and not whole.routes:
            raise InputError("the robot has no cables to improve; design without improving it")
        if self.request.warm_start:
            self._check_counts("to be improved", len(whole.sites), len(whole.routes))
            pushed = pushed_back(whole, self.region, 0.03 * self.robot.body.mesh.size)
            told = None if pushed is None else violations(pushed.robot(digits=DIGITS), self.constraints, self.region)
            if pushed is None or told:
                raise InputError(
                    "the robot's own network cannot be moved into what the constraints allow"
                    f"{f' ({told[0][:-1]})' if told else ''}; relax them, or design without improving it"
                )
            return pushed
        winches, cables = self.constraints.staying(self.robot)
        kept = [route for route in whole.routes if route.kept in cables]
        stays = [number for number, site in enumerate(whole.sites) if site.winch in winches]
        self._check_counts("locked", len(stays), len(kept))
        return replace(
            whole,
            sites=tuple(whole.sites[number] for number in stays),
            routes=tuple(replace(route, winch=stays.index(route.winch)) for route in kept),
        )

    def _check_counts(self, which: str, winches: int, cables: int) -> None:
        for name, present, asked in (("winches", winches, self.winches), ("cables", cables, self.cables)):
            if present > asked:
                raise InputError(
                    f"{present} {name} of the robot are {which}, more than the {asked} asked for; ask for at least "
                    f"{present}"
                )

    def _note_network(self, words: str, trial: Trial, *, is_begun: bool = False) -> None:
        """Note a network on the way: the best so far is returned if the search is interrupted."""
        if words.startswith(("cable", "the first")):
            self.grown += 1
            self.progress("Growing networks", min(self.grown, self._total), self._total)
        size = len(trial.layout.sites), len(trial.layout.routes)
        if size not in self.sizes or trial.cost < self.sizes[size].cost:
            self.sizes[size] = trial
        stage = DesignStage(
            words=words,
            robot=trial.layout.robot(digits=DIGITS),
            error=trial.built_error,
            num_evaluated=self.evaluator.solves,
            is_begun=is_begun,
        )
        self.stages.append(stage)
        self.passed.append((trial.cost, trial.layout))
        if self.best is None or trial.cost < self.best.cost:
            self.best = trial
            self.watch(stage)

    @property
    def _fitting_constraints(self) -> Constraints:
        """Return the request with the torque of the motors that fit."""
        own = self.constraints
        return replace(self.request.constraints, torque=own.torque)

    def _certificate(self, network: Alternative) -> Certificate | None:
        layout = layout_of(network.robot, self.constraints)
        poses = [reached.pose for reached in network.ik_results]
        return certify(
            self.proposals, self.evaluator.trial(layout, Simulation(network.robot, body=self.evaluator.body), poses)
        )


def _measure_cpu_time() -> float:
    """CPU time of this process and of those that shared its work [s]."""
    return sum(os.times()[:4])
