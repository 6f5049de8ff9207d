"""How long hydrostat takes to start, in a fresh process each time.

python benchmarks/startup.py [--repeats 15]
"""

import argparse
import subprocess
import sys
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


if __name__ == "__main__":
    main()
