"""`Growth`: a network grown cable by cable, each the best of those that promise most."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from hydrostat.design.polyline import turns
from hydrostat.design.routes.evaluator import Evaluator, Trial
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.propose import Additions, Proposals
from hydrostat.design.routes.refine import RefineOptions, refine
from hydrostat.design.routes.search_rules import RULES
from hydrostat.robot import Mount
from hydrostat.simulation import Simulation

Note = Callable[[str, Trial], None]  # receives the change, and the network after it


@dataclass(frozen=True, eq=False)
class _Promise:
    """A network, what may be added to it, and its cost then to first order [m]."""

    trial: Trial
    additions: Additions
    cost: float


@dataclass(eq=False)
class Growth:
    """Grows, refines and exchanges."""

    proposals: Proposals  # where cables may be added
    note: Note  # receives every network on the way

    @property
    def evaluator(self) -> Evaluator:
        """The evaluator that solves layouts."""
        return self.proposals.evaluator

    def evaluate(self, layout: Layout) -> Trial | None:
        """The trial of a layout as it is, even one without cables."""
        if layout.routes:
            return self.evaluator.reach_poses(layout, None)
        simulation = Simulation(layout.robot(), body=self.evaluator.body)
        return self.evaluator.trial(layout, simulation, [simulation.rest] * len(self.evaluator.targets))

    def grow_networks(self, begun: Sequence[Trial], *, winches: int, cables: int) -> list[Trial]:
        """Add cables one by one, each time to the network whose prices promise the least cost (best-first search).

        Networks are refined without sensitivities of build tolerances on the way, the best few with them at the end.
        It ends when enough is reached, when no price promises to help, or after some cables in a row that do not.
        """
        grown = [trial for trial in begun if trial.layout.routes]
        waiting = self._price_each(begun, winches, cables)
        idle, most_idle = 0, RULES.max_stalled_cables * self.proposals.options.starts
        while waiting and idle < most_idle:
            least = self._least(grown, winches)
            if least <= self.enough_error:
                break
            waiting.sort(key=lambda one: one.cost)
            best = waiting.pop(0)
            if best.cost > (1 - RULES.growth_promise) * least:
                break
            more = self._add_cable(best, winches)
            grown += more
            waiting += self._price_each(more, winches, cables)
            idle = 0 if self._least(more, winches) < (1 - RULES.growth_gain) * least or least == np.inf else idle + 1
        return self._refine_grown(grown, winches)

    def _price_each(self, trials: Sequence[Trial], winches: int, cables: int) -> "list[_Promise]":
        """Promises of one more cable, of those networks that have room and a path for one."""
        roomy = [trial for trial in trials if cables > len(trial.layout.routes)]

        def price(trial: Trial) -> Additions:
            return self.price(trial, winches, cables - len(trial.layout.routes), best=1)

        return [
            _Promise(trial, additions, predict_cost(trial, additions.gain))
            for trial, additions in zip(roomy, self.evaluator.map(price, roomy), strict=True)
            if additions.paths
        ]

    def _add_cable(self, promise: "_Promise", winches: int) -> list[Trial]:
        """Networks with one cable more, roughly refined, noted where they are better than before."""
        trial = promise.trial
        best = RULES.growth_candidates if trial.layout.routes else RULES.first_candidates

        def try_cables() -> list[Trial]:
            layouts = self.build(trial, promise.additions, winches, best=best)
            return self.solve_layouts(trial, layouts, best=best)

        solved = self.evaluator.keep("cables tried", try_cables)
        rough = unlike(self.refine_each(solved, directions=0, steps=RULES.growth_steps), best, self._rate)
        kept = rough[: 1 if trial.layout.routes else RULES.first_candidates]
        more = self.refine_each(kept, directions=0, steps=RULES.growth_more_steps)
        for one in more:
            self.note(_words(one), one)
        return more

    def _refine_grown(self, grown: Sequence[Trial], winches: int) -> list[Trial]:
        """The networks, the best few refined with the build tolerances, the best first."""
        whole = [trial for trial in grown if len(trial.layout.sites) >= winches] or grown
        likely = unlike(whole, RULES.growth_final)
        refined = self.refine_each([trial for trial in likely if trial.cost < RULES.growth_far * likely[0].cost])
        for trial in refined:
            self.note(_words(trial), trial)
        return sorted([*refined, *(trial for trial in grown if trial not in likely[: len(refined)])], key=_cost)

    @staticmethod
    def _least(trials: Sequence[Trial], winches: int) -> float:
        """The least cost of networks with all their winches [m]; infinite if there are none."""
        return min((trial.cost for trial in trials if len(trial.layout.sites) >= winches), default=np.inf)

    def refine(self, trial: Trial, *, wanted: float = np.inf) -> Trial:
        """Refine a network in rounds, each of which must hold from rest on.

        It ends early where a round gained less than what is left to a `wanted` cost [m]: later rounds gain less still.
        """
        steps = self.proposals.options.refine_steps
        best = (
            trial if trial.from_rest else self.evaluator.keep("from rest", lambda: [self.resolve_from_rest(trial)])[0]
        )
        effort, round_size = 1.0, RULES.round_steps
        done = failed = 0
        while done < steps and failed < RULES.round_failures and best.cost > self.enough_error:
            size = min(round_size, steps - done)
            options = replace(self._options(size), effort=effort * self._options(size).effort)
            found = self._refine_round(best, options)
            done += size
            if found.cost < best.cost:
                gain = 1.0 - found.cost / best.cost
                best = found
                hopeless = (1.0 - gain) * best.cost > wanted
                if gain < RULES.round_gain or hopeless or best.built_error <= options.stop_error:
                    break
            else:
                effort, round_size, failed = 4.0 * effort, max(round_size // 2, 1), failed + 1
        return best

    def _refine_round(self, trial: Trial, options: RefineOptions) -> Trial:
        """A network after some steps of refinement, its poses found from rest."""

        def refine_once() -> list[Trial]:
            refined = refine(self.evaluator, self.proposals.graph.region, trial, options)
            return [self.resolve_from_rest(refined, worst=trial.cost)]

        return self.evaluator.keep("refined, poses from rest", refine_once)[0]

    def resolve_from_rest(self, trial: Trial, *, worst: float = np.inf) -> Trial:
        """The same network with poses found from rest: what its user will find; infinite errors above `worst` [m]."""
        found = self.evaluator.reach_poses(trial.layout, None, iterations=60, worst=worst, hoped=trial)
        return replace(trial, error=np.inf) if found is None else replace(found, from_rest=True)

    @property
    def enough_error(self) -> float:
        """Error at which nothing more is sought [m]."""
        return self.proposals.options.stop_error * self.proposals.graph.size

    def enough(self, trial: Trial, winches: int) -> bool:
        """True if the network is good enough."""
        return len(trial.layout.sites) >= winches and trial.cost <= self.enough_error

    def price(self, trial: Trial, winches: int, needed: int, *, best: int) -> Additions:
        """Paths for one cable more, some to spare for those that cannot be built."""
        count = RULES.spare_paths * max(self.proposals.options.trials, best)
        return self.proposals.price_additions(trial, winches=winches, needed=needed, count=count)

    def build(self, trial: Trial, additions: Additions, winches: int, *, best: int) -> list[Layout]:
        """Layouts along the most promising of these paths that can be built."""
        most = max(self.proposals.options.trials, best)
        return self.proposals.build(trial, additions, winches, most=most)

    def solve_layouts(self, trial: Trial, layouts: Sequence[Layout], *, best: int) -> list[Trial]:
        """Solve networks with one cable more than a trial and return the `best`; hopeless ones are cut short.

        Marker errors add up over the poses, so those of the first poses bound them from below.
        """
        kept: list[Trial] = []
        for layout in layouts:
            worst = self._rate(kept[-1]) / self._effort_factor(layout) if len(kept) == best else np.inf
            found = self.evaluator.reach_poses(layout, trial, iterations=RULES.growth_ik_steps, worst=worst)
            if found is not None:
                kept = sorted([*kept, found], key=self._rate)[:best]
        return kept

    def _rate(self, trial: Trial) -> float:
        """Return the cost [m], more for networks that are worse to build."""
        return trial.cost * self._effort_factor(trial.layout)

    def _effort_factor(self, layout: Layout) -> float:
        """Factor on the cost: above 1 for winches that are not deep in the body (R12) and cables that turn (E14)."""
        inner = [site.winch.at for site in layout.sites if site.winch.mount is Mount.BODY]
        depths = self.proposals.graph.region.depths(np.array(inner)) if inner else np.zeros(0)
        shallow = np.maximum(1.0 - depths / self.proposals.deepest, 0.0).mean() if inner else 0.0
        turned = np.mean([turns(route.points).sum() for route in layout.routes])
        return 1.0 + RULES.shallow_cost * float(shallow) + RULES.turn_cost * float(turned)

    def refine_briefly(self, trial: Trial, *, directions: int = 2, steps: int | None = None) -> Trial:
        """Refine a network by a few steps: `steps`, or those of the options."""
        asked = self.proposals.options.steps
        options = replace(self._options(asked if steps is None else min(steps, asked)), directions=directions)
        return refine(self.evaluator, self.proposals.graph.region, trial, options)

    def refine_each(self, trials: Sequence[Trial], *, directions: int = 2, steps: int | None = None) -> list[Trial]:
        """Refine some networks by a few steps each, shared by the cores."""
        work = partial(self.refine_briefly, directions=directions, steps=steps)
        return list(self.evaluator.keep_each("refined", work, trials))

    def _options(self, steps: int) -> RefineOptions:
        return RefineOptions(iterations=steps, stop_error=self.enough_error)


def unlike(
    trials: Sequence[Trial], count: int, key: Callable[[Trial], float] = lambda trial: trial.cost
) -> list[Trial]:
    """The first few, the best first, no two of the same cost and spread."""
    kept: list[Trial] = []
    for trial in sorted(trials, key=key):
        if len(kept) < count and not any(_are_alike(trial, other) for other in kept):
            kept.append(trial)
    return kept


def _are_alike(one: Trial, other: Trial) -> bool:
    costs, spreads = abs(one.cost - other.cost), abs(one.spread - other.spread)
    return max(costs, spreads) <= RULES.alike * one.cost


def predict_cost(trial: Trial, gain: float) -> float:
    """Cost of a network [m] once half its squared error is less by a gain [m^2], its spread left as it is."""
    share = 1.0 - 2.0 * gain / max(trial.built_error**2, 1e-300)
    return trial.cost * float(np.sqrt(max(share, 0.0)))


def without(layout: Layout, number: int) -> Layout | None:
    """A layout less a line, its twin, and winches that pull nothing any more; None if nothing is left."""
    gone = {number} | {index for index, route in enumerate(layout.routes) if route.twin == number}
    kept = [index for index in range(len(layout.routes)) if index not in gone]
    pulled = {layout.routes[index].winch for index in kept}
    sites = [index for index, site in enumerate(layout.sites) if index in pulled or site.fixed]
    for index in list(sites):  # a winch whose twin is gone would have nothing to follow
        twin = layout.sites[index].twin
        if twin is not None and twin not in sites:
            sites.append(twin)
    sites.sort()
    if not kept:
        return None
    order = {None: None, **{old: new for new, old in enumerate(sites)}}
    rank = {None: None, **{old: new for new, old in enumerate(kept)}}
    rest = replace(
        layout,
        sites=tuple(replace(layout.sites[old], twin=order[layout.sites[old].twin]) for old in sites),
        routes=tuple(
            replace(route, winch=sites.index(route.winch), twin=rank[route.twin])
            for route in (layout.routes[old] for old in kept)
        ),
    )
    return rest.turn_winches()


def _cost(trial: Trial) -> float:
    return trial.cost


def _words(trial: Trial) -> str:
    layout = trial.layout
    name = layout.sites[layout.routes[-1].winch].winch.name
    return f"cable {len(layout.routes)}, pulled by {name}"
