"""`hydrostat animate`."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder, result_folder
from hydrostat.cli.option_errors import naming_option
from hydrostat.cli.options import PictureWidth, check_width
from hydrostat.cli.require_cables import require_cables
from hydrostat.cli.waiting import prepare_physics, progress_bar, read_robot
from hydrostat.errors import InputError
from hydrostat.progress import Progress
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.plot import Film, Stop
    from hydrostat.simulation import Simulation


class Format(StrEnum):
    """Kind of file that a film is written to."""

    GIF = "gif"
    GLB = "glb"
    MP4 = "mp4"


def animate(
    robot: RobotFolder,
    out: OutFolder,
    name: Annotated[
        list[str] | None,
        typer.Option("--pose", metavar="NAME", help="Pose to show. Repeatable.", show_default="all"),
    ] = None,
    seconds: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS", help="Length of the animation.", show_default="2 s per move, at most 12 s in total"
        ),
    ] = None,
    format: Annotated[
        list[Format] | None,
        typer.Option(metavar="gif|glb|mp4", help="File format. Repeatable.", show_default="gif and glb"),
    ] = None,
    width: PictureWidth = 640,
) -> None:
    """Animate a robot moving from rest through its poses and back.

    Writes animation.gif, and animation.glb for Blender, browsers and 3D viewers; with --format mp4, animation.mp4.
    A robot without poses contracts its winches one by one.

    Example: hydrostat animate gallery:starfish --pose wave --out build/wave
    """
    from hydrostat.plot import Film, find_ffmpeg

    require_folder(out)
    formats = list(dict.fromkeys(format or (Format.GIF, Format.GLB)))
    if Format.MP4 in formats:
        find_ffmpeg()
    longest = 60.0  # longest film [s]
    if seconds is not None and not 0 < seconds <= longest:
        raise InputError(f"--seconds {seconds:g}: must be above 0 and at most {longest:g}")
    check_width(width)
    loaded = read_robot(robot)
    for pose in name or []:
        with naming_option(f"--pose {pose}"):
            loaded.pose(pose)
    require_cables(loaded, robot, "films")
    simulation = prepare_physics(loaded)
    each_way, usual, least_way = 2.0, 12.0, 0.5  # time of a way, most of a whole film, least of a way [s]
    with progress_bar() as progress:
        stops = find_stops(simulation, name or list(loaded.poses), progress)
        ways = len(stops) + 1
        length = max(min(each_way * ways, usual), least_way * ways) if seconds is None else seconds
        made = Film.of_stops(simulation, stops, seconds=length, progress=progress)
        with result_folder(out) as folder:
            files = [out / _write(simulation, made, folder, kind, width, progress).name for kind in formats]
    print(f"{plural(len(made.frames), 'frame')}, {length:g} s: rest, {', '.join(stop.name for stop in stops)}, rest")
    if made.missing:
        print(
            f"warning: no equilibrium for {plural(len(made.missing), 'frame')}, the first at "
            f"{made.missing[0] * made.step:.1f} s. The previous frame is repeated"
        )
    print("Wrote " + ", ".join(str(file) for file in files))


def find_stops(simulation: "Simulation", names: list[str], progress: Progress) -> "list[Stop]":
    """Find what the winches reach of each pose; without poses one winch after the other."""
    from hydrostat.ik import solve_ik
    from hydrostat.plot import Stop

    if not names:
        return Stop.for_winches(simulation.robot)
    reached = []
    for index, pose in enumerate(names):
        reached.append(solve_ik(simulation, simulation.robot.pose(pose)))
        progress("solving poses", index + 1, len(names))
    for found in reached:
        print(f"{found.pose_target.name}: rms error {1e3 * found.rms_error:.2f} mm; {found.outcome}")
    return Stop.for_poses(reached)


def _write(simulation: "Simulation", made: "Film", out: Path, kind: Format, width: int, progress: Progress) -> Path:
    from hydrostat.plot import save_gif, save_glb, save_mp4

    robot, path = simulation.robot, out / f"animation.{kind}"
    if kind is Format.GLB:
        return save_glb(robot, made.frames, path, step=made.step)
    save = save_gif if kind is Format.GIF else save_mp4
    return save(robot, made.frames, path, step=made.step, width=width, progress=progress)
