"""`hydrostat design`."""

import json
import time
from dataclasses import asdict
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.arguments import OutFolder, RobotFolder, require_folder
from hydrostat.cli.prepare import read_robot
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.design import DesignOptions, Network
    from hydrostat.robot import Robot


def design(
    robot: RobotFolder,
    out: OutFolder,
    winches: Annotated[int, typer.Option(min=1, max=20, help="How many winches.")] = 2,
    cables: Annotated[int, typer.Option(min=1, max=60, help="How many cables in all, at most.")] = 6,
    pose: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Design for this pose; may be repeated; all if left out.")
    ] = None,
    fibres: Annotated[
        str, typer.Option(help="Muscles on mesh edges, or one in each element: edges | elements.")
    ] = "edges",
    clearance: Annotated[str, typer.Option(help="Least distance of a cable from the edge of the body.")] = "5 mm",
    kit: Annotated[bool, typer.Option(help="Also write the laser pattern.")] = False,
) -> None:
    """Find winches and cables that reach a robot's poses.

    Writes a robot folder, report.html with pictures of every stage, and score.json.

    Example: hydrostat design examples/starfish --pose wave --winches 2 --cables 6 --out build/starfish
    """
    from hydrostat import __version__
    from hydrostat.cli.progress import progress_bar
    from hydrostat.design import DesignOptions, FibreKind, design_cables, score_card
    from hydrostat.robot import replace_file, save_robot
    from hydrostat.units import LENGTH, parse_quantity

    require_folder(out)
    if fibres not in list(FibreKind):
        raise InputError(f"--fibres {fibres}: must be one of {', '.join(FibreKind)}")
    options = DesignOptions(fibres=FibreKind(fibres), clearance=parse_quantity(clearance, LENGTH))
    began = time.perf_counter()
    source = read_robot(robot)
    poses = [source.pose(name) for name in pose] if pose else list(source.poses.values())
    with progress_bar() as progress:
        network = design_cables(source, poses, winches=winches, cables=cables, options=options, progress=progress)
        progress("Writing results", 0, 1)
        out.mkdir(parents=True, exist_ok=True)
        save_robot(network.robot, out / "robot")
        card = score_card(network, source, options, version=__version__)
        replace_file(out / "score.json", (json.dumps(card, indent=2) + "\n").encode())
        _write_pictures(network, out, {"seed": "none: nothing is drawn at random", **_told(options)})
        _forget_kit(out / "pattern")
        warnings = _write_kit(network.robot, out / "pattern") if kit else []
        progress("Writing results", 1, 1)
    _print_table(network, card["rms_error_at_rest"], time.perf_counter() - began)
    for warning in warnings:
        print(f"warning: {warning}")
    if not kit:
        print(f"Next: hydrostat fabricate {quote(str(out / 'robot'))} --out {quote(str(out / 'pattern'))}")
    else:
        print(f"Laser pattern: {out / 'pattern' / 'pattern.svg'} and pattern.dxf")
    print(f"Open {out / 'report.html'}")


def _write_pictures(network: "Network", out: Path, facts: dict[str, object]) -> None:
    from hydrostat.plot import write_report

    write_report(network, out / "report.html", facts=facts)


def _told(options: "DesignOptions") -> dict[str, object]:
    """Options as a person reads them."""
    entries = asdict(options).items()
    return {name: ", ".join(map(str, value)) if isinstance(value, tuple) else value for name, value in entries}


def _forget_kit(folder: Path) -> None:
    """No pattern of an earlier design must lie beside a new one."""
    for name in ("pattern.svg", "pattern.dxf"):
        (folder / name).unlink(missing_ok=True)


def _write_kit(robot: "Robot", folder: Path) -> tuple[str, ...]:
    from hydrostat.fabrication import PatternOptions, export_kit, plush_pattern

    options = PatternOptions(force=True)
    export_kit(robot, folder, options=options)
    return plush_pattern(robot, options=options).warnings


def _print_table(network: "Network", rest: float, seconds: float) -> None:
    from rich.console import Console
    from rich.table import Table

    from hydrostat.units import counted

    robot = network.robot
    network_size = f"{counted(len(robot.winches), 'winch')}, {counted(len(robot.cables), 'cable')}"
    table = Table(title=f"{robot.name}: {network_size}", title_justify="left")
    for name, justify in (("pose", "left"), ("rms error", "right"), ("worst marker", "left"), ("contractions", "left")):
        table.add_column(name, justify=justify)  # type: ignore[arg-type]
    for reached in network.reached:
        worst = max(reached.errors, key=lambda name: reached.errors[name])
        taken = (
            f"{winch.name} {1e3 * value:.1f} mm"
            for winch, value in zip(robot.winches, reached.pose.contractions, strict=True)
        )
        table.add_row(
            reached.wanted.name,
            f"{1e3 * reached.rms_error:.2f} mm",
            f"{worst} {1e3 * reached.errors[worst]:.1f} mm",
            ", ".join(taken),
        )
    Console().print(table)
    print(
        f"rms error: {1e3 * rest:.2f} mm at rest, {1e3 * network.rms_error:.2f} mm reached; "
        f"{network.tried} networks tried in {seconds:.1f} s"
    )
