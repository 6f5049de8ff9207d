"""What slopes of tensions teach: networks that mind them more or less, on samples that nothing was learned from.

    hydrostat sample examples/cupping_hand --contact --seed 5 --count 768 --out build/sloped
    python lab/learned_ik/learned_tensions.py build/sloped [--counts 100,300,560] [--steps 2000] [--seeds 2]

The last 200 samples are held out. Columns: samples learned from, weight of the slopes of tensions in the loss, mean and
99 % quantile of the error of markers, root mean square error of tensions and of their slopes, means over the seeds.
"""

import argparse
from dataclasses import replace
from pathlib import Path

from machine import machine

from hydrostat.progress import no_progress

import numpy as np  # isort: skip

from hydrostat.learning import LearnOptions, Samples, TrainingSet, train_forward

HELD_OUT = 200


def errors(known: Samples, new: Samples, options: LearnOptions) -> tuple[float, float, float, float]:
    """Of markers [mm], mean and p99; of tensions [N]; of their slopes [N/m]."""
    training_set = TrainingSet.of_samples(known)
    networks = train_forward(training_set, known.facts["dim"], options, no_progress).networks
    low, high = known.limits
    answers = [networks.evaluate(row) for row in 2 * (new.contractions - low) / (high - low) - 1]
    values = np.array([value for value, _ in answers]) * training_set.unit + training_set.middle
    slopes = np.array([slope for _, slope in answers]) * training_set.unit[:, None] / (0.5 * (high - low))
    markers, tensions = np.split(values, [training_set.coordinates], axis=1)
    missed = 1e3 * np.linalg.norm(markers.reshape(new.markers.shape) - new.markers, axis=-1)
    assert new.tension_jacobians is not None
    return (
        float(missed.mean()),
        float(np.quantile(missed, 0.99)),
        float(np.sqrt(np.square(tensions - new.tensions).mean())),
        float(np.sqrt(np.square(slopes[:, training_set.coordinates :] - new.tension_jacobians).mean())),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("samples", type=Path)
    parser.add_argument("--counts", default="100,300,560")
    parser.add_argument("--weights", default="0,0.01,0.1,1")
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--seeds", type=int, default=2)
    given = parser.parse_args()
    samples = Samples.read(given.samples)
    if samples.tension_jacobians is None:
        parser.error(f"{given.samples}: an earlier version sampled no slopes of tensions; sample again")
    new = samples.only(np.arange(len(samples) - HELD_OUT, len(samples)))
    options = LearnOptions(members=1, steps=given.steps)
    print(machine())
    print(f"{len(new)} samples held out: tensions {new.tensions.std():.2f} N about their mean")
    print(f"{'samples':>7}{'weight':>8}{'mm':>9}{'p99':>9}{'N':>9}{'N/m':>9}")
    for count in map(int, given.counts.split(",")):
        for weight in map(float, given.weights.split(",")):
            rows = [
                errors(samples.first(count), new, replace(options, tension_jacobians=weight, seed=seed))
                for seed in range(given.seeds)
            ]
            print(f"{count:7}{weight:8g}" + "".join(f"{value:9.3f}" for value in np.mean(rows, axis=0)), flush=True)


if __name__ == "__main__":
    main()
