"""The thesis's network on as many samples as the thesis had, drawn from networks that have learned the body.

    python lab/learned_ik/learned_thesis.py examples/cupping_hand build/hand.model build/train build/test

A hundred thousand poses of the hand would take three hours of a core. Networks of ten thousand know where its markers
go within 0.1 mm, and the thesis's network leaves thirty times as much; so its samples are drawn from them, box by box,
and its answers are rolled out in the simulator, for the markers of samples that nothing was learned from. The first
row has the simulator's own samples, to tell what that changes. Errors in mm.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.learning import LearnedModel, Samples
from hydrostat_lab.thesis_network import train_thesis_network


def drawn(model: LearnedModel, like: Samples, count: int) -> Samples:
    """So many samples, evenly drawn, whose markers are where the networks expect them."""
    share = np.random.default_rng(0).uniform(size=(count, len(model.low)))
    rows = model.low + share * (model.high - model.low)
    markers = np.array([model.predict(row)[0][: like.markers[0].size] for row in rows])
    return replace(like, contractions=rows, markers=markers.reshape(count, *like.markers.shape[1:]))


def left(simulation: hs.Simulation, train: Samples, test: Samples) -> tuple[np.ndarray, float]:
    """What the network's answers leave of the markers of other samples [mm], and the CPU time of learning [s]."""
    began = time.process_time()
    network = train_thesis_network(train)
    seconds = time.process_time() - began
    answers = network.answers(test.markers.reshape(len(test), -1))
    found = [simulation.solve(answer).markers for answer in answers]
    places = np.array([[pose[name] for name in test.facts["markers"]] for pose in found])
    return 1e3 * np.linalg.norm(places - test.markers, axis=-1), seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", type=Path)
    parser.add_argument("model", type=Path)
    parser.add_argument("train", type=Path)
    parser.add_argument("test", type=Path)
    parser.add_argument("--counts", default="10000,100000")
    parser.add_argument("--targets", type=int, default=200)
    given = parser.parse_args()
    model, train = LearnedModel.load(given.model), Samples.read(given.train)
    test, counts = Samples.read(given.test).first(given.targets), [int(count) for count in given.counts.split(",")]
    robot = hs.load_robot(given.robot)
    simulation = hs.Simulation(replace(robot, contact=robot.contact or hs.Contact()))
    print(machine())
    print(f"{robot.name}, {len(test)} targets; errors in mm, and in % of the size")
    print(f"{'samples':>8} {'of':12}{'mean':>8}{'%':>8}{'median':>8}{'p90':>8}{'p99':>8}{'max':>8}{'CPU s':>8}")
    ways = [("simulator", train.first(min(len(train), counts[0])))]
    for source, some in [*ways, *(("networks", drawn(model, train, count)) for count in counts)]:
        errors, seconds = left(simulation, some, test)
        quantiles = "".join(f"{np.quantile(errors, share):8.3f}" for share in (0.5, 0.9, 0.99, 1.0))
        share = 0.1 * errors.mean() / model.card.size
        print(f"{len(some):8} {source:12}{errors.mean():8.3f}{share:8.3f}{quantiles}{seconds:8.0f}", flush=True)


if __name__ == "__main__":
    main()
