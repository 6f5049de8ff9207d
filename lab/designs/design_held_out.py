"""How well a network serves poses that it was not designed for (F3).

    python lab/designs/design_held_out.py [--quick] [--bodies starfish,trunk] [--methods routes,trees,random]
                                         [--random 100] [--seeds 1]

The poses of a body come from a hidden network, dense and unlike any that is designed: many cables at random, each with
a winch of its own, some of them pulled at random. So something on strings reaches every pose, though no few cables may.
A network is designed for some of them, and judged on eight others. First the number of cables grows, with a winch for
each as far as winches may stand; then the number of poses that the network is designed for. Errors are root means of
squares over hidden networks, one for each seed.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from design_bodies import BODIES, Body, body_robot, judged, rest_error
from design_random import best_of, ground, random_network
from machine import machine

import numpy as np  # isort: skip

from hydrostat.design import design_cables
from hydrostat.errors import HydrostatError
from hydrostat.robot import Mount, PoseTarget, Robot
from hydrostat.simulation import Simulation

POSES = 8
"""Held out; as many are there to design for."""

CABLES = (2, 4, 6, 8)

TRAINING = (1, 2, 4, 8)

FIXED = (6, 4)
"""Cables while poses vary, poses while cables vary."""

HIDDEN = {"starfish": 14, "trunk": 10}
"""Cables of the hidden network."""

PULLED = 0.5
"""Share of the hidden cables that a pose pulls."""

SHARE = 0.35
"""The most that one takes in, as a share of its bare length."""


@dataclass(frozen=True, eq=False)
class Family:
    """Poses of one kind.

    Attributes:
        robot: whose they are.
        training: to design for.
        held_out: to judge by.
    """

    robot: Robot
    training: tuple[PoseTarget, ...]
    held_out: tuple[PoseTarget, ...]


def family(name: str, seed: int) -> Family:
    """Poses that a hidden network reaches."""
    robot = body_robot(name)
    draw = np.random.default_rng([seed, 1])
    hidden = _hidden(robot, BODIES[name], HIDDEN[name], draw)
    simulation = Simulation(hidden)
    lengths = np.array([cable.segments[cable.bare].sum() for cable in hidden.cables])
    poses: list[PoseTarget] = []
    while len(poses) < 2 * POSES:
        pulled = draw.random(len(lengths)) < PULLED
        solved = simulation.solve(pulled * draw.uniform(0.0, SHARE, len(lengths)) * lengths, strict=False)
        if solved.result.converged and pulled.any():
            targets = {marker: tuple(map(float, at)) for marker, at in solved.markers.items()}
            poses.append(PoseTarget(name=f"pose {len(poses) + 1}", targets=targets))
    return Family(robot, tuple(poses[:POSES]), tuple(poses[POSES:]))


def _hidden(robot: Robot, body: Body, cables: int, draw: np.random.Generator) -> Robot:
    """Winches in the body, also where those of the robot stand beside it, and nearer to one another than can be built.

    Raises:
        RuntimeError: none is found.
    """
    crossing = replace(body.constraints, winch_gap=0.0, hole_gap=0.0, cable_gap=0.0, max_turn=75.0)
    dense = replace(crossing, mount=Mount.BODY, travel=1.0)
    found = random_network(ground(robot, dense), cables, cables, draw)
    if found is None:
        raise RuntimeError(f"no hidden network of {cables} cables")
    return found


def network(poses: Sequence[PoseTarget], of: Family, body: Body, method: str, count: int, seed: int) -> Robot | None:
    """What a method makes of some poses; None if nothing."""
    if method == "random":
        best = best_of(of.robot, poses, body, count=count, seed=seed)
        return None if best is None else best.robot
    try:
        return design_cables(
            of.robot,
            poses,
            winches=body.winches,
            cables=body.cables,
            method=method,
            constraints=body.constraints,
        ).robot
    except HydrostatError:
        return None


def cases(quick: bool) -> Iterator[tuple[int, int]]:
    """Numbers of cables and of poses to design for."""
    if quick:
        yield 2, 2
        return
    yield from ((cables, FIXED[1]) for cables in CABLES)
    yield from ((FIXED[0], training) for training in TRAINING if training != FIXED[1])


def _posed(robot: Robot, poses: Sequence[PoseTarget]) -> Robot:
    return replace(robot, poses={pose.name: pose for pose in poses})


def _errors(name: str, of: Family, asked: Body, method: str, training: int, count: int, seed: int) -> list[float]:
    """Cables used; poses designed for and held out, each at rest and as reached [m]; NaN where no network is found."""
    poses = of.training[:training]
    found = network(poses, of, asked, method, count, seed)
    errors = [np.nan if found is None else float(len(found.cables))]
    for some in (poses, of.held_out):
        errors.append(rest_error(_posed(of.robot, some)))
        errors.append(np.nan if found is None else judged(found, some, BODIES[name].constraints))
    return errors


def _row(name: str, families: Sequence[Family], method: str, cables: int, training: int, count: int) -> str:
    world = [winch for winch in families[0].robot.winches if winch.mount is Mount.WORLD]
    winches = min(cables, len(world)) if world else cables
    asked = replace(BODIES[name], winches=winches, cables=cables)
    found = [_errors(name, of, asked, method, training, count, seed) for seed, of in enumerate(families)]
    used, *errors = np.array(found).T
    cells = " | ".join(f"{1e3 * np.sqrt(np.mean(error**2)):.2f}" for error in errors)
    return f"| {name} | {method} | {winches} / {cables} | {np.mean(used):g} | {training} | {cells} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="the starfish with two cables and two poses only")
    parser.add_argument("--bodies", default=",".join(HIDDEN), help="names with commas between")
    parser.add_argument("--methods", default="routes,trees,random", help="names with commas between")
    parser.add_argument(
        "--random", type=int, default=100, metavar="N", help="random networks of which the best is kept"
    )
    parser.add_argument("--seeds", type=int, default=1, metavar="N", help="hidden networks")
    options = parser.parse_args()
    print(f"{machine()}; rms errors over markers and poses in mm")
    print(f"{POSES} poses held out; hidden networks: {options.seeds}; the best of {options.random} at random\n")
    columns = ["body", "method", "winches / cables", "cables used", "poses designed for", "they at rest", "reached"]
    columns += ["held out, at rest", "reached"]
    print("| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|", flush=True)
    for name in ["starfish"] if options.quick else options.bodies.split(","):
        families = [family(name, seed) for seed in range(options.seeds)]
        for cables, training in cases(options.quick):
            for method in options.methods.split(","):
                if method == "trees" and families[0].robot.body.mesh.dim == 3:
                    continue
                print(_row(name, families, method, cables, training, options.random), flush=True)


if __name__ == "__main__":
    main()
