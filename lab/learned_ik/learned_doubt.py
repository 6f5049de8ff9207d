"""What learned networks say of their own doubt: targets that can be reached, cannot, are noisy, or of another mesh.

    python lab/learned_ik/learned_doubt.py examples/cupping_hand build/hand.model build/test --out build/doubt.png
                       [--targets 100] [--finer build/finer_test]

Reachable targets are the markers of samples that nothing was learned from. Noisy ones: the same, each coordinate moved
at random by 2 mm (one deviation). Unreachable ones: moved away from the mean place of its marker by a half of its
distance. Of another mesh: markers of samples of a finer mesh. Answers are rolled out in the simulator from rest.
Columns: mean error in the simulator, mean error that the networks expect, mean doubt, rank correlation of the error
with expected error and doubt together, and the share of markers whose error is below twice these. The picture: means of
tenths of all markers, from those that it is surest of.
"""

import argparse
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip
from scipy.stats import rankdata

import hydrostat as hs
from hydrostat.learning import LearnedModel, Samples
from hydrostat.plot import save_png
from hydrostat_lab.learning_figures import draw_calibration


def kinds_of(markers: np.ndarray, finer: np.ndarray | None) -> dict[str, np.ndarray]:
    """Targets by their kind [m]."""
    draw, middle = np.random.default_rng(0), markers.mean(axis=0)
    kinds = {
        "reachable": markers,
        "noisy": markers + draw.normal(scale=2e-3, size=markers.shape),
        "unreachable": middle + 1.5 * (markers - middle),
    }
    return kinds if finer is None else kinds | {"another mesh": finer}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", type=Path)
    parser.add_argument("model", type=Path)
    parser.add_argument("test", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--targets", type=int, default=100)
    parser.add_argument("--finer", type=Path)
    given = parser.parse_args()
    model, test = LearnedModel.load(given.model), Samples.read(given.test).first(given.targets)
    robot = hs.load_robot(given.robot)
    if model.card.contact and robot.contact is None:
        robot = replace(robot, contact=hs.Contact())
    model.check(robot)
    simulation, names = hs.Simulation(robot), test.facts["markers"]
    finer = None if given.finer is None else Samples.read(given.finer).markers
    print(machine())
    print(f"{robot.name}, {model.card.samples} samples; errors in mm")
    print(f"{'targets':14}{'count':>6}{'found':>9}{'expected':>10}{'doubt':>8}{'rank':>7}{'within':>8}{'lost':>6}")
    curves: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for kind, markers in kinds_of(test.markers, finer).items():
        answers = [model.solve(dict(zip(names, map(tuple, places), strict=True))) for places in markers]
        rows = np.array([answer.contractions for answer in answers])
        reached = simulation.solve_batch(rows, jacobians=False, threads=1).markers
        found = np.linalg.norm(reached.reshape(markers.shape) - markers, axis=-1)
        expected = np.array([list(answer.errors.values()) for answer in answers])
        doubt = np.array([list(answer.spread.values()) for answer in answers])
        good = np.isfinite(found).all(axis=1)
        found, said = found[good].ravel(), (expected + doubt)[good].ravel()
        curves[kind] = said, found
        rank = np.corrcoef(rankdata(said), rankdata(found))[0, 1]
        means = f"{1e3 * found.mean():9.3f}{1e3 * expected[good].mean():10.3f}{1e3 * doubt[good].mean():8.3f}"
        lost = int((~good).sum())
        print(f"{kind:14}{len(markers):6}{means}{rank:7.2f}{np.mean(found < 2 * said):8.0%}{lost:6}", flush=True)
    print(f"Wrote {save_png(draw_calibration(curves), given.out)}")


if __name__ == "__main__":
    main()
