"""`Growth`: a network grown cable by cable, each the best of those that promise most."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.design.polyline import turns
from hydrostat.design.routes.bench import Bench, Trial
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.refine import RefineOptions, pushed_back, refine
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
        It ends with as many cables as there may be, or when enough is reached, or cables no longer help.
        """
        options = self.proposals.options
        width = options.starts
        front, found = list(begun), [trial for trial in begun if trial.layout.routes]
        idle = 0
        while front and idle < _PATIENCE:
            first = not front[0].layout.routes
            best = _SEEDS * width if first else _LIKELY * width
            count = max(options.trials, best)
            more: list[Trial] = []
            for trial in front:
                needed = cables - len(trial.layout.routes)
                if needed > 0:
                    more += self._try_cables(trial, winches, needed, count=count, best=best)
            rough = [self.refine_briefly(one, directions=0) for one in self._unlike(more, len(front) * best)]
            front = self._unlike([self.refine_briefly(one) for one in self._unlike(rough, _LIKELY * width)], width)
            for trial in front:
                self.note(_words(trial), trial)
            least = min((trial.cost for trial in found), default=np.inf)
            found += front
            if any(self.enough(trial, winches) for trial in front):
                break
            short = front and len(front[0].layout.sites) < winches
            idle = 0 if short or (front and front[0].cost < (1 - _HELPS) * least) else idle + 1
        return sorted(found, key=lambda trial: trial.cost)

    def _unlike(self, trials: list[Trial], count: int) -> list[Trial]:
        """The first few, the best first, no two of the same cost."""
        kept: list[Trial] = []
        for trial in sorted(trials, key=self._rate):
            if len(kept) < count and all(abs(trial.cost - other.cost) > 1e-3 * trial.cost for other in kept):
                kept.append(trial)
        return kept

    def with_one_more(self, trial: Trial, *, winches: int, needed: int) -> Trial | None:
        """The best network with one cable more (two where it is mirrored); None if there is none."""
        tried = self._try_cables(trial, winches, needed, count=self.proposals.options.trials, best=1)
        return self.refine_briefly(tried[0]) if tried else None

    def refine(self, trial: Trial) -> Trial:
        """Refine a network in rounds, each of which must hold from rest on."""
        steps = self.proposals.options.polish
        best = trial if trial.from_rest else self.resolve_from_rest(trial)
        effort, round_size = 1.0, _ROUND
        done = failed = 0
        while done < steps and failed < _FAILURES and best.cost > self._options(0).enough:
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

    def exchange_cables(self, trial: Trial, *, winches: int, most: int) -> Trial:
        """Take out up to `most` cables in turn, and put in the best where that is better."""
        for number in range(min(len(trial.layout.routes), most)):
            route = trial.layout.routes[number]
            if route.kept is not None or route.twin is not None or len(trial.layout.routes) < 2:
                continue
            rest = without(trial.layout, number)
            before = None if rest is None else self.bench.reach_poses(rest, None)
            if before is None:
                continue
            missing = len(trial.layout.routes) - len(before.layout.routes)
            found = self.with_one_more(before, winches=winches, needed=missing)
            if found is None:
                continue
            needed = (1 - _WORTH) * trial.cost
            found = self.resolve_from_rest(found, worst=needed)
            if found.cost < needed:
                trial = found
                self.note("a cable exchanged", trial)
        return trial

    def prune_cables(self, trial: Trial) -> Trial:
        """Remove cables that do not earn their place: without them the cost stays the same, or enough."""
        for number in reversed(range(len(trial.layout.routes))):
            route = trial.layout.routes[number]
            if route.kept is not None or route.twin is not None or len(trial.layout.routes) < 2:
                continue
            rest = without(trial.layout, number)
            allowed = max((1 + self._worth(trial, rest)) * trial.cost, self._options(0).enough)
            found = None if rest is None else self.bench.reach_poses(rest, None, worst=allowed)
            if found is not None and found.cost <= allowed:
                trial = found
                self.note("a cable that does nothing left out", trial)
        return trial

    def _worth(self, trial: Trial, rest: Layout | None) -> float:
        """The share of the cost that a cable must save to be kept, more where its winch goes too."""
        winch = rest is not None and len(rest.sites) < len(trial.layout.sites)
        return self.proposals.options.simplicity * (_MOTOR if winch else _CABLE)

    def remove_via_points(self, trial: Trial) -> Trial:
        """Remove via points that do not earn their stitch, those first whose place matters most as built.

        Each hole is sewn a little beside its mark, and each rubs: with fewer, less goes wrong.
        """
        kept: set[tuple[int, int]] = set()
        while True:
            holes = [hole for hole in self._holes(trial) if hole not in kept]
            if not holes:
                return trial
            route, point = holes[0]
            found = self._less_a_hole(trial, route, point)
            if found is None:
                kept.add((route, point))
                continue
            trial = found
            kept = {(r, p - (r == route and p > point)) for r, p in kept}

    def _holes(self, trial: Trial) -> list[tuple[int, int]]:
        """Via points that may go: route and number of each, by their share of the variance."""
        layout, shares = trial.layout, np.zeros(trial.layout.size)
        for weight, columns in zip(self.bench.weights, trial.columns, strict=True):
            places = layout.starts[-2]
            shares[:places] += ((weight[:, None] * columns[:, :places]) ** 2).sum(axis=0)
        found = [
            (float(shares[layout.place_of(number, point)].sum()), number, point)
            for number, route in enumerate(layout.routes)
            if route.kept is None and route.twin is None
            for point in range(max(route.lead, 0) + 1, len(route.points) - 1)
        ]
        twins = {route.twin for route in layout.routes}
        return [(number, point) for _, number, point in sorted(found, reverse=True) if number not in twins]

    def _less_a_hole(self, trial: Trial, number: int, point: int) -> Trial | None:
        layout = trial.layout
        route = layout.routes[number]
        points = np.delete(route.points, point, axis=0)
        if (
            len(points) - route.lead < _FEWEST
            or not self.proposals.graph.region.sees(points[point - 1 : point], points[point : point + 1]).all()
        ):
            return None
        routes = (*layout.routes[:number], replace(route, points=points), *layout.routes[number + 1 :])
        region = self.proposals.graph.region
        less = pushed_back(replace(layout, routes=routes), region, _NUDGE * self.proposals.graph.size)
        if less is None:
            return None
        allowed = (1 + self.proposals.options.simplicity * _HOLE) * trial.cost
        found = self.bench.reach_poses(less, trial, iterations=_GLANCE, worst=allowed)
        return found if found is not None and found.cost <= allowed else None

    def enough(self, trial: Trial, winches: int) -> bool:
        """True if the network is good enough."""
        enough = self.proposals.options.enough * self.proposals.graph.size
        return len(trial.layout.sites) >= winches and trial.cost <= enough

    def _try_cables(self, trial: Trial, winches: int, needed: int, *, count: int, best: int) -> list[Trial]:
        """Solve about `count` networks with one cable more and return the `best`; hopeless ones are cut short.

        Marker errors add up over the poses, so those of the first poses bound them from below.
        """
        kept: list[Trial] = []
        layouts = self.proposals.grow_layouts(trial, winches=winches, needed=needed, count=count)
        if not layouts:  # the best paths cannot be built: look at others
            layouts = self.proposals.grow_layouts(trial, winches=winches, needed=needed, count=_FURTHER * count)
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

    def refine_briefly(self, trial: Trial, *, directions: int = 2) -> Trial:
        """Refine a network by a few steps."""
        options = replace(self._options(self.proposals.options.steps), directions=directions)
        return refine(self.bench, self.proposals.graph.region, trial, options)

    def _options(self, steps: int) -> RefineOptions:
        enough = self.proposals.options.enough * self.proposals.graph.size
        return RefineOptions(iterations=steps, enough=enough)


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
    return replace(
        layout,
        sites=tuple(replace(layout.sites[old], twin=order[layout.sites[old].twin]) for old in sites),
        routes=tuple(
            replace(route, winch=sites.index(route.winch), twin=rank[route.twin])
            for route in (layout.routes[old] for old in kept)
        ),
    )


def _words(trial: Trial) -> str:
    layout = trial.layout
    name = layout.sites[layout.routes[-1].winch].winch.name
    return f"cable {len(layout.routes)}, pulled by {name}"


_FURTHER = 4  # times as many paths are looked at where none of the best can be built
_PATIENCE = 2  # so many rounds of cables that do not help end the growth
_HELPS = 0.02  # a cable that lowers the cost by less than this share does not help
_LIKELY = 2  # cables that are refined for each that a network is grown from
_SEEDS = 3  # first cables that are refined for each that a network is grown from
_GLANCE = 5  # steps of inverse kinematics that tell which of several networks is the best
_ROUND = 8  # steps of refinement before the poses are found from rest again
_FAILURES = 2  # rounds that do not hold from rest end the refinement
_IDLE = 0.02  # a round that gains less ends the refinement
_SHALLOW = 0.5  # how much more a network costs whose winches are at the edge
_TURNED = 0.2  # how much more a network costs whose cables turn by 1 rad
_HOLE = 0.003  # a hole without which the cost is larger by less than this share does not earn its stitch
_FEWEST = 2  # points of the bare part of a cable
_NUDGE = 0.005  # limits are felt within this share of the body's size where a hole was left out
_CABLE = 0.02  # a cable whose loss costs less than this share does not earn its place
_MOTOR = 0.04  # nor a winch whose loss does
_WORTH = 0.01  # an exchange must gain so much
