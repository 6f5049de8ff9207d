"""Learned inverse kinematics, rolled out in the simulator: ours, its parts, and what others do with the same samples.

    hydrostat sample examples/cupping_hand --contact --count 3000 --out build/train
    hydrostat sample examples/cupping_hand --contact --count 320 --seed 1 --out build/test
    python lab/learned_ik/learned_ik.py examples/cupping_hand build/train build/test [--counts 300,1000,3000]
                       [--targets 300] [--methods "ridge;search;search, step"] [--keep results.jsonl]

Targets are the markers of samples that nothing was learned from. Each way gives contractions; the simulator takes them
in from rest, with contact if the samples have it, and the error is the distance of each marker from its target. Ways:
`hydrostat_lab.compare`. Columns: mean error, the same as a share of the body's size, quantiles over all markers of
all targets, targets without an equilibrium, CPU time of learning, and for ours: time for a target, the error that the
networks expect, their doubt, and the share of markers whose error is below twice the sum of these two. With --keep,
rows are added to a file as they are found, and those that are there are printed, not found again.
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

import hydrostat as hs
from hydrostat.learning import Samples
from hydrostat_lab.compare import METHODS, Compared, compare

QUANTILES = {"median": 0.5, "p90": 0.9, "p99": 0.99, "max": 1.0}
HEAD = f"{'samples':>7}  {'way':18}{'mean':>8}{'%':>8}" + "".join(f"{name:>8}" for name in QUANTILES) + "  lost  CPU s"

Row = dict[str, float | str]


def row_of(found: Compared) -> Row:
    """Figures of one way: errors in mm."""
    errors = 1e3 * found.found.ravel()
    row: Row = {"method": found.method, "samples": found.samples, "mean": float(errors.mean())}
    row |= {name: float(np.quantile(errors, share)) for name, share in QUANTILES.items()}
    row |= {"lost": found.lost, "seconds": found.seconds}
    return row | {name: float(value) for name, value in found.facts.items()}


def line(row: Row, size: float) -> str:
    """A row as text; the body's size in meters."""
    numbers = "".join(f"{row[name]:8.3f}" for name in QUANTILES)
    text = f"{row['samples']:7}  {row['method']:18}{row['mean']:8.3f}{0.1 * float(row['mean']) / size:8.3f}{numbers}"
    text += f"{row['lost']:6}{row['seconds']:7.0f}"
    if "microseconds" in row:
        text += f"  {row['microseconds']:.0f} us"
    if "milliseconds" in row:
        text += f"  {row['milliseconds']:.0f} ms for {row['steps']:.2f} steps"
    if "expected" in row:
        text += f", expects {1e3 * float(row['expected']):.3f}"
    if "doubt" in row:
        text += f", doubts {1e3 * float(row['doubt']):.3f}, within {row['within']:.0%}"
    return text


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", type=Path)
    parser.add_argument("train", type=Path)
    parser.add_argument("test", type=Path)
    parser.add_argument("--counts", default="300,1000,3000")
    parser.add_argument("--targets", type=int, default=300)
    parser.add_argument("--methods", default=";".join(METHODS), help="separated by ;")
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args()
    train, test = Samples.read(given.train), Samples.read(given.test).first(given.targets)
    robot = hs.load_robot(given.robot)
    if test.facts["contact"] and robot.contact is None:
        robot = replace(robot, contact=hs.Contact())
    simulation, size = hs.Simulation(robot), test.facts["size"]
    kept: list[Row] = []
    if given.keep and given.keep.exists():
        kept = [json.loads(text) for text in given.keep.read_text().splitlines()]
    moved = 1e3 * np.linalg.norm(test.markers - train.markers.mean(axis=0), axis=-1).mean()
    print(machine())
    print(
        f"{robot.name}, drawn by {', '.join(train.facts['draws'])}; {len(test)} targets, {moved:.1f} mm from the mean"
    )
    print(f"place of their markers; errors in mm, and in % of the body's {1e3 * size:.0f} mm\n{HEAD}")
    for count in [int(text) for text in given.counts.split(",")]:
        known = [row for row in kept if row["samples"] == count]
        for row in sorted(known, key=lambda row: METHODS.index(str(row["method"]))):
            print(line(row, size))
        asked = [name for name in given.methods.split(";") if name and name not in {row["method"] for row in known}]
        for found in compare(simulation, train.first(count), test, asked) if asked else ():
            print(line(row_of(found), size), flush=True)
            if given.keep:
                with given.keep.open("a") as stream:
                    stream.write(json.dumps(row_of(found)) + "\n")


if __name__ == "__main__":
    main()
