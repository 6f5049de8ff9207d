"""`hydrostat branches`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder, result_folder
from hydrostat.cli.options import Contract, Moves, contractions, moves
from hydrostat.cli.waiting import prepare_physics, progress_bar, read_robot
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.simulation import Branch, Multistability, Simulation


def branches(
    robot: RobotFolder,
    out: OutFolder,
    contract: Contract = None,
    move: Moves = None,
    starts: Annotated[int, typer.Option(metavar="N", help="Number of loading paths to try.")] = 16,
    seed: Annotated[int, typer.Option(help="Random seed.")] = 0,
) -> None:
    """Test whether contractions lead to several stable poses.

    Multistability test: solves many loading paths, groups the poses found, and follows the equilibrium branches past
    folds, where the robot snaps through. Writes branches.json and branches.png.

    Example: hydrostat branches gallery:robot --contract left=60mm --contract right=60mm --out build/branches
    """
    from hydrostat.simulation import find_equilibria

    require_folder(out)
    loaded = read_robot(robot)
    given = {**contractions(loaded, contract), **moves(loaded, move)}
    if not any(given.values()):
        raise InputError("--contract: no contraction given. Name a winch and a length, e.g. left=40mm.")
    if starts < 1:
        raise InputError(f"--starts {starts}: must be at least 1. 16 is enough for most robots.")
    simulation = prepare_physics(loaded)
    with progress_bar() as progress:
        found = find_equilibria(simulation, given, count=starts, seed=seed, progress=progress)
    followed = _follow(simulation, found)
    with result_folder(out) as folder:
        files = _write(simulation, found, followed, folder)
    print(*found.lines(), sep="\n")
    for name, branch in followed:
        print(f"{name}: " + "\n  ".join(branch.lines()))
    print("Wrote " + ", ".join(str(out / file.relative_to(folder)) for file in files))
    if not found.poses:
        raise typer.Exit(1)


def _follow(simulation: "Simulation", found: "Multistability") -> "list[tuple[str, Branch]]":
    """The branch from rest, and of each pose that is not on it the branch back; none with friction."""
    from hydrostat.simulation import continue_branch, largest_distance

    if found.friction:
        return []
    first = continue_branch(simulation, simulation.solve({}), found.contractions, around_folds=True)
    followed = [("from rest", first)]
    for number, one in enumerate(found.poses, 1):
        if not first.reaches_goal or largest_distance(first.end.nodes, one.pose.nodes) > found.near:
            back = continue_branch(simulation, one.pose, {}, around_folds=True)
            followed.append((f"back from pose {number}", back))
    return followed


def _write(
    simulation: "Simulation", found: "Multistability", followed: "list[tuple[str, Branch]]", out: Path
) -> list[Path]:
    from hydrostat.files import replace_file
    from hydrostat.plot import draw_branches, save_png
    from hydrostat.robot import robot_hash
    from hydrostat.version import __version__

    controls = [part.name for part in (*simulation.robot.winches, *simulation.robot.drives)]
    facts = {
        "version": __version__,
        "robot": robot_hash(simulation.robot),
        "contractions": dict(zip(controls, map(float, found.contractions), strict=True)),
        "report": found.lines(),
        "poses": [_pose_facts(one.pose) | {"ways": list(one.ways)} for one in found.poses],
        "lost": list(found.lost),
        "spread": found.spread,
        "branches": [_branch_facts(name, branch) for name, branch in followed],
    }
    written = [replace_file(out / "branches.json", (json.dumps(facts, indent=1) + "\n").encode())]
    figure = draw_branches(simulation.robot, found, [branch for _, branch in followed])
    return [*written, save_png(figure, out / "branches.png")]


def _pose_facts(pose: Any) -> dict[str, Any]:
    return {
        "energy": pose.energy,
        "tensions": [float(tension) for tension in pose.tensions],
        "markers": {name: [float(value) for value in place] for name, place in pose.markers.items()},
    }


def _branch_facts(name: str, branch: "Branch") -> dict[str, Any]:
    return {
        "name": name,
        "status": str(branch.status),
        "begin": [float(value) for value in branch.begin],
        "goal": [float(value) for value in branch.goal],
        "critical": [
            {"kind": str(point.kind), "share": point.share, "index": point.index} for point in branch.critical
        ],
        "points": [
            {"share": point.share, "stable": point.stable, **_pose_facts(point.pose)} for point in branch.points
        ],
    }
