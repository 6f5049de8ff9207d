"""What designs are worth once they are built: errors of robots drawn at random, their commands played open loop.

    python benchmarks/design_robust.py [--bodies starfish,puppy] [--methods hand,trees,exact,routes] [--draws 60]
                                       [--draws-in-space 20] [--held-out 5] [--seeds 3] [--rough] [--aimed]
                                       [--reachable]
                                       [--jobs 2] [--rows build/design_robust.jsonl]

A network is found for each body by each method, and its commands by inverse kinematics in the model. Then so many
robots are drawn (`hydrostat.design.BuildTolerances`: holes, friction, stiffness, knots, spools), with draws that no
design saw, and solved from rest along the straight loading path with the friction of each. `exact` are routes for a
robot that is built just as its model: cables may cross, lie side by side and turn by 75 degrees.
Further methods, printed on request: `reach` are routes with `RouteOptions.workspace_weight` of 1, `family`
routes that are designed for the half-way poses too, `two_way` routes whose winches may pull both ways, `chang2018`
the search of the thesis with one setting (trees: with many).

Columns, errors in mm rms over markers and poses: `model`, as designed; `built`, median and 90 % of the draws;
`corrected`, the same after one round of correction: up to five markers of each pose are measured on the built robot,
each coordinate to 0.5 mm, and the contractions are solved again in the model for targets moved by what it missed;
`reachable`, median and 90 % with contractions that were solved on each built robot itself, its friction known: about
the best that a correction of contractions can do, with `--reachable`;
`aimed`, 90 % by contractions for targets moved back by the mean miss of 40 other draws, with `--aimed`;
`mu 0.3`, 90 % with friction 0.3 in all cables, with `--rough`; `held out`, poses that hidden networks reach, solved
again in the model, with `--held-out`. A second table has `built` of the routes as a share of the better of hand and
trees.

Each row is added to the file of `--rows` when it is done. Run the same command again to continue, with more bodies or
methods too. Name another file where the search or the physics changed.
"""

import argparse
import json
import time
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from design_bodies import BODIES, Body, body_robot
from machine import machine

import numpy as np  # isort: skip

from hydrostat.arrays import Vector
from hydrostat.design import (
    BuildTolerances,
    DesignMethod,
    DesignRequest,
    RouteOptions,
    built_errors,
    corrected_errors,
    find_network,
    nearest_shares,
    turns,
)
from hydrostat.errors import HydrostatError
from hydrostat.ik import IKOptions, IKResult, Limits, solve_ik
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Equilibrium, Simulation

METHODS = ("hand", "trees", "exact", "routes")

EVERY = (
    "starfish",
    "starfish_3",
    "robot",
    "pig",
    "letter_e",
    "letter_s",
    "puppy",
    "squid",
    "five_poses",
    "trunk",
    "fish_tail",
)


def network(method: str, robot: Robot, body: Body, poses: Sequence[PoseTarget]) -> Robot | None:
    """The robot with the network that a method finds; None if it finds none."""
    if method == "hand":
        return robot
    constraints, uncertainty = body.constraints, None
    if method == "exact":
        constraints = replace(constraints, cable_gap=0.0, max_turn=75.0, built_in=False)
        uncertainty = BuildTolerances.none()
    if method == "two_way":
        constraints = replace(constraints, two_way=True)
    if method == "family":
        poses = [*poses, *(half_way(robot, pose) for pose in poses)]
    request = DesignRequest(
        poses=tuple(poses), winches=body.winches, cables=body.cables, constraints=constraints, uncertainty=uncertainty,
        method=DesignMethod(method) if method in set(DesignMethod) else DesignMethod.ROUTES,
        options=RouteOptions(workspace_weight=1.0) if method == "reach" else None,
    )  # fmt: skip
    try:
        return find_network(robot, request).robot
    except HydrostatError as error:
        print(f"  {method}: {error}")
        return None


def half_way(robot: Robot, pose: PoseTarget) -> PoseTarget:
    """The pose with each target half as far from where its marker rests."""
    rest = {marker.name: np.array(marker.at) for marker in robot.markers}
    targets = {name: tuple((0.5 * (rest[name] + np.array(to))).tolist()) for name, to in pose.targets.items()}
    return PoseTarget(name=f"{pose.name}, half way", targets=targets)


Row = dict[str, Any]
"""Values of one line of the table, by column; None where nothing was computed. Errors in mm."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """A row that is asked for."""

    body: str
    method: str
    draws: int
    rough: bool
    held_out: int
    seeds: int
    aimed: bool
    reachable: bool

    @property
    def key(self) -> Row:
        """Values by which a row that is done already is known."""
        return asdict(self)


def compute_row(job: Job) -> Row:
    """One line of the table."""
    name, method, draws = job.body, job.method, job.draws
    robot, body = body_robot(name), BODIES[name]
    poses = list(robot.poses.values())
    began = time.process_time()
    found = network(method, robot, body, poses)
    row: Row = {**job.key, "seconds": time.process_time() - began, "found": found is not None}
    if found is None:
        return row
    simulation, limits = Simulation(found), Limits(tension=body.constraints.tension_limit)
    reached = [solve_ik(simulation, pose, limits=limits) for pose in poses]
    uncertainty = BuildTolerances.of(robot.body)
    corrected = corrected_errors(found, reached, uncertainty, limits=limits, draws=draws, seed=1)
    built = corrected.played
    rough = None
    if job.rough:
        slippery = replace(uncertainty, friction=(0.3, 0.3))
        commands = [one.pose.contractions for one in reached]
        rough = 1e3 * built_errors(found, poses, commands, slippery, draws=draws, seed=1).most
    aimed = None
    if job.aimed:
        commands = aim(found, reached, uncertainty, limits)
        aimed = 1e3 * built_errors(found, poses, commands, uncertainty, draws=draws, seed=1).most
    least = reachable_errors(found, reached, uncertainty, limits, draws) if job.reachable else None
    held_out = poses_of_others(name, job.held_out, job.seeds) if job.held_out else []
    unseen = [solve_ik(simulation, pose, limits=limits).rms_error for pose in held_out]
    return row | {
        "counts": f"{len(found.winches)}/{len(found.cables)}",
        "model": 1e3 * built.model,
        "built_median": 1e3 * built.median,
        "built": 1e3 * built.most,
        "corrected_median": 1e3 * corrected.median,
        "corrected": 1e3 * corrected.most,
        "reachable_median": None if least is None else 1e3 * float(np.median(least)),
        "reachable": None if least is None else 1e3 * float(np.quantile(least, 0.9, method="higher")),
        "rough_error": rough,
        "aimed": aimed,
        "held_out_error": 1e3 * float(np.sqrt(np.mean(np.square(unseen)))) if unseen else None,
        "holes": sum(len(cable.points) - 1 for cable in found.cables),
        "crossings": crossed(found),
        "sharp": sharp_turns(found),
        "pull": float(max(one.pose.tensions.max() for one in reached)),
    }


def reachable_errors(
    robot: Robot, reached: Sequence[IKResult], uncertainty: BuildTolerances, limits: Limits, draws: int
) -> Vector:
    """Errors [m] of the drawn robots by contractions solved on each itself, for targets moved by its friction."""
    options, errors = IKOptions(restarts=0, min_tension=False, hold_free_markers=False), []
    for number in range(draws):
        built = uncertainty.draw(robot, np.random.default_rng([1, number]))
        smooth = Simulation(replace(built, cables=tuple(replace(cable, friction=0.0) for cable in built.cables)))
        simulation, squares = Simulation(built), []
        for one in reached:
            played, ideal = (each.solve(one.pose.contractions, strict=False) for each in (simulation, smooth))
            moved = {
                name: tuple((target - (played.markers[name] - ideal.markers[name])).tolist())
                for name, target in one.pose_target.targets.items()
            }
            found = solve_ik(smooth, moved, limits=limits, start=ideal, options=options)
            ends = (played, simulation.solve(found.pose.contractions, strict=False))
            squares.append(min(square_of(end, one.pose_target) for end in ends))
        errors.append(np.sqrt(np.mean(squares)))
    return np.array(errors)


def square_of(played: Equilibrium, pose: PoseTarget) -> float:
    """Mean squared distance of the markers of a pose from their targets [m^2]; infinite without an equilibrium."""
    misses = [played.markers[name] - target for name, target in pose.targets.items()]
    return float(np.mean(np.sum(np.square(misses), axis=1))) if played.result.converged else float("inf")


def aim(robot: Robot, reached: Sequence[IKResult], uncertainty: BuildTolerances, limits: Limits) -> list[Vector]:
    """Contractions of each pose [m] for targets moved back by what 40 other robots miss in the mean."""
    others = [Simulation(uncertainty.draw(robot, np.random.default_rng([7, number]))) for number in range(40)]
    commands = []
    for one in reached:
        played = [other.solve(one.pose.contractions, strict=False) for other in others]
        held = [each for each in played if each.result.converged]
        targets = {}
        for name, target in one.pose_target.targets.items():
            mean = np.mean([each.markers[name] for each in held], axis=0)
            targets[name] = tuple((target - (mean - one.pose.markers[name])).tolist())
        moved = replace(one.pose_target, targets=targets)
        commands.append(solve_ik(Simulation(robot), moved, limits=limits).pose.contractions)
    return commands


def words(row: Row) -> str:
    """A row of the table, as Markdown."""
    begin = f"| {row['body']} | {row['method']} |"
    if not row["found"]:
        return f"{begin} none found |"
    errors = (
        "model",
        "built_median",
        "built",
        "corrected_median",
        "corrected",
        "reachable_median",
        "reachable",
        "aimed",
        "rough_error",
        "held_out_error",
    )
    told = ["" if row[name] is None else f"{row[name]:.2f}" for name in errors]
    told += [str(row[name]) for name in ("holes", "crossings", "sharp")]
    return f"{begin} {row['counts']} | {' | '.join(told)} | {row['pull']:.1f} | {row['seconds']:.0f} |"


def share_table(rows: Iterable[Row]) -> list[str]:
    """Lines of the table of shares: error of the routes over the better of hand and trees, 90 % and median of draws."""
    found: dict[str, dict[str, Row]] = {}
    for row in rows:
        if row["found"]:
            found.setdefault(row["body"], {})[row["method"]] = row
    lines, shares = ["| body | hand | trees | routes | share | share of medians |", "|" + "---|" * 6], []
    for name, own in found.items():
        others = [own[method] for method in ("hand", "trees") if method in own]
        if "routes" not in own or not others:
            continue
        pair = [own["routes"][part] / min(other[part] for other in others) for part in ("built", "built_median")]
        shares.append(pair)
        told = [f"{own[method]['built']:.2f}" if method in own else "" for method in ("hand", "trees", "routes")]
        lines.append(f"| {name} | {' | '.join(told)} | {pair[0]:.2f} | {pair[1]:.2f} |")
    if not shares:
        return []
    most, median = np.median(shares, axis=0)
    return [*lines, f"| median of {len(shares)} | | | | {most:.2f} | {median:.2f} |"]


def sharp_turns(robot: Robot) -> int:
    """Via points at which a cable turns by more than 60 degrees."""
    return sum(int((np.degrees(turns(np.array(cable.points))) > 60).sum()) for cable in robot.cables)


def crossed(robot: Robot) -> int:
    """Pairs of segments nearer than 1 mm, but beside a winch that both cables have; adjacent ones left out."""
    runs = [
        (index, at, np.array(cable.points[at : at + 2]))
        for index, cable in enumerate(robot.cables)
        for at in range(len(cable.points) - 1)
    ]
    found = 0
    for number, (index, at, one) in enumerate(runs):
        for other, there, two in runs[number + 1 :]:
            if other == index and there <= at + 1:
                continue
            share, far = nearest_shares(one[None], two[None])
            places = one[0] + share[0] * (one[1] - one[0]), two[0] + far[0] * (two[1] - two[0])
            winch = robot.winch(robot.cables[index].winch)
            beside = (
                robot.cables[other].winch == winch.name
                and max(float(np.linalg.norm(place - winch.at)) for place in places) <= 2 * winch.spool_radius
            )
            found += not beside and float(np.linalg.norm(places[0] - places[1])) < 1e-3
    return found


def poses_of_others(name: str, count: int, seeds: int) -> list[PoseTarget]:
    """Poses that dense hidden networks reach, some for each seed."""
    from design_held_out import HIDDEN, family

    HIDDEN.setdefault(name, 12)
    return [pose for seed in range(seeds) for pose in family(name, seed).held_out[:count]]


def read_rows(file: Path) -> list[Row]:
    """Rows that are done; a last line that was cut off is left out."""
    rows = []
    for line in file.read_text().splitlines() if file.exists() else []:
        with suppress(json.JSONDecodeError):
            rows.append(json.loads(line))
    return rows


def find_row(rows: Sequence[Row], key: Mapping[str, Any]) -> Row | None:
    """The row of a job; None if it is not done."""
    return next((row for row in rows if all(row.get(name) == value for name, value in key.items())), None)


def compute_rows(jobs: Sequence[Job], processes: int, file: Path) -> None:
    """Compute rows in some processes and add each to a file when it is done; the bodies that take longest first."""
    file.parent.mkdir(parents=True, exist_ok=True)
    order = sorted(jobs, key=lambda job: (body_robot(job.body).body.mesh.dim, job.method == "routes"), reverse=True)
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        for done in as_completed([pool.submit(compute_row, job) for job in order]):
            row = done.result()
            with file.open("a") as lines:
                lines.write(json.dumps(row) + "\n")
            print(words(row), flush=True)


def main() -> None:
    """Compute the rows that are missing, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bodies", default=",".join(EVERY))
    parser.add_argument("--methods", default=",".join(METHODS))
    parser.add_argument("--draws", type=int, default=60)
    parser.add_argument("--draws-in-space", type=int, default=20)
    parser.add_argument("--held-out", type=int, default=0)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--rough", action="store_true")
    parser.add_argument("--aimed", action="store_true")
    parser.add_argument("--reachable", action="store_true")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--rows", type=Path, default=Path("build/design_robust.jsonl"))
    given = parser.parse_args()
    print(machine())
    jobs = []
    for name in given.bodies.split(","):
        flat = body_robot(name).body.mesh.dim == 2
        for method in given.methods.split(","):
            if method in ("trees", "chang2018") and not flat:
                continue
            draws = given.draws if flat else given.draws_in_space
            jobs.append(
                Job(
                    body=name,
                    method=method,
                    draws=draws,
                    rough=given.rough,
                    held_out=given.held_out,
                    seeds=given.seeds,
                    aimed=given.aimed,
                    reachable=given.reachable,
                )
            )
    done = read_rows(given.rows)
    compute_rows([job for job in jobs if find_row(done, job.key) is None], given.jobs, given.rows)
    done = read_rows(given.rows)
    rows = [row for job in jobs if (row := find_row(done, job.key)) is not None]
    print(
        "\n| body | method | winches/cables | model | built median | built 90 % | corrected median | "
        "corrected 90 % | reachable median | reachable 90 % | aimed 90 % | mu 0.3 90 % | held out | "
        "holes | crossings | turns > 60 | N | CPU s |"
    )
    print("|" + "---|" * 18)
    print(*map(words, rows), "", *share_table(rows), sep="\n")


if __name__ == "__main__":
    main()
