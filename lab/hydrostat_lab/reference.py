"""`REFERENCES`: our method in tasks that others have published curves of (thesis, Fig 5.13)."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from hydrostat.progress import Progress, no_progress
from hydrostat_lab.curriculum import MASTERED
from hydrostat_lab.experiments import Claim, Experiment, Ran, Run, final, speed
from hydrostat_lab.hindsight_ddpg import DdpgOptions, HindsightDdpg
from hydrostat_lab.trials import GymnasiumTrials, robotics_task


@dataclass(frozen=True, kw_only=True)
class Reference:
    """An experiment in an environment of gymnasium-robotics.

    Attributes:
        task: its name, as gymnasium knows it.
        experiment: experiment that is repeated there.
    """

    task: str
    experiment: Experiment


def run_reference(
    reference: Reference, *, seeds: int, epochs: int, progress: Progress = no_progress
) -> Iterator[tuple[str, Ran]]:
    """Learn in the environment of a reference; what went by in centimeters.

    Args:
        reference: experiment, with its task.
        seeds: number of random starts of each run.
        epochs: epochs of each run.
        progress: callback for progress.

    Raises:
        HydrostatError: the environment does not run here.
    """
    for name, run in reference.experiment.runs.items():
        trials = GymnasiumTrials(partial(robotics_task, reference.task, run.horizon), horizon=run.horizon)
        learner = HindsightDdpg(trials, run.options, seeds=seeds, epochs=epochs)
        done = learner.learn(tests=_TESTS, progress=lambda at, of, name=name: progress(name, at, of))
        done = replace(done, distance=_CM * done.distance, tolerance=_CM * done.tolerance)
        yield name, Ran(run=run, epochs=done, best=_CM * learner.test(learner.best, _TESTS))


def none_missed_from(ran: Ran) -> float:
    """Actions from which on no seed missed a test; infinite if some still did at the end."""
    missed = np.flatnonzero((ran.epochs.success < 1.0).any(axis=1))
    return float([*ran.epochs.actions, np.inf][missed[-1] + 1 if len(missed) else 0])


def _experiment(title: str, tolerance: float, claims: tuple[Claim, ...]) -> Experiment:
    """Sparse and shaped rewards, with the settings of Plappert et al. in one worker; epochs are a fifth as long."""
    options = DdpgOptions(tolerance=tolerance, cycles=10, actions=2 * _HORIZON)
    runs = {name: Run(options=replace(options, shaped=name == "shaped"), horizon=_HORIZON) for name in _REWARDS}
    return Experiment(title=title, runs=runs, claims=claims)


def _lead(ran: Mapping[str, Ran]) -> np.ndarray:
    return speed(ran["shaped"]) - speed(ran["sparse"])


def _early(ran: Mapping[str, Ran]) -> np.ndarray:
    """Best success of each seed within as many actions as the authors' code took to succeed always."""
    within = ran["sparse"].epochs.actions <= _PUBLISHED
    return ran["sparse"].epochs.success[within].max(axis=0)


_HORIZON, _TESTS, _CM, _REWARDS = 50, 20, 100.0, ("sparse", "shaped")
"""Actions of an episode, episodes of a test, centimeters of a meter, and the rewards that are compared."""

_PUBLISHED = 4_000
"""Actions after which the authors' code in one worker is told to succeed in all tests of FetchReach: four epochs of
20 episodes (github.com/matthieu637/ddrl/issues/8)."""

REFERENCES: Mapping[str, Reference] = {
    "figure-5.13": Reference(
        task="FetchReach-v4",
        experiment=_experiment(
            "FetchReach: a rigid arm brings its gripper within 5 cm of a point; 3 x 256, T=50",
            0.05,
            (
                Claim(text="sparse ends above 0.9, as published", measure=lambda r: final(r["sparse"]), above=MASTERED),
                Claim(
                    text="sparse is there within 4,000 actions, as the authors' code", measure=_early, above=MASTERED
                ),
                Claim(text="shaped learns faster than sparse (R78)", measure=_lead),
            ),
        ),
    ),
    "figure-5.13-hand": Reference(
        task="HandReach-v3",
        experiment=_experiment(
            "HandReach: a rigid hand with 20 joints brings its fingertips to a goal; 3 x 256, T=50",
            0.01,
            (
                Claim(
                    text="sparse ends better than shaped (R78)",
                    measure=lambda r: final(r["sparse"]) - final(r["shaped"]),
                ),
            ),
        ),
    ),
}
"""By their names for `hydrostat reproduce`."""
