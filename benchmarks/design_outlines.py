"""Designs for bodies that a program draws: each ends in time with a network, or with a reason in one line.

    python benchmarks/design_outlines.py [--count 40] [--seed 0] [--seconds 15] [--only 7,12] [--keep FOLDER]

Each outline is a trunk with two to six limbs, some with a hole, 100 to 400 mm long. Its limbs have markers at their
tips, and one to four poses that turn some of them about the trunk. `hydrostat design --time SECONDS --kit` runs in a
process of its own. Columns: what was asked; how it ended (`network`, `reason`, or `FAULT` for a traceback, another exit
code or more than 30 s of CPU beyond the limit); error at rest, in the model and as built [mm]; checks of the kit; CPU
and wall seconds of the whole command; the line that states the reason, or the last warning. The exit code is the number
of faults.
"""

import argparse
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip
from shapely.geometry import LineString, Point, Polygon

from hydrostat.errors import HydrostatError
from hydrostat.ik import new_robot
from hydrostat.robot import Marker, Pin, PoseTarget, Robot, save_robot

LATE = 30.0
"""CPU time beyond the limit that is still in time: meshing, the report and the kit [s]."""

SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="-500 -500 1000 1000"><path fill-rule="evenodd" d="{path}"/></svg>'
)


@dataclass(frozen=True)
class Drawing:
    """An outline [mm, y up], the tips of its limbs and the middle and radius of its trunk."""

    polygon: Polygon
    tips: list[np.ndarray]
    middle: np.ndarray
    radius: float


def drawn(random: np.random.Generator) -> Drawing:
    """A trunk with limbs that bend."""
    radius, limbs = random.uniform(15, 60), int(random.integers(2, 7))
    shape, tips = Point(0, 0).buffer(radius), []
    begin = random.uniform(0, 2 * np.pi)
    for limb in range(limbs):
        angle = begin + 2 * np.pi * (limb + random.uniform(-0.25, 0.25)) / limbs
        length, width = random.uniform(30, 140), random.uniform(8, 22)
        bend = random.uniform(-0.8, 0.8)
        steps = [np.zeros(2), 0.9 * radius * np.array([np.cos(angle), np.sin(angle)])]
        for part in range(6):
            turned = angle + bend * (part + 1) / 6
            steps.append(steps[-1] + length / 6 * np.array([np.cos(turned), np.sin(turned)]))
        shape = shape.union(LineString(steps).buffer(width))
        tips.append(steps[-1])
    shape = shape.buffer(-4).buffer(8).buffer(-4)
    if random.random() < 0.2:
        shape = shape.difference(Point(0, 0.5 * radius).buffer(0.2 * radius))
    return Drawing(shape, tips, np.zeros(2), radius)


def posed(drawing: Drawing, random: np.random.Generator, folder: Path) -> Robot:
    """A robot of the drawing, its poses turn tips about the trunk."""
    rings = [drawing.polygon.exterior, *drawing.polygon.interiors]
    path = " ".join("M" + " L".join(f"{x:.3f},{-y:.3f}" for x, y in ring.coords[:-1]) + " Z" for ring in rings)
    (folder / "drawn.svg").write_text(SVG.format(path=path))
    low, high = np.array(drawing.polygon.bounds).reshape(2, 2)
    size = random.uniform(0.1, 0.4)
    robot = new_robot(folder / "drawn.svg", size=float(size), name="drawn")
    nodes = robot.body.mesh.nodes
    scale = float(np.ptp(nodes, axis=0).max() / (high - low).max())
    shift = nodes.min(axis=0) - scale * low
    tips = [tuple((scale * tip + shift).tolist()) for tip in drawing.tips]
    middle = scale * drawing.middle + shift
    markers = tuple(Marker(name=f"tip_{number}", at=tip) for number, tip in enumerate(tips, 1))
    poses = {}
    for number in range(1, int(random.integers(1, 5)) + 1):
        targets = {}
        for marker in markers:
            if random.random() < 0.3:
                continue
            angle = random.uniform(-0.7, 0.7) * (random.random() < 0.7)
            turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            arm = random.uniform(0.85, 1.0) * turn @ (np.array(marker.at) - middle)
            targets[marker.name] = tuple((middle + arm).tolist())
        if targets:
            poses[f"pose_{number}"] = PoseTarget(name=f"pose_{number}", targets=targets)
    if not poses:
        poses["pose_1"] = PoseTarget(name="pose_1", targets={markers[0].name: tips[0]})
    pin = Pin(at=tuple(middle.tolist()), radius=float(0.4 * scale * drawing.radius))
    return replace(robot, markers=markers, poses=poses, pins=(pin,), winches=(), cables=())


def row(number: int, seed: int, seconds: float, keep: Path | None) -> tuple[str, bool]:
    """One line of the table, and True for a fault."""
    random = np.random.default_rng([seed, number])
    drawing = drawn(random)
    winches = int(random.integers(1, 5))
    cables = winches + int(random.integers(0, 5))
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) if keep is None else keep / f"{number:02d}"
        folder.mkdir(parents=True, exist_ok=True)
        try:
            robot = posed(drawing, random, folder)
        except HydrostatError as error:
            return f"| {number} | | no body | | | | | | | {error} |", False
        save_robot(robot, folder / "robot")
        asked = f"{len(robot.markers)} limbs, {len(robot.poses)} poses, {winches}/{cables}"
        options = ["--winches", str(winches), "--cables", str(cables), "--time", f"{seconds:g}s", "--kit"]
        most = int(seconds + 2 * LATE)  # CPU seconds: other programs on the machine do not end a run
        limit = f"import resource, sys; resource.setrlimit(resource.RLIMIT_CPU, ({most}, {most}))"
        code = f"{limit}; sys.argv[0] = 'hydrostat'; from hydrostat.cli.main import main; main()"
        command = [sys.executable, "-c", code, "design", str(folder / "robot"), *options, "--out", str(folder / "out")]
        began, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        try:
            run = subprocess.run(command, capture_output=True, text=True, timeout=100 * seconds, check=False)
        except subprocess.TimeoutExpired:
            return f"| {number} | {asked} | FAULT | | | | | | {100 * seconds:.0f} | endless |", True
        after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic() - began
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        (folder / "told.txt").write_text(run.stdout + run.stderr)
        scores = folder / "out" / "score.json"
        figures, checks = ["", "", ""], ""
        if scores.exists():
            card = json.loads(scores.read_text())
            keys = ("rms_error_at_rest", "rms_error", "rms_error_as_built")
            figures = [f"{1e3 * card[key]:.2f}" for key in keys]
            found = re.search(r"Quality checks: (\d+) of (\d+)", run.stdout)
            checks = f"{found[1]}/{found[2]}" if found else "none"
        reasons = [line for line in (run.stderr + run.stdout).splitlines() if "error: " in line]
        told = reasons[-1] if reasons else next((x for x in run.stdout.splitlines()[::-1] if "warning" in x), "")
        crashed = "Traceback" in run.stderr + run.stdout
        silent = run.returncode != 0 and not reasons
        broken = checks and checks.split("/")[0] != checks.split("/")[-1]
        fault = bool(crashed or silent or run.returncode not in (0, 1, 2) or cpu > seconds + LATE or broken)
        end = "FAULT" if fault else "network" if run.returncode == 0 else "reason"
        numbers = f"{' | '.join(figures)} | {checks} | {cpu:.0f} | {wall:.0f}"
        return f"| {number} | {asked} | {end} | {numbers} | {told[:150]} |", fault


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=15.0)
    parser.add_argument("--only", default="", help="numbers of some drawings")
    parser.add_argument("--keep", type=Path, help="folder in which robots and results stay")
    given = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    print(machine())
    print("\n| drawing | asked | end | at rest | model | built | checks | CPU s | wall s | told |")
    print("|" + "---|" * 10)
    numbers = [int(number) for number in given.only.split(",")] if given.only else range(given.count)
    faults = 0
    for number in numbers:
        line, fault = row(number, given.seed, given.seconds, given.keep)
        faults += fault
        print(line, flush=True)
    print(f"\n{faults} faults")
    sys.exit(faults)


if __name__ == "__main__":
    main()
