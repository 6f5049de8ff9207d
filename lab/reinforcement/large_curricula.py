"""Print Fig 5.9 in the networks of the thesis, 3 x 256, in a quarter of the time of `hydrostat reproduce figure-5.9`.

    python lab/reinforcement/large_curricula.py build/hand.model --epochs 20 --more 6

The four curricula are one and the same run until a seed masters the first tolerance. This script learns that run once,
then goes on `--more` epochs with each, as `hydrostat reproduce` does from the start (a test holds both equal).
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

from hydrostat.learning import LearnedModel
from hydrostat_lab.curriculum import Curriculum
from hydrostat_lab.experiments import EXPERIMENTS, Ran, error, final, least
from hydrostat_lab.hindsight_ddpg import HindsightDdpg
from hydrostat_lab.run_experiment import finger_pairs
from hydrostat_lab.trial_tables import format_interval, judged_claims
from hydrostat_lab.trials import NetworkReach
from hydrostat_lab.verdict import interquartile

TESTS = 300
"""Goals that the best policies are tried on."""


def main() -> None:
    """Print the runs and their verdicts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=Path, help="networks of the hand, from hydrostat learn or hydrostat reproduce")
    parser.add_argument("--figure", choices=("figure-5.9", "figure-5.9-small"), default="figure-5.9")
    parser.add_argument("--epochs", type=int, default=20, help="most epochs of 500 actions to the first mastery")
    parser.add_argument("--more", type=int, default=6, help="epochs after it")
    parser.add_argument("--seeds", type=int, default=3)
    asked = parser.parse_args()
    model, experiment = LearnedModel.load(asked.model), EXPERIMENTS[asked.figure]
    runs = list(experiment.runs.items())
    trials = NetworkReach(model, groups=finger_pairs(model), horizon=runs[0][1].horizon)
    fixed = replace(runs[0][1].options, curriculum=Curriculum.FIXED)
    print(f"{model.card.robot}, networks of {model.card.samples} equilibria, {asked.seeds} seeds: {experiment.title}")
    first = HindsightDdpg(trials, fixed, seeds=asked.seeds, epochs=asked.epochs)
    first.learn_first(progress=lambda done, _: _report("first tolerance", first, done))
    ran: dict[str, Ran] = {}
    for name, run in runs if first.has_mastered else runs[:1]:
        learner = first.branch(run.options, more=asked.more if first.has_mastered else 0)
        epochs = learner.learn(progress=lambda done, _, name=name, learner=learner: _report(name, learner, done))
        ran[name] = Ran(run=run, epochs=epochs, best=learner.test(learner.best, TESTS))
        numbers = (final(ran[name]), 10 * epochs.tolerance[-1], 10 * least(ran[name]), 10 * error(ran[name]))
        words = ("success", "at [mm]", "mastered [mm]", "last action [mm]")
        print(name, *(f"{word} {format_interval(interquartile(n), 2)}" for word, n in zip(words, numbers, strict=True)))
    if first.has_mastered:
        judged_claims(experiment, ran)


def _report(name: str, learner: HindsightDdpg, done: int) -> None:
    """Print an epoch: successes, tolerances and distances of the seeds, and the CPU time so far."""
    _, success, distance, tolerance = learner.latest
    columns = ("/".join(f"{number:.2f}" for number in row) for row in (success, 10 * tolerance, 10 * distance))
    print(f"{name:18}{done:4}", *(f"{column:24}" for column in columns), f"{time.process_time():6.0f} s", flush=True)


if __name__ == "__main__":
    main()
