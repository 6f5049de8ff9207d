"""Networks of a coarse mesh on a finer one, and what a few samples of the finer one mend.

    hydrostat sample FINE --count 60 --contact --seed 9 --out build/test
    hydrostat sample FINE --count 100 --contact --seed 3 --out build/train
    python lab/learned_ik/learned_finer.py FINE build/hand.model build/train build/test [--counts 10,30,100] [--roll 15]
                       [--coarse examples/cupping_hand --orders 8]

FINE is the folder of the same robot with smaller elements. The model is corrected by so many of the first samples.
Known: how far markers are from where the networks expect them, at the contractions of samples that nothing was learned
from. Rolled: answers for the first markers of these, solved on the fine body from rest; how far they miss. Errors in
mm, and in % of the body's size. Coarse: how far the coarse body's markers are from the fine ones at equal contractions,
from rest; and of all equilibria that the coarse body has there, found from rest and by winches taken in one after
another in so many random orders, the nearest. If bodies differed by their branch, the nearest would be much nearer.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.learning import LearnedModel, Samples, correct_model
from hydrostat_lab.compare import targets_of


def known(model: LearnedModel, test: Samples) -> np.ndarray:
    """How far markers are from where they are expected [m]."""
    expected = np.array([model.predict(taken)[0][: test.markers[0].size] for taken in test.contractions])
    return np.linalg.norm(expected.reshape(test.markers.shape) - test.markers, axis=-1)


def rolled(model: LearnedModel, test: Samples, simulation: hs.Simulation) -> np.ndarray:
    """How far markers are from their targets in the simulator [m], at what the model answers."""
    rows = np.array([model.solve(target).contractions for target in targets_of(test)])
    found = simulation.solve_batch(rows, jacobians=False, threads=1).markers
    return np.linalg.norm(found.reshape(test.markers.shape) - test.markers, axis=-1)


def equilibria(simulation: hs.Simulation, taken: np.ndarray, orders: int) -> np.ndarray:
    """Markers of a body at given contractions, by several ways there, (ways, markers, dim); the first from rest."""
    draw, found = np.random.default_rng(0), [simulation.solve(taken.tolist(), strict=False)]
    for _ in range(orders):
        pose, order = None, draw.permutation(len(taken))
        for part in np.array_split(order, _LEGS):
            on_the_way = np.zeros(len(taken)) if pose is None else np.array(pose.contractions)
            on_the_way[part] = taken[part]
            pose = simulation.solve(on_the_way.tolist(), start=pose, strict=False)
        found.append(pose)
    good = [pose for pose in found if pose.result.converged]
    return np.array([list(pose.markers.values()) for pose in good])


def told(missed: np.ndarray, size: float) -> str:
    """Mean, its share of the size, median and the largest."""
    good = 1e3 * missed[np.isfinite(missed)]
    lost = f" {int(np.isnan(missed).any(axis=1).sum())} lost" if np.isnan(missed).any() else ""
    return f"{good.mean():9.3f}{good.mean() / size / 10:8.3f}{np.median(good):9.3f}{good.max():9.3f}{lost}"


def main() -> None:
    """Print errors before and after correction."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("robot", "model", "train", "test"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--counts", default="10,30,100")
    parser.add_argument("--roll", type=int, default=0)
    parser.add_argument("--coarse", type=Path)
    parser.add_argument("--orders", type=int, default=8)
    given = parser.parse_args()
    robot, model = hs.load_robot(given.robot), LearnedModel.load(given.model)
    if model.card.contact and robot.contact is None:
        robot = replace(robot, contact=hs.Contact())
    train, test, size = Samples.read(given.train), Samples.read(given.test), robot.body.mesh.size
    print(machine())
    coarse = f"networks of {model.card.samples} samples of a coarse mesh"
    print(f"{robot.name}, {len(robot.body.mesh.nodes)} nodes; {coarse}")
    print(f"{'corrected by':>12}{'known':>9}{'%':>8}{'median':>9}{'max':>9}{'CPU s':>8}   of {len(test)} samples")
    models, counts = {0: model}, [int(count) for count in given.counts.split(",")]
    for count in (0, *counts):
        began = time.process_time()
        if count:
            models[count] = correct_model(model, train.first(count))
        seconds = time.process_time() - began
        print(f"{count:12}{told(known(models[count], test), size)}{seconds:8.1f}", flush=True)
    if given.roll:
        simulation, few = hs.Simulation(robot), test.first(given.roll)
        print(f"{'corrected by':>12}{'rolled':>9}{'%':>8}{'median':>9}{'max':>9}   of {given.roll} targets")
        for count in (0, counts[-1]):
            print(f"{count:12}{told(rolled(models[count], few, simulation), size)}", flush=True)
    if given.coarse:
        branches(given.coarse, test, given.orders, size)


def branches(folder: Path, test: Samples, orders: int, size: float) -> None:
    """Print whether other equilibria of the coarse body are nearer to those of the fine one."""
    coarse = hs.load_robot(folder)
    coarse = coarse if coarse.contact is not None else replace(coarse, contact=hs.Contact())
    simulation, rest, nearest, several = hs.Simulation(coarse), [], [], 0
    for taken, markers in zip(test.contractions, test.markers, strict=True):
        found = equilibria(simulation, taken, orders)
        far = np.linalg.norm(found - markers, axis=-1)
        rest.append(far[0])
        nearest.append(far[far.mean(axis=1).argmin()])
        several += bool(np.linalg.norm(found - found[0], axis=-1).max() > _ELSEWHERE)
    print(f"{'coarse':>12}{'':9}{'%':>8}{'median':>9}{'max':>9}   of {len(test)}, {several} with other equilibria")
    print(f"{'from rest':>12}{told(np.array(rest), size)}")
    print(f"{'nearest':>12}{told(np.array(nearest), size)}")


_LEGS, _ELSEWHERE = 4, 1e-3
"""Parts in which winches are taken in one after another, and how far a marker is in another equilibrium [m]."""


if __name__ == "__main__":
    main()
