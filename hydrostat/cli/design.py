"""`hydrostat design`."""

import sys
import time
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.design_results import STALE, print_front, print_poses, write_kit, write_results
from hydrostat.cli.design_wishes import DesignArguments, parse_request
from hydrostat.cli.fabricate import print_kit
from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder, result_folder
from hydrostat.cli.waiting import one_interrupt, progress_bar, read_robot
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.design import DesignRequest, Network
    from hydrostat.fabrication import Kit
    from hydrostat.robot import Robot

STOPPING = "stopping: the best network so far is solved and written ..."  # said when Ctrl-C ends a search


Winches = Annotated[
    str | None,
    typer.Option(
        metavar="N|auto", help="How many winches, 2 if left out; auto finds the fewest that keep the tolerance."
    ),
]
Cables = Annotated[int | None, typer.Option(metavar="N", help="How many cables in all, at most; 6 if left out.")]
Poses = Annotated[
    list[str] | None, typer.Option(metavar="NAME", help="Design for this pose; may be repeated; all if left out.")
]
Method = Annotated[
    str | None,
    typer.Option(
        metavar="routes|trees", help="Routes priced by the pose error, or the thesis's winch trees; routes if left out."
    ),
]
ConstraintsFile = Annotated[
    Path | None, typer.Option(metavar="FILE.toml", help="What can be built; the options below come before it.")
]
CablesPerWinch = Annotated[int | None, typer.Option(metavar="N", help="Most of one winch.")]
Clearance = Annotated[
    str | None, typer.Option(metavar="LENGTH", help="Least distance of a cable from the edge; 5 mm if left out.")
]
Depth = Annotated[
    str | None,
    typer.Option(
        metavar="LENGTH", help="In space: cables on the skin, 0 mm, or at this depth under it, winches outside."
    ),
]
Tension = Annotated[str | None, typer.Option(metavar="FORCE", help="The most that a cable bears; 20 N if left out.")]
Slack = Annotated[
    str | None, typer.Option(metavar="LENGTH", help="The most that a stopper may leave loose; 0 if left out.")
]
SteppedSpools = Annotated[
    bool, typer.Option("--stepped-spools", help="Cables may have spools up to twice as large or small.")
]
Symmetric = Annotated[
    str | None, typer.Option(metavar="x|y|z", help="The same on both sides of the mirror across this axis.")
]
LockWinch = Annotated[
    list[str] | None, typer.Option(metavar="NAME", help="A winch of the robot that stays; may be repeated.")
]
LockCable = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME", help="A cable that stays, by its name or its number from 1; may be repeated."),
]
Improve = Annotated[bool, typer.Option("--improve", help="Begin with the robot's own network.")]
Simplicity = Annotated[
    float | None,
    typer.Option(
        help="How much fewer winches, cables and holes are worth: 1 if left out, 0 for all that help, 10 for a network "
        "that is quickly sewn."
    ),
]
Reach = Annotated[
    float | None,
    typer.Option(
        help="What reach beyond the poses is worth: 0 if left out; at 1 a network whose markers reach twice as far may "
        "miss twice as much."
    ),
]
AsModelled = Annotated[
    bool,
    typer.Option(
        "--as-modelled",
        help="Design for a robot that is built just as its model, with no hole beside its mark and no friction.",
    ),
]
Filled = Annotated[
    bool,
    typer.Option("--filled", help="Compare finalists on the filled body, cables on its skin, by commands found there."),
]
Tolerance = Annotated[
    str | None,
    typer.Option(
        metavar="LENGTH", help="With --winches auto: rms error of each pose; 1 % of the body's size if left out."
    ),
]
Fibres = Annotated[
    str | None, typer.Option(metavar="edges|elements", help="Muscles of trees; on mesh edges if left out.")
]
Knobs = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=VALUE",
        help="Of trees: threshold, distance, steps or phi as in the thesis, one value each; may be repeated.",
    ),
]
WithKit = Annotated[bool, typer.Option("--kit", help="Also write the fabrication kit.")]


def design(
    robot: RobotFolder,
    out: OutFolder,
    winches: Winches = None,
    cables: Cables = None,
    pose: Poses = None,
    method: Method = None,
    constraints: ConstraintsFile = None,
    cables_per_winch: CablesPerWinch = None,
    clearance: Clearance = None,
    depth: Depth = None,
    tension: Tension = None,
    slack: Slack = None,
    stepped_spools: SteppedSpools = False,
    symmetric: Symmetric = None,
    lock_winch: LockWinch = None,
    lock_cable: LockCable = None,
    improve: Improve = False,
    tolerance: Tolerance = None,
    simplicity: Simplicity = None,
    reach: Reach = None,
    as_modelled: AsModelled = False,
    filled: Filled = False,
    fibres: Fibres = None,
    knob: Knobs = None,
    kit: WithKit = False,
) -> None:
    """Find winches and cables that reach a robot's poses.

    Writes a robot folder, report.html with pictures of every stage, score.json, and the alternatives as robot folders.
    Ctrl-C ends the search and keeps the best network so far. A file of constraints has lines such as
    clearance = "4 mm", tension = "15 N", locked_cables = ["left 1"], and tables [[keep_out]], [[still]] and
    [[winch_zone]] with at and radius, box, or outline.

    Example: hydrostat design examples/starfish --pose wave --winches 2 --cables 6 --out build/starfish
    """
    require_folder(out)
    typed = DesignArguments(
        poses=pose or [],
        winches=winches,
        cables=cables,
        method=method,
        improve=improve,
        tolerance=tolerance,
        simplicity=simplicity,
        reach=reach,
        as_modelled=as_modelled,
        filled=filled,
        fibres=fibres,
        knobs=knob or [],
        file=constraints,
        cables_per_winch=cables_per_winch,
        clearance=clearance,
        depth=depth,
        tension=tension,
        slack=slack,
        stepped=stepped_spools,
        symmetric=symmetric,
        lock_winch=lock_winch or [],
        lock_cable=lock_cable or [],
    )
    began = time.perf_counter()
    source = read_robot(robot)
    request = parse_request(source, typed)
    network, made = _search(source, request, out, kit=kit)
    print_poses(network, time.perf_counter() - began)
    _tell_count(network, request)
    if made is not None:
        print_kit(made)
    _tell_next(network, out, kit=kit)
    if not network.complete:
        print("stopped early: the best network so far")
        raise typer.Exit(130)


def _search(source: "Robot", request: "DesignRequest", out: Path, *, kit: bool) -> "tuple[Network, Kit | None]":
    """Search, and write what is found, with its kit if wanted."""
    from hydrostat.design import find_network
    from hydrostat.fabrication import forget_files

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
        made = write_kit(network, out / "kit") if kit else None
        progress("Writing results", 1, 1)
    return network, made


def _tell_count(network: "Network", request: "DesignRequest") -> None:
    """Say it if there are fewer than there may be, or what each number gains where that was left open."""
    from hydrostat.design import AUTO

    found, asked = (len(network.robot.winches), len(network.robot.cables)), (request.winches, request.cables)
    if network.complete and isinstance(request.winches, int) and found != asked:
        words = f"{plural(request.winches, 'winch')} and {plural(request.cables, 'cable')}"
        print(f"of at most {words}: more would not help, or could not be built")
    if request.winches == AUTO:
        print_front(network)


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
