"""Targets that move: the gallery's cupping hand with ten cables follows them thirty times a second.

    python benchmarks/tracking.py [--robot cupping_hand] [--seconds 10] [--seed 0]

The targets of all markers run along a smooth closed curve: where the hand rests while contractions go from none through
hidden ones (drawn evenly from the ranges of all winches) and back. Each update, 1/30 s after the last, is given the
targets of that moment; its own CPU time is taken. Then, at every second, a copy of the tracker goes on with targets
that stay where they are, for half a second. Every pose is judged afresh: forces in balance, a minimum, no inverted
element, contractions in their ranges and no faster than the rate, tensions within their limit (at most 0.2 % above it).
Limits of 1.2 times what the curve needs leave every target within reach; with 0.7 times some are not.
"""

import argparse
import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ik_problem import hidden_contractions, largest_error, machine, places, ranges, rests, timed

import numpy as np  # isort: skip
from robustness import fault
from scipy.interpolate import PchipInterpolator

import hydrostat as hs
from hydrostat.arrays import Vector
from hydrostat.given import Point
from hydrostat.ik import Limits, Tracker
from hydrostat.robot import gallery_folder

UPDATES = 30
"""In a second."""

STOPPED = 15
"""Updates with targets that stay: half a second."""

WAYPOINTS = 6
"""Contractions that the curve goes through, with none at first and at last."""

Targets = Mapping[str, Point]


@dataclass
class Log:
    """What came of many updates.

    Attributes:
        spent: CPU time of each [ms].
        errors: largest distance of a marker from its target after each [m].
        wrong: what was wrong with a pose, in words.
    """

    spent: list[float] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)


def curve(simulation: hs.Simulation, seconds: float, seed: int) -> list[hs.Equilibrium]:
    """The pose of every update, each begun at the one before, so that the curve does not jump."""
    low, high = ranges(simulation.robot)
    hidden = [np.zeros(len(low)), *hidden_contractions(simulation.robot, WAYPOINTS - 1, seed)]
    around = np.array([*hidden[-3:], *hidden, *hidden[:4]])
    path = PchipInterpolator(np.arange(-3, WAYPOINTS + 4), around)
    poses = [simulation.rest]
    count = round(seconds * UPDATES)
    for update in range(1, count + 1):
        contractions = np.clip(path(WAYPOINTS * update / count), low, high)
        poses.append(simulation.solve(contractions, start=poses[-1]))
    return poses[1:]


def update(tracker: Tracker, simulation: hs.Simulation, targets: Targets, limits: Limits, log: Log) -> None:
    """One update, timed and judged."""
    before = tracker.pose.contractions
    reached, spent = timed(lambda: tracker.update(targets, seconds=1 / UPDATES))
    log.spent.append(spent)
    log.errors.append(largest_error(reached.pose, targets))
    word = broken(simulation, reached.pose, before, limits)
    if word:
        log.wrong.append(word)


def broken(simulation: hs.Simulation, pose: hs.Equilibrium, before: Vector, limits: Limits) -> str:
    """What a pose breaks, in words; empty if nothing."""
    low, high = ranges(simulation.robot)
    if not rests(pose):
        return "no stable equilibrium"
    if (pose.contractions < low - 1e-12).any() or (pose.contractions > high + 1e-12).any():
        return "contraction out of range"
    if isinstance(limits.rate, float) and np.abs(pose.contractions - before).max() * UPDATES > limits.rate * (1 + 1e-9):
        return "too fast"
    if isinstance(limits.tension, float) and pose.tensions.max() > 1.002 * limits.tension:
        return "too tight"
    return fault(simulation, pose)


def follow(simulation: hs.Simulation, poses: Sequence[hs.Equilibrium], limits: Limits) -> tuple[Log, Log, list[float]]:
    """Updates on the way, updates after stops, and the error that each stop ends with [m]."""
    tracker = Tracker(simulation, limits=limits)
    moving, stopped, left = Log(), Log(), []
    for number, pose in enumerate(poses, start=1):
        update(tracker, simulation, places(pose), limits, moving)
        if number % UPDATES == 0:
            resting = copy.copy(tracker)
            for _ in range(STOPPED):
                update(resting, simulation, places(pose), limits, stopped)
            left.append(stopped.errors[-1])
    return moving, stopped, left


def row(name: str, moving: Log, stopped: Log, left: Sequence[float]) -> str:
    """One line of the table."""
    quantiles = " / ".join(f"{value:.1f}" for value in np.percentile(moving.spent, [50, 95, 100]))
    errors = " / ".join(f"{1e3 * value:.2g}" for value in np.percentile(moving.errors, [50, 95, 100]))
    ends = " / ".join(f"{1e3 * value:.1e}" for value in (np.median(left), max(left)))
    late = sum(spent > 1e3 / UPDATES for spent in moving.spent)
    wrong = [*moving.wrong, *stopped.wrong]
    return (
        f"| {name} | {quantiles} | {1e3 * len(moving.spent) / sum(moving.spent):.0f} | {late} of {len(moving.spent)} "
        f"| {errors} | {np.median(stopped.spent):.1f} / {max(stopped.spent):.1f} | {ends} "
        f"| {np.sum(np.array(left) <= 1e-4)} of {len(left)} | {len(wrong)}{': ' + wrong[0] if wrong else ''} |"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--robot", default="cupping_hand")
    parser.add_argument("--seconds", type=float, default=10.0, help="for the whole curve")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    simulation = hs.Simulation(hs.load_robot(gallery_folder(options.robot)))
    poses = curve(simulation, options.seconds, options.seed)
    rate = UPDATES * float(np.abs(np.diff([pose.contractions for pose in poses], axis=0)).max())
    tension = float(max(pose.tensions.max() for pose in poses))
    print(
        f"{machine()}; {options.robot}, {len(simulation.robot.winches)} winches, {options.seconds:g} s at {UPDATES}/s"
    )
    print(f"The curve needs up to {1e3 * rate:.0f} mm/s and {tension:.1f} N\n")
    print(
        "| limits | CPU ms: median / p95 / max | updates a second | over 33 ms | error mm: median / p95 / max "
        "| CPU ms after a stop: median / max | error mm 0.5 s after a stop: median / max | below 0.1 mm | wrong |\n"
        "|---|---|---|---|---|---|---|---|---|",
        flush=True,
    )
    for name, limits in {
        "ranges": Limits(),
        "rate x 1.2": Limits(rate=1.2 * rate),
        "tension x 1.2": Limits(tension=1.2 * tension),
        "both x 1.2": Limits(rate=1.2 * rate, tension=1.2 * tension),
        "both x 0.7": Limits(rate=0.7 * rate, tension=0.7 * tension),
    }.items():
        Tracker(simulation, limits=limits).update(places(poses[0]), seconds=1 / UPDATES)  # compiles
        print(row(name, *follow(simulation, poses, limits)), flush=True)


if __name__ == "__main__":
    main()
