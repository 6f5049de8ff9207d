"""`hydrostat pose`."""

import json
import time
from pathlib import Path
from typing import Annotated

import typer

from hydrostat.cli.arguments import OutFolder, RobotFolder, require_folder
from hydrostat.cli.prepare import read_robot
from hydrostat.errors import InputError


def pose(
    robot: RobotFolder,
    out: OutFolder,
    name: Annotated[str | None, typer.Option("--pose", metavar="NAME", help="One pose; all if left out.")] = None,
    jacobian: Annotated[bool, typer.Option(help="Also write jacobian.npz.")] = False,
) -> None:
    """Find the contractions that come nearest to a pose.

    Writes contractions.json, pose.json, pose.vtu (for ParaView) and pose.png; several poses get a folder each.

    Example: hydrostat pose examples/starfish --pose wave --out build/wave
    """
    from hydrostat import __version__
    from hydrostat.ik import InverseReason, solve_ik
    from hydrostat.plot import draw_reached, save_png
    from hydrostat.robot import replace_file
    from hydrostat.simulation import Simulation, write_pose

    require_folder(out)
    loaded = read_robot(robot)
    if not loaded.poses:
        raise InputError(f"{robot}: the robot has no [[pose]]; add one")
    targets = [loaded.pose(name)] if name else list(loaded.poses.values())
    simulation = Simulation(loaded)
    stuck = False
    for target in targets:
        began = time.process_time()
        reached = solve_ik(simulation, target)
        seconds = time.process_time() - began
        folder: Path = out / target.name if len(targets) > 1 else out
        extra = {"seconds": seconds, "version": __version__, "pose": target.name, "errors": dict(reached.errors)}
        write_pose(simulation, reached.pose, folder, extra=extra, jacobian=jacobian)
        taken = {winch.name: float(a) for winch, a in zip(loaded.winches, reached.pose.contractions, strict=True)}
        replace_file(folder / "contractions.json", (json.dumps(taken, indent=2) + "\n").encode())
        save_png(draw_reached(loaded, reached), folder / "pose.png")
        text = ", ".join(f"{winch} {1e3 * value:.1f} mm" for winch, value in taken.items())
        print(f"{target.name}: rms error {1e3 * reached.rms_error:.2f} mm; {reached.reason} ({1e3 * seconds:.0f} ms)")
        print(f"  contractions: {text}")
        print(f"  wrote {folder}")
        stuck |= reached.reason in (InverseReason.ITERATION_LIMIT, InverseReason.NO_EQUILIBRIUM)
    if stuck:
        raise typer.Exit(1)
