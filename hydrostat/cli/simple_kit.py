"""`simplify_robot`: the version of a robot for a first afternoon, and what falls away, for `hydrostat fabricate`."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from hydrostat.errors import InputError, NotConvergedError
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.design import PosedNetwork
    from hydrostat.fabrication import KitOptions
    from hydrostat.robot import Robot

GROMMET, STITCHED = 0.2, 0.4  # largest friction at a hole with a grommet, as designs assume it, and without; assumed


def simplify_robot(robot: "Robot", options: "KitOptions") -> "tuple[Robot, KitOptions]":
    """The robot with the fewest cables on one panel where that stays flat, its holes stitched; prints a table.

    Raises:
        InputError: no plush robot with cables and poses.
    """
    from hydrostat.cli.waiting import progress_bar
    from hydrostat.design import drop_cables
    from hydrostat.fabrication import Method
    from hydrostat.ik import Limits

    if options.method_for(robot.body) is not Method.PLUSH:
        raise InputError("--simple: needs a plush robot. Remove it, or add --method plush.")
    with progress_bar() as progress:
        full, found = drop_cables(
            robot,
            limits=Limits(tension=options.tension, torque=options.torque),
            progress=progress,
        )
    simple, panel = _one_panel(found)
    cables, winches = (len(robot.cables) - len(simple.cables), len(robot.winches) - len(simple.winches))
    left_out = (
        *([f"{cables} of {len(robot.cables)} cables of the robot file"] if cables else []),
        *([plural(winches, "winch")] if winches else []),
        *(["cables on the back panel"] if simple.face is not robot.face else []),
        "printed grommets",
    )
    own = replace(options, parts=replace(options.parts, grommets=False), left_out=left_out)
    _print_table(robot, options, simple, own, _errors(full, found))
    if not cables and len(robot.cables) > 1:
        print(
            "note: all cables stay. Without any one of them the error is more than 1.5 times that of the full version"
        )
    if panel:
        print(f"note: {panel}")
    return simple, own


def _one_panel(found: "PosedNetwork") -> "tuple[Robot, str]":
    """The robot with its cables on the front if it has pairs and stays flat; else itself, and why."""
    from hydrostat.robot import CableSide
    from hydrostat.simulation import is_stuffed_motion_fast, solve_stuffed_motion

    robot = found.robot
    if robot.face is not CableSide.PAIRS:
        return robot, ""
    front = replace(robot, face=CableSide.FRONT)
    if not is_stuffed_motion_fast(front, len(found.reached)):
        return robot, "cables stay on both panels: what one panel bends out of plane takes long to compute"
    with suppress(InputError, NotConvergedError):
        moved = solve_stuffed_motion(front, [reached.pose.contractions for reached in found.reached])
        if moved.warning is None:
            return front, f"cables on the front alone: {moved}"
        return robot, f"cables stay on both panels: on one, {moved}"
    return robot, "cables stay on both panels: on one, the stuffed body has no equilibrium"


def _errors(full: "PosedNetwork", found: "PosedNetwork") -> Mapping[str, tuple[str, str]]:
    """Errors of the full and of the simple version, by what they are."""
    rows = {"Expected as-built error": (f"{1e3 * full.error:.2f} mm", f"{1e3 * found.error:.2f} mm")}
    with suppress(NotConvergedError):
        moved = full.friction_motion(GROMMET), found.friction_motion(STITCHED)
        rows["Friction moves markers by"] = (
            f"{1e3 * moved[0]:.2f} mm (grommets, {GROMMET:g})",
            f"{1e3 * moved[1]:.2f} mm (stitched holes, {STITCHED:g}, assumed)",
        )
    return rows


def _print_table(
    robot: "Robot", options: "KitOptions", simple: "Robot", own: "KitOptions", errors: Mapping[str, tuple[str, str]]
) -> None:
    """Print what the two versions ask of a person, and their errors."""
    from rich.console import Console
    from rich.table import Table

    from hydrostat.fabrication import summarize_kit

    one, other = (dict(summarize_kit(*each[:1], options=each[1])) for each in ((robot, options), (simple, own)))
    table = Table(title=f"{robot.name}: first afternoon", title_justify="left")
    for head in ("", "full", "simple"):
        table.add_column(head)
    table.add_row("Winches", str(len(robot.winches)), str(len(simple.winches)))
    for title in ("Difficulty", "Work", "Money", "To print", "To sew"):
        table.add_row(title, one[title][0], other[title][0])
    for title, values in errors.items():
        table.add_row(title, *values)
    Console(markup=False).print(table)
