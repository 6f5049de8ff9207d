"""`FinalJudgement`: the networks that a search found, judged as their user will find them."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from hydrostat.design.network import Alternative
from hydrostat.design.routes.begin import layout_of
from hydrostat.design.routes.deadline import TimeUpError
from hydrostat.design.routes.evaluator import Trial
from hydrostat.design.routes.finalists import Finalists, kit_fits
from hydrostat.design.routes.growth import Growth
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.search_rules import RULES
from hydrostat.design.winch_room import find_holding_torque
from hydrostat.errors import HydrostatError


@dataclass(eq=False)
class FinalJudgement:
    """Judges networks, the best first; its time is that of the evaluator."""

    growth: Growth
    finalists: Finalists  # with the torque of the motors that hold the first network, once that is judged
    found: Sequence[Trial]  # the networks of the search, the best first
    passed: Sequence[tuple[float, Layout]]  # cost and layout of the networks on the way
    sizes: dict[tuple[int, int], Trial]  # the best network of each size
    thinner: Trial | None  # the network whose holes were left out, which may cost `RULES.thinner_cost` more
    complete: bool  # whether the search came to its end
    networks: list[Alternative] = field(default_factory=list)  # that were judged, the chosen one first

    def judge_networks(self) -> None:
        """Fill `networks`, the best first; those whose kit would be refused come last.

        A search that was ended before has its best network judged without restarts, and others only if its kit would
        be refused. Where it is stopped or the time is up, the networks judged by then are in this order too.
        """
        try:
            self._judge_found()
        except (KeyboardInterrupt, TimeUpError):
            self.networks.sort(key=lambda network: (not kit_fits(network), network.expected_error))
            raise

    def _judge_found(self) -> None:
        judged, finalists = self.networks, self.finalists
        judged += finalists.judge_all(self.found[:1])
        thinner = judged[0] if judged and self.found[0] is self.thinner else None
        judged += finalists.judge_all(self.found[1:], thorough=not (judged and kit_fits(judged[0])))
        if judged and not kit_fits(judged[0]):
            refined = self.growth.refine if self.complete else self.growth.refine_briefly
            judged += finalists.with_room(self.found[:1], refined)
        if not any(kit_fits(network) for network in judged):
            judged += finalists.with_room(self.found[1:], self.growth.refine_briefly)
            known = [trial.layout for trial in self.found]
            others = [pair for pair in self.passed if not any(pair[1] is layout for layout in known)]
            judged += finalists.first_to_fit(others, RULES.judged_on_the_way if self.complete else RULES.judged_late)
        judged += finalists.judge_all(self._simpler() if self.complete else [], thorough=False)
        if not judged:
            raise HydrostatError(
                "no network that was found keeps all constraints; relax them, or ask for other numbers of cables"
            )
        best = judged[0]
        judged.sort(key=lambda one: finalists.cost(one) / (1 + RULES.thinner_cost * (one is thinner)))
        first = next((place for place, network in enumerate(judged) if kit_fits(network)), 0)
        judged.insert(0, judged.pop(first))
        if self.complete and judged[0] is not best:
            judged[0] = finalists.judge(layout_of(judged[0].robot, finalists.constraints)) or judged[0]
        held = self._hold(judged[0]) if self.complete and finalists.constraints.built_in else None
        if held is not None:
            judged.insert(0, held)

    def _hold(self, network: Alternative) -> Alternative | None:
        """A network whose motors hold the poses for long, where they hold these for seconds; None if that costs much.

        Winches stand farther apart, so that stronger motors fit, or poses ask for less torque.
        """
        torque = find_holding_torque(network.robot, network.ik_results)
        if torque is None:
            return None
        return self._hold_apart(network) or self._hold_weaker(network, torque)

    def _hold_apart(self, network: Alternative) -> Alternative | None:
        """The network with its winches as far apart as motors need that hold the poses for long; None if none is."""
        allowed = (1 + RULES.holding_cost) * network.expected_error
        layout = replace(layout_of(network.robot, self.finalists.constraints), source=self.finalists.robot)
        before = self.growth.evaluator.reach_poses(layout, None)
        if before is None:
            return None
        for times in RULES.holding_distances:
            moved = self.finalists.push_apart(before, times)
            if moved is None:
                continue
            refined = self.growth.refine(moved, wanted=allowed)
            hopeful = refined.cost < RULES.unjudged_cost * allowed
            held = self.finalists.judge(refined.layout) if hopeful else None
            if held is None or held.expected_error > allowed:
                continue
            if kit_fits(held) and find_holding_torque(held.robot, held.ik_results) is None:
                return held
        return None

    def _hold_weaker(self, network: Alternative, torque: float) -> Alternative | None:
        """The network refined until its poses ask for no more than a torque [N m]; None if that costs much."""
        evaluator, usual = self.growth.evaluator, self.growth.evaluator.constraints
        evaluator.constraints = replace(usual, torque=torque)
        try:
            layout = layout_of(network.robot, evaluator.constraints)
            trial = evaluator.reach_poses(layout, None)
            finalists = replace(self.finalists, constraints=evaluator.constraints)
            allowed = (1 + RULES.holding_cost) * network.expected_error
            refined = None if trial is None else self.growth.refine(trial, wanted=allowed)
            hopeful = refined is not None and refined.cost < RULES.unjudged_cost * allowed
            held = finalists.judge(refined.layout) if refined is not None and hopeful else None
        except BaseException:
            evaluator.constraints = usual
            raise
        if held is not None and kit_fits(held) and held.expected_error < allowed:
            self.finalists = finalists
            return held
        evaluator.constraints = usual
        return None

    def _simpler(self) -> list[Trial]:
        """The best network of each size with fewer cables, where none with fewer still is as good."""
        kept: list[Trial] = []
        for winches, cables in sorted(self.sizes, key=lambda size: size[1]):
            trial = self.sizes[winches, cables]
            fewer = cables < len(self.found[0].layout.routes)
            if fewer and all(trial.cost < (1 - RULES.simpler_cost) * other.cost for other in kept):
                kept.append(trial)
        return kept
