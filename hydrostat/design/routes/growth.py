"""`Growth`: a network grown cable by cable, each the best of those that promise most."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.design.polyline import turns
from hydrostat.design.routes.bench import Bench, Trial
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.propose import Additions, Proposals
from hydrostat.design.routes.refine import RefineOptions, refine
from hydrostat.robot import Mount
from hydrostat.simulation import Simulation

Note = Callable[[str, Trial], None]  # receives the change, and the network after it


@dataclass(eq=False)
class Growth:
    """Grows, refines and exchanges."""

    proposals: Proposals  # where cables may be added
    note: Note  # receives every network on the way

    @property
    def bench(self) -> Bench:
        """The bench that solves layouts."""
        return self.proposals.bench

    def evaluate(self, layout: Layout) -> Trial | None:
        """The trial of a layout as it is, even one without cables."""
        if layout.routes:
            return self.bench.reach_poses(layout, None)
        simulation = Simulation(layout.robot(), body=self.bench.body)
        return self.bench.trial(layout, simulation, [simulation.rest] * len(self.bench.targets))

    def grow_networks(self, begun: Sequence[Trial], *, winches: int, cables: int) -> list[Trial]:
        """Add cables one by one to the first networks, the best first (beam search).

        Of all networks with a cable more than those that are kept the best few are refined, and the best of these kept.
        It ends with as many cables as there may be, when enough is reached, when a cable does not help, or when no path
        promises to.
        """
        width = self.proposals.options.starts
        front, found = list(begun), [trial for trial in begun if trial.layout.routes]
        idle = 0
        while front and idle < _PATIENCE:
            best = (_SEEDS if not front[0].layout.routes else _LIKELY) * width
            more: list[Trial] = []
            for trial in front:
                needed = cables - len(trial.layout.routes)
                if needed > 0:
                    more += self._try_cables(trial, winches, needed, best=best)
            rough = [self.refine_briefly(one, directions=0) for one in unlike(more, len(front) * best, self._rate)]
            likely = unlike(rough, _LIKELY * width, self._rate)
            likely = [one for one in likely if one.cost < _FAR * likely[0].cost]
            front = unlike([self.refine_briefly(one) for one in likely], width, self._rate)
            for trial in front:
                self.note(_words(trial), trial)
            least = min((trial.cost for trial in found), default=np.inf)
            found += front
            if any(self.enough(trial, winches) for trial in front):
                break
            short = front and len(front[0].layout.sites) < winches
            idle = 0 if short or (front and front[0].cost < (1 - _HELPS) * least) else idle + 1
        return sorted(found, key=lambda trial: trial.cost)

    def refine(self, trial: Trial) -> Trial:
        """Refine a network in rounds, each of which must hold from rest on."""
        steps = self.proposals.options.polish
        best = trial if trial.from_rest else self.resolve_from_rest(trial)
        effort, round_size = 1.0, _ROUND
        done = failed = 0
        while done < steps and failed < _FAILURES and best.cost > self.enough_error:
            size = min(round_size, steps - done)
            options = replace(self._options(size), effort=effort * self._options(size).effort)
            found = self.resolve_from_rest(
                refine(self.bench, self.proposals.graph.region, best, options), worst=best.cost
            )
            done += size
            if found.cost < best.cost:
                gain = 1.0 - found.cost / best.cost
                best = found
                if gain < _IDLE or best.built_error <= options.enough:
                    break
            else:
                effort, round_size, failed = 4.0 * effort, max(round_size // 2, 1), failed + 1
        return best

    def resolve_from_rest(self, trial: Trial, *, worst: float = np.inf) -> Trial:
        """The same network with poses found from rest: what its user will find; infinite errors above `worst` [m]."""
        found = self.bench.reach_poses(trial.layout, None, iterations=60, worst=worst, hoped=trial)
        return replace(trial, error=np.inf) if found is None else replace(found, from_rest=True)

    @property
    def enough_error(self) -> float:
        """Error at which nothing more is sought [m]."""
        return self.proposals.options.enough * self.proposals.graph.size

    def enough(self, trial: Trial, winches: int) -> bool:
        """True if the network is good enough."""
        return len(trial.layout.sites) >= winches and trial.cost <= self.enough_error

    def _try_cables(self, trial: Trial, winches: int, needed: int, *, best: int) -> list[Trial]:
        """Solve some networks with one cable more and return the `best`; none if no path promises enough."""
        additions = self.price(trial, winches, needed, best=best)
        if len(trial.layout.sites) >= winches and predict_cost(trial, additions.gain) > (1 - _HOPE) * trial.cost:
            return []
        return self.solve_layouts(trial, self.build(trial, additions, winches, best=best), best=best)

    def price(self, trial: Trial, winches: int, needed: int, *, best: int) -> Additions:
        """Paths for one cable more, some to spare for those that cannot be built."""
        count = _SPARE * max(self.proposals.options.trials, best)
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
            found = self.bench.reach_poses(layout, trial, iterations=_GLANCE, worst=worst)
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
        return 1.0 + _SHALLOW * float(shallow) + _TURNED * float(turned)

    def refine_briefly(self, trial: Trial, *, directions: int = 2, steps: int | None = None) -> Trial:
        """Refine a network by a few steps: `steps`, or those of the options."""
        asked = self.proposals.options.steps
        options = replace(self._options(asked if steps is None else min(steps, asked)), directions=directions)
        return refine(self.bench, self.proposals.graph.region, trial, options)

    def _options(self, steps: int) -> RefineOptions:
        return RefineOptions(iterations=steps, enough=self.enough_error)


def unlike(
    trials: Sequence[Trial], count: int, key: Callable[[Trial], float] = lambda trial: trial.cost
) -> list[Trial]:
    """The first few, the best first, no two of the same cost."""
    kept: list[Trial] = []
    for trial in sorted(trials, key=key):
        if len(kept) < count and all(abs(trial.cost - other.cost) > _ALIKE * trial.cost for other in kept):
            kept.append(trial)
    return kept


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


def _words(trial: Trial) -> str:
    layout = trial.layout
    name = layout.sites[layout.routes[-1].winch].winch.name
    return f"cable {len(layout.routes)}, pulled by {name}"


_ALIKE = 1e-3  # costs that differ by less than this share are of the same network
_FAR = 1.1  # networks so much worse than the best are not refined with the build tolerances
_SPARE = 4  # times as many paths are priced as networks are solved: some cannot be built
_PATIENCE = 1  # rounds of cables without gain after which the growth ends
_HELPS = 0.02  # a cable that lowers the cost by less than this share does not help
_HOPE = 0.03  # a cable is tried if prices promise to lower the cost by this share
_LIKELY = 2  # cables that are refined for each that a network is grown from
_SEEDS = 3  # first cables that are refined for each that a network is grown from
_GLANCE = 5  # steps of inverse kinematics that tell which of several networks is the best
_ROUND = 8  # steps of refinement before the poses are found from rest again
_FAILURES = 2  # rounds that do not hold from rest end the refinement
_IDLE = 0.02  # a round that gains less ends the refinement
_SHALLOW = 0.5  # how much more a network costs whose winches are at the edge
_TURNED = 0.2  # how much more a network costs whose cables turn by 1 rad
