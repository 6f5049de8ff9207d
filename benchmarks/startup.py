"""How long hydrostat takes to start, in a fresh process each time.

    python benchmarks/startup.py [--repeats 15] [--commands]
    python benchmarks/startup.py --together 4
    python benchmarks/startup.py --check 3.3

Commands first: cold, with empty caches as after installing, and warm, when the body has been meshed. Then a first
solve, phase by phase, cold and warm too. Python keeps bytecode, even where PYTHONDONTWRITEBYTECODE forbids it.

The flat robot is the gallery's starfish, the one in space the hand of `benchmark_bodies.py`, of few nodes; each has its
own folder. In commands the hand is the example `cupping_hand`.

With `--together N` only this: N processes begin together on one empty cache, and each solves a robot; then N again, now
that the body is kept. It fails unless all of them end well and give the same bytes.

With `--check` only this: `hydrostat check` of the hand with elements of so many millimeters, in a process of its own,
once as the gallery's surface, which is meshed, and once as a folder that holds the ready mesh.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from statistics import median

from machine import machine  # isort: skip  (before NumPy)

HYDROSTAT = [sys.executable, "-c", "from hydrostat.cli.main import main; main()"]
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

STARFISH = str(Path(__file__).parents[1] / "examples" / "starfish")

HAND, GRIPPER = (str(Path(STARFISH).parent / name) for name in ("cupping_hand", "caging_gripper"))

COMMANDS = {
    "python -c pass": ([sys.executable, "-c", "pass"], None),
    "import hydrostat": ([sys.executable, "-c", "import hydrostat"], None),
    "import hydrostat.robot": ([sys.executable, "-c", "import hydrostat.robot"], None),
    "hydrostat --help": ([*HYDROSTAT, "--help"], None),
    "hydrostat materials": ([*HYDROSTAT, "materials"], None),
    "simulate starfish": ([*HYDROSTAT, "simulate", STARFISH, "--contract", "left=12mm", "--out", "{out}/a"], 0.7),
    "pose starfish": ([*HYDROSTAT, "pose", STARFISH, "--pose", "wave", "--out", "{out}/a"], 0.8),
    "new, of the gallery": ([*HYDROSTAT, "new", "{out}/new", "--from", "gallery:starfish"], 0.8),
    "check starfish": ([*HYDROSTAT, "check", STARFISH], 1.5),
    "fabricate starfish": ([*HYDROSTAT, "fabricate", STARFISH, "--out", "{out}/a"], 2.5),
    "simulate hand": ([*HYDROSTAT, "simulate", HAND, "--out", "{out}/a"], 1.2),
    "check hand": ([*HYDROSTAT, "check", HAND], 3.0),
    "fabricate hand": ([*HYDROSTAT, "fabricate", HAND, "--out", "{out}/a"], 8.0),
    "grasp gripper": ([*HYDROSTAT, "grasp", GRIPPER, "--pose", "close", "--out", "{out}/a"], 8.0),
}
"""Name, command, and the CPU time [s] that it should stay under."""


def seconds(command: list[str], kept: str) -> float | None:
    """CPU time of one run whose caches are in the folder `kept`; None if it fails."""
    environment = os.environ | {"HYDROSTAT_CACHE": kept}
    with tempfile.TemporaryDirectory() as out:
        used = used_by_children()
        words = [word.format(out=out) for word in command]
        ended = subprocess.run(words, capture_output=True, check=False, env=environment)
    return used_by_children() - used if ended.returncode == 0 else None


def print_commands(repeats: int) -> None:
    """A table of commands: cold once, with empty caches as after installing; warm the median."""
    print("| command | cold, CPU s | warm, CPU s | goal |\n|---|---|---|---|")
    for name, (command, goal) in COMMANDS.items():
        with tempfile.TemporaryDirectory() as kept:
            cold, *warm = [seconds(command, kept) for _ in range(repeats + 1)]
        usual = [taken for taken in warm if taken is not None]
        failed = cold is None or len(usual) < repeats
        text = "failed | failed" if failed else f"{cold:.2f} | {median(usual):.2f}"
        print(f"| `{name}` | {text} | {f'< {goal}' if goal else ''} |", flush=True)


def used_by_children() -> float:
    """CPU time of all processes that were begun here and have ended."""
    times = os.times()
    return times.children_user + times.children_system


ROBOTS = {
    "starfish": "robot = hydrostat.robot.load_robot(hydrostat.robot.gallery_folder('starfish'))",
    "hand": "from benchmark_bodies import hand_robot\nrobot = hand_robot(17e-3)",
}
"""How to make a robot."""

PHASES = ("imports", "robot", "simulation", "first solve", "second solve", "together")

SOLVE = """
import json, time
clocks = [(time.process_time(), time.perf_counter())]
def lap():
    clocks.append((time.process_time(), time.perf_counter()))
import hydrostat.robot, hydrostat.simulation
lap()
{robot}
lap()
simulation = hydrostat.simulation.Simulation(robot)
lap()
for contraction in (0.004, 0.005):
    assert simulation.solve({{robot.winches[0].name: contraction}}).result.status == 'converged'
    lap()
laps = [[b - a for a, b in zip(*pair)] for pair in zip(clocks, clocks[1:])]
print(json.dumps(laps + [[b - a for a, b in zip(clocks[0], clocks[-1])]]))
"""


def solve_times(robot: str, folder: str) -> list[list[float]]:
    """CPU and wall-clock time [s] of each phase of a first solve."""
    here = str(Path(__file__).parent)
    path = os.pathsep.join((here, os.environ.get("PYTHONPATH", "")))
    environment = os.environ | {"HYDROSTAT_CACHE": folder, "PYTHONPATH": path}
    code = SOLVE.format(robot=ROBOTS[robot])
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    return json.loads(ended.stdout)


def print_solves(repeats: int) -> None:
    """A table of first solves: cold once, warm the median."""
    print("\n| robot | phase | cold, CPU s | cold, wall s | warm, CPU s | warm, wall s |\n|---|---|---|---|---|---|")
    for robot in ROBOTS:
        with tempfile.TemporaryDirectory() as folder:
            cold, *warm = [solve_times(robot, folder) for _ in range(repeats + 1)]
        for index, phase in enumerate(PHASES):
            usual = [median(times[index][clock] for times in warm) for clock in (0, 1)]
            cells = " | ".join(f"{value:.3f}" for value in (*cold[index], *usual))
            print(f"| {robot} | {phase} | {cells} |")


SHAPE = """
import hydrostat.robot, hydrostat.simulation
{robot}
simulation = hydrostat.simulation.Simulation(robot)
solved = simulation.solve({{robot.winches[0].name: 0.004}})
assert solved.result.status == 'converged'
print(solved.nodes.tobytes().hex())
"""


def shapes(robot: str, variables: dict[str, str], processes: int) -> list[bytes]:
    """The shapes that processes begun at once find (RuntimeError: one of them failed or had something to say)."""
    here = os.pathsep.join((str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")))
    environment = os.environ | {"PYTHONPATH": here} | variables
    command = [sys.executable, "-c", SHAPE.format(robot=ROBOTS[robot])]
    begun = [
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
        for _ in range(processes)
    ]
    ended = [process.communicate() for process in begun]
    failed = [words for process, (_, words) in zip(begun, ended, strict=True) if process.returncode or words]
    if failed:
        raise RuntimeError(f"{robot}: {len(failed)} of {processes} processes failed: {failed[0]}")
    return [bytes.fromhex(found) for found, _ in ended]


def print_together(processes: int) -> None:
    """A table of processes that share one cold cache, and of as many that find it warm; an error if bytes differ."""
    print("| robot | processes | cold, wall s | warm, wall s | files kept |\n|---|---|---|---|---|")
    for robot in ROBOTS:
        found, taken = [], []
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(2):
                began = time.perf_counter()
                found += shapes(robot, {"HYDROSTAT_CACHE": folder}, processes)
                taken.append(time.perf_counter() - began)
            kept = sum(path.is_file() for path in Path(folder).rglob("*"))
        print(f"| {robot} | {processes} | {taken[0]:.1f} | {taken[1]:.1f} | {kept} |")
        if len(set(found)) != 1:
            raise RuntimeError(f"{robot}: {2 * processes} processes found {len(set(found))} different shapes")


def print_check(element_size: float, repeats: int) -> None:
    """A table of `hydrostat check` of a large body."""
    from benchmark_bodies import hand_robot

    from hydrostat.geometry import Mesh, write_vtu
    from hydrostat.robot import Body, save_robot

    robot = hand_robot(element_size)
    mesh = robot.body.mesh
    print("| hand | nodes | cold, CPU s | warm, CPU s | aim |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "hand.vtu"
        file.write_bytes(write_vtu(Mesh(1e3 * mesh.nodes, mesh.elements), 1e3 * mesh.nodes, {}))
        ready = Body.from_mesh(file, unit=1e-3, material=robot.body.material, volume=robot.body.volume)
        for name, saved in (("surface", robot), ("mesh", replace(robot, body=ready))):
            save_robot(saved, Path(folder) / name)
            kept = str(Path(folder) / "kept")
            found = [seconds([*HYDROSTAT, "check", str(Path(folder) / name)], kept) for _ in range(repeats + 1)]
            times = [taken for taken in found if taken is not None]
            text = f"{times[0]:.2f} | {median(times[1:]):.2f}" if len(times) > repeats else "failed | failed"
            print(f"| {name} | {len(mesh.nodes)} | {text} | < 3 |")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--commands", action="store_true", help="commands only")
    parser.add_argument("--together", type=int, metavar="PROCESSES")
    parser.add_argument("--check", type=float, metavar="MILLIMETERS")
    options = parser.parse_args()
    if options.check:
        print(f"{machine()}; median of {options.repeats} starts\n")
        print_check(1e-3 * options.check, options.repeats)
        return
    if options.together:
        print(f"{machine()}\n")
        print_together(options.together)
        return
    print(f"{machine()}; median of {options.repeats} starts\n")
    print_commands(options.repeats)
    if options.commands:
        return
    print_solves(options.repeats)


if __name__ == "__main__":
    main()
