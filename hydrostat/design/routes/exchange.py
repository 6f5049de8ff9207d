"""`Exchanges`: cables taken out of a network, for good or for a better one."""

from dataclasses import dataclass

from hydrostat.design.routes.bench import Trial
from hydrostat.design.routes.growth import Growth, predict_cost, without
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.propose import Additions


@dataclass(eq=False)
class Exchanges:
    """Exchanges cables of networks, or leaves them out."""

    growth: Growth
    winches: int  # of a whole network

    def exchange_cables(self, trial: Trial, most: int) -> Trial:
        """Exchange cables, those first whose loss costs least, where prices promise enough; `most` are tried.

        It ends after two exchanges in a row that do not help.
        """
        failed, order = 0, self._by_loss(trial)
        while order and most > 0 and failed < _FAILURES:
            number, needed = order.pop(0), (1 - _WORTH) * trial.cost
            rest = self._rest(trial, number)
            before = None if rest is None else self._reach(rest, trial)
            if before is None:
                continue
            missing = len(trial.layout.routes) - len(before.layout.routes)
            additions = self.growth.price(before, self.winches, missing, best=1)
            if predict_cost(before, additions.gain) > (1 - _HOPE) * trial.cost:
                continue
            most -= 1
            better = self._exchange(before, additions, needed)
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
            found = self._reach(rest, trial, worst=allowed)
            found = found and self.growth.bench.reach_poses(rest, None, worst=allowed)
            if found is not None and found.cost <= allowed:
                trial = found
                self.growth.note("a cable that does nothing left out", trial)
        return trial

    def _by_loss(self, trial: Trial) -> list[int]:
        """Cables that may be exchanged, by the cost without them."""
        found = []
        for number in range(len(trial.layout.routes)):
            rest = self._rest(trial, number)
            before = None if rest is None else self._reach(rest, trial)
            if before is not None:
                found.append((before.cost, number))
        return [number for _, number in sorted(found)]

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

    def _reach(self, rest: Layout, trial: Trial, worst: float = float("inf")) -> Trial | None:
        """A network without a cable, its poses sought from those with it."""
        places = {site.winch.name: number for number, site in enumerate(trial.layout.sites)}
        kept = [places[site.winch.name] for site in rest.sites]
        return self.growth.bench.reach_poses(rest, trial, iterations=_STEPS, kept=kept, worst=worst)

    def _worth(self, trial: Trial, rest: Layout) -> float:
        """The share of the cost that a cable must save to be kept, more where its winch goes too."""
        winch = len(rest.sites) < len(trial.layout.sites)
        return self.growth.proposals.options.simplicity * (_MOTOR if winch else _CABLE)


_STEPS = 8  # of inverse kinematics from the poses of the network with the cable
_FAILURES = 2  # exchanges in a row that do not help end the round
_HOPE = 0.03  # an exchange is tried if prices promise to lower the cost by this share
_WORTH = 0.01  # an exchange must gain so much
_CABLE = 0.02  # a cable whose loss costs less than this share does not earn its place
_MOTOR = 0.04  # nor a winch whose loss does
