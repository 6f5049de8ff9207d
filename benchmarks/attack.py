"""Random robots far outside the gallery: how often, how fast and why not the statics solver arrives.

    python benchmarks/attack.py [--robots 60] [--seed 0] [--seconds 10] [--friction] [--only ROBOT ...]

Each robot is a body of the gallery, flat or in space with about 300 nodes, 1 cm to 10 m large, of 100 Pa to 10 MPa, a
Poisson's ratio of 0 to 0.499, by elements or by patches; its cables are a hundredth to ten thousand times as stiff as
its body, its pins one to a million times. Of ten commands six are within travel (0 to 30 % of the shortest cable of
each winch, one time in five 0 to 10 % let out), four beyond (up to all of it, or half of it let out). Every pose is
judged afresh; the exit code is 1 if fewer than 99 % within travel or 97 % in all converge. The time of a solve is CPU
time, and is compared with the median of its kind: flat, or in space. With `--friction` one to three cables zigzag
through 5 to 13 random elements each, friction 0.2 to 0.8, and what has slipped has to fit the capstan law too.
"""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh, tetrahedralize
from hydrostat.robot import Cable, Material, Pin, Robot, Volume, Winch, gallery_folder

FLAT = ("letter_e", "letter_s", "pig", "puppy", "robot", "squid", "starfish")
IN_SPACE = ("fish_tail", "octopus_arm", "tongue", "trunk", "cupping_hand")
NODES = 300
WITHIN, BEYOND = 6, 4
LEAST_WITHIN, LEAST = 0.99, 0.97


@dataclass
class Outcome:
    """What came of one command.

    Attributes:
        robot: number of the robot.
        title: its body and numbers.
        flat: whether its body is.
        within: whether the command was within travel.
        contractions: the command [m].
        reason: why the solve ended.
        fault: what is wrong with the pose, in words; empty if nothing is.
        iterations: of Newton.
        seconds: CPU time.
        message: what a person is told of a failure.
    """

    robot: int
    title: str
    flat: bool
    within: bool
    contractions: list[float]
    reason: str
    fault: str
    iterations: int
    seconds: float
    message: str


@cache
def gallery_body(name: str) -> Robot:
    """A robot of the gallery, in space with about 300 nodes."""
    robot = hs.load_robot(gallery_folder(name))
    body = robot.body
    if body.mesh.dim == 2 or body.healing is None:
        return robot
    try:
        size = body.element_size_for(NODES)
    except InputError:
        size = 2 * (body.element_size or 0.01)
    return replace(robot, body=replace(body, mesh=tetrahedralize(body.healing.surface, size), element_size=size))


def random_robot(number: int, seed: int) -> tuple[Robot, str]:
    """Robot of a number, and what it is in words."""
    random = np.random.default_rng([seed, number])
    names = FLAT if random.random() < 0.5 else IN_SPACE
    name = str(random.choice(names))
    robot = gallery_body(name)
    size = 10.0 ** random.uniform(-2, 1)
    young = 10.0 ** random.uniform(2, 7)
    ratios = (random.uniform(0, 0.45), float(random.choice([0.48, 0.49, 0.495, 0.499])))
    poisson = ratios[int(random.random() < 0.4)]
    volume = Volume.PATCH if random.random() < 0.5 else Volume.ELEMENT
    cables, pins = 10.0 ** random.uniform(-2, 4), 10.0 ** random.uniform(0, 6)
    title = (
        f"{name} {size:.2g} m, {young:.2g} Pa, nu {poisson:.3f} by {volume}, cables x {cables:.2g}, pins x {pins:.2g}"
    )
    body = robot.body
    scale = size / body.mesh.size
    thick = None if body.thickness is None else body.thickness * scale
    mesh = Mesh(body.mesh.nodes * scale, body.mesh.elements)
    body = replace(
        body,
        mesh=mesh,
        size=None,
        thickness=thick,
        material=Material(young=young, poisson=poisson, density=body.material.density),
        volume=volume,
        outline=None,
        healing=None,
    )
    soft = young * float(mesh.volumes.sum()) * (thick or 1.0) / size**2
    return (
        replace(
            robot,
            body=body,
            gravity=None,
            pins=tuple(_pin(pin, scale, pins * soft) for pin in robot.pins),
            cables=tuple(_cable(cable, scale, cables * soft) for cable in robot.cables),
            winches=tuple(_winch(winch, scale) for winch in robot.winches),
            markers=(),
            poses={},
        ),
        title,
    )


def rubbing_robot(number: int, seed: int) -> tuple[Robot, str]:
    """The robot of a number pulled by one to three rubbing zigzags through random element centers, in words too."""
    random = np.random.default_rng([seed, number, 2])
    robot, title = random_robot(number, seed)
    mesh = robot.body.mesh
    centers, friction = mesh.nodes[mesh.elements].mean(axis=1), float(random.uniform(0.2, 0.8))
    soft = robot.body.material.young * float(mesh.volumes.sum()) * (robot.body.thickness or 1.0) / mesh.size**2
    cables = [
        Cable(
            winch=f"w{cable}",
            points=tuple(map(tuple, random.choice(centers, size=int(random.integers(5, 14)), replace=False).tolist())),
            stiffness=soft * 10.0 ** random.uniform(-2, 4),
            smoothing=0.002 * mesh.size,
            friction=friction,
        )
        for cable in range(int(random.integers(1, 4)))
    ]
    winches = [Winch(name=cable.winch, at=cable.points[0], travel=mesh.size) for cable in cables]
    points = "+".join(str(len(cable.points)) for cable in cables)
    stiff = "+".join(f"{cable.stiffness / soft:.2g}" for cable in cables)
    title = f"{title.split(', cables')[0]}, {points} points, cables x {stiff}, mu {friction:.2f}"
    return robot.with_network(winches, cables), title


def _point(point: Sequence[float], scale: float) -> tuple[float, ...]:
    return tuple(float(value) * scale for value in point)


def _pin(pin: Pin, scale: float, stiffness: float) -> Pin:
    at = None if pin.at is None else _point(pin.at, scale)
    box = None if pin.box is None else (_point(pin.box[0], scale), _point(pin.box[1], scale))
    return replace(pin, at=at, box=box, radius=pin.radius * scale, stiffness=stiffness)


def _winch(winch: Winch, scale: float) -> Winch:
    return replace(winch, at=_point(winch.at, scale), travel=winch.travel * scale)


def _cable(cable: Cable, scale: float, stiffness: float) -> Cable:
    return replace(
        cable,
        points=tuple(_point(point, scale) for point in cable.points),
        stiffness=stiffness,
        smoothing=cable.smoothing * scale,
        slack=cable.slack * scale,
        friction=0.0,
    )


def commands(robot: Robot, number: int, seed: int) -> Iterator[tuple[bool, Vector]]:
    """Whether a command is within travel, and its contractions [m]."""
    random = np.random.default_rng([seed, number, 1])
    lengths = np.array(
        [
            min(cable.segments[cable.bare].sum() for cable in robot.cables if cable.winch == winch.name)
            for winch in robot.winches
        ]
    )
    for within in [True] * WITHIN + [False] * BEYOND:
        out = random.random(len(lengths)) < 0.2
        most, least = (0.3, -0.1) if within else (1.0, -0.5)
        yield within, np.where(out, least, most) * random.random(len(lengths)) * lengths


def fault(simulation: hs.Simulation, pose: hs.Equilibrium) -> str:
    """What is wrong with a pose, in words; empty if nothing is."""
    if not (np.isfinite(pose.nodes).all() and np.isfinite(pose.tensions).all()):
        return "a number is not finite"
    mesh = simulation.robot.body.mesh
    now, before = (np.linalg.det(x[mesh.elements][:, 1:] - x[mesh.elements][:, :1]) for x in (pose.nodes, mesh.nodes))
    if not (now / before).min() > 0:
        return "an element is inverted"
    rubs = bool(len(pose.history))  # then limits fit to 1e-8 of the largest tension, and these pull at many points
    assembly = simulation.path.with_history(pose) if rubs else simulation.assembly.with_active_terms(pose.nodes)
    residual = float(np.abs(assembly.gradient(pose.nodes, pose.contractions)).max())
    allowed = max(
        (1e-7 if rubs else 1e-8) * float(pose.tensions.max(initial=0.0)),
        1.01 * simulation.solver.force_tolerance(pose.nodes, pose.contractions),
    )
    return "" if residual <= allowed else f"residual {residual:.2g} N, allowed {allowed:.2g} N"


def attack(
    number: int,
    seed: int,
    solve: Callable[[hs.Simulation, Vector], hs.Equilibrium],
    draw: Callable[[int, int], tuple[Robot, str]] = random_robot,
) -> Iterator[Outcome]:
    """Give one robot its commands."""
    robot, title = draw(number, seed)
    simulation = hs.Simulation(robot)
    for within, contractions in commands(robot, number, seed):
        began, message = time.process_time(), ""
        try:
            pose = solve(simulation, contractions)
        except hs.NotConvergedError as error:
            message = str(error)
            result: Any = error.result
            pose = simulation.make_pose(contractions, result)
        spent = time.process_time() - began
        wrong = fault(simulation, pose)
        yield Outcome(
            robot=number,
            title=title,
            flat=robot.body.mesh.dim == 2,
            within=within,
            contractions=contractions.tolist(),
            reason=str(pose.result.status),
            fault=wrong,
            iterations=pose.result.iterations,
            seconds=spent,
            message=message,
        )


def report(outcomes: Sequence[Outcome]) -> None:
    """Print the tables."""
    failed = [outcome for outcome in outcomes if outcome.reason != "converged" or outcome.fault]
    print("\n| commands | converged | iterations median / p99 / max | CPU ms median / p99 / max | over 20 medians |")
    print("|---|---|---|---|---|")
    medians = {
        flat: float(np.median([outcome.seconds for outcome in outcomes if outcome.flat is flat] or [0.0]))
        for flat in (True, False)
    }
    kinds: dict[str, Callable[[Outcome], bool]] = {
        "within travel": lambda outcome: outcome.within,
        "beyond": lambda outcome: not outcome.within,
        "flat": lambda outcome: outcome.flat,
        "in space": lambda outcome: not outcome.flat,
        "all": lambda _: True,
    }
    for kind, belongs in kinds.items():
        these = [outcome for outcome in outcomes if belongs(outcome)]
        if not these:
            continue
        good = sum(outcome not in failed for outcome in these)
        steps, spent = (
            np.percentile(values, [50, 99, 100])
            for values in ([outcome.iterations for outcome in these], [1e3 * outcome.seconds for outcome in these])
        )
        slow = sum(outcome.seconds > 20 * medians[outcome.flat] for outcome in these)
        print(
            f"| {kind} | {good} of {len(these)} ({100 * good / len(these):.1f} %) "
            f"| {steps[0]:.0f} / {steps[1]:.0f} / {steps[2]:.0f} | {spent[0]:.0f} / {spent[1]:.0f} / {spent[2]:.0f} "
            f"| {slow} |"
        )
    print("\n| ended with | commands |\n|---|---|")
    for reason, count in Counter(f"{outcome.reason} {'!' if outcome.fault else ''}" for outcome in outcomes).items():
        print(f"| {reason} | {count} |")
    print()


def main(arguments: Sequence[str] | None = None) -> int:
    """Print how robots fared, then the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=10.0, help="limit of one solve")
    parser.add_argument("--friction", action="store_true", help="rubbing zigzags in place of the cables of the gallery")
    parser.add_argument("--only", type=int, nargs="*", help="numbers of robots")
    options = parser.parse_args(arguments)
    print(f"{machine()}\n{options.robots} robots, seed {options.seed}, at most {options.seconds:g} s for a solve\n")

    def solve(simulation: hs.Simulation, contractions: Vector) -> hs.Equilibrium:
        return simulation.solve(contractions, seconds=options.seconds)

    outcomes: list[Outcome] = []
    for number in options.only or range(options.robots):
        found = list(attack(number, options.seed, solve, rubbing_robot if options.friction else random_robot))
        outcomes += found
        for place, outcome in enumerate(found):
            if outcome.reason != "converged" or outcome.fault:
                where = "within" if outcome.within else "beyond"
                print(
                    f"{number}.{place} {where}: {outcome.title}: {outcome.fault}; {outcome.message} "
                    f"[{outcome.seconds:.1f} s]",
                    flush=True,
                )
    report(outcomes)
    good = [outcome.reason == "converged" and not outcome.fault for outcome in outcomes]
    near = [fine for fine, outcome in zip(good, outcomes, strict=True) if outcome.within]
    return int(np.mean(near) < LEAST_WITHIN or np.mean(good) < LEAST)


if __name__ == "__main__":
    sys.exit(main())
