"""`hydrostat scale`."""

from pathlib import Path
from typing import Annotated

import typer

from hydrostat.cli.folders import OwnRobotFolder
from hydrostat.cli.waiting import patiently, read_robot
from hydrostat.errors import InputError


def scale(
    robot: OwnRobotFolder,
    factor: Annotated[str, typer.Argument(metavar="FACTOR", help="How many times as large, such as 1.5.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder for the scaled robot; else it is changed.")
    ] = None,
) -> None:
    """Make a robot larger or smaller: its body with pins, markers, winches, cables, obstacles and poses together.

    Comments of robot.toml stay. Materials, stiffnesses and masses stay too, so a larger robot is another robot: check
    and simulate it again.

    Example: hydrostat scale my_starfish 1.5
    """
    from hydrostat.robot import merged_text, read_text, save_robot, scaled_robot

    if out is not None and out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(f"{out}: exists already; choose another name or remove it")
    try:
        times = float(factor.replace(",", "."))
    except ValueError:
        raise InputError(f"{factor}: is no factor; write for example 1.5") from None
    loaded = read_robot(robot)
    with patiently("meshing the body ..."):
        made = scaled_robot(loaded, times)
    home = robot.parent if robot.suffix == ".toml" and not robot.is_dir() else robot
    text = merged_text(read_text(home / "robot.toml"), made)
    path = save_robot(made, out or home, text=text)
    size = f"{1e3 * loaded.body.mesh.size:.0f} mm to {1e3 * made.body.mesh.size:.0f} mm"
    if out is None and (home / "studio.json").exists():
        print("note: studio.json keeps its keyframes and wishes, lengths and forces, as they were; set them anew")
    print(f"Scaled {path}: from {size}; see what is risky now: hydrostat check {out or home}")
