"""`Exchanges`: cables taken out of a network, for good or for a better one."""

from dataclasses import dataclass, field

from hydrostat.design.routes.evaluator import Trial
from hydrostat.design.routes.growth import Growth, predict_cost, without
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.propose import Additions
from hydrostat.design.routes.search_rules import RULES


@dataclass(eq=False)
class Exchanges:
    """Exchanges cables of networks, or leaves them out."""

    growth: Growth
    winches: int  # of a whole network
    _trial: Trial | None = None  # network that `_known` belongs to
    _known: dict[int, Trial | None] = field(default_factory=dict)  # it without each of its cables, where that is solved

    def exchange_cables(self, trial: Trial, most: int) -> Trial:
        """Exchange cables, those first whose loss costs least, where prices promise enough; `most` are tried.

        It ends after the first exchange that does not help (`RULES.exchange_failures`).
        """
        failed, order = 0, self._by_loss(trial)
        while order and most > 0 and failed < RULES.exchange_failures:
            number, needed = order.pop(0), (1 - RULES.exchange_gain) * trial.cost
            before = self._without(trial, number)
            if before is None:
                continue
            missing = len(trial.layout.routes) - len(before.layout.routes)
            additions = self.growth.price(before, self.winches, missing, best=1)
            if predict_cost(before, additions.gain) > (1 - RULES.exchange_promise) * trial.cost:
                continue
            most -= 1
            better = self._keep_exchange(before, additions, needed)
            if better is None:
                failed += 1
                continue
            failed, trial = 0, better
            order = [other - (other > number) for other in order]  # the new cable is the last one
            self.growth.note("a cable exchanged", trial)
        return trial

    def prune_cables(self, trial: Trial) -> Trial:
        """Remove cables that do not earn their place: without them the cost stays the same, or enough."""
        for number in reversed(range(len(trial.layout.routes))):
            rest = self._rest(trial, number)
            if rest is None:
                continue
            allowed = max((1 + self._worth(trial, rest)) * trial.cost, self.growth.enough_error)
            found = self._without(trial, number, worst=allowed)
            hopeful = found is not None and found.cost <= allowed
            found = self._reach_from_rest(rest, allowed) if hopeful else None
            if found is not None and found.cost <= allowed:
                trial = found
                self.growth.note("a cable that does nothing left out", trial)
        return trial

    def _by_loss(self, trial: Trial) -> list[int]:
        """Cables that may be exchanged, by the cost without them."""
        numbers = range(len(trial.layout.routes))
        rests = [(number, rest) for number in numbers if (rest := self._rest(trial, number)) is not None]
        solved = self.growth.evaluator.keep_each("a cable less", lambda pair: self._reach(pair[1], trial), rests)
        self._trial = trial
        self._known = {number: before for (number, _), before in zip(rests, solved, strict=True)}
        return [number for _, number in sorted((one.cost, number) for number, one in self._known.items() if one)]

    def _keep_exchange(self, before: Trial, additions: Additions, worst: float) -> Trial | None:
        """Exchange a cable, as a step of the search."""
        return self.growth.evaluator.keep("a cable exchanged", lambda: [self._exchange(before, additions, worst)])[0]

    def _exchange(self, before: Trial, additions: Additions, worst: float) -> Trial | None:
        """The best network with another cable, from rest; None if its cost is not below `worst` [m]."""
        layouts = self.growth.build(before, additions, self.winches, best=1)
        tried = self.growth.solve_layouts(before, layouts, best=1)
        if not tried:
            return None
        found = self.growth.refine_briefly(tried[0])
        if found.cost >= worst:
            return None
        found = self.growth.resolve_from_rest(found, worst=worst)
        return found if found.cost < worst else None

    @staticmethod
    def _rest(trial: Trial, number: int) -> Layout | None:
        """The layout without a cable; None if that stays, follows another one, or is the last."""
        route = trial.layout.routes[number]
        if route.kept is not None or route.twin is not None or len(trial.layout.routes) < 2:
            return None
        return without(trial.layout, number)

    def _without(self, trial: Trial, number: int, worst: float = float("inf")) -> Trial | None:
        """A network without a cable, its poses sought from those with it; each is solved once.

        None where it has no equilibrium, or an error above `worst` [m] if it was not solved before.
        """
        if trial is not self._trial:
            self._trial, self._known = trial, {}
        if number in self._known:
            return self._known[number]
        rest = self._rest(trial, number)
        if rest is None:
            return None
        found = self.growth.evaluator.keep("a cable less", lambda: [self._reach(rest, trial, worst)])[0]
        if found is not None or worst == float("inf"):
            self._known[number] = found
        return found

    def _reach(self, rest: Layout, trial: Trial, worst: float = float("inf")) -> Trial | None:
        """A network without a cable, its poses sought from those with it."""
        places = {site.winch.name: number for number, site in enumerate(trial.layout.sites)}
        kept = [places[site.winch.name] for site in rest.sites]
        return self.growth.evaluator.reach_poses(
            rest, trial, iterations=RULES.exchange_ik_steps, kept=kept, worst=worst
        )

    def _reach_from_rest(self, rest: Layout, worst: float) -> Trial | None:
        """A network with poses from rest, kept as a step of the search; None with an error above `worst` [m]."""
        return self.growth.evaluator.keep(
            "a cable left out", lambda: [self.growth.evaluator.reach_poses(rest, None, worst=worst)]
        )[0]

    def _worth(self, trial: Trial, rest: Layout) -> float:
        """The share of the cost that a cable must save to be kept, more where its winch goes too."""
        winch = len(rest.sites) < len(trial.layout.sites)
        return self.growth.proposals.options.simplicity * (RULES.winch_worth if winch else RULES.cable_worth)
