"""Networks at random, with the counts and constraints of those that are designed.

    python lab/designs/design_random.py [--count 500] [--seed 0] [BODY ...]

Winches stand at places drawn evenly from all that are allowed; each pulls at least one cable. A cable is a walk at
random from its winch through the graph that routes are priced on, of a length drawn evenly, without sharp turns: how
sharp is drawn for each cable, so that there are straight ones and winding ones. It is laid as the designed ones are,
half of them with a sheathed lead. What cannot be built is drawn again.
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass

from design_bodies import BODIES, Body, body_robot, judged
from machine import machine

import numpy as np  # isort: skip

from hydrostat.design import (
    CableRoute,
    Constraints,
    Layout,
    PricedPath,
    Region,
    RouteGraph,
    RouteOptions,
    WinchSite,
    rms_error,
    route_along,
    violations,
)
from hydrostat.errors import HydrostatError
from hydrostat.ik import IKOptions, IKResult, Limits, solve_ik
from hydrostat.robot import Mount, PoseTarget, Robot, Winch
from hydrostat.simulation import Simulation

TRIES = 60
"""Walks that one cable is drawn from, before the network is begun again."""

NETWORKS = 2000
"""Networks begun, before it is held to be impossible."""

LONGEST = 1.2
"""Of a cable, in sizes of the body."""

TURNS = (10.0, 75.0)
"""Least and largest limit on the turns of a walk [degrees]."""

SHORTEST = 2
"""Edges that a walk must have, to be more than a stub."""

ROUNDS = ((4, 3), (4, 10), (0, 100))
"""Rounds: one in so many goes on, just the final ones where it is 0; steps of inverse kinematics in each."""

FINAL = 5
"""So many of the best are solved to the end by the judge, and so many at least go on from each round."""


@dataclass(frozen=True, eq=False)
class Ground:
    """What networks are drawn on: a robot, where cables may be, the graph, and how far apart via points are [m]."""

    robot: Robot
    constraints: Constraints
    region: Region
    graph: RouteGraph
    spacing: float


def ground(robot: Robot, constraints: Constraints) -> Ground:
    """The same as routes are found on."""
    mesh = robot.body.mesh
    edge = float(mesh.edge_lengths.mean())
    region = Region.of_body(robot.body, constraints.clearance)
    graph = RouteGraph.build(robot, region, constraints, spacing=edge)
    return Ground(robot, constraints, region, graph, RouteOptions().spacing * edge)


def random_network(on: Ground, winches: int, cables: int, draw: np.random.Generator) -> Robot | None:
    """A network at random that can be built; None if none is found."""
    for _ in range(NETWORKS):
        places = _places(on, winches, draw)
        robot = None if places is None else _with_cables(on, places, _share(on, winches, cables, draw), draw)
        if robot is not None:
            return robot
    return None


def _places(on: Ground, winches: int, draw: np.random.Generator) -> list[int] | None:
    """Graph points far enough apart for winches."""
    chosen: list[int] = []
    for place in draw.permutation(on.graph.winch_places).tolist():
        away = np.linalg.norm(on.graph.points[chosen] - on.graph.points[place], axis=1)
        if on.graph.world[place] or not chosen or away.min() >= on.constraints.winch_gap:
            chosen.append(place)
        if len(chosen) == winches:
            return chosen
    return None


def _share(on: Ground, winches: int, cables: int, draw: np.random.Generator) -> list[int]:
    """The winch of each cable, in order."""
    counts = np.ones(winches, dtype=int)
    for _ in range(cables - winches):
        room = np.flatnonzero(counts < on.constraints.cables_per_winch)
        counts[draw.choice(room)] += 1
    return np.repeat(np.arange(winches), counts).tolist()


def _with_cables(on: Ground, places: list[int], share: list[int], draw: np.random.Generator) -> Robot | None:
    """A cable after the other, each drawn until it goes with those before."""
    sites = tuple(WinchSite(_winch(on, place, number)) for number, place in enumerate(places))
    lines: list[CableRoute] = []
    robot = None
    for winch in share:
        for _ in range(TRIES):
            line = _random_line(on, winch, places[winch], draw)
            if line is None:
                continue
            robot = Layout(on.robot, on.constraints, sites, (*lines, line)).robot(digits=5)
            if not violations(robot, on.constraints, on.region):
                lines.append(line)
                break
        else:
            return None
    return robot


def _winch(on: Ground, place: int, number: int) -> Winch:
    world = bool(on.graph.world[place])
    at = on.graph.points[place]
    return Winch(
        name=f"winch_{number + 1}",
        at=tuple(float(value) if world else round(float(value), 5) for value in at),
        spool_radius=on.constraints.spool_radius,
        travel=on.constraints.travel,
        release=on.constraints.release,
        mount=Mount.WORLD if world else Mount.BODY,
    )


def _random_line(on: Ground, winch: int, place: int, draw: np.random.Generator) -> CableRoute | None:
    """A walk as a cable; half of them run in a sheath up to some point of their first half."""
    walk = _walk(on, place, draw)
    if len(walk) < SHORTEST + 1:
        return None
    first = 1 if on.graph.world[place] else 0
    if draw.random() < 0.5:
        first = int(draw.integers(first, max(first, len(walk) // 2) + 1))
    path = PricedPath(
        nodes=tuple(walk[first:]), lead=tuple(walk[: first + 1]), gain=0.0, moves=np.zeros(0), tensions=np.zeros(0)
    )
    at = np.asarray(_winch(on, place, winch).at)
    try:
        return route_along(path, on.graph, winch=winch, place=at, spacing=on.spacing) if len(path.nodes) > 1 else None
    except HydrostatError:
        return None


def _walk(on: Ground, place: int, draw: np.random.Generator) -> list[int]:
    """Graph points from a winch on, each drawn evenly from those that are no sharp turn and not yet visited."""
    graph = on.graph
    wanted = draw.uniform(2 * on.spacing, LONGEST * graph.size)
    straight = np.cos(np.radians(draw.uniform(*TURNS)))
    walk, way, before = [place], 0.0, None
    while way < wanted:
        ahead = np.arange(graph.offsets[walk[-1]], graph.offsets[walk[-1] + 1])
        ends = graph.targets[ahead]
        spans = graph.points[ends] - graph.points[walk[-1]]
        lengths = np.linalg.norm(spans, axis=1)
        good = ~np.isin(ends, walk) & ~graph.world[ends]
        if before is not None:
            good &= spans @ before >= straight * lengths
        if not good.any():
            break
        chosen = draw.choice(np.flatnonzero(good))
        if not graph.world[walk[-1]]:
            way += float(lengths[chosen])
            before = spans[chosen] / lengths[chosen]
        walk.append(int(ends[chosen]))
    return walk


@dataclass(frozen=True, eq=False)
class Best:
    """The best of many networks.

    Attributes:
        robot: with it.
        error: rms over markers and poses [m].
        errors: of all networks as the first round left them, the best first [m].
        seconds: CPU time.
    """

    robot: Robot
    error: float
    errors: tuple[float, ...]
    seconds: float


def best_of(
    robot: Robot,
    poses: Sequence[PoseTarget],
    body: Body,
    *,
    count: int = 500,
    seed: int = 0,
) -> Best | None:
    """The best of `count` random networks; None if none can be built.

    A few steps of inverse kinematics for all, more for the best quarter, all for the best of these; the best few are
    judged as every network is.
    """
    began = time.process_time()
    draw, on = np.random.default_rng(seed), ground(robot, body.constraints)
    drawn = (random_network(on, body.winches, body.cables, draw) for _ in range(count))
    left = [network for network in drawn if network is not None]
    errors: list[float] = []
    for number, (share, iterations) in enumerate(ROUNDS):
        ranked = sorted(
            ((_rough(network, poses, body.constraints, iterations), network) for network in left),
            key=lambda pair: pair[0],
        )
        errors = errors if number else [error for error, _ in ranked]
        left = [network for _, network in ranked[: max(FINAL, len(ranked) // share) if share else FINAL]]
    if not left:
        return None
    final = [(judged(network, poses, body.constraints), network) for network in left]
    error, best = min(final, key=lambda pair: pair[0])
    return Best(best, error, tuple(errors), time.process_time() - began)


def _rough(robot: Robot, poses: Sequence[PoseTarget], constraints: Constraints, iterations: int) -> float:
    """Rms error over markers and poses [m] after so many steps from rest."""
    simulation, limits = Simulation(robot), Limits(tension=constraints.tension_limit)
    options = IKOptions(iterations=iterations, restarts=0, min_tension=False)
    reached: list[IKResult] = []
    for pose in poses:
        try:
            reached.append(solve_ik(simulation, pose, limits=limits, options=options))
        except HydrostatError:
            return float("inf")
    return rms_error(reached)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("bodies", nargs="*", help="names of bodies; all of them if left out")
    parser.add_argument("--count", type=int, default=500, help="networks to draw for each body")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    print(f"{machine()}; {options.count} random networks, seed {options.seed}\n")
    print("| body | networks | best, mm rms | median after a few steps, mm | CPU s |\n|---|---|---|---|---|")
    for name in options.bodies or BODIES:
        robot = body_robot(name)
        best = best_of(robot, list(robot.poses.values()), BODIES[name], count=options.count, seed=options.seed)
        if best is None:
            print(f"| {name} | 0 | | | |", flush=True)
            continue
        print(
            f"| {name} | {len(best.errors)} | {1e3 * best.error:.2f} | {1e3 * float(np.median(best.errors)):.2f} "
            f"| {best.seconds:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
