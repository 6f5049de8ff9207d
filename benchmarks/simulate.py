"""How long an equilibrium in space takes, beside SOFA's times and the goals; and how the cost grows with the body.

    python benchmarks/simulate.py [--quick] [--robots FOLDER] [--only finger trunk ...] [--largest 20000]
    python benchmarks/simulate.py --profile hand

The robots that SOFA ships are read from a folder next to this checkout (see benchmark_bodies.py) and left out if it is
not there; SOFA's times were taken on another machine (one thread at 2.1 GHz), so no ratio is given. Each row is
measured in a process of its own: CPU time of one thread, after one solve that is not counted.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from cProfile import Profile
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from pstats import Stats
from typing import Any

import numpy as np
from machine import machine

ROBOTS = Path(__file__).parents[2] / "shared" / "robots"
SIZES = {1_000: 11.2e-3, 2_000: 8.5e-3, 5_000: 6.0e-3, 10_000: 4.6e-3, 20_000: 3.55e-3}
"""About how many nodes a hand has at which element size [m]."""

FINGER_TIPS = {
    0: (-101.011, -8.132, 7.0),
    5: (-100.811, 3.302, 6.617),
    10: (-98.458, 14.537, 6.458),
    20: (-87.670, 34.964, 6.955),
}
"""Contraction [mm] and tip [mm] of the finger under gravity by SOFA 25.06: corotated elements, not Neo-Hookean ones."""


@dataclass(frozen=True)
class Solve:
    """One equilibrium to find: contractions [m], whether from the pose before, whether it is measured."""

    goal: np.ndarray
    onwards: bool = False
    counted: bool = True


Walk = Callable[[Any, np.random.Generator, int], Iterator[Solve]]
"""The solves for a robot, random numbers and a count."""


@dataclass(frozen=True)
class Case:
    """One row of the table.

    Attributes:
        name: short, for --only.
        what: is solved.
        sofa: CPU time of SOFA 25.06 for the same on another machine [ms], as text.
        goal: CPU time to stay under [ms].
        repeats: how often each solve is measured; steps of the stream, poses of the hand.
        few: the same with --quick.
        walk: the solves.
    """

    name: str
    what: str
    sofa: str
    goal: float
    repeats: int
    few: int
    walk: Walk


@dataclass
class Row:
    """What was measured.

    Attributes:
        nodes: of the mesh.
        elements: of the mesh.
        times: CPU time of each solve [ms].
        iterations: Newton's, of each solve.
        converged: how many solves did.
        residual: largest force left over by the largest cable force, of the worst solve.
        least_j: of any element in any solve.
        made: CPU time to make robot and simulation [s].
        memory: most that the process held [MB].
        hessian: CPU time to assemble one Hessian [ms].
        factors: CPU time to factorize it [ms].
    """

    nodes: int = 0
    elements: int = 0
    times: list[float] = field(default_factory=list)
    iterations: list[int] = field(default_factory=list)
    converged: int = 0
    residual: float = 0.0
    least_j: float = np.inf
    made: float = np.nan
    memory: float = np.nan
    hessian: float = np.nan
    factors: float = np.nan


def finger_steps(_robot: Any, _random: np.random.Generator, count: int) -> Iterator[Solve]:
    for _ in range(count):
        yield Solve(np.zeros(1), counted=False)
        for contraction in (5e-3, 10e-3, 15e-3, 20e-3):
            yield Solve(np.array([contraction]), onwards=True)


def one_cable(contraction: float) -> Walk:
    """The first winch takes in a length [m], from rest."""

    def walk(robot: Any, _random: np.random.Generator, count: int) -> Iterator[Solve]:
        for _ in range(count):
            yield Solve(contraction * np.eye(len(robot.winches))[0])

    return walk


def random_poses(robot: Any, random: np.random.Generator, count: int) -> Iterator[Solve]:
    for _ in range(count):
        yield Solve(random.uniform(0, 0.3 * lengths(robot)))


def stream(robot: Any, random: np.random.Generator, count: int) -> Iterator[Solve]:
    share = random.uniform(0.05, 0.2, len(robot.winches))
    yield Solve(share * lengths(robot), counted=False)
    for _ in range(count):
        share = np.abs(share + random.choice([-0.01, 0.01], len(share)))
        share = np.where(share > 0.3, 0.6 - share, share)
        yield Solve(share * lengths(robot), onwards=True)


def lengths(robot: Any) -> np.ndarray:
    """Rest length of each winch's cable outside sheaths [m]; every winch has one."""
    return np.array([cable.segments[cable.bare].sum() for cable in robot.cables])


CASES = {
    case.name: case
    for case in (
        Case("finger", "5 mm step, 0 to 20 mm, from the pose before", "16 to 96", 5, 10, 2, finger_steps),
        Case("trunk", "one cable 10 mm, from rest, no gravity", "2300", 80, 10, 2, one_cable(10e-3)),
        Case("diamond", "one cable 20 mm, from rest", "580", 100, 10, 2, one_cable(20e-3)),
        Case("diamond_34k", "one cable 20 mm, from rest", "15000", 3000, 3, 1, one_cable(20e-3)),
        Case("hand", "10 cables at random, 0 to 30 %, from rest", "", 60, 30, 5, random_poses),
        Case("stream", "hand, steps of 1 % of every cable, from the pose before", "", 15, 100, 20, stream),
    )
}


def read_robot(name: str, folder: Path) -> Any:
    """The robot of a case; a name such as "hand 3.8e-3" is a hand of that element size with one cable."""
    from benchmark_bodies import hand_robot, sofa_robots

    if name.startswith("hand "):
        robot = hand_robot(float(name.split()[1]))
        winch = robot.winch("middle flexor")
        return robot.with_network([winch], [cable for cable in robot.cables if cable.winch == winch.name])
    if name in ("hand", "stream"):
        return hand_robot()
    robot = sofa_robots(folder)[name]()
    return replace(robot, gravity=None) if name == "trunk" else robot


def measure(name: str, folder: Path, count: int, profile: Profile | None = None) -> Row:
    """Solve all that a case asks for, in this process; a profile, if given, sees the solves that count."""
    from hydrostat import Simulation

    began = time.process_time()
    robot = read_robot(name, folder)
    walk = CASES[name].walk if name in CASES else one_cable(0.15 * lengths(robot)[0])
    simulation = Simulation(robot)
    mesh = robot.body.mesh
    row = Row(nodes=len(mesh.nodes), elements=len(mesh.elements), made=time.process_time() - began)
    warm = False
    pose = None
    for solve in walk(robot, np.random.default_rng(0), count):
        start = pose if solve.onwards else None
        if not warm:
            simulation.solve(solve.goal, start=start, strict=False)
        warm = warm or solve.goal.any()
        began = time.process_time()
        with profile if profile and solve.counted else nullcontext():
            pose = simulation.solve(solve.goal, start=start, strict=False)
        taken = 1e3 * (time.process_time() - began)
        if solve.counted:
            row.times.append(taken)
            row.iterations.append(pose.result.iterations)
            row.converged += pose.result.converged
            row.residual = max(row.residual, pose.result.residual / float(pose.tensions.max()))
            row.least_j = min(row.least_j, least_j(mesh, pose.nodes))
    row.memory = peak_memory()
    row.hessian, row.factors = cost_of_factors(simulation, pose)
    return row


def cost_of_factors(simulation: Any, pose: Any) -> tuple[float, float]:
    """CPU time to assemble the Hessian at a pose, and to factorize it [ms]; the shorter of two."""
    hessian = whole = np.inf
    for _ in range(2):
        began = time.process_time()
        simulation.assembly.hessian(pose.nodes, pose.contractions)
        hessian = min(hessian, 1e3 * (time.process_time() - began))
        began = time.process_time()
        simulation.assembly.stiffness(pose.nodes, pose.contractions)
        whole = min(whole, 1e3 * (time.process_time() - began))
    return hessian, whole - hessian


def least_j(mesh: Any, nodes: np.ndarray) -> float:
    """Least ratio of an element's volume to that at rest."""
    corners = nodes[mesh.elements]
    return float((np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6 / mesh.volumes).min())


def peak_memory() -> float:
    """Most memory this process has held [MB], Python and libraries included; NaN where the system does not tell."""
    try:
        import resource
    except ImportError:
        return float("nan")
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)


def first_solve(name: str, folder: Path) -> dict[str, float]:
    """CPU time of this process [s] when each thing is done for the first time."""
    import hydrostat

    done = {"import": time.process_time()}
    robot = read_robot(name, folder)
    done["robot"] = time.process_time()
    simulation = hydrostat.Simulation(robot)
    done["simulation"] = time.process_time()
    simulation.solve(0.1 * lengths(robot), strict=False)
    return {**done, "solve": time.process_time()}


def in_own_process(folder: Path, *arguments: str, **environment: str) -> Any:
    """What this file prints when it is called with other arguments; None and the reason on stderr if it fails."""
    command = [sys.executable, __file__, "--robots", str(folder), *arguments]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, **environment})
    if ended.returncode == 0:
        return json.loads(ended.stdout)
    print(f"{' '.join(arguments)}: {ended.stderr.strip().splitlines()[-1:]}", file=sys.stderr)
    return None


def print_heads(*heads: str) -> None:
    print(f"| {' | '.join(heads)} |\n{'|---' * len(heads)}|", flush=True)


def print_cases(cases: Sequence[Case], folder: Path, *, quick: bool) -> None:
    times = ("ms median", "p95", "SOFA, another machine", "goal")
    print_heads("robot", "nodes", "what", "n", *times, "iterations", "converged", "residual", "least J", "MB")
    for case in cases:
        found = in_own_process(folder, "--measure", case.name, str(case.few if quick else case.repeats))
        if found is None:
            print(f"| {case.name} | | {case.what} | failed | | | {case.sofa} | {case.goal:g} | | | | | |", flush=True)
            continue
        row = Row(**found)
        count = len(row.times)
        print(
            f"| {case.name} | {row.nodes} | {case.what} | {count} | {np.median(row.times):.1f} "
            f"| {np.percentile(row.times, 95):.1f} | {case.sofa} | {case.goal:g} | {np.median(row.iterations):.0f} "
            f"| {row.converged} of {count} | {row.residual:.0e} | {row.least_j:.2f} | {row.memory:.0f} |",
            flush=True,
        )
    print(
        "\nTimes are CPU time. Residual: largest nodal force left over by the largest cable force, of the worst solve. "
        "MB: most memory the process held (getrusage), Python and libraries included.\n"
        "SOFA's are corotated elements, on another machine (one thread at 2.1 GHz).\n"
    )


def print_first_solve(folder: Path) -> None:
    """CPU time from a fresh process to the first solve of the hand, without and with its body kept in the cache."""
    print_heads("first solve of the hand, s", "import", "robot", "simulation", "solve", "in all")
    with tempfile.TemporaryDirectory() as cache:
        for what in ("empty cache", "body kept"):
            found = in_own_process(folder, "--first", "hand", HYDROSTAT_CACHE=cache)
            if found is not None:
                steps = np.diff([0.0, *found.values()])
                print(f"| {what} | {' | '.join(f'{step:.2f}' for step in steps)} | {found['solve']:.2f} |", flush=True)
    print()


def print_sizes(largest: int, folder: Path, *, quick: bool) -> None:
    """One cable of the hand, at several element sizes."""
    print_heads(
        "nodes",
        "elements",
        "ms",
        "iterations",
        "ms each",
        "a Hessian ms",
        "its factors ms",
        "converged",
        "made s",
        "MB",
    )
    points = []
    for size, element_size in SIZES.items():
        if size > largest:
            continue
        found = in_own_process(folder, "--measure", f"hand {element_size}", "1" if quick else "3")
        if found is None:
            continue
        row = Row(**found)
        took, steps = float(np.median(row.times)), float(np.median(row.iterations))
        points.append((row.nodes, took, row.hessian, row.factors))
        print(
            f"| {row.nodes} | {row.elements} | {took:.0f} | {steps:.0f} | {took / max(steps, 1):.1f} "
            f"| {row.hessian:.1f} | {row.factors:.1f} | {row.converged} of {len(row.times)} "
            f"| {row.made:.1f} | {row.memory:.0f} |",
            flush=True,
        )
    print("\nMade: CPU time to make mesh, robot and simulation. Contraction: 15 % of the cable, from rest.")
    if len(points) > 1:
        logs = np.log(points)
        slopes = [np.polyfit(logs[:, 0], logs[:, column], 1)[0] for column in (1, 2, 3)]
        print("CPU time grows as nodes^{:.2f}: of a Hessian ^{:.2f}, of its factors ^{:.2f}.\n".format(*slopes))


def print_finger_tips(folder: Path) -> None:
    """Whether the scene is the same: the tip of the finger, that of SOFA, and how far they are apart."""
    from hydrostat import Simulation

    simulation = Simulation(read_robot("finger", folder))
    print_heads("finger: contraction mm", "tip mm", "SOFA's, corotated", "apart mm")
    pose = None
    for contraction, expected in FINGER_TIPS.items():
        pose = simulation.solve(np.array([1e-3 * contraction]), start=pose, strict=False)
        tip = 1e3 * pose.markers["tip"]
        apart = np.linalg.norm(tip - expected)
        print(f"| {contraction} | {np.round(tip, 2)} | {np.round(expected, 2)} | {apart:.2f} |", flush=True)
    print()


def print_profile(name: str, folder: Path) -> None:
    """The functions that take most of the solves of a row, in this process."""
    profile = Profile()
    measure(name, folder, CASES[name].few, profile)
    Stats(profile).strip_dirs().sort_stats("tottime").print_stats(25)


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few repeats, no large bodies")
    parser.add_argument("--robots", type=Path, default=ROBOTS, help="folder of SOFA's robots")
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES), help="rows of the first table alone")
    parser.add_argument("--largest", type=int, default=20_000, help="nodes of the largest hand; 0: no such table")
    parser.add_argument("--profile", choices=CASES, help="where the time of one row goes, by function")
    parser.add_argument("--measure", nargs=2, help=argparse.SUPPRESS)
    parser.add_argument("--first", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.measure:
        print(json.dumps(asdict(measure(options.measure[0], options.robots, int(options.measure[1])))))
        return
    if options.first:
        print(json.dumps(first_solve(options.first, options.robots)))
        return
    if options.profile:
        print_profile(options.profile, options.robots)
        return
    there = {"hand", "stream"} | {name for name in CASES if (options.robots / name / "case.json").is_file()}
    print(f"{machine()}\n")
    missing = [name for name in options.only if name not in there]
    if missing:
        print(f"Left out, for {options.robots} does not hold them: {', '.join(missing)}\n")
    print_cases([CASES[name] for name in options.only if name in there], options.robots, quick=options.quick)
    if options.only != list(CASES):
        return
    print_first_solve(options.robots)
    if "finger" in there:
        print_finger_tips(options.robots)
    print_sizes(min(options.largest, 2_000) if options.quick else options.largest, options.robots, quick=options.quick)


if __name__ == "__main__":
    main()
