"""`hydrostat simulate`."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.arguments import OutFolder, RobotFolder, require_folder
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
) -> None:
    """Find where a robot rests when its winches take in cable.

    Writes pose.json, pose.vtu (for ParaView) and pose.png.

    Example: hydrostat simulate examples/starfish --contract left=12mm --out build/pose
    """
    from hydrostat import __version__
    from hydrostat.robot import load_robot
    from hydrostat.simulation import Simulation, write_pose

    require_folder(out)
    loaded = load_robot(robot)
    simulation = Simulation(loaded)
    contractions = dict(_contraction(text) for text in contract or [])
    for name, value in contractions.items():
        winch = loaded.winch(name)
        if not -winch.release <= value <= winch.travel:
            print(
                f"note: winch {name} can take in from {-1e3 * winch.release:g} to {1e3 * winch.travel:g} mm, "
                f"{1e3 * value:g} mm is beyond it"
            )
        shortest = min((cable.length for cable in loaded.cables if cable.winch == name), default=float("inf"))
        if value >= shortest:
            raise InputError(
                f"--contract {name}: {1e3 * value:g} mm is all of a cable that is {1e3 * shortest:.3g} mm long"
            )
    began = time.process_time()
    pose = simulation.solve(contractions, strict=False)
    seconds = time.process_time() - began
    files = write_pose(simulation, pose, out, extra={"seconds": seconds, "version": __version__}, jacobian=jacobian)
    files += _picture(simulation, pose, out)
    for name, place in pose.markers.items():
        print(f"{name:<16} {', '.join(f'{1e3 * value:8.2f}' for value in place)} mm")
    for index, tension in enumerate(pose.tensions):
        print(f"cable {index + 1:<10} {tension:8.3f} N")
    print(f"{pose.result.reason} after {pose.result.iterations} iterations, {1e3 * seconds:.0f} ms")
    print("Wrote " + ", ".join(str(file) for file in files))
    if not pose.result.converged:
        raise typer.Exit(1)


def _contraction(text: str) -> tuple[str, float]:
    from hydrostat.units import LENGTH, parse_quantity

    name, equals, length = text.partition("=")
    if not equals:
        raise InputError(f'--contract {text}: write WINCH=LENGTH, for example "left=12mm"')
    sign = -1.0 if length.strip().startswith("-") else 1.0
    try:
        return name.strip(), sign * parse_quantity(length.strip().removeprefix("-"), LENGTH)
    except InputError as error:
        raise InputError(f"--contract {text}: {error}") from None


def _picture(simulation: "Simulation", pose: "SolvedPose", out: Path) -> list[Path]:
    from hydrostat.plot import draw_pose, save_png

    return [save_png(draw_pose(simulation.robot, pose), out / "pose.png")]
