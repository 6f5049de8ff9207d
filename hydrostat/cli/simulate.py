"""`hydrostat simulate`."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.arguments import OutFolder, RobotFolder, require_folder
from hydrostat.cli.contractions import check_contraction, contraction
from hydrostat.cli.motion import move
from hydrostat.cli.places import print_places
from hydrostat.cli.prepare import prepared, read_robot
from hydrostat.cli.profiling import profiled
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.simulation import Simulation, SolvedPose


def simulate(
    robot: RobotFolder,
    out: OutFolder,
    contract: Annotated[
        list[str] | None, typer.Option(metavar="WINCH=LENGTH", help="Cable a winch takes in; may be repeated.")
    ] = None,
    jacobian: Annotated[bool, typer.Option(help="Also write jacobian.npz.")] = False,
    dynamic: Annotated[
        bool, typer.Option("--dynamic", help="Move there in time, from where it rests at first.")
    ] = False,
    duration: Annotated[
        str | None, typer.Option(metavar="TIME", help="How long; as --ramp or --play, at least 1 s, if left out.")
    ] = None,
    step: Annotated[str, typer.Option(metavar="TIME", help="Longest time step.")] = "5ms",
    ramp: Annotated[str, typer.Option(metavar="TIME", help="In which the winches take in their cable.")] = "0.5s",
    play: Annotated[
        Path | None, typer.Option(metavar="FILE.csv", help="Contractions in time: columns time_s, WINCH ... [mm].")
    ] = None,
    profile: Annotated[bool, typer.Option("--profile", help="Print where time went.")] = False,
) -> None:
    """Find where a robot rests when its winches take in cable, or with --dynamic how it moves.

    Writes pose.json, pose.vtu (for ParaView) and pose.png; of a motion these show its end, and there are also
    motion.csv, motion.pvd (for ParaView) and motion.png.

    Example: hydrostat simulate examples/starfish --contract left=12mm --out build/pose
    """
    from hydrostat import __version__
    from hydrostat.simulation import write_pose

    require_folder(out)
    with profiled(profile, "reading"):
        loaded = read_robot(robot)
    contractions = dict(contraction(text) for text in contract or [])
    for name, value in contractions.items():
        check_contraction(loaded, name, value)
    if dynamic and jacobian:
        raise InputError("--jacobian: a motion has none; leave out --dynamic")
    if not dynamic and (play is not None or duration is not None):
        raise InputError("--play and --duration go with --dynamic; add it")
    with profiled(profile, "preparing"):
        simulation = prepared(loaded)
    if dynamic:
        with profiled(profile, "moving"):
            files = move(simulation, contractions, out, duration=duration, step=step, ramp=ramp, play=play)
        print("Wrote " + ", ".join(str(file) for file in files))
        return
    began = time.process_time()
    with profiled(profile, "finding the pose"):
        pose = simulation.solve(contractions, strict=False)
    seconds = time.process_time() - began
    files = write_pose(simulation, pose, out, extra={"seconds": seconds, "version": __version__}, jacobian=jacobian)
    files += _picture(simulation, pose, out)
    print_places(pose, loaded)
    print(f"{pose.result.reason} after {pose.result.iterations} iterations, {1e3 * seconds:.0f} ms")
    if pose.result.buckled:
        print("note: the body buckled on the way; it could as well have gone to another side")
    if pose.result.converged and not pose.result.stable:
        print("note: the body is at rest on a saddle; the least push would make it leave")
    print("Wrote " + ", ".join(str(file) for file in files))
    if not pose.result.converged:
        raise typer.Exit(1)


def _picture(simulation: "Simulation", pose: "SolvedPose", out: Path) -> list[Path]:
    from hydrostat.plot import draw_pose, save_png

    return [save_png(draw_pose(simulation.robot, pose), out / "pose.png")]
