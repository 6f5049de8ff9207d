"""What exact steps leave of learned answers, on a model that is there: one step, or up to three where that misses.

    python lab/learned_ik/learned_steps.py examples/cupping_hand build/hand.model build/test [--targets 300] [--again]

Targets are the markers of samples that nothing was learned from. Columns: errors of the markers in the simulator in mm,
CPU time for a target beyond that from rest [ms], steps taken. Up to three: as long as more than 0.01 mm is
left on average. With --again the contractions after one step are taken in from rest, too: a pose after steps lies at
the end of their way, and the same contractions from rest may lead elsewhere (by more than 0.01 mm: told below).
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.learning import LearnedModel, Samples, exact_steps, verify
from hydrostat.simulation import Equilibrium
from hydrostat_lab.compare import targets_of

ENOUGH = 1e-5
AGAIN = "one step, rest"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", type=Path)
    parser.add_argument("model", type=Path)
    parser.add_argument("test", type=Path)
    parser.add_argument("--targets", type=int, default=300)
    parser.add_argument("--again", action="store_true")
    given = parser.parse_args()
    model, test = LearnedModel.load(given.model), Samples.read(given.test).first(given.targets)
    robot = hs.load_robot(given.robot)
    if model.card.contact and robot.contact is None:
        robot = replace(robot, contact=hs.Contact())
    simulation, targets = hs.Simulation(robot), targets_of(test)
    print(machine())
    print(f"{robot.name}, {model.card.samples} samples, {len(test)} targets; errors in mm")
    print(f"{'':18}{'mean':>8}{'median':>8}{'p90':>8}{'p99':>8}{'max':>8}{'lost':>6}{'ms':>7}{'steps':>7}")
    ways = {"from rest": (0, 0.0), "one step": (1, 0.0), "up to three": (3, ENOUGH)}
    errors: dict[str, list[list[float]]] = {name: [] for name in ways}
    seconds, taken = dict.fromkeys(ways, 0.0), dict.fromkeys(ways, 0)
    for target in targets:
        began = time.process_time()
        begun = verify(simulation, model, model.solve(target)).pose
        seconds["from rest"] += time.process_time() - began
        assert begun is not None
        for name, (most, enough) in ways.items():
            began = time.process_time()
            pose, steps = exact_steps(simulation, begun, target, most, enough=enough)
            seconds[name] += time.process_time() - began
            taken[name] += steps
            errors[name].append(missed(pose, target))
            if given.again and name == "one step":
                began = time.process_time()
                errors.setdefault(AGAIN, []).append(missed(simulation.solve(pose.contractions, strict=False), target))
                seconds[AGAIN] = seconds.get(AGAIN, 0.0) + time.process_time() - began
    taken[AGAIN] = taken["one step"]
    for name in errors:
        found = np.array(errors[name])
        good = 1e3 * found[np.isfinite(found).all(axis=1)].ravel()
        numbers = [good.mean(), *np.quantile(good, [0.5, 0.9, 0.99, 1.0])]
        lost = int((~np.isfinite(found).all(axis=1)).sum())
        text = "".join(f"{number:8.4f}" for number in numbers)
        print(f"{name:18}{text}{lost:6}{1e3 * seconds[name] / len(test):7.0f}{taken[name] / len(test):7.2f}")
    if given.again:
        away = np.abs(np.array(errors[AGAIN]) - np.array(errors["one step"])).max(axis=1) > ENOUGH
        print(f"{int(away.sum())} of {len(test)} answers of one step are elsewhere from rest")


def missed(pose: Equilibrium, target: dict[str, tuple[float, ...]]) -> list[float]:
    """Distances of markers from targets [m]; NaN where there is no equilibrium."""
    if not pose.result.converged:
        return [np.nan] * len(target)
    return [float(np.linalg.norm(pose.markers[name] - np.array(place))) for name, place in target.items()]


if __name__ == "__main__":
    main()
