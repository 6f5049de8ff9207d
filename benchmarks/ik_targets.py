"""Many poses for every robot of the gallery: which are reached, at what cost, and how near the others come.

    python benchmarks/ik_targets.py [ROBOT ...] [--kind hidden] [--count 200] [--restarts 3] [--seed 0]

Contractions are drawn evenly from the ranges of all winches. Where they lead from rest is the target of all markers.
"reached": every marker within 1e-6 of the body's size in a stable equilibrium; errors are those of the worst marker.

    hidden        those targets; first without restarts, then with them where the pose was missed
    unreachable   each marker's target is moved by 10 to 30 % of the body's size, anywhere; on the first --compare poses
                  SciPy's least_squares (trf) minimizes the same residual, from our answer and from rest
    finer         targets of the same robot with elements of half the size
    stiffer       targets of a material whose Young's modulus is 20 % larger
    poisson       targets of a material whose Poisson's ratio is 0.05 larger (smaller where it is above 0.44)

In the last three "left" is the error that inverse kinematics leaves on its own model, "in truth" the error of the other
robot, at rest under the contractions found; "blind" is that of our model under the hidden contractions. Contractions
decide a pose, so a body that is stiffer as a whole moves as before, but for its cables, pins and weight.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

from ik_problem import REACHED, Problem, hidden_poses, largest_error, machine, middle, places, rests, timed

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.geometry import tetrahedralize, triangulate
from hydrostat.given import Point
from hydrostat.ik import IKStatus
from hydrostat.robot import Robot, gallery_folder, list_gallery

HEADS = {
    "hidden": "robot | nodes | winches | markers | poses | reached | without restarts | CPU ms | error mm | iterations "
    "| equilibria",
    "unreachable": "robot | poses | reasons | optimality | CPU ms | error mm | SciPy from ours: lower, same, higher "
    "| SciPy from rest | its largest gain",
    "finer": "robot | poses | reached | left mm | % of size | in truth mm | % of size | blind mm | CPU ms",
}
"""Columns of the tables."""

SAME = 1e-6
"""Objectives that differ by less than this share are the same."""


def hidden(robot: Robot, count: int, seed: int, restarts: int) -> str:
    """A line on poses that can be reached; those that are not go to standard error."""
    simulation, size = hs.Simulation(robot), robot.body.mesh.size
    poses = hidden_poses(simulation, count, seed)
    spent, found, first = [], [], 0
    for number, pose in enumerate(poses):
        reached, milliseconds = inverse(simulation, places(pose), 0)
        first += reached.status is IKStatus.REACHED
        if restarts and reached.status is not IKStatus.REACHED:
            reached, milliseconds = inverse(simulation, places(pose), restarts)
        if reached.status is not IKStatus.REACHED:
            error = 1e3 * max(reached.errors.values())
            print(f"  {robot.name} {number}: {error:.3g} mm left, {reached.status.name}", file=sys.stderr, flush=True)
        spent.append(milliseconds)
        found.append(reached)
    errors = [largest_error(each.pose, places(pose)) for each, pose in zip(found, poses, strict=True)]
    hits = [error <= REACHED * size and rests(each.pose) for each, error in zip(found, errors, strict=True)]
    return (
        f"{robot.name} | {len(robot.body.mesh.nodes)} | {len(robot.winches)} | {len(robot.markers)} "
        f"| {len(poses)} of {count} | {share(hits)} | {100 * first / len(poses):.1f} % "
        f"| {middle(spent, '.0f')} | {middle([1e3 * error for error in errors], '.1e')} "
        f"| {middle([each.iterations for each in found], '.0f')} | {middle([each.solves for each in found], '.0f')}"
    )


def unreachable(robot: Robot, count: int, seed: int, restarts: int, compared: int) -> str:
    """A line on poses that no contractions reach."""
    simulation = hs.Simulation(robot)
    draw = np.random.default_rng(seed + 1)
    spent, found = [], []
    near, far, gain = Counter(), Counter(), 0.0
    for number, pose in enumerate(hidden_poses(simulation, count, seed)):
        targets = moved(places(pose), robot.body.mesh.size, draw)
        reached, milliseconds = inverse(simulation, targets, restarts)
        spent.append(milliseconds)
        found.append(reached)
        if number < compared:
            gains = [gained(simulation, targets, reached, begin) for begin in (reached.pose, None)]
            near[_verdict(gains[0])] += 1
            far[_verdict(gains[1])] += 1
            gain = max(gain, *gains)
    reasons = ", ".join(f"{name} {times}" for name, times in Counter(each.status.name for each in found).items())
    errors = middle([1e3 * max(each.errors.values()) for each in found], ".1f")
    return (
        f"{robot.name} | {len(found)} of {count} | {reasons} | {middle([each.optimality for each in found], '.1e')} "
        f"| {middle(spent, '.0f')} | {errors} | {_verdicts(near)} | {_verdicts(far)} | {100 * gain:.2g} %"
    )


def other(robot: Robot, truth: Robot, count: int, seed: int, restarts: int) -> str:
    """A line on targets that another robot reaches."""
    model, real = hs.Simulation(robot), hs.Simulation(truth)
    size = robot.body.mesh.size
    left, true, blind, spent = [], [], [], []
    for pose in hidden_poses(real, count, seed):
        targets = places(pose)
        reached, milliseconds = inverse(model, targets, restarts)
        there = real.solve(reached.pose.contractions, strict=False)
        if not rests(there):
            print(f"  {truth.name}: no equilibrium under the contractions found", file=sys.stderr, flush=True)
            continue
        spent.append(milliseconds)
        left.append(1e3 * largest_error(reached.pose, targets))
        true.append(1e3 * largest_error(there, targets))
        blind.append(1e3 * largest_error(model.solve(pose.contractions, strict=False), targets))
    shares = [[0.1 / size * error for error in errors] for errors in (left, true)]
    reached = share([error <= 1e3 * REACHED * size for error in left])
    return (
        f"{robot.name} | {len(left)} of {count} | {reached} | {middle(left)} | {middle(shares[0])} "
        f"| {middle(true)} | {middle(shares[1])} | {middle(blind)} | {middle(spent, '.0f')}"
    )


def inverse(simulation: hs.Simulation, targets: Mapping[str, Point], restarts: int) -> tuple[hs.IKResult, float]:
    """What inverse kinematics finds, and its CPU time [ms]."""
    options = hs.IKOptions(restarts=restarts, restart_error=0.0)
    return timed(lambda: hs.solve_ik(simulation, targets, options=options))


def moved(targets: Mapping[str, Point], size: float, draw: np.random.Generator) -> dict[str, Point]:
    """Targets moved by 10 to 30 % of a body's size [m], each its own way."""
    ways = draw.standard_normal((len(targets), len(next(iter(targets.values())))))
    ways *= size * draw.uniform(0.1, 0.3, (len(ways), 1)) / np.linalg.norm(ways, axis=1, keepdims=True)
    return {name: tuple(np.add(place, way).tolist()) for (name, place), way in zip(targets.items(), ways, strict=True)}


def gained(
    simulation: hs.Simulation, targets: Mapping[str, Point], reached: hs.IKResult, begin: hs.Equilibrium | None
) -> float:
    """By which share SciPy's objective is lower than ours, from a pose, or from near rest; negative if it is higher."""
    missed = float(np.sqrt(np.sum(np.square(list(reached.errors.values())))))
    effort = min(hs.IKOptions().effort, 0.1 * missed / simulation.robot.body.mesh.size)
    problem = Problem(simulation, targets, start=begin, effort=effort, stop=False)
    ours = problem.objective(reached.pose)
    problem.least_squares(0.02 * problem.high if begin is None else begin.contractions)
    return 1.0 - problem.least / ours


def _verdict(gain: float) -> str:
    return "lower" if gain > SAME else "higher" if gain < -SAME else "same"


def _verdicts(counted: Counter[str]) -> str:
    return ", ".join(str(counted[word]) for word in ("lower", "same", "higher"))


def share(hits: Sequence[bool]) -> str:
    return f"{100 * float(np.mean(hits)):.1f} %"


def truth(robot: Robot, kind: str) -> Robot:
    """The robot that targets come from."""
    body = robot.body
    if kind == "stiffer":
        return replace(robot, body=replace(body, material=replace(body.material, young=1.2 * body.material.young)))
    if kind == "poisson":
        poisson = body.material.poisson + (0.05 if body.material.poisson <= 0.44 else -0.05)
        return replace(robot, body=replace(body, material=replace(body.material, poisson=poisson)))
    assert body.element_size is not None
    half = 0.5 * body.element_size
    if body.outline is not None:
        return replace(robot, body=replace(body, element_size=half, mesh=triangulate(body.outline, half)))
    assert body.healing is not None
    return replace(robot, body=replace(body, element_size=half, mesh=tetrahedralize(body.healing.surface, half)))


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("robots", nargs="*", default=list_gallery(), metavar="ROBOT")
    parser.add_argument("--kind", choices=["hidden", "unreachable", "finer", "stiffer", "poisson"], default="hidden")
    parser.add_argument("--count", type=int, default=200, help="hidden contractions of each robot")
    parser.add_argument("--restarts", type=int, default=hs.IKOptions().restarts)
    parser.add_argument("--compare", type=int, default=20, help="unreachable poses that SciPy is given too")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    print(f"{machine()}; {options.kind}, {options.count} hidden contractions each, seed {options.seed}, ", end="")
    print(f"{options.restarts} restarts; median / 99th percentile\n")
    head = HEADS.get(options.kind, HEADS["finer"])
    print(f"| {head} |\n{'|---' * (head.count('|') + 1)}|", flush=True)
    for name in options.robots:
        robot = hs.load_robot(gallery_folder(name))
        common = options.count, options.seed, options.restarts
        if options.kind == "hidden":
            line = hidden(robot, *common)
        elif options.kind == "unreachable":
            line = unreachable(robot, *common, options.compare)
        else:
            line = other(robot, truth(robot, options.kind), *common)
        print(f"| {line} |", flush=True)


if __name__ == "__main__":
    main()
