"""`hydrostat scale`."""

from pathlib import Path
from typing import Annotated

import typer

from hydrostat.cli.folders import OwnRobotFolder
from hydrostat.cli.waiting import patiently, read_robot
from hydrostat.errors import InputError


def scale(
    robot: OwnRobotFolder,
    factor: Annotated[str, typer.Argument(metavar="FACTOR", help="Scale factor, e.g. 1.5.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Output folder.", show_default="change ROBOT in place")
    ] = None,
) -> None:
    """Scale a robot with all its parts and poses.

    Scales body, pins, markers, winches, cables, obstacles and poses. Keeps the comments in robot.toml, materials,
    stiffnesses and masses. A scaled robot behaves differently: check and simulate it again.

    Example: hydrostat scale my_starfish 1.5
    """
    from hydrostat.files import read_text
    from hydrostat.project import PROJECT_FILE
    from hydrostat.robot import merged_text, save_robot, scaled_robot

    if out is not None and out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(f"{out} already exists. Choose another name or delete the folder.")
    try:
        times = float(factor.replace(",", "."))
    except ValueError:
        raise InputError(f"{factor}: not a number. Write a factor, e.g. 1.5.") from None
    loaded = read_robot(robot)
    with patiently("meshing the body ..."):
        made = scaled_robot(loaded, times)
    home = robot.parent if robot.suffix == ".toml" and not robot.is_dir() else robot
    text = merged_text(read_text(home / "robot.toml"), made)
    path = save_robot(made, out or home, text=text)
    size = f"{1e3 * loaded.body.mesh.size:.0f} mm to {1e3 * made.body.mesh.size:.0f} mm"
    if out is None and (home / PROJECT_FILE).exists():
        print(f"note: keyframes and limits in {PROJECT_FILE} are not scaled. Set them again in the studio")
    if out is None:
        print(f"note: {path} was changed in place. Undo: hydrostat scale {home} {1 / times:.10g}")
    print(f"Scaled {path}: {size}. Next: hydrostat check {out or home}")
