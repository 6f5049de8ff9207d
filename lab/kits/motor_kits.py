"""Kits of four robots with each motor: checks, warnings, price, pieces; or the refusal and whether its remedy works.

    python lab/kits/motor_kits.py [--robots starfish,spiral] [--motors n20,25d] [--out DIR] [--remedies]

Each kit is made by `hydrostat fabricate`, as a maker runs it. `--remedies` also runs the command that a refusal prints,
and that of a refused remedy, up to three in a row.
"""

import argparse
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from machine import machine  # first: it sets one thread

from hydrostat.fabrication import ALL_MOTORS
from hydrostat.robot import gallery_folder

ROBOTS = ("starfish", "puppy", "cupping_hand", "spiral")  # two of plush, one of foam, one of TPU
HEAD = "| robot | motor | checks | warnings | used up [USD] | pieces | refusal |\n" + "|---" * 7 + "|"
FOUND = (r"Quality checks: (\d+ of \d+)", r"Material used: about (\d+) USD", r"To print: (.*?), about")
STEPS, LIMIT = 3, 1500.0  # remedies in a row, and the time of each [s]


def main() -> None:
    """Print a row for each kit."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--motors", default=",".join(motor.key for motor in ALL_MOTORS))
    parser.add_argument("--out", type=Path, help="also keep the kits there")
    parser.add_argument("--remedies", action="store_true", help="run the commands that refusals print")
    given = parser.parse_args()
    print(machine(), HEAD, sep="\n")
    with tempfile.TemporaryDirectory() as folder:
        out = given.out or Path(folder)
        for name in given.robots.split(","):
            for key in given.motors.split(","):
                print(f"| {name} | {key} | {find_row(name, key, out, run=given.remedies)} |", flush=True)


def find_row(name: str, key: str, out: Path, *, run: bool) -> str:
    """Columns of a kit after its robot and motor."""
    place = gallery_folder(name)
    told, failed = run_command(f"hydrostat fabricate {place} --motor {key} --out {out}/{name}-{key}")
    text = "\n".join(told)
    if not failed:
        held, used, pieces = (re.search(pattern, text)[1] for pattern in FOUND)
        warnings = sum(line.startswith("warning:") for line in told)
        return f"{held} | {warnings} | {used} | {' + '.join(re.findall(r'[0-9]+', pieces))} | "
    first, *more = [line.removeprefix("error: ") for line in told if line.startswith("error:")]
    words = [first + (f" (and {len(more)} more)" if more else "")]
    words += [line for line in told if line.startswith("note: a body")]
    words += try_remedies(told, run=run)
    return f" | | | | {'; '.join(words).replace(str(out), 'build').replace(str(place), f'gallery:{name}')}"


def try_remedies(told: list[str], *, run: bool) -> list[str]:
    """Remedies that commands print, and whether they work."""
    words = []
    for _ in range(STEPS if run else 1):
        found = next((line.removeprefix("Try: ") for line in told if line.startswith("Try: ")), "")
        words.append(f"try `{found}`" if found else "no remedy")
        if not (run and found.startswith("hydrostat")):
            break
        told, failed = run_command(found)
        words.append(f"fails: {failed[0]}" if failed else "works")
        if not failed:
            break
    return words


def run_command(command: str) -> tuple[list[str], list[str]]:
    """Lines that a command printed, and its errors."""
    words = [sys.executable, "-m", *shlex.split(command)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return [], [f"over {LIMIT:g} s"]
    lines = [*done.stdout.splitlines(), *done.stderr.splitlines()]
    errors = [line for line in lines if "error:" in line]
    return lines, (errors or ["no reason"]) if done.returncode else []


if __name__ == "__main__":
    main()
