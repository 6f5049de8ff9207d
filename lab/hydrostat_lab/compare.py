"""`compare`: ways to learn, on the same samples, rolled out in the simulator on the same targets."""

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from hydrostat.arrays import Float
from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.learning import LearnedModel, LearnOptions, Samples, exact_steps, learn_model
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat_lab.others import OTHERS
from hydrostat_lab.thesis_network import Answers, train_thesis_network

Distances = Float[np.ndarray, "targets markers"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Compared:
    """Distances between markers and targets for one learning method.

    Attributes:
        method: its name, one of `METHODS`.
        samples: number of samples that it learned from.
        distances: distance of each marker from its target in the simulator [m]; NaN where there is no equilibrium.
        seconds: CPU time of learning in this process [s].
        contractions: contractions of its answers [m]; of the result of a step, if one was taken.
        facts: more that is known of it.
        curve: learning curve, as in `ThesisNetwork`; for the thesis's network alone.
        doubts: expected error of each marker and disagreement of the networks, together [m]; of the search.
    """

    method: str
    samples: int
    distances: Distances
    seconds: float
    contractions: Answers
    facts: Mapping[str, float] = field(default_factory=dict)
    curve: Float[np.ndarray, "epochs 2"] | None = None
    doubts: Distances | None = None

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
        simulation: simulation of the sampled robot, with contact if the samples know it.
        train: to learn from.
        test: samples with the markers that are the targets; nothing is learned from them.
        methods: learning methods, of `METHODS`; "..., step" is the same and one exact step, "..., steps" up to three.
        options: options of our networks; its seed is that of the thesis's network too.

    Raises:
        InputError: a way that there is not.
    """
    for name in methods:
        if name not in METHODS:
            raise InputError(f'unknown method "{name}". Available: {", ".join(METHODS)}.')
    asked = {way_of(name) for name in methods}
    for found in _fit_models(train, test, asked, options or LearnOptions()):
        yield from _roll_out(simulation, test, found, set(methods))


def way_of(method: str) -> str:
    """The way to learn of a method, without the steps that it may take after."""
    return method.removesuffix(STEPS).removesuffix(STEP)


def targets_of(samples: Samples) -> list[dict[str, Point]]:
    """Places of the markers by name [m]."""
    names = samples.facts["markers"]
    return [dict(zip(names, (tuple(place) for place in places.tolist()), strict=True)) for places in samples.markers]


def _fit_models(train: Samples, test: Samples, asked: set[str], options: LearnOptions) -> Iterator[Compared]:
    """Compute the answers of each method; not rolled out."""
    goals, none = test.markers.reshape(len(test), -1), np.full(test.markers.shape[:2], np.nan)

    def told(method: str, answers: Answers, seconds: float, **more: object) -> Compared:
        one = Compared(method=method, samples=len(train), distances=none, seconds=seconds, contractions=answers)
        return replace(one, **more)  # pyright: ignore[reportArgumentType]

    for name in (name for name in OTHERS if name in asked):
        began = time.process_time()
        yield told(name, OTHERS[name](train, goals), time.process_time() - began)
    if "thesis" in asked:
        began = time.process_time()
        network = train_thesis_network(train, seed=options.seed)
        yield told("thesis", network.answers(goals), time.process_time() - began, curve=network.curve)
    if "values" in asked:
        model = learn_model(train, options=replace(options, jacobians=0.0))
        yield told("values", _search_answers(model, test)[0], model.card.seconds)
    if asked & set(OURS):
        model = learn_model(train, options=options)
        seconds = model.card.seconds
        if "inverse" in asked and model.inverse is not None:
            model.predict_inverse(goals[0])
            began = time.process_time()
            answers = np.array([model.predict_inverse(goal) for goal in goals])
            each = 1e6 * (time.process_time() - began) / len(test)
            yield told("inverse", answers, seconds, facts={"microseconds": each})
        if "search" in asked:
            answers, doubts, facts = _search_answers(model, test)
            yield told("search", answers, seconds, facts=facts, doubts=doubts)


def _search_answers(model: LearnedModel, test: Samples) -> tuple[Answers, Distances, dict[str, float]]:
    """Answers of the search on the networks, what they doubt, and means of what they expect and of their time."""
    targets = targets_of(test)
    model.solve(targets[0])
    began = time.process_time()
    answers = [model.solve(target) for target in targets]
    each = 1e6 * (time.process_time() - began) / len(test)
    expected = np.array([list(answer.errors.values()) for answer in answers])
    spread = np.array([list(answer.spread.values()) for answer in answers])
    facts = {"microseconds": each, "expected": float(expected.mean()), "doubt": float(spread.mean())}
    return np.array([answer.contractions for answer in answers]), expected + spread, facts


def _roll_out(simulation: Simulation, test: Samples, found: Compared, methods: set[str]) -> Iterator[Compared]:
    """Return the answers that the simulator checks: from rest, and after one exact step for each target."""
    poses = list[Equilibrium]()
    for row in found.contractions:
        same = poses and np.array_equal(row, poses[-1].contractions)
        poses.append(poses[-1] if same else simulation.solve(row, strict=False).without_factors())
    if found.method in methods:
        rolled, facts = _distances(poses, test), dict(found.facts)
        if found.doubts is not None:
            facts["within"] = float(np.mean(rolled < 2 * found.doubts))
        yield replace(found, distances=rolled, facts=facts)
    for ending, most, enough in ((STEP, 1, 0.0), (STEPS, _MOST, _ENOUGH)):
        if found.method + ending not in methods:
            continue
        began = time.process_time()
        stepped = [
            exact_steps(simulation, pose, goal, most, enough=enough)
            for pose, goal in zip(poses, targets_of(test), strict=True)
        ]
        each = 1e3 * (time.process_time() - began) / len(test)
        yield Compared(
            method=found.method + ending,
            samples=found.samples,
            distances=_distances([pose for pose, _ in stepped], test),
            seconds=found.seconds,
            contractions=np.array([pose.contractions for pose, _ in stepped]),
            facts={"milliseconds": each, "steps": float(np.mean([taken for _, taken in stepped]))},
        )


def _distances(poses: Sequence[Equilibrium], test: Samples) -> Distances:
    """Return the distances of markers from their positions in samples [m]; NaN without an equilibrium."""
    names = test.facts["markers"]
    rows = [
        np.linalg.norm(np.array([pose.markers[name] for name in names]) - places, axis=1)
        if pose.result.converged
        else np.full(len(names), np.nan)
        for pose, places in zip(poses, test.markers, strict=True)
    ]
    return np.array(rows)


STEP, STEPS = ", step", ", steps"
"""Endings of the names of methods after which one exact step is taken, or a few."""

OURS = ("inverse", "search")

WAYS = (*OTHERS, "thesis", "values", *OURS)
"""Ways to learn, by their names in tables: others', networks without slopes, ours."""

METHODS = (*(name for way in WAYS for name in (way, way + STEP)), "search, steps")
"""The same, each with one exact step, and ours with up to three, as long as more than 0.01 mm is left."""

_MOST, _ENOUGH = 3, 1e-5
"""Most steps, and mean error [m] that is enough."""
