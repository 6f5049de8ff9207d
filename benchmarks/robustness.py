"""Random contractions on every example: how often, how fast and why not the statics solver arrives.

    python benchmarks/robustness.py [--count 1000] [--seed 0] [EXAMPLE ...]

Each winch draws from 0 to 40 % of the length of its shortest cable outside sheaths, or, one time in five, lets out 0 to
10 %. Every pose is judged afresh, not by what the solver says: the largest nodal force must be under 1e-8 of the
largest cable force (or 1e-11 N), every element's J above 0, no number NaN. The exit code is 1 if one pose fails.
"""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.arrays import Vector
from hydrostat.mechanics import NewtonResult
from hydrostat.robot import Robot
from hydrostat.simulation import StaticSolver

EXAMPLES = Path(__file__).parents[1] / "examples"
LARGEST_SHARE = 0.4
PAY_OUT_SHARE = 0.1
PAY_OUT_ODDS = 0.2
TOLERANCE = 1e-8
ROUNDING = 1e-11
"""Forces [N] below this are rounding errors, for a cable that hardly pulls at all."""


@dataclass
class Sweep:
    """What came of the random contractions of one robot.

    Attributes:
        name: of the robot.
        nodes: of its mesh.
        reasons: how often a solve ended for each reason.
        failures: contractions [m] and what was wrong, for every pose that is not an equilibrium.
        iterations: Newton steps of each pose, all attempts counted.
        retries: poses that Newton did not reach at once, but by smaller steps.
        unstable: equilibria that are no minimum.
        buckled: minima that were reached by leaving a saddle.
        seconds: CPU time of each pose.
    """

    name: str
    nodes: int
    reasons: Counter[str] = field(default_factory=Counter)
    failures: list[tuple[list[float], str]] = field(default_factory=list)
    iterations: list[int] = field(default_factory=list)
    retries: int = 0
    unstable: int = 0
    buckled: int = 0
    seconds: list[float] = field(default_factory=list)


class CountingSolver(StaticSolver):
    """A solver that remembers every call of Newton."""

    def relax(self, *given: Any, **options: Any) -> NewtonResult:
        """Find what `StaticSolver.relax` does, and remember it."""
        result = super().relax(*given, **options)
        self.__dict__.get("calls", []).append(result)
        return result


class CountingSimulation(hs.Simulation):
    """A simulation that remembers every call of Newton, but those of load steps with a part of the weight."""

    def __init__(self, robot: Robot) -> None:
        super().__init__(robot)
        self.calls: list[NewtonResult] = []
        plain = self.solver
        self.solver = CountingSolver(plain.assembly, plain.options, plain.round_off, plain.warp)
        self.solver.__dict__["calls"] = self.calls


def example_folders() -> list[Path]:
    """Every example that has a robot.toml."""
    return sorted(file.parent for file in EXAMPLES.glob("*/robot.toml"))


def reaches(robot: Robot) -> Vector:
    """Largest contraction of each winch [m]."""
    return np.array(
        [
            LARGEST_SHARE * min(cable.segments[cable.bare].sum() for cable in robot.cables if cable.winch == winch.name)
            for winch in robot.winches
        ]
    )


def draw(largest: Vector, random: np.random.Generator) -> Vector:
    """Random contractions [m], some of them pay-outs."""
    out = random.random(len(largest)) < PAY_OUT_ODDS
    shares = np.where(out, -PAY_OUT_SHARE / LARGEST_SHARE, 1.0) * random.random(len(largest))
    return shares * largest


def sweep(robot: Robot, count: int, *, seed: int = 0) -> Sweep:
    """Solve `count` random contractions from rest."""
    simulation = CountingSimulation(robot)
    result = Sweep(robot.name, len(robot.body.mesh.nodes))
    largest, random = reaches(robot), np.random.default_rng(seed)
    for _ in range(count):
        contractions = draw(largest, random)
        simulation.calls.clear()
        began = time.process_time()
        pose = simulation.solve(contractions, strict=False)
        result.seconds.append(time.process_time() - began)
        result.iterations.append(sum(call.iterations for call in simulation.calls))
        result.retries += len(simulation.calls) > 1
        result.reasons[str(pose.result.status)] += 1
        result.buckled += pose.result.buckled
        result.unstable += pose.result.converged and not pose.result.stable
        wrong = fault(simulation, pose)
        if wrong:
            result.failures.append((contractions.tolist(), f"{wrong} ({pose.result.status})"))
    return result


def fault(simulation: hs.Simulation, pose: hs.Equilibrium) -> str:
    """What is wrong with a pose, in words; empty if nothing is."""
    if not (np.isfinite(pose.nodes).all() and np.isfinite(pose.tensions).all() and np.isfinite(pose.energy)):
        return "a number is not finite"
    mesh = simulation.robot.body.mesh
    corners = pose.nodes[mesh.elements]
    ratios = np.linalg.det(corners[:, 1:] - corners[:, :1]) / np.linalg.det(
        mesh.nodes[mesh.elements][:, 1:] - mesh.nodes[mesh.elements][:, :1]
    )
    if not ratios.min() > 0:
        return f"J = {ratios.min():.2g}"
    residual = float(np.abs(simulation.assembly.gradient(pose.nodes, pose.contractions)).max())
    rigid = any(part.is_rigid for part in simulation.robot.body.parts)  # forces in rigid parts are rounded to more
    rounding = simulation.body.round_off().force if rigid else ROUNDING
    allowed = max(TOLERANCE * float(pose.tensions.max(initial=0.0)), rounding)
    return "" if residual < allowed or residual == 0.0 else f"residual {residual:.2g} N, allowed {allowed:.2g} N"


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("examples", nargs="*", help="names of example folders; all if left out")
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    robots = {folder.name: partial(hs.load_robot, folder) for folder in example_folders()}
    print(f"{machine()}\n{options.count} random contractions each, seed {options.seed}\n")
    print(
        "| body | nodes | converged | in load steps | buckled | no minimum | iterations median / p99 / max "
        "| CPU ms median / p99 |"
    )
    print("|---|---|---|---|---|---|---|---|", flush=True)
    failed = False
    for name in options.examples or robots:
        found = sweep(robots[name](), options.count, seed=options.seed)
        failed |= bool(found.failures)
        steps, seconds = (np.percentile(values, [50, 99, 100]) for values in (found.iterations, found.seconds))
        print(
            f"| {found.name} | {found.nodes} | {options.count - len(found.failures)} of {options.count} "
            f"| {found.retries} | {found.buckled} | {found.unstable} "
            f"| {steps[0]:.0f} / {steps[1]:.0f} / {steps[2]:.0f} "
            f"| {1e3 * seconds[0]:.0f} / {1e3 * seconds[1]:.0f} |",
            flush=True,
        )
        for contractions, wrong in found.failures[:10]:
            print(f"  {found.name}: {wrong} at {[float(f'{value:.6g}') for value in contractions]}", file=sys.stderr)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
