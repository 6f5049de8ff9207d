"""What networks gain a tracker: the time to its first good answer, and its error while targets move.

    python lab/learned_ik/learned_drag.py examples/cupping_hand build/hand.model build/test [--targets 20] [--seconds 1]

Targets are all markers of samples that nothing was learned from. *Jump*: from rest to a target that appears; the error
after the first update, its CPU time, and the CPU time until 1 mm and 0.1 mm are left on average (of those that get
there within 60 updates; `lost` are the others). *Drag*: the targets go on straight lines from sample to sample, in so
many seconds each; an update takes its own CPU time, and is given the targets of the moment at which it begins; errors
are to the targets of the moment at which it ends, as a person sees them. Every pose is a stable equilibrium, or counted
as wrong. *studio* has its strides of at most 0.05 of a winch's range, *free* those of `Tracker`; all errors in mm.
"""

import argparse
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip
from ik_problem import rests

import hydrostat as hs
from hydrostat.ik import IKOptions, Tracker
from hydrostat.learning import LearnedModel, Samples
from hydrostat.simulation import Equilibrium
from hydrostat.studio import STRIDE
from hydrostat_lab.compare import targets_of

MOST = 60
GOOD = (1e-3, 1e-4)

Targets = Mapping[str, tuple[float, ...]]


@dataclass
class Found:
    """What came of one way: errors [m] and CPU times [s]."""

    first: list[float] = field(default_factory=list)
    spent: list[float] = field(default_factory=list)
    until: dict[float, list[float]] = field(default_factory=lambda: {good: [] for good in GOOD})
    dragged: list[float] = field(default_factory=list)
    updates: list[float] = field(default_factory=list)
    wrong: int = 0


def missed(pose: Equilibrium, targets: Targets) -> float:
    """Mean distance of markers from targets [m]."""
    return float(np.mean([np.linalg.norm(pose.markers[name] - np.array(place)) for name, place in targets.items()]))


def update(tracker: Tracker, targets: Targets, found: Found) -> float:
    """One update, judged; its CPU time [s]."""
    began = time.process_time()
    pose = tracker.update(targets, seconds=1.0).pose
    spent = time.process_time() - began
    found.wrong += not rests(pose)
    return spent


def jump(tracker: Tracker, targets: Targets, found: Found) -> None:
    """From rest to targets that appear."""
    clock, left = 0.0, set(GOOD)
    for number in range(MOST):
        spent = update(tracker, targets, found)
        clock += spent
        error = missed(tracker.pose, targets)
        if not number:
            found.first.append(error)
            found.spent.append(spent)
        for good in [good for good in left if error <= good]:
            found.until[good].append(clock)
            left.remove(good)
        if not left:
            return


def drag(tracker: Tracker, ways: Sequence[Targets], seconds: float, found: Found) -> None:
    """Along straight lines between targets, as fast as the updates go."""
    clock, end = 0.0, seconds * (len(ways) - 1)
    while clock < end:
        spent = update(tracker, between(ways, clock / seconds), found)
        clock += spent
        found.updates.append(spent)
        found.dragged.append(missed(tracker.pose, between(ways, min(clock, end) / seconds)))


def between(ways: Sequence[Targets], at: float) -> dict[str, tuple[float, ...]]:
    """Targets at a moment, counted in lines."""
    line = min(int(at), len(ways) - 2)
    share, first, then = at - line, ways[line], ways[line + 1]
    return {name: tuple((1 - share) * np.array(first[name]) + share * np.array(then[name])) for name in first}


def row(name: str, found: Found, count: int) -> str:
    """What was found, in a line."""
    until = "".join(
        f"{1e3 * np.median(times):8.0f}{count - len(times):5}" if times else f"{'-':>8}{count:5}"
        for times in found.until.values()
    )
    jumped = f"{1e3 * np.mean(found.first):8.3f}{1e3 * np.median(found.spent):6.0f}{until}"
    dragged = 1e3 * np.array(found.dragged)
    figures = f"{dragged.mean():8.3f}{np.quantile(dragged, 0.95):8.3f}{1e3 * np.median(found.updates):6.0f}"
    return f"{name:22}{jumped}{figures}{found.wrong:6}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", type=Path)
    parser.add_argument("model", type=Path)
    parser.add_argument("test", type=Path)
    parser.add_argument("--targets", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=1.0)
    given = parser.parse_args()
    model, test = LearnedModel.load(given.model), Samples.read(given.test).first(given.targets)
    robot = hs.load_robot(given.robot)
    if model.card.contact and robot.contact is None:
        robot = replace(robot, contact=hs.Contact())
    simulation, ways = hs.Simulation(robot), targets_of(test)
    print(machine())
    print(f"{robot.name}, {model.card.samples} samples, {len(ways)} targets, {given.seconds:g} s a line; mm, CPU ms")
    print(
        f"{'':22}{'first':>8}{'ms':>6}{'to 1':>8}{'lost':>5}{'to 0.1':>8}{'lost':>5}{'drag':>8}{'95 %':>8}{'ms':>6}",
        end="",
    )
    print(f"{'wrong':>6}")
    Tracker(simulation).update(ways[0], seconds=1.0)  # what is compiled or made once is not counted
    for strides, options in (("free", None), ("studio", IKOptions(largest_step=STRIDE))):
        for way, known in (("alone", None), ("by networks", model)):
            print(
                row(f"{strides}, {way}", measured(simulation, ways, given.seconds, options, known), len(ways)),
                flush=True,
            )


def measured(
    simulation: hs.Simulation,
    ways: Sequence[Targets],
    seconds: float,
    options: IKOptions | None,
    model: LearnedModel | None,
) -> Found:
    """Jumps to all targets, and a drag through them."""
    found = Found()
    for targets in ways:
        jump(Tracker(simulation, options=options, model=model), targets, found)
    drag(Tracker(simulation, options=options, model=model), ways, seconds, found)
    return found


if __name__ == "__main__":
    main()
