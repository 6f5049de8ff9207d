"""`hydrostat fabricate`."""

import re
import time
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.design_results import designed_motor, designed_tension, designed_torque
from hydrostat.cli.folders import RobotFolder, require_folder
from hydrostat.cli.options import Budget, MotorOption, parse_budget, parse_optional, positive
from hydrostat.cli.servo_zeros import SERVO_BOARD, tell_zero_loss
from hydrostat.cli.waiting import progress_bar, read_robot
from hydrostat.closed_set import parse_choice
from hydrostat.errors import InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.fabrication import Kit, KitOptions
    from hydrostat.robot import Robot


Tension = Annotated[
    str | None,
    typer.Option(
        metavar="FORCE",
        help="Cable tension to build for: motors and line must hold it.",
        show_default="that of robot.toml or of the studio, else none",
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Write the kit despite errors. The assembly sheet lists them.")]


def fabricate(
    robot: RobotFolder,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Output folder (created if missing).", show_default=False),
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(
            metavar="plush|foam|print",
            help="Build method.",
            show_default="print for TPU, foam for castable materials, plush for flat or stuffed bodies",
        ),
    ] = None,
    motor: MotorOption = None,
    budget: Budget = None,
    board: Annotated[
        str | None,
        typer.Option(
            metavar="uno|mega|esp32s3",
            help="Board for n20 and 25d; esp32s3 also for Feetech servos.",
            show_default="smallest Arduino",
        ),
    ] = None,
    mould: Annotated[
        str | None,
        typer.Option(metavar="printed|silicone", help="Mold material for foam robots.", show_default="printed"),
    ] = None,
    bed: Annotated[
        str, typer.Option(metavar="LENGTHS", help="Build volume of your 3D printer along x, y and z.")
    ] = "220 x 220 x 250 mm",
    tension: Tension = None,
    paper: Annotated[str, typer.Option(metavar="a4|letter|a3", help="Paper size of pattern and tags.")] = "a4",
    seam: Annotated[str, typer.Option(metavar="LENGTH", help="Seam allowance for plush robots.")] = "8 mm",
    line: Annotated[str, typer.Option(metavar="LENGTH", help="Diameter of the braided line used as cable.")] = "0.4 mm",
    clearance: Annotated[
        str, typer.Option("--print-clearance", metavar="LENGTH", help="Print clearance per side between moving parts.")
    ] = "0.3 mm",
    step: Annotated[bool, typer.Option("--cad", help="Also write printed parts as STEP. Needs the extra cad.")] = False,
    force: Force = False,
    simple: Annotated[
        bool,
        typer.Option(
            "--simple", help="Simpler kit: fewer cables, one panel if the body stays flat, no grommets. Plush only."
        ),
    ] = False,
    stopper: Annotated[
        str, typer.Option(metavar="cleat|screw", help="Ends of cables: cleats set by hand, or clamps with a screw.")
    ] = "cleat",
    swap: Annotated[
        bool, typer.Option("--swap-core", help="Let foam cores be swapped in minutes: core plates and line couplers.")
    ] = False,
    summary: Annotated[
        bool, typer.Option("--summary", help="Print difficulty, time, cost and tools. Write nothing.")
    ] = False,
) -> None:
    """Write a build kit: patterns, parts, lists and assembly sheet.

    Start with assembly_sheet.pdf; steps.txt has its text. pattern/ is for a laser cutter, or a printer and scissors.
    parts/ and mould/ are for a 3D printer. lists/ holds the bill of materials and the cable lengths. tags.pdf holds
    tags to measure the robot with photographs. manifest.json records the inputs.

    Example: hydrostat fabricate gallery:starfish --out build/kit
    """
    from hydrostat import fabrication as kits
    from hydrostat.units import FORCE

    if out is not None:
        require_folder(out)
    elif not summary:
        raise InputError("missing option --out. Name a folder, or add --summary.")
    kind = parse_choice(kits.MoldKind, mould or "printed", what="--mould")
    options = kits.KitOptions(
        method=None if method is None else parse_choice(kits.Method, method, what="--method"),
        mould=kits.MoldOptions(kind=kind, bed=_lengths("--bed", bed)),
        paper=parse_choice(kits.Paper, paper, what="--paper"),
        pattern=kits.PatternOptions(seam_allowance=_millimeters("--seam", seam)),
        parts=kits.PartOptions(
            cable=_millimeters("--line", line),
            clearance=_millimeters("--print-clearance", clearance),
            stopper=parse_choice(kits.StopperKind, stopper, what="--stopper"),
            swap=swap,
        ),
        board=board,
        step=step,
        force=force,
    )
    kits.check_motor_and_board(motor or "auto", board)
    limit = parse_optional("--tension", tension, FORCE)
    spend = parse_budget(budget)
    began = time.perf_counter()
    loaded = read_robot(robot)
    kept = designed_tension(loaded, robot) if limit is None else None
    torque = designed_torque(loaded, robot)
    planned = designed_motor(loaded, robot) if motor is None else motor
    zeros = tell_zero_loss(loaded, loaded.motor if planned == "auto" else planned) if board == SERVO_BOARD else ""
    options = replace(options, tension=kept or limit, torque=torque, motor=planned, budget=spend)
    options = replace(options, cautions=(f"{zeros[:1].upper()}{zeros[1:]}.",) if zeros else ())
    if motor is None and planned != "auto":
        print(f"note: motor {planned}, that of its design. Override with --motor")
    if mould is not None and options.method_for(loaded.body) is not kits.Method.FOAM:
        raise InputError("--mould: needs a foam body. Remove it, or add --method foam.")
    if simple:
        from hydrostat.cli.simple_kit import simplify_robot

        loaded, options = simplify_robot(loaded, options)
    if out is None or summary:
        _print_summary(robot, loaded, options)
        return
    kit = _build_or_report(robot, loaded, options, out)
    kit.write(out)
    _print_motors(loaded, kit, options)
    print_kit(kit)
    _warn_of_zeros(loaded, kit.motor, board)
    if motor not in (None, "auto", loaded.motor):
        print(f'note: to keep this motor for calibrate and play, write motor = "{motor}" into robot.toml')
    if simple:
        from hydrostat.robot import save_robot

        save_robot(loaded, out / "robot")
        print(f"Its robot: {out / 'robot'}. Calibrate and play that one")
    if loaded.markers:
        print("Tags for photographs, with their places: tags.pdf")
    for drive in (drive for drive in loaded.drives if drive.unit != "share"):
        print(f"warning: the kit has no servo or stage for drive {drive.name}; add your own")
    if kept is not None:
        where = "robot.toml" if kept == loaded.max_tension else "the studio or of an older design"
        print(f"Cable tension: at most {kept:g} N, the limit of {where}. Override with --tension")
    seconds = time.perf_counter() - began
    print(f"Wrote {len(kit.files)} files in {seconds:.1f} s. Start with {out / 'assembly_sheet.pdf'}")


def _warn_of_zeros(robot: "Robot", key: str, board: str | None) -> None:
    """Print a warning if servos on this board lose their zeros without power."""
    words = tell_zero_loss(robot, key) if board == SERVO_BOARD else ""
    if words:
        print(f"warning: {words}")


def _print_summary(folder: Path, robot: "Robot", options: "KitOptions") -> None:
    """Print what building a robot asks, a heading and its sentences at a time (InputError: it cannot be built well)."""
    from hydrostat.errors import in_words
    from hydrostat.fabrication import summarize_kit

    with progress_bar() as progress:
        rows = summarize_kit(robot, options=options, progress=progress)
    print(f"{robot.name}: {options.method_for(robot.body)} robot")
    for title, lines in rows:
        print(f"{title}: {in_words(lines[0])}")
        for line in lines[1:]:
            print(f"  {in_words(line)}")
    if (problems := dict(rows).get("Problems")) and not options.force:
        raise _refusal(folder, problems)


def _build_or_report(folder: Path, robot: "Robot", options: "KitOptions", out: Path) -> "Kit":
    """The kit; else the reasons are printed, and a command that fixes them (InputError: it cannot be built well)."""
    from hydrostat.camera import tag_files
    from hydrostat.cli.remedies import kit_remedy, note_room
    from hydrostat.errors import in_words
    from hydrostat.fabrication import UnbuildableError, build_kit

    try:
        with progress_bar() as progress:
            return build_kit(robot, options=options, progress=progress, added=tag_files(robot, options.paper))
    except UnbuildableError as error:
        for reason in error.reasons:
            print(f"error: {in_words(reason)}")
        if note := note_room(robot, str(folder), options=options, reasons=error.reasons):
            print(note)
        if remedy := kit_remedy(robot, folder, out, options=options, reasons=error.reasons):
            print(f"Try: {remedy}")
        raise _refusal(folder, error.reasons) from None


def _refusal(folder: Path, reasons: Collection[str]) -> InputError:
    """Error of a robot that cannot be built well."""
    count = f"{plural(len(reasons), 'problem')} {'prevents' if len(reasons) == 1 else 'prevent'}"
    return InputError(f"{folder}: {count} fabrication. Fix the robot, or add --force to write the kit anyway.")


def _print_motors(robot: "Robot", kit: "Kit", options: "KitOptions") -> None:
    """Print a table of the motors that the winches may have, the cheapest first; nothing without winches."""
    from rich.console import Console
    from rich.table import Table

    from hydrostat.fabrication import motor_offers

    if not robot.cables:
        return
    count = plural(len({cable.winch for cable in robot.cables}), "winch")
    table = Table(title=f"motors for {count}, with boards and power", title_justify="left")
    for name, justify in (("motor", "left"), ("price", "right"), ("full travel in", "right"), ("", "left")):
        table.add_column(name, justify=justify)  # type: ignore[arg-type]
    for offer in motor_offers(robot, kit.torques, options):
        words = offer.remark
        chosen = "chosen" + (f", {words}" if words else "") if offer.motor.key == kit.motor else words
        seconds = "stalls" if offer.seconds is None else f"{offer.seconds:.1f} s"
        table.add_row(offer.motor.key, f"{offer.price:.0f} USD", seconds, chosen)
    Console(markup=False).print(table)


def print_kit(kit: "Kit", *, printed: Collection[str] = ()) -> None:
    """Print the contents of a kit, its problems but those printed already, and its quality checks."""
    from hydrostat.errors import in_words

    for level, texts in (("error", kit.problems), ("warning", kit.warnings), ("note", kit.notes)):
        for text in texts:
            if text not in printed:
                print(f"{level}: {in_words(text)}")
    for line in kit.summary:
        print(line)
    held = sum(check.passed for check in kit.checks)
    missing = "" if kit.robot.winches else ". They cover the body alone: it has no winches and cannot move"
    print(f"Quality checks: {held} of {len(kit.checks)} passed{missing}")
    for check in kit.checks:
        if not check.passed:
            print(f"  failed: {check.what}: {check.measured} (allowed: {check.allowed})")


def _millimeters(option: str, text: str) -> float:
    """A length such as "8 mm" [mm]."""
    from hydrostat.units import LENGTH

    return 1e3 * positive(option, text, LENGTH)


def _lengths(option: str, text: str) -> tuple[float, float, float]:
    """Three lengths such as "220 x 220 x 250 mm" [mm]."""
    match = re.fullmatch(r"\s*([\d.]+)\s*x\s*([\d.]+)\s*x\s*([\d.]+)\s*([^\W\d].*)", text)
    if match is None:
        raise InputError(
            f'{option} {text}: not a build volume. Write three lengths with a unit, e.g. "220 x 220 x 250 mm".'
        )
    *sides, unit = match.groups()
    x, y, z = (_millimeters(option, f"{side} {unit}") for side in sides)
    return x, y, z
