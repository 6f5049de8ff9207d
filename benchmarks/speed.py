"""Speed of hydrostat in one table: CPU time of one thread, at each vector level that the processor has.

    python benchmarks/speed.py [--quick] [--only hand stream ...] [--levels v3 v4] [--against PYTHON] [--write FILE]

Each row is measured in a process of its own with HYDROSTAT_LEVEL set, `speed.py --row NAME COUNT`, which prints JSON.
`--against` measures the same rows by another Python, whose hydrostat is another checkout. Goals are for AVX2 (v3) and
AVX-512 (v4). MuJoCo is installed into an environment in the user's cache; SOFA's times are published ones of another
machine. `--tests` takes a sentence about `make test`, which is not run here.
"""

import argparse
import contextlib
import io
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

from machine import machine  # isort: skip  (before NumPy)
import numpy as np
from startup import COMMANDS

EXAMPLES = Path(__file__).parents[1] / "examples"
BODIES = ("cupping_hand", "extended_hand", "caging_gripper", "octopus_arm", "starfish", "puppy", "squid", "robot")
SHARED = Path(__file__).parents[2] / "shared" / "robots"
DEADLINE = 0.3
"""Time limit of each search in the row of deadlines [s]."""
LEVELS = ("base", "v3", "v4")
LIMIT = 3600
"""Longest process [s]."""


@dataclass(frozen=True)
class Row:
    """A row, or several that are measured together.

    Attributes:
        what: in the table.
        unit: of the numbers.
        goal: text: AVX2 / AVX-512; for several rows by their names.
        count: how many or how often.
        few: the same with --quick.
        levels: whether it depends on the vector level; else only the highest is measured.
    """

    what: str
    unit: str
    goal: str | dict[str, str]
    count: int
    few: int
    levels: bool = True


CONTACT = {"touching": "2", "not": "1.15"}
GOALS = {name: f"{goal:g}" for name, (_, goal) in COMMANDS.items() if goal is not None}

ROWS = {
    "hand": Row("cupping hand from rest, random poses to 30 %", "ms", "22 / 13", 12, 6),
    "stream": Row("stream, steps of 1 %", "ms", "10 / 7", 60, 20),
    "columns": Row("ten columns dx/da", "ms", {"by factors": "0.8 / 0.5"}, 300, 50),
    "sample": Row("sample with contact and Jacobians, hand, full travel", "a second", "12 / 20", 64, 16),
    **{
        f"contact_{name}": Row(
            f"contact by none, {name}",
            "ratio",
            CONTACT | ({"touching": "4"} if name in ("extended_hand", "caging_gripper") else {}),
            30,
            6,
        )
        for name in BODIES
    },
    "rod": Row("slender rod, nine cables", "ms", "60", 30, 10),
    "friction": Row(
        "friction, zigzag routes, within travel", "", {"converged %": "99.5", "over 20 x median": "0"}, 40, 12
    ),
    "deadlines": Row("longest overrun of a deadline, random robots with friction and contact", "s", "0.3", 500, 24),
    "commands": Row("command", "s", GOALS, 3, 1, levels=False),
    "first": Row("first pose after installing", "s", {"starfish": "1", "hand": "1.5"}, 3, 1, levels=False),
    "environment": Row("environment of make demo", "MB", "500", 1, 1, levels=False),
    "collection": Row("collection of the tests", "s", "15", 1, 1, levels=False),
    "mujoco": Row("hand under its weight, to 1 %", "ms", "", 1, 1, levels=False),
    "sofa_finger": Row("SOFA's finger, 5 mm steps; SOFA 16 to 96 on another machine", "ms", "10", 10, 2),
    "sofa_trunk": Row("SOFA's trunk, one cable 10 mm; SOFA 2300 on another machine", "ms", "80", 10, 2),
    "sofa_diamond": Row("SOFA's diamond, one cable 20 mm; SOFA 580 on another machine", "ms", "100", 10, 2),
}


def levels_of(python: str) -> list[str]:
    """Vector levels that this processor and that core have."""
    code = "import hydrostat.kernel as kernel; assert kernel.native"
    return [level for level in LEVELS if run(python, ["-c", code], level).returncode == 0]


def run(python: str, arguments: Sequence[str], level: str) -> subprocess.CompletedProcess[str]:
    """Run Python at a vector level; another checkout's Python finds its own package."""
    environment = os.environ | {"HYDROSTAT_LEVEL": level, "HYDROSTAT_THREADS": "1"}
    if python != sys.executable:
        environment.pop("PYTHONPATH", None)
    command = [python, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment, timeout=LIMIT)


def measure(python: str, name: str, count: int, level: str) -> dict[str, float]:
    """Numbers of a row by name; one number has the name "". Empty if it failed, with the reason on stderr."""
    try:
        ended = run(python, [__file__, "--row", name, str(count)], level)
    except subprocess.TimeoutExpired:
        print(f"{name} at {level}: stopped after {LIMIT} s", file=sys.stderr)
        return {}
    if ended.returncode:
        print(f"{name} at {level}: {ended.stderr.strip().splitlines()[-1:]}", file=sys.stderr)
        return {}
    found: Any = json.loads(ended.stdout)
    return found if isinstance(found, dict) else {"": found}


def text_of(value: float | None) -> str:
    """A number with three digits; "failed" for none."""
    return "failed" if value is None or math.isnan(value) else f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def lines_of(name: str, columns: Sequence[tuple[str, str]], *, quick: bool) -> Iterator[str]:
    """Lines of the table for a row; a column is a Python and a level."""
    row = ROWS[name]
    highest = dict(columns)
    found = [
        measure(python, name, row.few if quick else row.count, level)
        if row.levels or highest[python] == level
        else None
        for python, level in columns
    ]
    parts = list(dict.fromkeys(part for numbers in found if numbers for part in numbers)) or [""]
    for part in parts:
        goal = row.goal.get(part, "") if isinstance(row.goal, dict) else row.goal
        cells = ["" if numbers is None else text_of(numbers.get(part)) for numbers in found]
        what = ": ".join(filter(None, (row.what, part)))
        yield f"| {what} | {row.unit} | {goal} | {' | '.join(cells)} |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few poses, once")
    parser.add_argument("--only", nargs="+", default=list(ROWS), metavar="ROW", help="rows, or how their names begin")
    parser.add_argument("--levels", nargs="+", choices=LEVELS, default=list(LEVELS))
    parser.add_argument("--against", metavar="PYTHON", help="Python of another checkout, measured too")
    parser.add_argument("--tests", metavar="TEXT", default="", help="what `make test` took")
    parser.add_argument("--robots", type=Path, default=SHARED, help="folder of SOFA's robots")
    parser.add_argument("--write", type=Path, metavar="FILE", help="write the table there, too")
    options = parser.parse_args(arguments)
    os.environ["SOFA_ROBOTS"] = str(options.robots.absolute())
    pythons = [sys.executable, *([options.against] if options.against else [])]
    columns = [(python, level) for python in pythons for level in levels_of(python) if level in options.levels]
    names = [name for name in ROWS if any(name.startswith(begin) for begin in options.only)]
    absent = [
        name for name in names if name.startswith("sofa_") and not (options.robots / name[5:] / "case.json").exists()
    ]
    names = [name for name in names if name not in absent]
    told: list[str] = []

    def tell(line: str) -> None:
        print(line, flush=True)
        told.append(line)

    heads = [f"{level}, against" if python == options.against else level for python, level in columns]
    tell(f"{machine()}; CPU time, vector levels {', '.join(options.levels)}\n")
    tell(f"| what | unit | goal, v3 / v4 | {' | '.join(heads)} |\n|---|---|---|{'---|' * len(heads)}")
    for name in names:
        for line in lines_of(name, columns, quick=options.quick):
            tell(line)
    if absent:
        tell(f"\nLeft out, as their files are not in {options.robots} (--robots): {', '.join(absent)}")
    if options.tests:
        tell(f"\n`make test`: {options.tests}")
    if options.write:
        options.write.write_text("\n".join(told) + "\n", encoding="utf-8")


def cpu(function: Callable[[], Any]) -> tuple[float, Any]:
    """CPU time of a call [s], and its result."""
    began = time.process_time()
    found = function()
    return time.process_time() - began, found


def median_solve(name: str, count: int, repeats: int = 3) -> float:
    """Median over the solves of a case in simulate.py [ms], each the least of some runs."""
    from simulate import measure

    folder = Path(os.environ.get("SOFA_ROBOTS", SHARED))
    return float(np.median(np.min([measure(name, folder, count).times for _ in range(repeats)], axis=0)))


def columns(count: int) -> dict[str, float]:
    """dx/da of the hand's ten cables at a pose [ms]: by the factors alone, and with the residual refined."""
    from benchmark_bodies import hand_robot
    from simulate import lengths

    from hydrostat import Simulation

    simulation = Simulation(robot := hand_robot())
    pose = simulation.solve(0.15 * lengths(robot))
    stiffness = simulation.stiffness(pose)
    right = np.random.default_rng(0).standard_normal((pose.nodes.size, len(robot.winches)))
    solved = min(cpu(lambda: stiffness.factors.solve(right))[0] for _ in range(count))
    refined = min(cpu(lambda: simulation.jacobian(pose))[0] for _ in range(count))
    return {"by factors": 1e3 * solved, "refined": 1e3 * refined}


def sample(count: int) -> float:
    """Samples of the hand with contact and Jacobians, a second; contractions up to full travel."""
    from benchmark_bodies import hand_robot

    from hydrostat.learning import SamplePlan, sample_shard

    plan = SamplePlan.of_robot(hand_robot(), count, contact=True, shard=count)
    return count / cpu(lambda: sample_shard(plan, 0))[0]


def contact(name: str, count: int) -> dict[str, float]:
    """Median of CPU time with contact by that without, poses up to full travel, where the body touches and not."""
    import hydrostat as hs

    robot = hs.load_robot(EXAMPLES / name)
    free, touching = hs.Simulation(robot), hs.Simulation(replace(robot, contact=hs.Contact()))
    travel = np.array([winch.travel for winch in robot.winches])
    random = np.random.default_rng(0)
    _ = free.rest, touching.rest
    ratios: dict[str, list[float]] = {"touching": [], "not": []}
    for _ in range(count):
        goal = random.uniform(0, 1, len(travel)) * travel
        without, _ = cpu(lambda goal=goal: free.solve(goal, strict=False))
        taken, pose = cpu(lambda goal=goal: touching.solve(goal, strict=False))
        ratios["touching" if hs.find_contacts(touching, pose) else "not"].append(taken / without)
    return {name: median(found) for name, found in ratios.items() if found}


def rod(count: int) -> dict[str, float]:
    """Median over poses of a slender rod with nine cables [ms], by friction coefficient."""
    from benchmark_bodies import rod_commands, rod_robot

    from hydrostat import Simulation

    found = {}
    for name, rub in (("without friction", 0.0), ("friction 0.2", 0.2)):
        simulation = Simulation(rod_robot(rub))
        _ = simulation.rest
        times = [cpu(partial(simulation.solve, goal, strict=False)) for goal in rod_commands(count)]
        good = all(pose.result.converged for _, pose in times)
        found[name] = 1e3 * median(taken for taken, _ in times) if good else float("nan")
    return found


def friction(count: int) -> dict[str, float]:
    """Poses within travel on random zigzags [%] that converge, and how many take over 20 times the median."""
    from attack import commands, rubbing_robot

    from hydrostat import Simulation

    times, good = [], 0
    for number in range(count):
        robot, _ = rubbing_robot(number, 31)
        simulation = Simulation(robot)
        for within, goal in commands(robot, number, 31):
            if within:
                taken, pose = cpu(partial(simulation.solve, goal, strict=False, seconds=20))
                good += pose.result.converged
                times.append(taken)
    slow = sum(taken > 20 * median(times) for taken in times)
    return {"converged %": 100 * good / len(times), "over 20 x median": slow, "poses": len(times)}


def deadlines(count: int) -> float:
    """Longest overrun of inverse kinematics with a time limit, by the clock [s]."""
    from deadlines import NAMES, draw_robot, overrun

    random = np.random.default_rng(7)
    robots = (draw_robot(NAMES[number % len(NAMES)], random) for number in range(count))
    return max(overrun(robot, DEADLINE, random)[0] for robot in robots)


def commands(count: int) -> dict[str, float]:
    """Commands of startup.py [s]."""
    from startup import seconds

    found = {}
    for name, (command, _) in COMMANDS.items():
        with tempfile.TemporaryDirectory() as kept:
            done = [taken for taken in [seconds(command, kept) for _ in range(count + 1)][1:] if taken is not None]
        found[name] = min(done) if len(done) == count else float("nan")
    return found


def first_pose(count: int) -> dict[str, float]:
    """First pose after installing [s], from a process's start: nothing compiled or kept before."""
    from startup import ROBOTS, solve_times

    found = {}
    for robot in ROBOTS:
        with contextlib.ExitStack() as stack:
            folders = [stack.enter_context(tempfile.TemporaryDirectory()) for _ in range(count)]
            os.environ["XDG_CACHE_HOME"] = folders[0]
            laps = [solve_times(robot, folder) for folder in folders]
        found[robot] = min(sum(phase[0] for phase in lap[:4]) for lap in laps)
    return found


def environment(_: int) -> float:
    """Size of a fresh environment with what `make demo` installs [MB]."""
    root = Path(__file__).parents[1]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        command = [f"{folder}/bin/python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        command += ["--constraint", str(root / "constraints.txt"), "--editable", str(root)]
        subprocess.run(command, check=True, capture_output=True)
        return sum(path.lstat().st_size for path in Path(folder).rglob("*") if path.is_file()) / 1e6


def collection(_: int) -> float:
    """CPU time in which pytest collects all tests, once their bytecode is kept [s]."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    taken = 0.0
    for _ in range(2):
        began = os.times()
        subprocess.run(
            [sys.executable, "-m", "pytest", "--collect-only", "-q"],
            cwd=Path(__file__).parents[1], env=kept, check=True, capture_output=True,
        )  # fmt: skip
        ended = os.times()
        taken = ended.children_user + ended.children_system - began.children_user - began.children_system
    return taken


def mujoco(_: int) -> dict[str, float]:
    """CPU time to 1 % of the largest move of the hand under its weight [ms], by MuJoCo's flex and by hydrostat."""
    sys.path.append(str(Path(__file__).parents[1] / "lab" / "peers"))
    import peers

    folder = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "hydrostat" / "peers"
    body = peers.gallery_body("cupping_hand", 1)
    chosen = [peer for peer in peers.PEERS if peer.name in ("hydrostat", "MuJoCo flex", "MuJoCo flex, SNH")]
    true = peers.truths(body, {peer.law for peer in chosen} | {"Neo-Hookean"})
    way = float(peers.apart(true["Neo-Hookean"], body.nodes))
    found = {}
    with tempfile.TemporaryDirectory() as place:
        body.save(stored := Path(place) / "body.npz")
        for peer in chosen:
            trail, reason = peers.run(peer, folder, stored, 20.0)
            if trail is None:
                print(f"{peer.name}: {reason}", file=sys.stderr)
                found[peer.name] = float("nan")
                continue
            near = peers.apart(trail.answers, true[peer.law]) <= 0.01 * way
            found[peer.name] = 1e3 * float(trail.seconds[near][0]) if near.any() else float("nan")
    return found


MEASURES: dict[str, Callable[[int], Any]] = {
    "hand": lambda count: median_solve("hand", count),
    "stream": lambda count: median_solve("stream", count),
    "columns": columns,
    "sample": sample,
    **{f"contact_{name}": lambda count, name=name: contact(name, count) for name in BODIES},
    "rod": rod,
    "friction": friction,
    "deadlines": deadlines,
    "commands": commands,
    "first": first_pose,
    "environment": environment,
    "collection": collection,
    "mujoco": mujoco,
    **{f"sofa_{name}": lambda count, name=name: median_solve(name, count) for name in ("finger", "trunk", "diamond")},
}
"""What a row is measured by; it takes how often or how many."""


if __name__ == "__main__" and sys.argv[1:2] == ["--row"]:  # NaN: it failed
    with contextlib.redirect_stdout(io.StringIO()):
        measured = MEASURES[sys.argv[2]](int(sys.argv[3]))
    print(json.dumps(measured))
elif __name__ == "__main__":
    assert ROWS.keys() == MEASURES.keys()
    main()
