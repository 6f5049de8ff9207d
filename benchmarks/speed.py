"""Speed of hydrostat in one table: CPU time of one thread, at each vector level that the processor has.

    python benchmarks/speed.py [--quick] [--only hand stream ...] [--levels v3 v4] [--against PYTHON] [--write FILE]

Each row is measured in a process of its own with HYDROSTAT_LEVEL set (speed_rows.py). `--against` measures the same
rows by another Python, whose hydrostat is another checkout. Goals are for AVX2 (v3) and AVX-512 (v4). MuJoCo is
installed into an environment in the user's cache; SOFA's times are published ones of another machine.
`--tests` takes a sentence about `make test`, which is not run here.
"""

import argparse
import json
import math
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from machine import machine
from speed_rows import BODIES, MEASURES, SHARED
from startup import COMMANDS

FILE = Path(__file__).with_name("speed_rows.py")
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
        ended = run(python, [str(FILE), name, str(count)], level)
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
    names = [
        name for name in names if not name.startswith("sofa_") or (options.robots / name[5:] / "case.json").exists()
    ]
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
    if options.tests:
        tell(f"\n`make test`: {options.tests}")
    if options.write:
        options.write.write_text("\n".join(told) + "\n", encoding="utf-8")


if __name__ == "__main__":
    assert ROWS.keys() == MEASURES.keys()
    main()
