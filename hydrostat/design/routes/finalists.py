"""`Finalists`: networks judged as their user will find them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np

from hydrostat.design.buildable import pulls, violations
from hydrostat.design.built_error import expected_error
from hydrostat.design.constraints import Constraints
from hydrostat.design.network import Alternative, Network
from hydrostat.design.region import Region
from hydrostat.design.request import DesignRequest
from hydrostat.design.routes.evaluator import Evaluator, Trial
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.reach_from_rest import reach_from_rest
from hydrostat.design.routes.refine import pushed_back
from hydrostat.design.routes.search_rules import RULES
from hydrostat.errors import NotConvergedError
from hydrostat.fabrication import Demand, find_refusals
from hydrostat.ik import IKOptions
from hydrostat.robot import Robot, limit_travels
from hydrostat.simulation import Simulation, cable_sensitivities

DIGITS = 5
"""Coordinates are rounded to a hundredth of a millimeter [digits of a meter]: nobody places a cable finer."""


@dataclass(frozen=True, eq=False)
class Finalists:
    """Judges layouts by rounded coordinates, poses from rest, and what a kit needs."""

    robot: Robot  # that is designed for
    request: DesignRequest
    constraints: Constraints  # of the search
    evaluator: Evaluator
    region: Region
    restarts: int = IKOptions.restarts  # of the search for each pose

    def judge(self, layout: Layout, *, restarts: int | None = None) -> Alternative | None:
        """A network with rounded coordinates and poses solved from rest; None if it breaks a constraint."""
        robot = self.safe_robot(layout)
        if violations(robot, self.constraints, self.region):
            return None
        self.evaluator.look()
        simulation = Simulation(robot, body=self.evaluator.body)
        limits = self.constraints.limits
        try:
            options = IKOptions(restarts=self.restarts if restarts is None else restarts)
            reached = list(
                self.evaluator.map(
                    lambda pose: reach_from_rest(simulation, pose, limits, options),
                    self.request.poses,
                    known=(simulation, robot, simulation.assembly, simulation.assembly.token),
                )
            )
        except NotConvergedError:
            return None
        if pulls(robot, reached, self.constraints):
            return None
        built = expected_error(simulation, reached, self.evaluator.uncertainty)
        return Alternative(robot=robot, ik_results=tuple(reached), expected_error=built)

    def safe_robot(self, layout: Layout) -> Robot:
        """The robot of a layout, coordinates rounded, new winches with travels that are safe."""
        locked = {winch.name for winch in self.constraints.staying(self.robot)[0]}
        robot = self._number_winches(layout).robot(digits=DIGITS)
        return self.constraints.limit_robot(limit_travels(robot, locked))

    def cost(self, network: Alternative) -> float:
        """The error as built, more where little else is in reach [m]."""
        if not self.evaluator.reach:
            return network.expected_error
        simulation = Simulation(network.robot, body=self.evaluator.body)
        sensitivities = [
            cable_sensitivities(simulation, one.pose, own)
            for one, own in zip(network.ik_results, self.evaluator.markers, strict=True)
        ]
        return network.expected_error * self.evaluator.nearness(network.robot, sensitivities)

    def _number_winches(self, layout: Layout) -> Layout:
        """Number new winches in their order; those of the robot keep their names."""
        own = {winch.name for winch in self.robot.winches}
        free = (name for number in range(1, 99) if (name := f"winch_{number}") not in own)
        sites = tuple(
            site if site.winch.name in own else replace(site, winch=replace(site.winch, name=next(free)))
            for site in layout.sites
        )
        return replace(layout, sites=sites)

    def judge_all(self, trials: Iterable[Trial | None], *, thorough: bool = True) -> list[Alternative]:
        """The networks of some trials that keep all constraints.

        If it is `thorough`, poses are sought from several beginnings, until a kit can be made of a network.
        """
        judged = []
        for trial in trials:
            network = trial and self.judge(trial.layout, restarts=None if thorough else 0)
            if network is not None:
                judged.append(network)
                thorough = thorough and not kit_fits(network)
        return judged

    def with_room(self, trials: Iterable[Trial | None], refined: Callable[[Trial], Trial]) -> list[Alternative]:
        """The first of some networks that a kit can be made of once its winches stand farther apart."""
        for times in RULES.winch_distances:
            for trial in trials:
                moved = None if trial is None else self.push_apart(trial, times)
                judged = None if moved is None else self.judge(refined(moved).layout)
                if judged is not None and kit_fits(judged):
                    return [judged]
        return []

    def push_apart(self, trial: Trial, times: float) -> Trial | None:
        """The network with winches apart by a multiple of the distance of the nearest two; None if it cannot be."""
        pushed = self._push_apart(trial.layout, times)
        return self.evaluator.reach_poses(pushed, trial) if pushed else None

    def _push_apart(self, layout: Layout, times: float) -> Layout | None:
        """The layout with winches apart by a multiple of the distance of the nearest two, or of what they need."""
        places = np.array([site.winch.at for site in layout.sites])
        away = np.linalg.norm(places[:, None] - places, axis=2) + np.diag(np.full(len(places), np.inf))
        gap = max(float(away.min(initial=np.inf)) if len(places) > 1 else 0.0, self.constraints.winch_gap)
        limits = replace(self.constraints, winch_gap=times * gap)
        return pushed_back(replace(layout, constraints=limits), self.region, 0.03 * self.robot.body.mesh.size)

    def first_to_fit(self, passed: Iterable[tuple[float, Layout]], most: int) -> list[Alternative]:
        """The best networks of the search, with their costs, that a kit can be made of."""
        for _, layout in sorted(passed, key=lambda pair: pair[0])[:most]:
            judged = self.judge(layout)
            if judged is not None and kit_fits(judged):
                return [judged]
        return []


def kit_fits(network: Alternative | Network) -> bool:
    """True if the kit of a network would not be refused; each network is examined once."""
    if network not in _EXAMINED:
        demand = Demand.of_results(network.robot, network.ik_results)
        refusals = find_refusals(network.robot, demand)
        _EXAMINED[network] = not refusals
    return _EXAMINED[network]


_EXAMINED: WeakKeyDictionary[Alternative | Network, bool] = WeakKeyDictionary()
