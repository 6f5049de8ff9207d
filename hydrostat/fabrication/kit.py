"""`Kit`: everything that a robot is built from, as files (R9 to R14, R50 to R57)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from hydrostat.errors import InputError
from hydrostat.fabrication.body_work import BodyWork
from hydrostat.fabrication.checks.solid_checks import solid_checks, too_large
from hydrostat.fabrication.checks.spool_checks import spool_checks
from hydrostat.fabrication.demand import Demand, find_demand
from hydrostat.fabrication.foam import foam_work
from hydrostat.fabrication.kit_folder import write_files
from hydrostat.fabrication.kit_options import KitOptions, Method
from hydrostat.fabrication.lists.list_input import ListInput
from hydrostat.fabrication.lists.lists import Lists, make_lists
from hydrostat.fabrication.manifest import NAME, manifest
from hydrostat.fabrication.parts.motor import choose_motor
from hydrostat.fabrication.parts.rigid_parts import RigidParts, rigid_parts
from hydrostat.fabrication.patterns.cut_sheet import cut_sheet
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.fabrication.plush import plush_work
from hydrostat.fabrication.self_check import Check
from hydrostat.fabrication.sheets.assembly_sheet import assembly_sheet
from hydrostat.fabrication.sheets.sheet_input import SheetInput
from hydrostat.fabrication.solids.assembly import Assembly
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.fabrication.solids.step import require_cad, step_bytes
from hydrostat.fabrication.solids.stl import stl_bytes
from hydrostat.fabrication.solids.three_mf import three_mf_plates
from hydrostat.robot import Robot
from hydrostat.units import counted

Progress = Callable[[str, int, int], None]
"""Told the stage, how much of it is done, and how much there is."""


class UnbuildableError(InputError):
    """A robot cannot be built well as it is.

    Attributes:
        reasons: a line each.
    """

    def __init__(self, reasons: tuple[str, ...]) -> None:
        super().__init__(f"it cannot be built well, for {counted(len(reasons), 'reason')}: {'; '.join(reasons)}")
        self.reasons = reasons


@dataclass(frozen=True, eq=False, kw_only=True)
class Kit:
    """Everything that a robot is built from.

    Attributes:
        robot: that is built.
        method: how its body is made.
        motor: key of the motor in its winches.
        printed: all parts for a 3D printer.
        files: content by path.
        summary: what is in it, a line each.
        problems: why it cannot be built well; only with `force`.
        warnings: what to mind.
        checks: whether the files are true to the robot that was simulated.
    """

    robot: Robot
    method: Method
    motor: str
    printed: tuple[Printed, ...]
    files: Mapping[str, bytes]
    summary: tuple[str, ...]
    problems: tuple[str, ...]
    warnings: tuple[str, ...]
    checks: tuple[Check, ...]

    def write(self, folder: str | Path) -> list[Path]:
        """Write all files into a folder, made if need be; what an earlier kit left there is removed.

        Raises:
            InputError: the folder or a file cannot be written.
        """
        return write_files(self.files, folder)


def export_kit(
    robot: Robot, folder: str | Path, *, options: KitOptions | None = None, progress: Progress | None = None
) -> Kit:
    """Make the kit of a robot and write it into a folder. Nothing is written unless all can be.

    Raises:
        UnbuildableError: the robot cannot be built well (unless `force`).
        InputError: a body that the method cannot make, an unknown motor, or a folder that cannot be written.
    """
    kit = build_kit(robot, options=options, progress=progress)
    kit.write(folder)
    return kit


def build_kit(robot: Robot, *, options: KitOptions | None = None, progress: Progress | None = None) -> Kit:
    """Make the kit of a robot; the same robot and options give the same bytes.

    Args:
        robot: with winches and cables.
        options: how it is built.
        progress: told the stages.

    Raises:
        UnbuildableError: the robot cannot be built well (unless `force`).
        InputError: a body that the method cannot make, or an unknown motor.
    """
    options, tell = options or KitOptions(), _Stages(progress)
    choose_motor(options.motor, ())  # a name that is wrong is told before the work
    if options.step:
        require_cad()
    method = options.method_for(robot.body)
    tell("Loads in its poses")
    demand = find_demand(robot, progress=tell.part)
    rigid, work = _parts_and_body(robot, options, method, demand, tell)
    tell("Lists")
    lists = make_lists(_list_input(robot, options, method, demand, rigid, work))
    tell("Checks")
    printed = (*rigid.printed, *work.printed)
    sound = solid_checks((*printed, *work.spare), (*rigid.assemblies, *work.assemblies))
    checks = (*work.checks, *lists.checks, *spool_checks(robot, rigid.units), *sound)
    large = too_large((*printed, *work.spare), options.mould.bed)
    problems = (*rigid.problems, *work.problems, *lists.problems, *large, *_failed(checks))
    if problems and not options.force:
        raise UnbuildableError(problems)
    warnings = (*work.warnings, *rigid.warnings, *lists.warnings, *demand.far)
    tell("Files")
    told = SheetInput(
        robot=robot,
        method=method,
        paper=options.paper,
        motor=rigid.motor.title,
        winch=_pictured(rigid),
        base=rigid.base.assembly if rigid.base else None,
        stopper=rigid.stopper.assembly if rigid.stopper else None,
        printed=printed,
        tables={table.name: table for table in lists.tables},
        stitches=work.stitches,
        gusset=work.gusset,
        mould=work.mould,
        checks=checks,
        problems=problems,
        warnings=warnings,
    )
    files = {
        **work.files,
        **_solid_files("parts", robot.name, rigid.printed, options),
        **_solid_files("mould", robot.name, work.printed, options),
        **_solid_files("positive", robot.name, work.spare, options),
        **_base_files(robot.name, rigid),
        **{f"lists/{table.name}.csv": table.csv for table in lists.tables},
        "assembly_sheet.pdf": assembly_sheet(told),
    }
    summary = (*work.summary, *_summary(rigid, printed, lists))
    facts = {"method": method, "motor": rigid.motor.key, "summary": summary, "problems": problems, "warnings": warnings}
    files[NAME] = manifest(robot, options, files, checks=checks, told=facts)
    tell.end()
    return Kit(
        robot=robot,
        method=method,
        motor=rigid.motor.key,
        printed=printed,
        files=files,
        summary=summary,
        problems=problems,
        warnings=warnings,
        checks=checks,
    )


class _Stages:
    """Tells which of the stages has begun."""

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self._stage = ""
        self._total = 1

    def __call__(self, stage: str) -> None:
        self.end()
        self._stage, self._total = stage, 1
        self.part(0, 1)

    def part(self, done: int, total: int) -> None:
        """So much of the stage is done."""
        self._total = total
        if self._progress is not None and self._stage:
            self._progress(self._stage, done, total)

    def end(self) -> None:
        """The stage is over."""
        self.part(self._total, self._total)


def _parts_and_body(
    robot: Robot, options: KitOptions, method: Method, demand: Demand, tell: _Stages
) -> tuple[RigidParts, BodyWork]:
    """Winches and the body they are for: felt has holes for grommets, foam has room for winches."""

    def rigid(holes: int) -> RigidParts:
        tell("Winches")
        pinhole, bed = options.pattern.pinhole, options.mould.bed
        return rigid_parts(
            robot, demand, motor=options.motor, options=options.parts, bed=bed, holes=holes, hole=pinhole
        )

    if method is Method.PLUSH:
        tell("Pattern")
        work = plush_work(robot, options)
        return rigid(work.holes), work
    parts = rigid(0)
    tell("Mould")
    return parts, foam_work(robot, options, parts.units)


def _list_input(
    robot: Robot, options: KitOptions, method: Method, demand: Demand, rigid: RigidParts, work: BodyWork
) -> ListInput:
    exits = [way for unit in rigid.units for way in unit.exits]
    return ListInput(
        robot=robot,
        demand=demand,
        motor=rigid.motor,
        method=method,
        options=options.parts,
        printed=rigid.printed,
        mould=work.printed,
        screws={title: count for title, count in rigid.bought if title != rigid.motor.title},
        leads={way.cable: way.lead for way in exits},
        seats={way.cable: way.seat for way in exits},
        outside=dict(rigid.base.tubes) if rigid.base else {},
        stitches=work.stitches,
        cloth=work.cloth,
        foam=work.foam,
        stopper_hold=rigid.stopper.hold if rigid.stopper else None,
    )


def _pictured(rigid: RigidParts) -> Assembly | None:
    """The winch with the most cables."""
    if not rigid.units:
        return None
    return max(rigid.units, key=lambda unit: len(unit.cables)).assembly


def _solid_files(folder: str, name: str, parts: tuple[Printed, ...], options: KitOptions) -> dict[str, bytes]:
    """Each part as STL, all as 3MF by beds, and as STEP what is made of true shapes, if that is wanted."""
    if not parts:
        return {}
    files = {f"{folder}/{part.name}.stl": stl_bytes(part) for part in parts}
    wide, deep, _ = options.mould.bed
    plates = three_mf_plates(parts, f"{name}: {folder}", bed=(wide, deep))
    files |= {f"{folder}/plate_{number}.3mf": plate for number, plate in enumerate(plates, start=1)}
    if options.step:
        files |= {f"{folder}/{part.name}.step": step_bytes(part) for part in parts if part.model is not None}
    return files


def _base_files(name: str, rigid: RigidParts) -> dict[str, bytes]:
    """The base for a laser cutter, to be cut from acrylic in place of the printed one."""
    if rigid.base is None:
        return {}
    sheet = cut_sheet(f"{name} - base", rigid.base.sheet)
    return {"parts/base.svg": pattern_svg(sheet), "parts/base.dxf": pattern_dxf(sheet)}


def _summary(rigid: RigidParts, printed: tuple[Printed, ...], lists: Lists) -> tuple[str, ...]:
    """What is in a kit besides the body, a line each."""
    count, mass = sum(part.count for part in printed), sum(part.count * part.mass for part in printed)
    used, packs = lists.cost
    return (
        f"Winches: {len(rigid.units)} x {rigid.motor.title}",
        f"To print: {counted(count, 'piece')}, about {mass:.0f} g",
        f"To buy: about {used:.0f} USD of what is used up, {packs:.0f} USD in whole packs",
    )


def _failed(checks: tuple[Check, ...]) -> tuple[str, ...]:
    return tuple(
        f"the self-check failed: {check.what}: {check.measured} (allowed: {check.allowed})"
        for check in checks
        if not check.passed
    )
