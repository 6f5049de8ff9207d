"""`hydrostat design`."""

import sys
import time
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.design_results import STALE, print_front, print_poses, write_kit, write_results
from hydrostat.cli.design_wishes import TypedLimits, TypedRequest, asked_of
from hydrostat.cli.fabricate import print_kit
from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder, result_folder
from hydrostat.cli.waiting import one_interrupt, read_robot
from hydrostat.units import counted

if TYPE_CHECKING:
    from hydrostat.design import Network

STOPPING = "stopping: the best network so far is solved and written ..."  # said when Ctrl-C ends a search


def design(
    robot: RobotFolder,
    out: OutFolder,
    winches: Annotated[
        str | None,
        typer.Option(
            metavar="N|auto",
            help="How many winches, 2 if left out; auto finds the fewest that keep the tolerance.",
        ),
    ] = None,
    cables: Annotated[
        int | None, typer.Option(metavar="N", help="How many cables in all, at most; 6 if left out.")
    ] = None,
    pose: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Design for this pose; may be repeated; all if left out.")
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(
            metavar="routes|trees",
            help="Routes priced by the pose error, or the thesis's winch trees; routes if left out.",
        ),
    ] = None,
    constraints: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="What can be built; the options below come before it.")
    ] = None,
    cables_per_winch: Annotated[int | None, typer.Option(metavar="N", help="Most of one winch.")] = None,
    clearance: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Least distance of a cable from the edge; 5 mm if left out.")
    ] = None,
    tension: Annotated[
        str | None, typer.Option(metavar="FORCE", help="The most that a cable bears; 20 N if left out.")
    ] = None,
    slack: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="The most that a stopper may leave loose; 0 if left out.")
    ] = None,
    stepped_spools: Annotated[
        bool, typer.Option("--stepped-spools", help="Cables may have spools up to twice as large or small.")
    ] = False,
    symmetric: Annotated[
        str | None, typer.Option(metavar="x|y|z", help="The same on both sides of the mirror across this axis.")
    ] = None,
    lock_winch: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="A winch of the robot that stays; may be repeated.")
    ] = None,
    lock_cable: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="A cable that stays, by its name or its number from 1; may be repeated."),
    ] = None,
    improve: Annotated[bool, typer.Option("--improve", help="Begin with the robot's own network.")] = False,
    tolerance: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH", help="With --winches auto: rms error of each pose; 1 % of the body's size if left out."
        ),
    ] = None,
    fibres: Annotated[
        str | None, typer.Option(metavar="edges|elements", help="Muscles of trees; on mesh edges if left out.")
    ] = None,
    kit: Annotated[bool, typer.Option("--kit", help="Also write the fabrication kit.")] = False,
) -> None:
    """Find winches and cables that reach a robot's poses.

    Writes a robot folder, report.html with pictures of every stage, score.json, and the alternatives as robot folders.
    Ctrl-C ends the search and keeps the best network so far. A file of constraints has lines such as
    clearance = "4 mm", tension = "15 N", locked_cables = ["left 1"], and tables [[keep_out]], [[still]] and
    [[winch_zone]] with at and radius, box, or outline.

    Example: hydrostat design examples/starfish --pose wave --winches 2 --cables 6 --out build/starfish
    """
    from hydrostat.cli.waiting import progress_bar
    from hydrostat.design import AUTO, find_network
    from hydrostat.fabrication.kit import forget_files

    require_folder(out)
    limits = TypedLimits(
        file=constraints,
        cables_per_winch=cables_per_winch,
        clearance=clearance,
        tension=tension,
        slack=slack,
        stepped=stepped_spools,
        symmetric=symmetric,
        lock_winch=tuple(lock_winch or ()),
        lock_cable=tuple(lock_cable or ()),
    )
    typed = TypedRequest(
        poses=tuple(pose or ()),
        winches=winches,
        cables=cables,
        method=method,
        improve=improve,
        tolerance=tolerance,
        fibres=fibres,
        limits=limits,
    )
    began = time.perf_counter()
    source = read_robot(robot)
    request = asked_of(source, typed)
    with progress_bar() as progress, one_interrupt(STOPPING) as pass_over:
        try:
            network = find_network(source, request, progress=progress)
        except KeyboardInterrupt:
            print("hydrostat: stopped before there was a network; nothing is written", file=sys.stderr)
            raise typer.Exit(130) from None
        pass_over()
        progress("Writing results", 0, 1)
        with result_folder(out, stale=STALE) as folder:
            write_results(network, folder)
        forget_files(out / "kit")
        made = write_kit(network.robot, out / "kit") if kit else None
        progress("Writing results", 1, 1)
    print_poses(network, time.perf_counter() - began)
    found, asked = (len(network.robot.winches), len(network.robot.cables)), (request.winches, request.cables)
    if network.complete and isinstance(request.winches, int) and found != asked:
        words = f"{counted(request.winches, 'winch')} and {counted(request.cables, 'cable')}"
        print(f"fewer than the {words} asked for: more would not help, or could not be built")
    if request.winches == AUTO:
        print_front(network)
    if made is not None:
        print_kit(made)
    _tell_next(network, out, kit=kit)
    if not network.complete:
        print("stopped early: the best network so far")
        raise typer.Exit(130)


def _tell_next(network: "Network", out: Path, *, kit: bool) -> None:
    """Where things are."""
    if network.alternatives:
        print(f"Alternatives: {out / 'alternatives'}")
    if kit:
        print(f"To build it, begin with {out / 'kit' / 'assembly_sheet.pdf'}")
    else:
        print(f"Next: hydrostat fabricate {quote(str(out / 'robot'))} --out {quote(str(out / 'kit'))}")
    limit = f"{network.constraints.tension_limit:g}N"
    print(f"Its poses keep to {limit}: hydrostat pose {quote(str(out / 'robot'))} --tension {limit} --out DIR")
    print(f"Open {out / 'report.html'}")
