"""Learned inverse kinematics, rolled out in the simulator: ours, its parts, and what others do with the same samples.

    hydrostat sample examples/cupping_hand --contact --count 3000 --out build/train
    hydrostat sample examples/cupping_hand --contact --count 320 --seed 1 --out build/test
    python benchmarks/learned_ik.py examples/cupping_hand build/train build/test [--counts 300,1000,3000]
                                    [--targets 300] [--methods ridge,ours] [--keep results.jsonl]

Targets are the markers of samples that nothing was learned from. Each method gives contractions; the simulator takes
them in from rest, with contact if the samples have it, and the error is the distance of each marker from its target.
Where there is no equilibrium the target counts with the error of the constant answer, and is counted. CPU time is that
of this process. With --keep, rows are added to a file as they are found, and those that are there are not found again.
"""

import argparse
import json
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.learning import LearnedModel, LearnOptions, Samples, certify, learn_model, read_samples
from hydrostat.learning.certify import bounded_step
from hydrostat.learning.lesson import linear_map

Answers = np.ndarray  # contractions [m], a row for each target
Row = dict[str, object]


def constant(train: Samples, goals: np.ndarray) -> Answers:
    """The mean contractions, whatever is asked."""
    return np.tile(train.contractions.mean(axis=0), (len(goals), 1))


def nearest(train: Samples, goals: np.ndarray) -> Answers:
    """Those of the sample whose markers are nearest."""
    return train.contractions[_nearest(train, goals)]


def nearest_with_slopes(train: Samples, goals: np.ndarray) -> Answers:
    """The same, and one bounded Gauss-Newton step by its Jacobian."""
    low, high = limits(train)
    rows = []
    for goal, place in zip(goals, _nearest(train, goals), strict=True):
        begun, markers = train.contractions[place], train.markers[place].ravel()
        slopes = train.jacobians[place].reshape(len(goal), -1)
        rows.append(begun + bounded_step(slopes, markers - goal, low - begun, high - begun))
    return np.array(rows)


def ridge(train: Samples, goals: np.ndarray) -> Answers:
    """Ridge regression from markers to contractions."""
    linear = linear_map(train.markers.reshape(len(train), -1) / train.facts["size"], train.contractions)
    rows = np.hstack([goals / train.facts["size"], np.ones((len(goals), 1))])
    return np.clip(rows @ linear, *limits(train))


def thesis(train: Samples, goals: np.ndarray) -> Answers:
    """The thesis's network: four layers of 30, ReLU, tanh at the end, raw centimetres, squares of the action (R66).

    Adam with rate 0.001, batches of 20, 300 epochs, the weights that were best on a tenth of the samples.
    """
    import torch

    torch.manual_seed(0)
    torch.set_num_threads(1)
    low, high = limits(train)
    inputs = torch.tensor(100 * train.markers.reshape(len(train), -1), dtype=torch.float32)
    actions = torch.tensor(2 * (train.contractions - low) / (high - low) - 1, dtype=torch.float32)
    sizes = [inputs.shape[1], 30, 30, 30, 30, actions.shape[1]]
    layers: list[torch.nn.Module] = []
    for one, two in pairwise(sizes):
        layers += [torch.nn.Linear(one, two), torch.nn.ReLU()]
    network = torch.nn.Sequential(*layers[:-1], torch.nn.Tanh())
    optimiser, kept = torch.optim.Adam(network.parameters(), lr=1e-3), len(inputs) - len(inputs) // 10
    order, best, least = torch.randperm(len(inputs)), network.state_dict(), float("inf")
    learned, held = order[:kept], order[kept:]
    for _ in range(300):
        for rows in learned[torch.randperm(kept)].split(20):
            optimiser.zero_grad(set_to_none=True)
            (network(inputs[rows]) - actions[rows]).square().mean().backward()
            optimiser.step()
        with torch.no_grad():
            loss = float((network(inputs[held]) - actions[held]).square().mean())
        if loss < least:
            best, least = {name: part.clone() for name, part in network.state_dict().items()}, loss
    network.load_state_dict(best)
    with torch.no_grad():
        found = network(torch.tensor(100 * goals, dtype=torch.float32)).double().numpy()
    return low + 0.5 * (found + 1) * (high - low)


def limits(train: Samples) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest contractions [m]."""
    return -np.array(train.facts["release"], dtype=float), np.array(train.facts["travel"], dtype=float)


def _nearest(train: Samples, goals: np.ndarray) -> np.ndarray:
    known = train.markers.reshape(len(train), -1)
    return np.array([np.square(known - goal).sum(axis=1).argmin() for goal in goals])


OTHERS: dict[str, Callable[[Samples, np.ndarray], Answers]] = {
    "constant": constant,
    "1-NN": nearest,
    "1-NN, Jacobian": nearest_with_slopes,
    "ridge": ridge,
    "thesis": thesis,
}
OURS = ("values", "inverse", "ours", "ours, step")


class Bench:
    """Targets, and the simulator in which answers are rolled out."""

    def __init__(self, robot: hs.Robot, test: Samples, targets: int, file: Path | None) -> None:
        """The robot, samples to take targets from, how many, and where rows are kept."""
        if test.facts["contact"] and robot.contact is None:
            robot = replace(robot, contact=hs.Contact())
        self.test, self.file = test.first(targets), file
        self.goals = self.test.markers.reshape(targets, -1)
        self.simulation = hs.Simulation(robot)
        self.rows = [json.loads(line) for line in file.read_text().splitlines()] if file and file.exists() else []
        self.worst = np.zeros(0)

    def poses(self) -> list[dict[str, np.ndarray]]:
        """Targets by marker."""
        return [dict(zip(self.test.facts["markers"], places, strict=True)) for places in self.test.markers]

    def distances(self, markers: np.ndarray) -> np.ndarray:
        """Of each marker from its target [m], NaN where there is no equilibrium."""
        return np.linalg.norm(markers.reshape(self.test.markers.shape) - self.test.markers, axis=-1)

    def rolled_out(self, answers: Answers) -> np.ndarray:
        """Errors of contractions [m]."""
        return self.distances(self.simulation.solve_many(answers, jacobians=False, threads=1).markers)

    def rolled_out_once(self, answer: np.ndarray) -> np.ndarray:
        """Coordinates of the markers at some contractions [m]."""
        return np.concatenate(list(self.simulation.solve(answer).markers.values()))

    def has(self, key: Row) -> bool:
        """Whether a row is known already."""
        return any(key.items() <= row.items() for row in self.rows)

    def add(self, key: Row, errors: np.ndarray, seconds: float, **more: object) -> None:
        """Keep a row, and print it."""
        lost = np.isnan(errors).any(axis=1)
        if key["method"] == "constant":
            self.worst = errors
        filled = np.where(lost[:, None], self.worst if len(self.worst) else np.nanmax(errors), errors)
        found = 1e3 * filled.ravel()
        numbers = {name: float(np.quantile(found, share)) for name, share in QUANTILES.items()}
        row = key | {"mean": float(found.mean())} | numbers | {"lost": int(lost.sum()), "seconds": seconds} | more
        self.rows.append(row)
        print(line(row, self.test.facts["size"]), flush=True)
        if self.file is not None:
            with self.file.open("a") as stream:
                stream.write(json.dumps(row) + "\n")


QUANTILES = {"median": 0.5, "p90": 0.9, "p99": 0.99, "max": 1.0}
MORE = ("expected", "rank", "within", "solve_us", "inverse_us")
HEAD = (
    f"{'samples':>7}  {'method':16}{'mean':>8}{'%':>8}" + "".join(f"{name:>8}" for name in QUANTILES) + "  lost  CPU s"
)


def line(row: Row, size: float) -> str:
    """A row as text."""
    numbers = "".join(f"{row[name]:8.3f}" for name in QUANTILES)
    share = 0.1 * float(str(row["mean"])) / size
    begin = f"{row['count']:7}  {row['method']:16}{row['mean']:8.3f}{share:8.3f}{numbers}"
    more = "".join(f"  {name} {row[name]}" for name in MORE if name in row)
    return f"{begin}{row['lost']:6}{row['seconds']:7.0f}{more}"


def study(bench: Bench, train: Samples, methods: list[str], options: LearnOptions) -> None:
    """Rows of one number of samples."""
    key: Row = {"draws": str(train.facts["draws"]), "count": len(train), "targets": len(bench.test)}
    for name in [name for name in OTHERS if name in methods and not bench.has(key | {"method": name})]:
        began = time.process_time()
        answers = OTHERS[name](train, bench.goals)
        seconds = time.process_time() - began
        if name == "1-NN":
            errors = bench.distances(train.markers[_nearest(train, bench.goals)])
        elif name == "constant":
            errors = bench.distances(np.tile(bench.rolled_out_once(answers[0]), (len(answers), 1)))
        else:
            errors = bench.rolled_out(answers)
        bench.add(key | {"method": name}, errors, seconds)
    if "values" in methods and not bench.has(key | {"method": "values"}):
        model = learn_model(train, options=replace(options, slopes=0.0))
        answers = np.array([model.solve(target).contractions for target in bench.poses()])
        bench.add(key | {"method": "values"}, bench.rolled_out(answers), model.facts["seconds"])
    if set(methods) & set(OURS[1:]) and not bench.has(key | {"method": "ours, step"}):
        ours(bench, key, learn_model(train, options=options))


def ours(bench: Bench, key: Row, model: LearnedModel) -> None:
    """Rows of the inverse network, of the search, and of one exact step from there."""
    seconds, poses = model.facts["seconds"], bench.poses()
    model.solve(poses[0])
    began = time.process_time()
    fast = np.array([model.inverted(goal) for goal in bench.goals])
    inverse_us = round(1e6 * (time.process_time() - began) / len(poses))
    bench.add(key | {"method": "inverse"}, bench.rolled_out(fast), seconds, inverse_us=inverse_us)
    began = time.process_time()
    answers = [model.solve(target) for target in poses]
    solve_us = round(1e6 * (time.process_time() - began) / len(poses))
    found: list[tuple[np.ndarray, np.ndarray]] = []
    for answer in answers:
        whole = certify(bench.simulation, model, answer)
        stepped = certify(bench.simulation, model, whole, steps=1)
        found.append((_errors(whole.certified, answer.errors), _errors(stepped.certified, answer.errors)))
    once, stepped = (np.array(part) for part in zip(*found, strict=True))
    doubts = np.array([list(answer.spread.values()) for answer in answers])
    expected = np.array([list(answer.errors.values()) for answer in answers])
    more: Row = {
        "expected": f"{1e3 * expected.mean():.3f}",
        "rank": f"{_rank(doubts.mean(axis=1), once.mean(axis=1)):.2f}",
        "within": f"{np.mean(once < 2 * (doubts + expected)):.0%}",
        "solve_us": solve_us,
    }
    bench.add(key | {"method": "ours"}, once, seconds, **more)
    bench.add(key | {"method": "ours, step"}, stepped, seconds)


def _errors(certified: object, expected: object) -> list[float]:
    """Errors by marker; NaN where nothing was certified."""
    return list(certified.values()) if isinstance(certified, dict) else [np.nan] * len(dict(expected))  # type: ignore[call-overload]


def _rank(first: np.ndarray, second: np.ndarray) -> float:
    """Correlation of ranks (Spearman)."""
    from scipy.stats import spearmanr

    return float(spearmanr(first, second, nan_policy="omit").statistic)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", type=Path)
    parser.add_argument("train", type=Path)
    parser.add_argument("test", type=Path)
    parser.add_argument("--counts", default="300,1000,3000")
    parser.add_argument("--targets", type=int, default=300)
    parser.add_argument("--methods", default=",".join(name.replace(", ", "+") for name in [*OTHERS, *OURS]))
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args()
    train, test = read_samples(given.train), read_samples(given.test)
    bench = Bench(hs.load_robot(given.robot), test, given.targets, given.keep)
    print(machine())
    moved = 1e3 * np.linalg.norm(bench.test.markers - train.markers.mean(axis=0), axis=-1).mean()
    print(
        f"{train.facts['robot']}, draws {train.facts['draws']}, {len(bench.test)} targets, size "
        f"{1e3 * test.facts['size']:.0f} mm, targets {moved:.1f} mm from the mean place; errors in mm"
    )
    print(HEAD)
    methods = [name.replace("+", ", ") for name in given.methods.split(",")]
    for count in [int(text) for text in given.counts.split(",")]:
        study(bench, train.first(count), methods, LearnOptions())


if __name__ == "__main__":
    main()
