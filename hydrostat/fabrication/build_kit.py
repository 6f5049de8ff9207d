"""`build_kit`: from a robot to everything that it is built from."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from hydrostat.fabrication.body_work import BodyWork, foam_work, plush_work
from hydrostat.fabrication.checks.solid_checks import solid_checks, spool_checks, too_large
from hydrostat.fabrication.demand import Demand, find_demand
from hydrostat.fabrication.kit import MANIFEST, Check, Kit, UnbuildableError, manifest
from hydrostat.fabrication.kit_options import KitOptions, Method
from hydrostat.fabrication.lists.list_input import ListInput
from hydrostat.fabrication.lists.lists import Lists, make_lists
from hydrostat.fabrication.parts.motor import choose_motor
from hydrostat.fabrication.parts.rigid_parts import RigidParts, rigid_parts
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import cut_sheet
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.fabrication.refusals import find_refusals
from hydrostat.fabrication.sheets.assembly_sheet import assembly_sheet
from hydrostat.fabrication.sheets.sheet_input import SheetInput
from hydrostat.fabrication.solids.print_files import stl_bytes, three_mf_plates
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.fabrication.solids.step import require_cad, step_bytes
from hydrostat.given import check_type, path_of
from hydrostat.robot import Face, Robot, describe_cable_side, sewn_robot
from hydrostat.units import plural

Progress = Callable[[str, int, int], None]  # told the stage, how much of it is done, and how much there is


def write_kit(
    robot: Robot, folder: str | Path, *, options: KitOptions | None = None, progress: Progress | None = None
) -> Kit:
    """Make the kit of a robot and write it into a folder. Nothing is written unless all can be.

    Raises:
        UnbuildableError: the robot cannot be built well (unless `force`).
        InputError: a body that the method cannot make, an unknown motor, or a folder that cannot be written.
    """
    place = path_of(folder, "a kit is written into a folder")
    kit = build_kit(robot, options=options, progress=progress)
    kit.write(place)
    return kit


def build_kit(robot: Robot, *, options: KitOptions | None = None, progress: Progress | None = None) -> Kit:
    """Make the kit of a robot; the same robot and options give the same bytes. `progress` is told the stages.

    Raises:
        UnbuildableError: the robot cannot be built well (unless `force`).
        InputError: a body that the method cannot make, or an unknown motor.
    """
    check_type(robot, Robot, "a kit is made of a Robot, such as load_robot gives")
    check_type(options, (KitOptions, type(None)), "options must be KitOptions(...)")
    options, tell = options or KitOptions(), _Stages(progress)
    choose_motor(options.motor, ())  # a name that is wrong is told before the work
    if options.step:
        require_cad()
    plan = _plan(robot, options, tell)
    if plan.problems and not options.force:
        raise UnbuildableError(plan.problems)
    tell("Files")
    files, summary = _files(plan), (*_summary(plan), *_cable_summary(robot, plan))
    facts = {
        "method": plan.method,
        "motor": plan.rigid.motor.key,
        "summary": summary,
        "problems": plan.problems,
        "warnings": plan.warnings,
    }
    files[MANIFEST] = manifest(robot, options, files, checks=plan.checks, told=facts)
    tell.end()
    return Kit(
        robot=robot,
        method=plan.method,
        motor=plan.rigid.motor.key,
        printed=plan.printed,
        files=files,
        summary=summary,
        problems=plan.problems,
        warnings=plan.warnings,
        checks=plan.checks,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _Plan:
    """All that a kit is written from."""

    drawn: Robot  # as it was given
    robot: Robot  # as it is sewn: of pairs both cables
    options: KitOptions
    method: Method
    demand: Demand
    rigid: RigidParts
    work: BodyWork
    lists: Lists
    checks: tuple[Check, ...]

    @property
    def printed(self) -> tuple[Printed, ...]:
        return (*self.rigid.printed, *self.work.printed)

    @cached_property
    def problems(self) -> tuple[str, ...]:
        """Why it is refused: what was known before, then what came of making it, each once."""
        large = too_large((*self.printed, *self.work.spare), self.options.mould.bed)
        failed = (
            f"the self-check failed: {check.what}: {check.measured} (allowed: {check.allowed})"
            for check in self.checks
            if not check.passed
        )
        known = find_refusals(self.drawn, self.demand, options=self.options)
        made = (*self.rigid.problems, *self.work.problems, *self.lists.problems)
        return tuple(dict.fromkeys((*known, *made, *large, *failed)))

    @property
    def warnings(self) -> tuple[str, ...]:
        return (*self.work.warnings, *self.rigid.warnings, *self.lists.warnings, *self.demand.far)


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
        """Tell that so much of the stage is done."""
        self._total = total
        if self._progress is not None and self._stage:
            self._progress(self._stage, done, total)

    def end(self) -> None:
        """The stage is over."""
        self.part(self._total, self._total)


def _plan(robot: Robot, options: KitOptions, tell: _Stages) -> _Plan:
    method = options.method_for(robot.body)
    drawn, robot = robot, sewn_robot(robot) if method is Method.PLUSH else robot
    tell("Loads in its poses")
    demand = find_demand(robot, tension=options.tension, progress=tell.part)
    rigid, work = _parts_and_body(drawn, robot, options, demand, tell)
    tell("Lists")
    lists = make_lists(_list_input(robot, options, method, demand, rigid, work))
    tell("Checks")
    solids = (*rigid.printed, *work.printed, *work.spare)
    checks = (
        *work.checks,
        *lists.checks,
        *spool_checks(robot, rigid.units),
        *solid_checks(solids, (*rigid.assemblies, *work.assemblies)),
    )
    return _Plan(
        drawn=drawn,
        robot=robot,
        options=options,
        method=method,
        demand=demand,
        rigid=rigid,
        work=work,
        lists=lists,
        checks=checks,
    )


def _parts_and_body(
    drawn: Robot, robot: Robot, options: KitOptions, demand: Demand, tell: _Stages
) -> tuple[RigidParts, BodyWork]:
    """Winches and the body they are for, of a robot as it is drawn and as it is sewn.

    Felt has holes for grommets, foam has room for winches.
    """

    def rigid(holes: int) -> RigidParts:
        tell("Winches")
        pinhole, bed = options.pattern.pinhole, options.mould.bed
        return rigid_parts(
            robot, demand, motor=options.motor, options=options.parts, bed=bed, holes=holes, hole=pinhole
        )

    if options.method_for(robot.body) is Method.PLUSH:
        tell("Pattern")
        work = plush_work(drawn, options)
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
        bolts=work.mould.bolts if work.mould else 0,
        dowels=work.mould.dowels if work.mould else 0,
        stopper_hold=rigid.stopper.hold if rigid.stopper else None,
    )


def _files(plan: _Plan) -> dict[str, bytes]:
    """Content by path in the kit, without the manifest."""
    rigid, work, name = plan.rigid, plan.work, plan.robot.name
    return {
        **work.files,
        **_solid_files("parts", name, rigid.printed, plan.options),
        **_solid_files("mould", name, work.printed, plan.options),
        **_solid_files("positive", name, work.spare, plan.options),
        **_base_files(name, rigid),
        **{f"lists/{table.name}.csv": table.csv for table in plan.lists.tables},
        "assembly_sheet.pdf": assembly_sheet(_sheet(plan)),
    }


def _sheet(plan: _Plan) -> SheetInput:
    rigid, work = plan.rigid, plan.work
    most = max(rigid.units, key=lambda unit: len(unit.cables), default=None)
    return SheetInput(
        robot=plan.robot,
        method=plan.method,
        paper=plan.options.paper,
        motor=rigid.motor.title,
        winch=most.assembly if most else None,
        base=rigid.base.assembly if rigid.base else None,
        seat=rigid.seat.assembly,
        stopper=rigid.stopper.assembly if rigid.stopper else None,
        printed=plan.printed,
        tables={table.name: table for table in plan.lists.tables},
        stitches=work.stitches,
        gusset=work.gusset,
        mould=work.mould,
        power=plan.lists.power,
        checks=plan.checks,
        problems=plan.problems,
        warnings=plan.warnings,
    )


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


def _cable_summary(robot: Robot, plan: _Plan) -> tuple[str, ...]:
    """Where the cables of a flat robot run, a line if it says so."""
    if robot.face is None or not plan.robot.cables:
        return ()
    words = describe_cable_side(robot) if plan.method is Method.PLUSH else Face.MIDDLE.words
    return (f"Cables: {len(plan.robot.cables)}, {words}",)


def _summary(plan: _Plan) -> tuple[str, ...]:
    """What is in a kit, a line each."""
    count = sum(part.count for part in plan.printed)
    mass = sum(part.count * part.mass for part in plan.printed)
    used, packs = plan.lists.cost
    return (
        *plan.work.summary,
        f"Winches: {len(plan.rigid.units)} x {plan.rigid.motor.title}" if plan.rigid.units else "Winches: none",
        f"To print: {plural(count, 'piece')}, about {mass:.0f} g",
        f"To buy: about {used:.0f} USD of what is used up, {packs:.0f} USD in whole packs",
    )
