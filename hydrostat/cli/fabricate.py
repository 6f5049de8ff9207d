"""`hydrostat fabricate`."""

import re
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.design_results import designed_tension
from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder
from hydrostat.cli.options import asked, positive
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
        help="The most that its poses pull a cable with; if left out that of its design or of the studio, else none.",
    ),
]
Force = Annotated[
    bool, typer.Option("--force", help="Write the kit even if it cannot be built well; the sheet says why.")
]


def fabricate(
    robot: RobotFolder,
    out: OutFolder,
    method: Annotated[
        str | None,
        typer.Option(metavar="plush|foam", help="If left out: plush for what is flat or stuffed, else foam."),
    ] = None,
    motor: Annotated[
        str, typer.Option(metavar="NAME", help="n20, xl330, 25d; auto takes the first that is strong enough.")
    ] = "auto",
    mould: Annotated[
        str | None, typer.Option(metavar="printed|silicone", help="Of foam: what the mould is of; printed if left out.")
    ] = None,
    bed: Annotated[
        str, typer.Option(metavar="LENGTHS", help="The most that your 3D printer takes, along x, y and z.")
    ] = "220 x 220 x 250 mm",
    tension: Tension = None,
    paper: Annotated[str, typer.Option(metavar="a4|letter", help="What the pages are printed on.")] = "a4",
    seam: Annotated[str, typer.Option(metavar="LENGTH", help="Of plush: cloth between seam and cut.")] = "8 mm",
    line: Annotated[str, typer.Option(metavar="LENGTH", help="Diameter of the cables, a braided line.")] = "0.4 mm",
    clearance: Annotated[
        str, typer.Option(metavar="LENGTH", help="Between printed parts that move in each other, on each side.")
    ] = "0.3 mm",
    step: Annotated[
        bool, typer.Option("--step", help='Also write printed parts as STEP; needs pip install "hydrostat[cad]".')
    ] = False,
    force: Force = False,
) -> None:
    """Write all that is needed to build a robot.

    Begin with assembly_sheet.pdf. pattern/ is for the laser cutter, or for a printer and scissors; parts/ and mould/
    are for a 3D printer; lists/ tells what to buy and how long to cut cables; manifest.json is what all is made from.

    Example: hydrostat fabricate examples/starfish --out build/kit
    """
    from hydrostat import fabrication as kits
    from hydrostat.units import FORCE

    require_folder(out)
    kind = parse_choice(kits.MouldKind, mould or "printed", what="--mould")
    options = kits.KitOptions(
        method=None if method is None else parse_choice(kits.Method, method, what="--method"),
        motor=motor,
        mould=kits.MouldOptions(kind=kind, bed=_lengths("--bed", bed)),
        paper=parse_choice(kits.Paper, paper, what="--paper"),
        pattern=kits.PatternOptions(seam_allowance=_millimetres("--seam", seam)),
        parts=kits.PartOptions(cable=_millimetres("--line", line), clearance=_millimetres("--clearance", clearance)),
        step=step,
        force=force,
    )
    limit = asked("--tension", tension, FORCE)
    began = time.perf_counter()
    loaded = read_robot(robot)
    kept = designed_tension(loaded, robot) if limit is None else None
    options = replace(options, tension=kept or limit)
    if mould is not None and options.method_for(loaded.body) is not kits.Method.FOAM:
        raise InputError("--mould: is for bodies of foam; leave it out, or add --method foam")
    kit = _built(robot, loaded, options)
    kit.write(out)
    print_kit(kit)
    if kept is not None:
        print(
            f"Cables: pulled with at most {kept:g} N, the limit of its design or of the studio; --tension says another"
        )
    print(
        f"Wrote {len(kit.files)} files in {time.perf_counter() - began:.1f} s; begin with {out / 'assembly_sheet.pdf'}"
    )


def _built(folder: Path, robot: "Robot", options: "KitOptions") -> "Kit":
    """The kit; the reasons are printed why there is none (InputError: it cannot be built well)."""
    from hydrostat.fabrication import UnbuildableError, build_kit
    from hydrostat.robot import in_words

    try:
        with progress_bar() as progress:
            return build_kit(robot, options=options, progress=progress)
    except UnbuildableError as error:
        for reason in error.reasons:
            print(f"cannot be built: {in_words(reason)}")
        count = plural(len(error.reasons), "reason")
        words = f"{folder}: cannot be built well, for {count}; mend it, or write it anyway with --force"
        raise InputError(words) from None


def print_kit(kit: "Kit") -> None:
    """Print what is in a kit, what to mind, and whether it is true to the robot."""
    from hydrostat.robot import in_words

    for problem in kit.problems:
        print(f"cannot be built well: {in_words(problem)}")
    for warning in kit.warnings:
        print(f"warning: {in_words(warning)}")
    for line in kit.summary:
        print(line)
    held = sum(check.passed for check in kit.checks)
    print(f"Self-check: {held} of {len(kit.checks)} hold")
    for check in kit.checks:
        if not check.passed:
            print(f"  does not hold: {check.what}: {check.measured} (allowed: {check.allowed})")


def _millimetres(option: str, text: str) -> float:
    """A length such as "8 mm" [mm]."""
    from hydrostat.units import LENGTH

    return 1e3 * positive(option, text, LENGTH)


def _lengths(option: str, text: str) -> tuple[float, float, float]:
    """Three lengths such as "220 x 220 x 250 mm" [mm]."""
    match = re.fullmatch(r"\s*([\d.]+)\s*x\s*([\d.]+)\s*x\s*([\d.]+)\s*([^\W\d].*)", text)
    if match is None:
        raise InputError(f'{option} {text}: must be three lengths and their unit, such as "220 x 220 x 250 mm"')
    *sides, unit = match.groups()
    x, y, z = (_millimetres(option, f"{side} {unit}") for side in sides)
    return x, y, z
