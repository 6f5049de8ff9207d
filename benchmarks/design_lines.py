"""What the default designs print: errors, warnings and notes of `hydrostat design --kit`, and checks of their kits.

    python benchmarks/design_lines.py [--bodies pig,squid] [--keep FOLDER]

Each body is designed with its winches and cables of `design_bodies.py` by the command line. Columns: errors, warnings
and notes that it printed; checks of the kit that passed; CPU seconds of the whole command, reading, report and kit
included; then each error and warning.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from design_bodies import BODIES
from machine import machine
from robustness import EXAMPLES

TEN = "starfish,starfish_3,robot,pig,letter_e,letter_s,puppy,squid,cupping_hand,trunk"


def row(name: str, out: Path) -> str:
    """One body's line of the table, and the errors and warnings below it."""
    body = BODIES[name]
    limits = out.with_suffix(".toml")
    travel = "" if body.constraints.travel is None else f'travel = "{1e3 * body.constraints.travel:g} mm"\n'
    limits.write_text(f'clearance = "{1e3 * body.constraints.clearance:g} mm"\n{travel}')
    command = (
        "design", EXAMPLES / (body.example or name), "--winches", body.winches, "--cables", body.cables,
        "--constraints", limits, "--kit", "--out", out,
    )  # fmt: skip
    before = sum(os.times()[2:4])
    done = subprocess.run(
        [sys.executable, "-m", "hydrostat", *map(str, command)], capture_output=True, text=True, check=False
    )
    seconds = sum(os.times()[2:4]) - before
    lines = (done.stdout + done.stderr).splitlines()
    printed = {kind: [line for line in lines if line.startswith(kind)] for kind in ("error", "warning", "note")}
    checks = re.search(r"Quality checks: (\d+) of (\d+)", done.stdout)
    counts = " | ".join(str(len(found)) for found in printed.values())
    passed = "/".join(checks.groups()) if checks else "none"
    failed = lines[-1:] if done.returncode else []
    return "\n".join(
        [f"| {name} | {counts} | {passed} | {seconds:.0f} |", *printed["error"], *printed["warning"], *failed]
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bodies", default=TEN)
    parser.add_argument("--keep", type=Path, help="folder for the designs")
    given = parser.parse_args()
    print(machine())
    print("| body | errors | warnings | notes | checks | CPU s |", "|---|---|---|---|---|---|", sep="\n")
    with tempfile.TemporaryDirectory() as place:
        folder = given.keep or Path(place)
        folder.mkdir(parents=True, exist_ok=True)
        for name in given.bodies.split(","):
            print(row(name, folder / name), flush=True)


if __name__ == "__main__":
    main()
