"""How long a learned answer takes: by the inverse network alone, with what all networks say of it, and by their search.

    python lab/learned_ik/learned_speed.py build/hand.model build/test [--targets 1000] [--rounds 5]

Targets are the places of all markers in samples. CPU time of this process, one thread, mean over all targets and rounds
after one that is not counted. Rows: `model.predict_inverse(markers)`, which gives contractions only;
`model.solve(targets, search=False)`, which also gives the error that the networks predict and their doubt for each
marker; `model.solve(targets)`.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path

from machine import machine

from hydrostat.learning import LearnedModel, Samples
from hydrostat_lab.compare import targets_of


def microseconds(answer: Callable, asked: list, rounds: int) -> float:
    """CPU time of one answer [us]."""
    for one in asked:
        answer(one)
    began = time.process_time()
    for _ in range(rounds):
        for one in asked:
            answer(one)
    return 1e6 * (time.process_time() - began) / (rounds * len(asked))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=Path)
    parser.add_argument("test", type=Path)
    parser.add_argument("--targets", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    model, test = LearnedModel.load(given.model), Samples.read(given.test).first(given.targets)
    targets, markers = targets_of(test), list(test.markers.reshape(len(test), -1))
    print(machine())
    words = f"{len(model.forward)} networks; {len(test)} targets, {given.rounds} rounds"
    print(f"{model.card.robot}, {words}; CPU us a target")
    for name, answer, asked in (
        ("inverse network alone", model.predict_inverse, markers),
        ("with predicted error and doubt", lambda target: model.solve(target, search=False), targets),
        ("search on the networks", model.solve, targets),
    ):
        print(f"{name:32}{microseconds(answer, asked, given.rounds):7.0f}", flush=True)


if __name__ == "__main__":
    main()
