"""Random contractions with and without self-contact: what arrives, what crosses, what it costs.

    python benchmarks/contact.py [--count 100] [--minutes 60] [--seed 0] [--share 1.0] [EXAMPLE ...]

Each winch draws from 0 to a share of its travel. A pose with contact counts as wrong if the solver says so, if an
independent program (ipctk in space, our cuts of edges in the plane) finds that the body crosses itself, if an element
has J <= 0, or if a gap is below 0.3 of the distance at which it is felt. CPU time is of this process, one pose with
contact after the same pose without; "warm" is one more step of a hundredth of each travel from where it touches. A body
has so many poses, or as many as fit into some minutes. The exit code is 1 if one pose is wrong.
"""

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.arrays import Nodes, Vector
from hydrostat.geometry import find_crossings
from hydrostat.mechanics import SelfContactEnergy
from hydrostat.robot import Robot

EXAMPLES = Path(__file__).parents[1] / "examples"
BODIES = ("cupping_hand", "extended_hand", "caging_gripper", "octopus_arm", "starfish", "puppy", "squid", "robot")
LEAST_GAP = 0.3


def crosses(robot: Robot, nodes: Nodes) -> bool:
    """Return True if a body crosses itself: by ipctk in space, by cuts of edges in the plane."""
    if robot.body.mesh.dim == 2:
        return len(find_crossings(robot.body.mesh, nodes)) > 0
    import ipctk

    facets = robot.body.mesh.boundary
    outer, mapped = np.unique(facets, return_inverse=True)
    mapped = mapped.reshape(facets.shape)
    mesh = ipctk.CollisionMesh(robot.body.mesh.nodes[outer], ipctk.edges(mapped), mapped)
    return bool(ipctk.has_intersections(mesh, nodes[outer]))


def gaps(energy: SelfContactEnergy, nodes: Nodes) -> np.ndarray:
    """Gap of each pair that is felt, as a share of the distance at which it is."""
    near = energy.with_active_terms(nodes)
    squared, begins = energy.skin.compute_squared_distances(nodes, near.pairs), energy.skin.begins(near.pairs)
    return np.sqrt(squared / begins)[squared < begins]


def warm(
    free: hs.Simulation, other: hs.Equilibrium, touching: hs.Simulation, pose: hs.Equilibrium, step: Vector
) -> float:
    """How many times longer than without contact a small step takes from a pose; NaN where one does not arrive."""
    times = []
    for simulation, begin in ((free, other), (touching, pose)):
        start = time.process_time()
        arrived = simulation.solve(np.maximum(begin.contractions + step, 0.0), start=begin, strict=False)
        times.append(time.process_time() - start if arrived.result.converged else np.nan)
    return times[1] / times[0]


def study(name: str, count: int, minutes: float, seed: int, share: float) -> int:
    """Print the row of one body; return how many poses are wrong."""
    robot = hs.load_robot(EXAMPLES / name)
    free, touching = hs.Simulation(robot), hs.Simulation(replace(robot, contact=hs.Contact()))
    energy = next(each for each in touching.assembly.energies if isinstance(each, SelfContactEnergy))
    travel = np.array([winch.travel for winch in robot.winches])
    random, steps = np.random.default_rng(seed), np.random.default_rng(seed + 1)
    _ = free.rest, touching.rest
    rows, wrong, begin = [], 0, time.monotonic()
    for number in range(count):
        if rows and time.monotonic() - begin > 60 * minutes:
            break
        contractions = random.uniform(0, share, len(travel)) * travel
        start = time.process_time()
        other = free.solve(contractions, strict=False)
        middle = time.process_time()
        pose = touching.solve(contractions, strict=False)
        end = time.process_time()
        found = gaps(energy, pose.nodes)
        least = float(found.min(initial=1.0))
        good = (
            pose.result.converged
            and not crosses(robot, pose.nodes)
            and touching.assembly.min_volume_ratio(pose.nodes) > 0
            and least > LEAST_GAP
        )
        if not good:
            wrong += 1
            print(
                f"  {name} {number}: {pose.result.status}, least gap {least:.2f}, residual {pose.result.residual:.2g} N"
            )
        crossed = crosses(robot, other.nodes)
        onward = warm(free, other, touching, pose, steps.choice([-0.01, 0.01], len(travel)) * travel)
        rows.append((middle - start, end - middle, pose.result.iterations, len(found), least, crossed, onward))
    cpu, cpu_contact, iterations, felt, least_gap, crossed, onward = np.array(rows).T
    ratio, touch = cpu_contact / cpu, felt > 0
    parts = [f"{np.median(ratio[kind]):.2f}" if kind.any() else "" for kind in (touch, ~touch)]
    parts += [f"{np.quantile(ratio, 0.99):.1f}", f"{np.nanmedian(onward[touch]):.2f}" if touch.any() else ""]
    count = len(rows)
    print(
        f"| {name} | {len(robot.body.mesh.nodes)} | {count - wrong}/{count} | "
        f"{crossed.mean():.0%} | {touch.mean():.0%} | "
        f"{least_gap.min():.2f} | {np.median(iterations):.0f}, {iterations.max():.0f} | {1e3 * np.median(cpu):.1f} | "
        f"{1e3 * np.median(cpu_contact):.1f} | {' | '.join(parts)} |",
        flush=True,
    )
    return wrong


def main() -> None:
    """Print a table of all bodies."""
    parser = argparse.ArgumentParser()
    parser.add_argument("examples", nargs="*", default=BODIES)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--share", type=float, default=1.0)
    given = parser.parse_args()
    print(machine())
    print(
        "| body | nodes | right | cross without | touch | least gap | iterations: median, most | ms without | "
        "ms with | ratio where touching | elsewhere | 99 % | warm |\n|" + 13 * "---|"
    )
    wrong = sum(study(name, given.count, given.minutes, given.seed, given.share) for name in given.examples)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
