"""What designed networks reach: routes beside trees, networks at random, one drawn by hand, and all muscles at once.

    python lab/designs/designs.py [--quick] [--bodies pig,squid] [--methods routes,hand] [--random 500] [--seed 0]
                                [--json FILE]

The starfish, the six designs of the thesis with its numbers of winches and cables (N1), and two bodies in space; each
network is for all poses of its body at once, has the same counts and keeps the same constraints. However a network was
found, its error is what `solve_ik` makes of it with its own options within the same limits. Fibres are counted for both
definitions (E21).

Two columns bound what can be hoped for: all fibres, each pulled as each pose likes, and "a line a winch", the error if
each winch moved all markers along straight lines of one's choice: what sharing costs to first order.
"""

import argparse
import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from design_bodies import BODIES, Body, body_robot, judged, rest_error, sharing_error
from design_random import best_of
from drawn_networks import hand_network
from machine import machine

import numpy as np  # isort: skip

from hydrostat.design import Region, activate, design_cables, edge_fibres, violations
from hydrostat.errors import HydrostatError
from hydrostat.robot import Robot

METHODS = ("rest", "fibres", "sharing", "trees", "routes", "random", "hand")
"""What is asked for each body, in the order of the columns."""

Row = dict[str, Any]


def fibres_error(robot: Robot) -> float:
    """The same with a muscle on every edge of the mesh [m]: what no network can be asked to beat."""
    fibres = edge_fibres(robot.body.mesh)
    return float(np.sqrt(np.mean([activate(robot, pose, fibres).rms_error ** 2 for pose in robot.poses.values()])))


def row_of(name: str, methods: Sequence[str], count: int, seed: int) -> Row:
    """Everything that is known of one body; errors in meters."""
    robot, body = body_robot(name), BODIES[name]
    ways: dict[str, Callable[[], Robot | None]] = {
        "trees": lambda: _designed(robot, body, "trees"),
        "routes": lambda: _designed(robot, body, "routes"),
        "random": lambda: _random(robot, body, count, seed),
        "hand": lambda: hand_network(name),
    }
    bounds = {
        "rest": lambda: rest_error(robot),
        "fibres": lambda: fibres_error(robot),
        "sharing": lambda: sharing_error(robot, body.winches),
    }
    row: Row = {"body": name, "poses": len(robot.poses), "winches": body.winches, "cables": body.cables}
    for method in methods:
        if method == "trees" and robot.body.mesh.dim == 3:
            continue
        began = time.process_time()
        if method in ways:
            row[method] = _tried(ways[method], robot, body)
        else:
            row[method] = {"error": bounds[method]()}
        row[method]["seconds"] = time.process_time() - began
    return row


def _designed(robot: Robot, body: Body, method: str) -> Robot:
    return design_cables(
        robot,
        robot.poses.values(),
        winches=body.winches,
        cables=body.cables,
        method=method,
        constraints=body.constraints,
    ).robot


def _random(robot: Robot, body: Body, count: int, seed: int) -> Robot | None:
    best = best_of(robot, list(robot.poses.values()), body, count=count, seed=seed)
    return None if best is None else best.robot


def _tried(way: Callable[[], Robot | None], robot: Robot, body: Body) -> Row:
    """What one way to a network leads to; its error only if there is one."""
    try:
        network = way()
    except HydrostatError as problem:
        return {"problem": str(problem)}
    if network is None:
        return {"problem": "no network can be built"}
    return {
        "error": judged(network, list(robot.poses.values()), body.constraints),
        "winches": len(network.winches),
        "cables": len(network.cables),
        "violations": violations(network, body.constraints, Region.of_body(robot.body, body.constraints.clearance)),
    }


def error_of(row: Row, method: str) -> float | None:
    """Of a method in a row [m]; None if it was not asked or found none."""
    return row.get(method, {}).get("error")


def counts(names: Sequence[str]) -> None:
    """The table of N1."""
    print("| body | edges | elements | fibres in the thesis |\n|---|---|---|---|")
    for name in names:
        mesh = body_robot(name).body.mesh
        print(f"| {name} | {len(mesh.edges)} | {len(mesh.elements)} | {BODIES[name].fibres or ''} |")


def header(count: int) -> None:
    """Of the table of errors [mm]."""
    columns = ["body", "winches / cables", "poses", "at rest", "all fibres", "a line a winch", "trees", "routes"]
    columns += [f"best of {count} at random", "by hand", "routes / fibres", "routes / trees", "routes win against"]
    columns += ["CPU s of routes"]
    print("\n| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|")


def line(row: Row) -> str:
    """One row of the table."""
    routes = error_of(row, "routes")
    rivals = {method: error_of(row, method) for method in ("trees", "random", "hand")}
    won = [method for method, error in rivals.items() if routes is not None and error is not None and routes < error]
    asked = [method for method, error in rivals.items() if error is not None]
    seconds = f"{row['routes']['seconds']:.0f}" if routes is not None else ""
    verdict = ("all" if won == asked else ", ".join(won) or "none") if routes is not None else ""
    return (
        f"| {row['body']} | {row['winches']} / {row['cables']} | {row['poses']} | "
        + " | ".join(_mm(error_of(row, method)) for method in METHODS)
        + f" | {_ratio(routes, error_of(row, 'fibres'))} | {_ratio(routes, rivals['trees'])} | {verdict} | {seconds} |"
    )


def _mm(error: float | None) -> str:
    return "" if error is None else f"{1e3 * error:.2f}"


def _ratio(first: float | None, second: float | None) -> str:
    return "" if first is None or not second else f"{first / second:.2f}"


def footnotes(row: Row) -> list[str]:
    """What of a row the table does not show."""
    found = []
    for method in METHODS:
        cell = row.get(method, {})
        if "problem" in cell:
            found.append(f"{row['body']}, {method}: {cell['problem']}")
        if cell.get("cables", row["cables"]) != row["cables"] or cell.get("winches", row["winches"]) != row["winches"]:
            found.append(f"{row['body']}, {method}: {cell['winches']} winches, {cell['cables']} cables")
        found += [f"{row['body']}, {method}: cannot be built: {wrong}" for wrong in cell.get("violations", ())]
    return found


def summary(rows: Sequence[Row]) -> list[str]:
    """Routes against each rival, over all bodies where both found a network."""
    found = []
    for rival in ("trees", "random", "hand", "fibres"):
        pairs = [
            (routes, other)
            for row in rows
            if (routes := error_of(row, "routes")) is not None and (other := error_of(row, rival)) is not None
        ]
        if pairs:
            ratios = [routes / other for routes, other in pairs]
            wins = sum(routes < other for routes, other in pairs)
            found.append(f"routes / {rival}: median {np.median(ratios):.2f}; lower on {wins} of {len(pairs)} bodies")
    return found


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="the pig only, with few random networks")
    parser.add_argument("--bodies", default=",".join(BODIES), help="names with commas between")
    parser.add_argument("--methods", default=",".join(METHODS), help="names with commas between")
    parser.add_argument("--random", type=int, default=500, metavar="N", help="random networks for each body")
    parser.add_argument("--seed", type=int, default=0, help="of the random networks")
    parser.add_argument("--json", type=Path, metavar="FILE", help="where results go, after each row")
    given = parser.parse_args()
    if given.quick:
        given.bodies, given.random = "pig", min(given.random, 40)
    given.bodies, given.methods = given.bodies.split(","), given.methods.split(",")
    for asked, known in ((given.bodies, BODIES), (given.methods, METHODS)):
        for name in asked:
            if name not in known:
                parser.error(f'"{name}" must be one of {", ".join(known)}')
    return given


def main() -> None:
    options = _arguments()
    print(f"{machine()}; rms errors over targeted markers and poses in mm, CPU time\n")
    counts(options.bodies)
    header(options.random)
    rows = []
    for name in options.bodies:
        rows.append(row_of(name, options.methods, options.random, options.seed))
        print(line(rows[-1]), flush=True)
        if options.json:
            kept = {"machine": machine(), "random": options.random, "seed": options.seed, "rows": rows}
            options.json.write_text(json.dumps(kept, indent=2) + "\n")
    print()
    for text in [*summary(rows), *(note for row in rows for note in footnotes(row))]:
        print(f"- {text}")


if __name__ == "__main__":
    main()
