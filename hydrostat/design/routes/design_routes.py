"""`design_routes`: routes priced by the pose error, added one by one, and moved to where it is least (F1, F2)."""

import time
from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property

import numpy as np
from scipy.optimize import nnls

from hydrostat.arrays import Vector
from hydrostat.design.buildable import pulls, violations
from hydrostat.design.network import Alternative, Certificate, DesignStage, Network, RouteTrace, Size, size_of
from hydrostat.design.progress import Better, Progress, Watch, unseen
from hydrostat.design.region import Region, body_region
from hydrostat.design.request import COUNTS, DesignRequest
from hydrostat.design.routes.begin import layout_of
from hydrostat.design.routes.bench import Bench, Trial
from hydrostat.design.routes.growth import Growth
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.refine import linear_model, pushed_back
from hydrostat.design.routes.route_graph import route_graph
from hydrostat.errors import HydrostatError, InputError, NotConvergedError
from hydrostat.ik import InverseOptions, Limits, solve_ik
from hydrostat.robot import Robot
from hydrostat.simulation import BodyPhysics, Simulation


def certify(proposals: Proposals, trial: Trial) -> Certificate:
    """What one more cable promises, and how steeply the error falls along a move of the network that is allowed.

    Both are exact to first order at the equilibria of the poses; the search for the best path keeps a few paths for
    each edge, so what it finds is a lower bound of what the best of all paths would gain.
    """
    unbiased = replace(proposals, options=replace(proposals.options, lead_penalty=0.0))
    paths = unbiased.priced(trial, count=1)
    gain = paths[0].gain if paths else 0.0
    model = linear_model(proposals.bench, proposals.graph.region, trial, effort=0.0, reach=_HOLDS)
    return Certificate(
        further=float(np.sqrt(max(trial.error**2 - 2 * gain, 0.0))),
        paths=len(proposals.graph.edges) * 2 * proposals.options.hops,
        slope=_slope(model.matrix, model.right, model.rows[model.left <= _HOLDS], trial.error),
    )


def _slope(matrix: np.ndarray, right: Vector, limits: np.ndarray, error: float) -> float:
    """The steepest fall of the error along a number that limits which hold allow [m/m] (Karush, Kuhn and Tucker)."""
    if error == 0.0:
        return 0.0
    gradient = matrix.T @ right / error
    norms = np.linalg.norm(limits, axis=1)
    limits = limits[norms > 0] / norms[norms > 0, None]
    if len(limits):
        gradient = gradient + limits.T @ nnls(limits.T, -gradient)[0]
    return float(np.abs(gradient).max(initial=0.0))


_HOLDS = 1e-4  # a limit with a smaller margin than this [m] holds


def design_routes(robot: Robot, request: DesignRequest, *, progress: Progress, watch: Watch = unseen) -> Network:
    """Cables added where the adjoint of the pose error prices them best, and moved to where it is least.

    At the equilibria of all poses the adjoint field prices every run between two via points; a dynamic program finds
    the paths along which one more cable lowers the error most. The best few are solved, the best of these is kept, and
    all via points are moved downhill; so it goes on (column generation). Several networks are grown from different
    first cables; the best is refined, and its cables are exchanged one by one where another path does better.

    Interrupted (KeyboardInterrupt), it returns the best network so far.

    Raises:
        InputError: a body too thin for the constraints.
        HydrostatError: no network can be built.
    """
    return RouteSearch(robot, request, BodyPhysics(robot), progress, watch).run()


class RouteSearch:
    """One search for a network of a given number of winches.

    Attributes:
        bench: solves the poses of layouts.
        stages: networks on the way.
        sizes: the best network of each size, by its numbers of winches and cables.
    """

    def __init__(
        self, robot: Robot, request: DesignRequest, body: BodyPhysics, progress: Progress, watch: Watch = unseen
    ) -> None:
        self.robot, self.request, self.progress, self.watch = robot, request, progress, watch
        self.winches, self.cables = int(request.winches), request.cables
        self.constraints, self.options = request.constraints, request.route_options
        self.bench = Bench(robot, request.poses, request.constraints, body)
        self.stages: list[DesignStage] = []
        self.found: list[Trial] = []
        self.best: Trial | None = None
        self.sizes: dict[tuple[int, int], Trial] = {}
        self.grown = 0

    def run(self) -> Network:
        """Search, judge, and tell how it came about."""
        began = time.process_time()
        complete = True
        try:
            self._search()
        except KeyboardInterrupt:
            complete = False
            if self.best is None:
                raise
        try:
            network, alternatives = self._finished(complete)
            certificate = self._certificate(network) if complete else None
        except KeyboardInterrupt:
            complete, certificate, self.found = False, None, self.found[:1]
            network, alternatives = self._finished(complete)
        return Network(
            robot=network.robot,
            source=self.robot,
            request=self.request,
            reached=network.reached,
            alternatives=tuple(alternatives),
            trace=RouteTrace(stages=tuple(self.stages), certificate=certificate),
            tried=self.bench.solves,
            seconds=time.process_time() - began,
            complete=complete,
        )

    def _search(self) -> None:
        if self.constraints.mirror is not None and self.cables < 2:
            raise InputError("1 cable: a mirrored network has its cables in pairs; ask for at least 2 cables")
        spacing = float(self.robot.body.mesh.edge_lengths.mean())
        graph = route_graph(self.robot, self.region, self.constraints, spacing=spacing)
        self.proposals = Proposals(self.bench, graph, self.options, self.options.spacing * spacing)
        growth = Growth(self.proposals, self._noted)
        self.progress("Growing networks", 0, self._total)
        begun = growth.bare(self._beginning())
        if begun is None:
            raise HydrostatError("the network to begin with has no equilibrium in reach of its poses; start without it")
        if begun.layout.routes:
            self._noted("as it was", begun)
        for seed in growth.seeds(begun, winches=self.winches, cables=self.cables):
            self._noted("the first cable", seed)
            trial = growth.truly(growth.grown(seed, winches=self.winches, cables=self.cables))
            self.found.append(trial)
            if growth.enough(trial, self.winches):
                break
        if not self.found:
            raise HydrostatError(
                "no network could be built: no cable keeps clear of the edge, of forbidden zones and of other cables; "
                "lower the clearance, or allow sharper turns"
            )
        self.found.sort(key=lambda trial: trial.cost)
        for rank, trial in enumerate(self.found[:_REFINED]):
            self.progress("Refining", rank, _REFINED)
            self.found[rank] = growth.polished(trial)
            self._noted("via points moved", self.found[rank])
        self.found.sort(key=lambda trial: trial.cost)
        left = self.options.exchanges
        while left > 0 and not growth.enough(best := self.found[0], self.winches):
            self.progress("Exchanging cables", self.options.exchanges - left, self.options.exchanges)
            better = growth.exchanged(best, winches=self.winches, most=left)
            left -= len(best.layout.routes)
            if better is best:
                break
            self.found.insert(0, growth.polished(better))
            self._noted("cables exchanged, via points moved", self.found[0])
            self.found.sort(key=lambda trial: trial.cost)
            if self.found[0].cost > (1 - _ANOTHER) * best.cost:
                break
        self.progress("Exchanging cables", 1, 1)
        self.found[0] = growth.pruned(self.found[0])

    @cached_property
    def region(self) -> Region:
        """Where cables may be."""
        return body_region(self.robot.body, self.constraints.clearance)

    @property
    def _total(self) -> int:
        return self.options.starts_for(self.robot.body.mesh.dim) * self.cables

    def _beginning(self) -> Layout:
        """What the search begins with: nothing, what is locked, or all that there is."""
        whole = layout_of(self.robot, self.constraints)
        if self.request.improve and not whole.routes:
            raise InputError("the robot has no cables to improve; design without improving it")
        if self.request.improve:
            self._check_counts("to be improved", len(whole.sites), len(whole.routes))
            pushed = pushed_back(whole, self.region, 0.03 * self.robot.body.mesh.size)
            told = None if pushed is None else violations(pushed.robot(digits=_DIGITS), self.constraints, self.region)
            if pushed is None or told:
                raise InputError(
                    "the robot's own network cannot be moved into what the constraints allow"
                    f"{f' ({told[0]})' if told else ''}; relax them, or design without improving it"
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

    def _noted(self, words: str, trial: Trial) -> None:
        """A network on the way: the best so far is kept, to be returned if the search is interrupted."""
        if words.startswith(("cable", "the first")):
            self.grown += 1
            self.progress("Growing networks", min(self.grown, self._total), self._total)
        size = len(trial.layout.sites), len(trial.layout.routes)
        if size not in self.sizes or trial.cost < self.sizes[size].cost:
            self.sizes[size] = trial
        stage = DesignStage(words=words, robot=trial.layout.robot(digits=_DIGITS), error=trial.error)
        self.stages.append(stage)
        if self.best is None or trial.cost < self.best.cost:
            self.best = trial
            self.watch(stage)

    def _finished(self, complete: bool) -> tuple[Alternative, list[Alternative]]:
        """The networks found, judged as their user will find them, the best first."""
        trials = [*self.found, *([] if complete else [self.best])]
        judged = [judged for trial in trials if trial is not None and (judged := self.judged(trial)) is not None]
        if not judged:
            raise HydrostatError(
                "no network that was found keeps all constraints; relax them, or ask for other numbers of cables"
            )
        judged.sort(key=lambda network: network.rms_error)
        return judged[0], judged[1:]

    def judged(self, trial: Trial) -> Alternative | None:
        """A network with rounded coordinates and poses solved from rest; None if it breaks a constraint."""
        robot = trial.layout.robot(digits=_DIGITS)
        if violations(robot, self.constraints, self.region):
            return None
        simulation = Simulation(robot, body=self.bench.body)
        limits = Limits(tension=self.constraints.tension_limit)
        try:
            reached = [
                solve_ik(simulation, pose, limits=limits, options=InverseOptions()) for pose in self.request.poses
            ]
        except NotConvergedError:
            return None
        return None if pulls(robot, reached, self.constraints) else Alternative(robot=robot, reached=tuple(reached))

    def _certificate(self, network: Alternative) -> Certificate | None:
        layout = layout_of(network.robot, self.constraints)
        poses = [reached.pose for reached in network.reached]
        return certify(self.proposals, self.bench.trial(layout, Simulation(network.robot, body=self.bench.body), poses))


_DIGITS = 5  # coordinates to a hundredth of a millimetre, as nobody places a cable finer
_ANOTHER = 0.2  # a round of exchanges that gains so much is followed by another
_REFINED = 2  # networks that are refined to the end


def design_fewest(robot: Robot, request: DesignRequest, *, progress: Progress, watch: Watch = unseen) -> Network:
    """One winch, then two, and so on, until every pose is reached within the tolerance, or there are no more cables.

    Each number of winches is searched by itself. It ends, as it may, with fewer cables than are allowed. Of networks
    that miss the tolerance the best one is returned. Locked winches count; `watch` is told each better network on the
    way, whatever its number of winches.
    """
    size = robot.body.mesh.size
    constraints, options, cables = request.constraints, request.route_options, request.cables
    tolerance = _SHARE * size if options.tolerance is None else options.tolerance
    sought = replace(options, enough=max(options.enough, _SAFE * tolerance / size))
    found: list[Network] = []
    body, better = BodyPhysics(robot), Better(watch)
    front: dict[Size, Alternative] = {}
    interrupted = False
    least = _fewest(robot, request)
    largest = min(cables, int(COUNTS["winches"].most))
    for winches in range(least, largest + 1):
        most = min(cables, winches * constraints.cables_per_winch)
        asked = replace(request, winches=winches, cables=most, options=sought)
        search = RouteSearch(robot, asked, body, progress, watch=better)
        try:
            found.append(search.run())
        except KeyboardInterrupt:
            if not found:
                raise
            interrupted = True
            break
        except InputError:
            raise
        except HydrostatError:
            if winches == largest and not found:
                raise
            continue
        judged = (search.judged(trial) for trial in search.sizes.values())
        _keep_best(front, [*(network for network in judged if network is not None), *_all(found[-1])])
        if not found[-1].complete or all(reached.rms_error <= tolerance for reached in found[-1].reached):
            break
    best = found[-1]
    if any(reached.rms_error > tolerance for reached in best.reached):
        best = min(found, key=lambda network: network.rms_error)
    return replace(
        best,
        alternatives=tuple(front[counts] for counts in sorted(front)),
        request=request,
        tried=sum(network.tried for network in found),
        seconds=sum(network.seconds for network in found),
        complete=not interrupted and all(network.complete for network in found),
    )


def _fewest(robot: Robot, request: DesignRequest) -> int:
    """The number of winches to begin with: those that stay, two where a mirrored network has a cable on each."""
    constraints, cables = request.constraints, request.cables
    least = max(1, len(constraints.staying(robot)[0]))
    if constraints.mirror is not None and constraints.cables_per_winch == 1:
        least = max(least, 2)
    if least > cables:
        raise InputError(
            f"{least} winches are needed at the least, for what is locked or mirrored, but there may be {cables} cables"
        )
    return least


def _keep_best(front: dict[Size, Alternative], networks: Iterable[Alternative]) -> None:
    """Put networks in place of those of their size that have a larger error."""
    for network in networks:
        size = size_of(network)
        if size not in front or network.rms_error < front[size].rms_error:
            front[size] = network


def _all(network: Network) -> tuple[Alternative, ...]:
    return Alternative(robot=network.robot, reached=network.reached), *network.alternatives


_SHARE = 0.01  # the tolerance where none is given, as a share of the body's size
_SAFE = 0.6  # share of the tolerance at which no more cables are added: the mean over poses hides the worst
