"""`hydrostat share`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import RobotFolder, folder_of, require_writable
from hydrostat.cli.options import parse_optional
from hydrostat.cli.require_cables import require_cables
from hydrostat.cli.waiting import one_interrupt, prepare_physics, progress_bar, read_robot
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.control import Timeline
    from hydrostat.robot import Robot
    from hydrostat.toy import LearnedShape


def share(
    robot: RobotFolder,
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="HTML file to write, e.g. toy.html.")],
    samples: Annotated[
        int | None,
        typer.Option(
            metavar="N", min=20, max=100_000, help="Number of poses to simulate.", show_default="400 flat, 2000 in 3D"
        ),
    ] = None,
    time: Annotated[
        str | None, typer.Option("--time", metavar="TIME", help="Maximum time, e.g. 120s.", show_default="none")
    ] = None,
    seed: Annotated[int, typer.Option(help="Random seed.")] = 0,
) -> None:
    """Write a robot as one interactive HTML page.

    Samples the robot, trains a network of the whole body, and checks it in other poses. In the page you drag the body,
    turn the winches and play the poses of robot.toml and the keyframes of the studio. The page states its error.

    Example: hydrostat share gallery:starfish --out starfish.html
    """
    from hydrostat.control import CALIBRATION, Calibration
    from hydrostat.files import replace_file
    from hydrostat.toy import default_samples, make_toy
    from hydrostat.units import TIME

    if out.suffix.lower() not in (".html", ".htm"):
        raise InputError(f"--out {out}: not an HTML file. Name a file such as toy.html.")
    if out.is_dir() or not out.absolute().parent.is_dir():
        raise InputError(
            f"--out {out}: {'is a folder' if out.is_dir() else 'folder not found'}. Name a file in an existing folder."
        )
    require_writable(out.absolute().parent, f"--out {out}")
    seconds = parse_optional("--time", time, TIME)
    if seconds is not None and not seconds > 0:
        raise InputError(f"--time {time}: must be above 0")
    loaded = read_robot(robot)
    require_cables(loaded, robot, "shared pages")
    motors = Calibration.read(folder_of(robot), loaded) if (folder_of(robot) / CALIBRATION).exists() else None
    with one_interrupt(""), progress_bar() as progress:  # worker processes end before this one
        toy = make_toy(
            prepare_physics(loaded),
            samples=samples,
            seconds=seconds,
            seed=seed,
            timeline=_read_moves(folder_of(robot), loaded),
            motors=motors,
            progress=progress,
        )
    page, taken = toy.page, toy.samples
    replace_file(out, page.encode())
    _print_error(toy.shape, taken.lost, float(taken.crosses.mean()), samples or default_samples(loaded))
    print(f"Wrote {out} ({len(page) / 1e6:.2f} MB). Open it in any browser, or send it")


def _read_moves(folder: Path, robot: "Robot") -> "Timeline | None":
    """Keyframes that the studio saved with the robot; None without a readable studio.json."""
    from hydrostat.project import read_project_file

    try:
        return read_project_file(folder, [cable.name for cable in robot.cables])[0]
    except InputError:
        return None


def _print_error(shape: "LearnedShape", lost: int, crossing: float, count: int) -> None:
    """Print the error of a shape, and what limits it."""
    print(
        f"mean error {1e3 * shape.error:.2f} mm in {shape.held_out} held-out poses (mean motion "
        f"{1e3 * shape.moved:.1f} mm); the worst node of a pose is off by less than {1e3 * shape.worst:.2f} mm in 95 % "
        "of them"
    )
    found = shape.samples + shape.held_out + lost
    if found < count or shape.stopped:
        print(f"note: time limit reached after {found} of {count} samples. A higher --time lowers the error")
    if lost:
        print(f"note: {lost} samples without a stable equilibrium")
    if crossing > 0.01:
        print(
            f"note: the body self-intersects in {100 * crossing:.0f} % of the poses. Contact: [contact] in robot.toml"
        )
