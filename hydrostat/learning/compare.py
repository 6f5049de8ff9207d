"""`compare`: ways to learn, on the same samples, rolled out in the simulator on the same targets."""

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from hydrostat.errors import InputError
from hydrostat.learning.certify import certify
from hydrostat.learning.learn_model import learn_model
from hydrostat.learning.learn_options import LearnOptions
from hydrostat.learning.learned_model import LearnedModel
from hydrostat.learning.learned_pose import LearnedPose
from hydrostat.learning.others import OTHERS
from hydrostat.learning.samples import Samples
from hydrostat.robot import Point
from hydrostat.simulation import Simulation

Distances = Float[np.ndarray, "targets markers"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Compared:
    """How far one way to learn leaves the markers from their targets.

    Attributes:
        method: its name, one of `METHODS`.
        samples: how many it learned from.
        distances: of each marker from its target in the simulator [m]; NaN where there is no equilibrium.
        seconds: of learning, CPU time of this process.
        facts: more that is known of it.
    """

    method: str
    samples: int
    distances: Distances
    seconds: float
    facts: Mapping[str, float] = field(default_factory=dict)

    @property
    def lost(self) -> int:
        """Targets for which there is no equilibrium."""
        return int(np.isnan(self.distances).any(axis=1).sum())

    @property
    def found(self) -> Distances:
        """Distances of the targets for which there is one [m]."""
        return self.distances[~np.isnan(self.distances).any(axis=1)]


def compare(
    simulation: Simulation,
    train: Samples,
    test: Samples,
    methods: Sequence[str],
    *,
    options: LearnOptions | None = None,
) -> Iterator[Compared]:
    """Learn from samples in several ways, ask each for the places of the markers in others, and roll its answers out.

    Args:
        simulation: of the robot that was sampled, with contact if the samples know it.
        train: to learn from.
        test: whose markers are the targets; nothing is learned from them.
        methods: which ways, of `METHODS`.
        options: of our networks.

    Raises:
        InputError: a way that there is not.
    """
    for name in methods:
        if name not in METHODS:
            raise InputError(f"there is no way to learn called {name!r}; there are: {', '.join(METHODS)}")
    goals = test.markers.reshape(len(test), -1)
    for name in (name for name in OTHERS if name in methods):
        began = time.process_time()
        answers = OTHERS[name](train, goals)
        seconds = time.process_time() - began
        yield Compared(method=name, samples=len(train), distances=_rolled(simulation, test, answers), seconds=seconds)
    chosen = options or LearnOptions()
    if "values" in methods:
        model = learn_model(train, options=replace(chosen, slopes=0.0))
        rows = np.array([model.solve(target).contractions for target in targets_of(test)])
        seconds = model.facts["seconds"]
        yield Compared(method="values", samples=len(train), distances=_rolled(simulation, test, rows), seconds=seconds)
    if set(methods) & set(OURS):
        model = learn_model(train, options=chosen)
        if "inverse" in methods and model.inverse is not None:
            yield _inverse(simulation, model, test)
        if {"search", "search, step"} & set(methods):
            yield from (one for one in _searches(simulation, model, test) if one.method in methods)


def targets_of(samples: Samples) -> list[dict[str, Point]]:
    """Places of the markers by name [m]."""
    names = samples.facts["markers"]
    return [dict(zip(names, (tuple(place) for place in places.tolist()), strict=True)) for places in samples.markers]


def _inverse(simulation: Simulation, model: LearnedModel, test: Samples) -> Compared:
    """The inverse network alone."""
    model.inverted(test.markers[0].ravel())
    began = time.process_time()
    rows = np.array([model.inverted(places.ravel()) for places in test.markers])
    facts = {"microseconds": 1e6 * (time.process_time() - began) / len(test)}
    rolled, seconds = _rolled(simulation, test, rows), model.facts["seconds"]
    return Compared(method="inverse", samples=model.facts["samples"], distances=rolled, seconds=seconds, facts=facts)


def _searches(simulation: Simulation, model: LearnedModel, test: Samples) -> Iterator[Compared]:
    """The search on the networks, and one exact step from there."""
    targets, seconds, count = targets_of(test), model.facts["seconds"], model.facts["samples"]
    model.solve(targets[0])
    began = time.process_time()
    answers = [model.solve(target) for target in targets]
    each = 1e6 * (time.process_time() - began) / len(test)
    once: list[np.ndarray] = []
    stepped: list[np.ndarray] = []
    for answer in answers:
        whole = certify(simulation, model, answer)
        once.append(_certified(whole))
        stepped.append(_certified(certify(simulation, model, whole, steps=1)))
    expected = np.array([list(answer.errors.values()) for answer in answers])
    doubts = np.array([list(answer.spread.values()) for answer in answers])
    within = np.mean(np.array(once) < 2 * (doubts + expected))
    facts = {"microseconds": each, "expected": float(expected.mean()), "doubt": float(doubts.mean())}
    facts |= {"within": float(within)}
    yield Compared(method="search", samples=count, distances=np.array(once), seconds=seconds, facts=facts)
    yield Compared(method="search, step", samples=count, distances=np.array(stepped), seconds=seconds)


def _certified(answer: LearnedPose) -> np.ndarray:
    """Errors of the markers; NaN where there is no equilibrium."""
    some = np.full(len(answer.errors), np.nan)
    return some if answer.certified is None else np.array([answer.certified[name] for name in answer.errors])


def _rolled(simulation: Simulation, test: Samples, answers: np.ndarray) -> Distances:
    """Distances of the markers from their targets at contractions, from rest [m]."""
    same = (answers == answers[0]).all()
    found = simulation.solve_many(answers[:1] if same else answers, jacobians=False, threads=1).markers
    return np.linalg.norm(found.reshape(-1, *test.markers.shape[1:]) - test.markers, axis=-1)


OURS = ("inverse", "search", "search, step")

METHODS = (*OTHERS, "values", *OURS)
"""Ways to learn, by their names in tables: others', networks without slopes, ours."""
