"""`hydrostat design`."""

import math
import sys
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.check import print_sewing
from hydrostat.cli.check_poses import FAR_SHARE
from hydrostat.cli.design_arguments import DesignArguments, parse_request
from hydrostat.cli.design_record import RECORDS, open_record, tell_record, write_record
from hydrostat.cli.design_results import (
    STALE,
    find_over_budget,
    find_refused_better,
    print_front,
    print_poses,
    write_kit,
    write_results,
)
from hydrostat.cli.fabricate import print_kit
from hydrostat.cli.folders import OutFolder, RobotFolder, folder_of, note_others, require_folder, result_folder
from hydrostat.cli.limits import print_far_targets
from hydrostat.cli.options import parse_budget
from hydrostat.cli.records import take_records
from hydrostat.cli.remedies import body_refusals, design_remedy
from hydrostat.cli.servo_zeros import tell_zero_loss
from hydrostat.cli.waiting import one_interrupt, progress_bar, read_robot
from hydrostat.units import plural

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from hydrostat.design import DesignRequest, DesignStage, Lift, Network, SearchRecord
    from hydrostat.fabrication import Kit
    from hydrostat.robot import Robot

_IMPROVEMENT_RATIO = 0.95  # a network is printed below this share of the last printed error
STOPPING = "stopping: solving and writing the best network so far ..."  # said when Ctrl-C ends a search


Resume = Annotated[bool, typer.Option("--resume", help="Continue a search that was stopped: same command, same --out.")]
WithKit = Annotated[bool, typer.Option("--kit", help="Also write the build kit.")]


@take_records
def design(
    robot: RobotFolder, out: OutFolder, asked: DesignArguments, kit: WithKit = False, resume: Resume = False
) -> None:
    """Design the winches and cable routes that reach given poses.

    Writes a robot folder, report.html with pictures of every stage, score.json, and alternatives as robot folders.
    Ctrl-C, SIGTERM, a closed terminal and --time end the search and keep the best network so far; search.json keeps its
    steps for --resume. A constraints file has lines such as clearance = "4 mm", tension = "15 N", locked_cables =
    ["left 1"], and tables [[keep_out]], [[passive_zone]] and [[winch_zone]] with at and radius, box, or outline.

    Example: hydrostat design gallery:starfish --pose wave --winches 2 --cables 6 --out build/starfish
    """
    require_folder(out)
    note_others(out, (*RECORDS, "score.json"))
    from hydrostat.design import kit_fits
    from hydrostat.errors import in_words

    began = time.perf_counter()
    source = read_robot(robot)
    request = parse_request(source, asked, measured=folder_of(robot) / "tolerances.toml")
    _refuse_body(source, request)
    _tell_left_out(source)
    print_far_targets(source, request.poses)
    warn_of_mirror(source, request, asked)
    spend = parse_budget(asked.budget)
    _refuse_budget(request, request.motor_for(source), spend)
    record = open_record(out, source, request, resume=resume)
    with one_interrupt(STOPPING, interrupt=True) as pass_over:
        network, lifts = _search(source, request, record, out)
        pass_over()
        printed = print_poses(network, time.perf_counter() - began)
        print(end="", flush=True)
        made = _write(network, out, kit=kit, budget=spend)
        write_record(record, network, out, source, request)
    if made is not None:
        print_kit(made, printed=printed)
    _tell_count(network, request, lifts)
    if not lifts:
        _tell_miss(network)
    taken = [max(pulls) for pulls in zip(*(found.pose.contractions for found in network.ik_results), strict=True)]
    if words := tell_zero_loss(network.robot, network.robot.motor, taken):
        print(f"note: {words}")
    fits = kit_fits(network) and not (made is not None and made.problems)
    over = find_over_budget(network, spend) if made is None and fits else ()
    for problem in over:
        print(f"error: {in_words(problem)}")
    _tell_next(network, robot, out, kit=kit, fits=fits, budget=spend, over=over)
    if network.timed_out:
        print(f"time limit of {asked.time} reached: best network so far")
    elif not network.complete:
        print("interrupted: best network so far")
        raise typer.Exit(130)
    if not fits or over:
        print("hydrostat: error: the kit of this network would be rejected", file=sys.stderr)
        raise typer.Exit(1)


def _refuse_body(source: "Robot", request: "DesignRequest") -> None:
    """Stop before the search if no kit can be made of the body (InputError), or warn where none is asked for."""
    from hydrostat.errors import NO_KIT, InputError, in_words

    reasons = [NO_KIT + in_words(reason) for reason in (*print_sewing(source.body), *body_refusals(source))]
    if reasons and request.constraints.built_in and not request.method.grows_trees:
        more = f" ({len(reasons) - 1} more: hydrostat check)" if len(reasons) > 1 else ""
        raise InputError(f"{reasons[0]}{more}. To design without a kit: built_in = false in a file for --constraints.")
    for reason in reasons:
        print(f"warning: {reason}", file=sys.stderr, flush=True)


def _tell_left_out(source: "Robot") -> None:
    """Print notes of drives and of units that are parts of the body, which a search leaves out."""
    if source.drives:
        names = ", ".join(drive.name for drive in source.drives)
        print(f"note: drives stay at rest in the search: {names}", file=sys.stderr, flush=True)
    if any(winch.body for winch in source.winches):
        words = "body = true is left out, since the search places the units itself. Add it to the winches of the result"
        print(f"note: {words}", file=sys.stderr, flush=True)


def warn_of_mirror(source: "Robot", request: "DesignRequest", asked: DesignArguments) -> None:
    """Print a warning of poses that a symmetric network may not reach, with the option or the key that asks for it."""
    from hydrostat.design import find_unmirrored_poses
    from hydrostat.units import list_words

    axis = request.constraints.mirror
    if axis is None or not (names := find_unmirrored_poses(source, request.poses, axis)):
        return
    one = len(names) == 1
    cause = "--symmetric" if asked.symmetric is not None else f'mirror = "{axis}" from {asked.constraints}'
    print(
        f"warning: no pose mirrors {'pose' if one else 'poses'} {list_words(names)} about {axis}. A symmetric network "
        f"may miss {'it' if one else 'them'}. Remove {cause}, or add the mirror image as a pose",
        file=sys.stderr,
        flush=True,
    )


def _refuse_budget(request: "DesignRequest", key: str, budget: float | None) -> None:
    """Stop before the search if a budget does not buy the motors of the winches that are asked for (InputError)."""
    from hydrostat.errors import InputError
    from hydrostat.fabrication import ALL_MOTORS, AUTO_MOTORS, motors_price

    if budget is None:
        return
    least = request.winches if isinstance(request.winches, int) else 1
    motors = [motor for motor in ALL_MOTORS if motor.key == key] or AUTO_MOTORS
    price, cheapest = min((motors_price([0.0] * least, motor), motor.key) for motor in motors)
    if price > budget:
        count = plural(least, "motor")
        raise InputError(
            f"--budget {budget:g}USD: {count} with boards and power cost at least {price:.0f} USD ({cheapest}). Ask "
            "for fewer winches or a greater budget."
        )


def _search(
    source: "Robot", request: "DesignRequest", record: "SearchRecord", out: Path
) -> "tuple[Network, tuple[Lift, ...]]":
    """Find the network, and changes that lower its error; exit where it is interrupted before the first network."""
    from hydrostat.design import find_lifts, find_network

    lifts: tuple[Lift, ...] = ()
    with progress_bar() as progress:
        try:
            network = find_network(source, request, progress=progress, watch=_tell_better(), record=record)
        except KeyboardInterrupt:
            print(f"hydrostat: interrupted before the first network; {tell_record(out)}", file=sys.stderr)
            raise typer.Exit(130) from None
        if network.complete and not request.method.grows_trees and not request.front:
            progress("Other winches", 0, 1)
            with suppress(KeyboardInterrupt):
                lifts = find_lifts(network)
            progress("Other winches", 1, 1)
    return replace(network, alternatives=(*network.alternatives, *(lift.network for lift in lifts))), lifts


def _write(network: "Network", out: Path, *, kit: bool, budget: float | None) -> "Kit | None":
    """Write the results, with the kit if wanted, and print the seconds that this took."""
    from hydrostat.fabrication import Kit

    began = time.perf_counter()
    if network.timed_out:
        print("search ended by --time. The report takes additional time", file=sys.stderr, flush=True)
    with progress_bar() as progress:
        progress("Writing results", 0, 1)
        with result_folder(out, stale=STALE, kept=RECORDS) as folder:
            write_results(network, folder)
        Kit.forget_files(out / "kit")
        made = write_kit(network, out / "kit", budget=budget) if kit else None
        progress("Writing results", 1, 1)
    print(f"results written in {time.perf_counter() - began:.1f} s", file=sys.stderr, flush=True)
    return made


def _tell_better() -> "Callable[[DesignStage], None]":
    """A function that prints each network that is clearly better than those before."""
    began, least = time.perf_counter(), math.inf

    def tell(stage: "DesignStage") -> None:
        nonlocal least
        if stage.error > _IMPROVEMENT_RATIO * least:
            return
        least = stage.error
        counts = f"{plural(len(stage.robot.winches), 'winch')}, {plural(len(stage.robot.cables), 'cable')}"
        seconds = time.perf_counter() - began
        print(f"{seconds:5.1f} s: {1e3 * least:.3g} mm so far ({counts}), kit not checked", file=sys.stderr, flush=True)

    return tell


def _tell_count(network: "Network", request: "DesignRequest", lifts: "Iterable[Lift]") -> None:
    """Print a note if there are fewer than there may be, what lowers the error, and the front of other winches."""
    from hydrostat.design import find_mirror_axis
    from hydrostat.errors import in_words

    found, asked = (len(network.robot.winches), len(network.robot.cables)), (request.winches, request.cables)
    if network.complete and isinstance(request.winches, int) and found != asked:
        words = f"{plural(request.winches, 'winch')} and {plural(request.cables, 'cable')}"
        print(f"note: {words} were allowed. The search found no larger buildable network with a smaller error")
    if refused := find_refused_better(network):
        better, reason = refused
        size = f"{1e3 * better.expected_error:.3g} mm with {plural(len(better.robot.cables), 'cable')}"
        print(f"note: {size} fell away, its kit would be refused: {in_words(reason)}")
    if request.constraints.mirror is None and (axis := find_mirror_axis(network.source, request.poses)):
        print(f"note: body, markers and poses mirror about {axis}. Try --symmetric {axis}")
    for name, error in (network.idle_winches if network.complete else {}).items():
        words = f"{1e3 * error:.3g} mm in the model instead of {1e3 * network.rms_error:.3g} mm"
        print(f"note: winch {name} hardly helps: without it {words}. Try --winches {len(network.robot.winches) - 1}")
    for lift in lifts:
        error = 1e3 * lift.network.expected_error
        print(f"note: {lift.words} would leave at most {error:.2g} mm as built, by a quick search")
    if request.is_open or request.front or lifts:
        print_front(network)


def _tell_miss(network: "Network") -> None:
    """Print a note on what keeps a network from its targets where it leaves much of the way to them."""
    left = network.rms_error / max(network.rest_error, 1e-12)
    if left < FAR_SHARE:
        return
    held = dict.fromkeys(words for reached in network.ik_results for words in reached.active_limits)
    if not network.complete:
        words = "the search was stopped before its end. Give it more time"
    elif held:
        words = f"{', '.join(held)}. Raise these limits, or move the targets nearer"
    else:
        words = "no limit of winches or cables stands in the way. Allow more cables, or move the targets nearer"
    print(f"note: {100 * left:.0f} % of the way to the targets is left: {words}")


def _tell_next(
    network: "Network", source: Path, out: Path, *, kit: bool, fits: bool, budget: float | None, over: tuple[str, ...]
) -> None:
    """Print the locations of the results and the next command."""
    if network.alternatives:
        print(f"Alternatives: {out / 'alternatives'}")
    if not fits or over:
        print(f"Try: {design_remedy(network, source, out, budget=budget, over=over)}")
    elif kit:
        print(f"To build it, start with {out / 'kit' / 'assembly_sheet.pdf'}")
    else:
        spend = "" if budget is None else f" --budget {budget:g}USD"
        print(f"Next: hydrostat fabricate {quote(str(out / 'robot'))}{spend} --out {quote(str(out / 'kit'))}")
    print(f"Pose it within the limits of its robot.toml: hydrostat pose {quote(str(out / 'robot'))} --out DIR")
    print(f"Open {out / 'report.html'}")
