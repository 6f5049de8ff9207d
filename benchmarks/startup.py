"""How long hydrostat takes to start, in a fresh process each time.

    python benchmarks/startup.py [--repeats 15]

Then a first solve, phase by phase: cold, where nothing has been compiled yet (an empty folder for what numba keeps),
and warm, where it has been. The flat robot is the gallery's starfish, the one in space the hand of `hand_body.py`, of
few nodes; each has its own folder.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

from machine import machine

COMMANDS = {
    "python -c pass": ([sys.executable, "-c", "pass"], None),
    "import hydrostat": ([sys.executable, "-c", "import hydrostat"], 0.5),
    "hydrostat --help": ([str(Path(sys.executable).with_name("hydrostat")), "--help"], 0.3),
}
"""Name, command, and the time [s] it should stay under."""


def seconds(command: list[str]) -> float | None:
    """Wall-clock time of one run; None if it fails."""
    began = time.perf_counter()
    ended = subprocess.run(command, capture_output=True, check=False)
    return time.perf_counter() - began if ended.returncode == 0 else None


ROBOTS = {
    "starfish": "robot = hydrostat.robot.load_robot(hydrostat.robot.gallery_folder('starfish'))",
    "hand": "from hand_body import hand_robot\nrobot = hand_robot(17e-3)",
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
    assert simulation.solve({{robot.winches[0].name: contraction}}).result.reason == 'converged'
    lap()
laps = [[b - a for a, b in zip(*pair)] for pair in zip(clocks, clocks[1:])]
print(json.dumps(laps + [[b - a for a, b in zip(clocks[0], clocks[-1])]]))
"""


def solve_times(robot: str, folder: str) -> list[list[float]]:
    """CPU and wall-clock time [s] of each phase of a first solve."""
    here = str(Path(__file__).parent)
    environment = os.environ | {"NUMBA_CACHE_DIR": folder, "PYTHONPATH": here}
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


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--repeats", type=int, default=15)
    options = parser.parse_args()
    print(f"{machine()}; wall-clock time, median of {options.repeats} starts\n")
    print("| command | s | aim |\n|---|---|---|")
    for name, (command, aim) in COMMANDS.items():
        times = [seconds(command) for _ in range(options.repeats + 1)][1:]
        found = [taken for taken in times if taken is not None]
        text = f"{median(found):.3f}" if len(found) == len(times) else "failed"
        print(f"| `{name}` | {text} | {f'< {aim}' if aim else ''} |")
    print_solves(options.repeats)


if __name__ == "__main__":
    main()
