"""`hydrostat grasp`."""

import csv
import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder, result_folder
from hydrostat.cli.given_object import parse_object
from hydrostat.cli.option_errors import naming_option
from hydrostat.cli.options import Contract, contractions, middle, positive
from hydrostat.cli.waiting import progress_bar, read_robot
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.arrays import Points, Vector
    from hydrostat.grasp import PullCase, PullOut
    from hydrostat.robot import Obstacle, Robot
    from hydrostat.simulation import Equilibrium, Simulation


GraspedObject = Annotated[
    str,
    typer.Option(
        "--object",
        metavar="SHAPE:SIZES",
        help="Object shape and size: sphere:65mm, cylinder:40mm,120mm or box:40mm,40mm,60mm. Or a closed surface in "
        "mm, oriented as in its file: mug.stl.",
    ),
]


def grasp(
    robot: RobotFolder,
    out: OutFolder,
    obstacle: GraspedObject = "sphere:65mm",
    pose: Annotated[
        str | None, typer.Option(metavar="NAME", help="Pose that closes the robot, instead of --contract.")
    ] = None,
    contract: Contract = None,
    direction: Annotated[
        str | None,
        typer.Option(metavar="AXIS", help="Pull direction, e.g. +x.", show_default="+z; +y for a flat robot"),
    ] = None,
    at: Annotated[
        str | None,
        typer.Option(metavar="X,Y,Z", help="Object center [mm].", show_default="near the markers of the pose"),
    ] = None,
    friction: Annotated[
        float, typer.Option(metavar="MU", help="Coulomb friction coefficient between robot and object.")
    ] = 0.5,
    mass: Annotated[str, typer.Option(metavar="MASS", help="Object mass.")] = "58 g",
    step: Annotated[
        str, typer.Option("--increment", metavar="LENGTH", help="Pull increment. The result hardly depends on it.")
    ] = "2mm",
    bands: Annotated[
        bool,
        typer.Option(
            "--bands",
            help="Sensitivity analysis: 12 more pulls with varied friction, stiffness and object position.",
        ),
    ] = False,
) -> None:
    """Measure grasp strength: force to pull an object out.

    Closes the robot on an object, pulls the object out, and reports force vs. displacement. The object is rigid and
    moves in a straight line. Self-contact and contact with the object are on, with friction on the object. Writes
    pull.csv, pull.png and pull.gif; with --bands also bands.csv.

    Example: hydrostat grasp gallery:caging_gripper --pose close --object sphere:65mm --direction +z --out build/grasp
    """
    from hydrostat.files import replace_file
    from hydrostat.grasp import PullOptions, find_overlaps, pull_bands, pull_out
    from hydrostat.plot import draw_pull, pull_frames, save_gif, save_png
    from hydrostat.units import LENGTH

    require_folder(out)
    stride, loaded = positive("--increment", step, LENGTH), _feeling(read_robot(robot))
    held = parse_object(obstacle, loaded.body.mesh.dim, mass=mass, friction=friction)
    options = PullOptions(direction=_direction(direction, loaded.body.mesh.dim), step=stride)
    with progress_bar() as progress:
        closing, closed = _close_robot(loaded, pose, contractions(loaded, contract))
        placed = _place_object(loaded, held, at, closed)
        place = ", ".join(f"{1e3 * value:z.1f}" for value in placed.frame()[0])
        for name in find_overlaps(loaded, placed):
            print(
                f'warning: the object overlaps obstacle "{name}". They have no contact in the pull. Move it with --at.'
            )
        with naming_option(f"object at ({place}) mm" if at is None else f"--at {at}"), _naming_object():
            found = pull_out(loaded, placed, closing, options, progress=progress)
            cases = pull_bands(loaded, placed, closing, options, progress=progress) if bands else ()
        with result_folder(out) as folder:
            files = [replace_file(folder / "pull.csv", _table(found).encode())]
            files.append(save_png(draw_pull(loaded, found, cases), folder / "pull.png"))
            files.append(save_gif(loaded, pull_frames(found), folder / "pull.gif", step=0.1, progress=progress))
            if cases:
                files.append(replace_file(folder / "bands.csv", _bands(cases).encode()))
    print(f"object at ({place}) mm")
    _print(found, cases)
    print("Wrote " + ", ".join(str(out / file.relative_to(folder)) for file in files))


@contextmanager
def _naming_object() -> Iterator[None]:
    """Call the object by its name alone: it is in no robot.toml, where obstacles have numbers."""
    try:
        yield
    except InputError as error:
        raise InputError(re.sub(r'obstacle\[\d+\]: "object"', "the object", str(error))) from None


def _feeling(robot: "Robot") -> "Robot":
    """The robot, feeling itself."""
    from dataclasses import replace

    from hydrostat.robot import Contact

    return robot if robot.contact is not None else replace(robot, contact=Contact())


def _close_robot(robot: "Robot", name: str | None, given: dict[str, float]) -> "tuple[Vector, Points]":
    """Contractions that close the robot [m], and where its markers then are without the object [m]."""
    import numpy as np

    from hydrostat.simulation import Simulation

    simulation = Simulation(robot)
    if (name is None) == (not given):
        poses = f" Poses: {', '.join(robot.poses)}." if robot.poses else ""
        raise InputError(f"--pose or --contract: give exactly one of them to close the robot.{poses}")
    found = simulation.solve(given) if name is None else _reach_pose(simulation, name)
    targets = list(found.markers) if name is None else list(robot.pose(name).targets)
    places = np.array([found.markers[marker] for marker in targets])
    if not len(places):
        raise InputError("--at: needed, because the robot has no markers. Give the object center, e.g. --at 0,0,90.")
    return found.contractions, places


def _reach_pose(simulation: "Simulation", name: str) -> "Equilibrium":
    """Equilibrium that comes nearest to a pose; other beginnings are tried where it would look different."""
    from hydrostat.ik import IKOptions, solve_ik

    target, seen = simulation.robot.pose(name), 1e-3  # Error that shows, as a share of the size of the body
    found = solve_ik(simulation, target, options=IKOptions(restarts=0))
    if found.rms_error > seen * simulation.robot.body.mesh.size:
        found = solve_ik(simulation, target)
    return found.pose


def _place_object(robot: "Robot", obstacle: "Obstacle", at: str | None, closed: "Points") -> "Obstacle":
    """Place the object."""
    from hydrostat.grasp import move_object, place_object

    if at is None:
        return place_object(robot, obstacle, closed)
    return move_object(obstacle, middle(at, robot.body.mesh.dim))


def _direction(text: str | None, dim: int) -> tuple[float, ...]:
    axes = "xyz"[:dim]
    text = f"+{axes[-1]}" if text is None else text
    if len(text) != 2 or text[0] not in "+-" or text[1] not in axes:
        raise InputError(
            f"--direction {text}: unknown axis. Allowed: {', '.join(sign + axis for axis in axes for sign in '+-')}."
        )
    return tuple((1.0 if text[0] == "+" else -1.0) * (axis == text[1]) for axis in axes)


def _table(pull: "PullOut") -> str:
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    axes = "xyz"[: pull.contact.shape[1]]
    writer.writerow(["pulled_mm", "moved_mm", "force_N", *(f"contact_{axis}_N" for axis in axes)])
    for pulled, moved, force, contact in zip(pull.pulled, pull.moved, pull.forces, pull.contact, strict=True):
        writer.writerow(
            [f"{1e3 * pulled:.4f}", f"{1e3 * moved:.4f}", f"{force:.6f}", *(f"{one:.6f}" for one in contact)]
        )
    return lines.getvalue()


def _bands(cases: "tuple[PullCase, ...]") -> str:
    lines = ["case,peak_N,work_mJ,result"]
    for case in cases:
        if case.pull is None:
            lines.append(f'{case.name},,,"{case.trouble}"')
        else:
            lines.append(f'{case.name},{case.pull.peak:.4f},{1e3 * case.pull.work:.4f},"{case.pull.status}"')
    return "\n".join(lines) + "\n"


def _print(pull: "PullOut", cases: "tuple[PullCase, ...]") -> None:
    """Print the highest force of the pull, and its changes by uncertain parameters."""
    hardest = 1e3 * float(pull.moved[int(pull.forces.argmax())])
    words = "highest force so far" if pull.is_rising else "peak force"
    print(f"{words} {pull.peak:.3g} N at {hardest:.1f} mm, work {1e3 * pull.work:.3g} mJ; {pull.status}")
    for case in cases:
        print(f"  {case.name:<14} " + (case.trouble if case.pull is None else f"{case.pull.peak:.3g} N"))
    if pull.peak <= 0:
        print(
            "warning: the robot does not hold the object: nothing resists the pull. Close it further, choose another "
            "--direction, or put the object into its grasp with --at"
        )
    known = [case.pull for case in cases if case.pull is not None and case.name != "no friction"]
    if known:
        peaks = [pull.peak, *(each.peak for each in known)]
        print(f"peak force {min(peaks):.3g} to {max(peaks):.3g} N over these cases")
    for case in cases:
        if case.name == "no friction" and case.pull is not None:
            print(f"work without friction: {1e3 * case.pull.work:.3g} mJ to escape in this direction")
