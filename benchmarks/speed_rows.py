"""What `speed.py` measures, each row in a process of its own: `python speed_rows.py NAME COUNT` prints it as JSON.

A row is a number or several by name, CPU time of one thread unless its unit says otherwise. NaN: it failed.
"""

import contextlib
import io
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

from machine import machine as machine  # isort: skip  (before NumPy)
import numpy as np

EXAMPLES = Path(__file__).parents[1] / "examples"
BODIES = ("cupping_hand", "extended_hand", "caging_gripper", "octopus_arm", "starfish", "puppy", "squid", "robot")
SHARED = Path(__file__).parents[2] / "shared" / "robots"
DEADLINE = 0.3
"""Time limit of each search in the row of deadlines [s]."""


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
    from hand_body import hand_robot
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
    from hand_body import hand_robot

    from hydrostat.learning import plan_samples, sample_shard

    plan = plan_samples(hand_robot(), count, contact=True, shard=count)
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
    from rod_body import rod_commands, rod_robot

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
    from startup import COMMANDS, seconds

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


def mujoco(_: int) -> dict[str, float]:
    """CPU time to 1 % of the largest move of the hand under its weight [ms], by MuJoCo's flex and by hydrostat."""
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
    "mujoco": mujoco,
    **{f"sofa_{name}": lambda count, name=name: median_solve(name, count) for name in ("finger", "trunk", "diamond")},
}
"""What a row is measured by; it takes how often or how many."""


if __name__ == "__main__" and len(sys.argv) > 1:  # speed.py starts it, a row at a time
    with contextlib.redirect_stdout(io.StringIO()):
        measured = MEASURES[sys.argv[1]](int(sys.argv[2]))
    print(json.dumps(measured))
