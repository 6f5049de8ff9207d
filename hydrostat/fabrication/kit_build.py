"""`build_kit`: from a robot to everything that it is built from."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from hydrostat.errors import InputError, NotConvergedError
from hydrostat.fabrication.body_work import foam_work, plush_work
from hydrostat.fabrication.checks.solid_checks import solid_checks, spool_checks, too_large
from hydrostat.fabrication.demand import DEMAND_STAGE, Demand
from hydrostat.fabrication.inserts import InsertKind
from hydrostat.fabrication.kit import MANIFEST, Kit, UnbuildableError, manifest
from hydrostat.fabrication.kit_options import OVER_BUDGET, KitOptions, Method
from hydrostat.fabrication.kit_plan import BodyWork, KitFindings, KitPlan
from hydrostat.fabrication.lists.lists import Lists, make_lists
from hydrostat.fabrication.lists.motors import check_motor_and_board
from hydrostat.fabrication.motor_choice import find_motor, motors_price, pulled_torques
from hydrostat.fabrication.parts.rigid_parts import RigidParts, rigid_parts
from hydrostat.fabrication.passage import find_passage_problems, find_passage_warnings
from hydrostat.fabrication.patterns.channels import channel_strips
from hydrostat.fabrication.patterns.dxf_writer import pattern_dxf
from hydrostat.fabrication.patterns.pattern import cut_sheet
from hydrostat.fabrication.patterns.sheet_pieces import sheet_pieces
from hydrostat.fabrication.patterns.svg_writer import pattern_svg
from hydrostat.fabrication.print_work import print_work
from hydrostat.fabrication.refusals import find_material_problems, find_refusals
from hydrostat.fabrication.sheets.assembly_sheet import assembly_sheet
from hydrostat.fabrication.sheets.foam_steps import channel_ways
from hydrostat.fabrication.sheets.sheet_facts import sheet_facts
from hydrostat.fabrication.sheets.summary import drive_share, summary_rows
from hydrostat.fabrication.sheets.text_sheet import sheet_text
from hydrostat.fabrication.sheets.tiles import tiled_pdf
from hydrostat.fabrication.solids.print_files import stl_bytes, three_mf_plates
from hydrostat.fabrication.solids.printed import Printed
from hydrostat.fabrication.solids.step import require_cad, step_bytes
from hydrostat.given import check_type, path_of
from hydrostat.progress import Progress, no_progress
from hydrostat.robot import CableSide, Robot, describe_cable_side, sewn_robot, sewn_sides
from hydrostat.simulation import is_stuffed_motion_fast, solve_stuffed_motion
from hydrostat.units import plural


def write_kit(
    robot: Robot, folder: str | Path, *, options: KitOptions | None = None, progress: Progress | None = None
) -> Kit:
    """Build the kit of a robot and write it to a folder; on an error, nothing is written.

    Raises:
        UnbuildableError: the robot cannot be built well (unless `force`).
        InputError: a body that the method cannot make, an unknown motor, or a folder that cannot be written.
    """
    place = path_of(folder, "a kit is written into a folder")
    kit = build_kit(robot, options=options, progress=progress)
    kit.write(place)
    return kit


def build_kit(
    robot: Robot,
    *,
    options: KitOptions | None = None,
    progress: Progress | None = None,
    added: Mapping[str, bytes] | None = None,
) -> Kit:
    """Build the kit of a robot; the same robot and options give the same bytes.

    Args:
        robot: robot to build.
        options: options of the kit.
        progress: callback for each stage.
        added: additional files of the kit by path, such as camera tags.

    Raises:
        UnbuildableError: the robot cannot be built well (unless `force`).
        InputError: a body that the method cannot make, or an unknown motor.
    """
    tell = _Stages(progress)
    _require_material(robot, options)
    plan, lists = _plan_and_lists(robot, options, tell)
    options = plan.options
    tell("Checks")
    findings = _findings(plan, lists)
    if findings.problems and not options.force:
        raise UnbuildableError(findings.problems)
    tell("Files")
    files, summary = _files(plan, lists, findings), (*_summary(plan, lists), *_cable_summary(plan))
    files |= added or {}
    facts = {
        "method": plan.method,
        "motor": plan.rigid.motor.key,
        "summary": summary,
        "problems": findings.problems,
        "warnings": findings.warnings,
        "notes": findings.notes,
    }
    files[MANIFEST] = manifest(robot, options, files, checks=findings.checks, told=facts)
    tell.end()
    return Kit(
        robot=robot,
        method=plan.method,
        motor=plan.rigid.motor.key,
        torques=tuple(plan.demand.torques.tolist()),
        printed=plan.printed,
        files=files,
        summary=summary,
        problems=findings.problems,
        warnings=findings.warnings,
        notes=findings.notes,
        checks=findings.checks,
    )


def summarize_kit(
    robot: Robot, *, options: KitOptions | None = None, progress: Progress | None = None
) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Return what building a robot asks, as headings with sentences, before its files and checks are made.

    Raises:
        InputError: a body that the method cannot make, or an unknown motor.
    """
    tell = _Stages(progress)
    plan, lists = _plan_and_lists(robot, options, tell)
    tell.end()
    problems = _problems(plan, lists)
    return (*((("Problems", problems),) if problems else ()), *summary_rows(plan, lists))


def _require_material(robot: Robot, options: KitOptions | None) -> None:
    """Refuse a material that no kit takes before the poses are solved (UnbuildableError: with all that is known)."""
    if not isinstance(robot, Robot) or (options is not None and getattr(options, "force", True)):
        return
    if problems := find_material_problems(robot, options=options):
        raise UnbuildableError(tuple(dict.fromkeys((*problems, *find_refusals(robot, options=options)))))


def _plan_and_lists(robot: Robot, options: KitOptions | None, tell: "_Stages") -> tuple[KitPlan, Lists]:
    """Parts, body and lists of a robot (TypeError: it is none; InputError: an unknown motor)."""
    check_type(robot, Robot, "a kit is made of a Robot, such as load_robot gives")
    check_type(options, (KitOptions, type(None)), "options must be KitOptions(...)")
    options = options or KitOptions()
    check_motor_and_board(options.motor_for(robot), options.board, len(robot.winches))  # before the work
    if options.step:
        require_cad()
    plan = _plan(robot, options, tell)
    tell("Lists")
    return plan, make_lists(plan)


class _Stages:
    """Tells which of the stages has begun."""

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress or no_progress
        self._stage = ""
        self._total = 1

    def __call__(self, stage: str, done: int = 0, total: int = 1) -> None:
        if stage != self._stage:
            self.end()
        self._stage, self._total = stage, total
        self._progress(stage, done, total)

    def end(self) -> None:
        """The stage is over."""
        if self._stage:
            self._progress(self._stage, self._total, self._total)


def _plan(drawn: Robot, options: KitOptions, tell: _Stages) -> KitPlan:
    robot = sewn_robot(drawn) if options.method_for(drawn.body) is Method.PLUSH else drawn
    tell(DEMAND_STAGE)
    demand = Demand.find(robot, tension=options.tension, torque=options.torque, progress=tell)
    rigid, work = _parts_and_body(drawn, robot, options, demand, tell)
    return KitPlan(drawn=drawn, robot=robot, options=options, demand=demand, rigid=rigid, work=work)


def _parts_and_body(
    drawn: Robot, robot: Robot, options: KitOptions, demand: Demand, tell: _Stages
) -> tuple[RigidParts, BodyWork]:
    """Winches and the body they are for, of a robot as it is drawn and as it is sewn.

    Felt has holes for grommets, foam has room for winches.
    """
    motor = find_motor(drawn, demand.torques.tolist(), options).key

    def rigid(holes: int) -> RigidParts:
        tell("Winches")
        pinhole, bed = options.pattern.pinhole, options.mould.bed
        return rigid_parts(robot, motor=motor, options=options.parts, bed=bed, holes=holes, hole=pinhole)

    if options.method_for(robot.body) is Method.PLUSH:
        tell("Pattern")
        work = plush_work(drawn, options)
        return rigid(work.holes if options.parts.grommets else 0), work
    parts = rigid(0)
    if options.method_for(robot.body) is Method.PRINT:
        tell("Body")
        return parts, print_work(drawn, options)
    tell("Mold")
    return parts, foam_work(robot, options, parts.units)


def _findings(plan: KitPlan, lists: Lists) -> KitFindings:
    """Results of all checks; problems are those known before, then those of making it, each once."""
    rigid, work = plan.rigid, plan.work
    checks = (
        *work.checks,
        *lists.checks,
        *spool_checks(plan.robot, rigid.units),
        *solid_checks((*plan.printed, *work.spare), (*rigid.assemblies, *work.assemblies)),
    )
    failed = (
        f"quality check failed: {check.what}: {check.measured} (allowed: {check.allowed})"
        for check in checks
        if not check.passed
    )
    return KitFindings(
        checks=checks,
        problems=tuple(dict.fromkeys((*_problems(plan, lists), *failed))),
        warnings=(
            *(*_cable_warnings(plan), *_bending_warnings(plan), *_part_warnings(plan), *find_passage_warnings(plan)),
            *(*work.warnings, *rigid.warnings, *lists.warnings),
        ),
        notes=(*work.notes, *rigid.notes, *plan.demand.far),
    )


def _problems(plan: KitPlan, lists: Lists) -> tuple[str, ...]:
    """Return why a robot cannot be built well, as far as it is known without measuring its files."""
    large = too_large((*plan.printed, *plan.work.spare), plan.options.mould.bed)
    known = find_refusals(plan.drawn, plan.demand, options=plan.options)
    made = (*plan.rigid.problems, *plan.work.problems, *lists.problems, *find_passage_problems(plan))
    return tuple(dict.fromkeys((*known, *made, *large, *_budget_problems(plan, lists))))


def _cable_warnings(plan: KitPlan) -> tuple[str, ...]:
    """Warn of a robot that nothing moves."""
    if plan.drawn.cables:
        return ()
    return ("the robot has no cables: the kit has its body alone. `hydrostat design` adds winches and cables",)


def _budget_problems(plan: KitPlan, lists: Lists) -> tuple[str, ...]:
    """A line if the kit costs more than its budget in whole packs, with the cheapest that it can be."""
    budget, cost = plan.options.budget, lists.cost[1]
    if budget is None or cost <= budget:
        return ()
    free, options = replace(plan.drawn, motor="auto"), replace(plan.options, motor="auto")
    cheapest = find_motor(free, plan.demand.torques.tolist(), options)
    pulled = pulled_torques(plan.robot, plan.demand.torques.tolist())
    saved = motors_price(pulled, plan.rigid.motor) - motors_price(pulled, cheapest)
    shares = ", ".join(f"{row.group} {row.cost_packs:.0f}" for row in lists.bill.rows[:-1] if row.is_total)
    other = f"With --motor {cheapest.key} it costs about {cost - saved:.0f} USD"
    way = other if saved > 0 else f"No cheaper motor than {plan.rigid.motor.key} fits"
    return (f"the kit costs {cost:.0f} USD in whole packs ({shares}), {OVER_BUDGET} {budget:g} USD. {way}",)


def _bending_warnings(plan: KitPlan) -> tuple[str, ...]:
    """Warn of cables on one panel that bend the body out of its plane, as `check --thorough` does where that is quick.

    Elsewhere the warning is without a length.
    """
    robot, pulled = plan.drawn, plan.demand.contractions
    one_panel = len(sewn_sides(robot)) == 1 and robot.face is not CableSide.MIDDLE
    if plan.method is not Method.PLUSH or robot.body.mesh.dim != 2 or not (robot.cables and one_panel):
        return ()
    if is_stuffed_motion_fast(robot, len(pulled)):
        with suppress(InputError, NotConvergedError):
            found = solve_stuffed_motion(robot, pulled).warning
            return () if found is None else (found,)
    return (
        f"the cables are sewn on the {sewn_sides(robot)[0]} alone: they also bend the body toward it (hydrostat check "
        '--stuffed prints by how much). Set face = "pairs" above [body] to sew on both panels',
    )


def _part_warnings(plan: KitPlan) -> tuple[str, ...]:
    """Warn of parts, and of sheets in space, which no file of the kit makes."""
    flat = plan.drawn.body.mesh.dim == 2
    made = [insert for insert in plan.inserts if not (flat and insert.kind is InsertKind.SHEET)]
    names = ", ".join(f"{insert.mark} {insert.name}" for insert in made)
    return (f"the kit has no files for {names}: make them to the sizes of lists/inserts.csv",) if made else ()


def _files(plan: KitPlan, lists: Lists, findings: KitFindings) -> dict[str, bytes]:
    """Content by path in the kit, without the manifest."""
    rigid, work, name, paper = plan.rigid, plan.work, plan.robot.name, plan.options.paper
    return {
        **work.files,
        **({f"pattern/pattern_{paper}.pdf": tiled_pdf(work.pattern, paper)} if work.pattern else {}),
        **_solid_files("parts", name, rigid.printed, plan.options),
        **_solid_files("body" if plan.method is Method.PRINT else "mould", name, work.printed, plan.options),
        **_solid_files("positive", name, work.spare, plan.options),
        **_base_files(name, rigid),
        **_sheet_files(plan.drawn),
        **_channel_files(plan, lists),
        **{f"lists/{table.name}.csv": table.csv for table in lists.tables},
        "lists/notes.txt": lists.notes_text.encode(),
        "assembly_sheet.pdf": assembly_sheet(plan, lists, findings),
        "steps.txt": sheet_text(sheet_facts(plan, lists, findings)).encode(),
    }


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


def _sheet_files(robot: Robot) -> dict[str, bytes]:
    """Cloth of the sheets on the skin of a flat body."""
    files = {}
    for number, sheet in enumerate(robot.sheets, start=1):
        if (pieces := sheet_pieces(robot, sheet)) is not None:
            files |= {
                f"pattern/sheet_S{number}.svg": pattern_svg(pieces),
                f"pattern/sheet_S{number}.dxf": pattern_dxf(pieces),
            }
    return files


def _channel_files(plan: KitPlan, lists: Lists) -> dict[str, bytes]:
    """Strips of cloth for the channels of cables that are sewn on the skin of a foam body."""
    ways = channel_ways(lists.stitching, len(plan.robot.cables)) if plan.method is Method.FOAM else {}
    if not ways:
        return {}
    strips, paper = channel_strips(f"{plan.robot.name} - channels", ways), plan.options.paper
    return {"pattern/channels.svg": pattern_svg(strips), f"pattern/channels_{paper}.pdf": tiled_pdf(strips, paper)}


def _cable_summary(plan: KitPlan) -> tuple[str, ...]:
    """Return one line on the side of the cables of a flat robot; empty if the robot does not set it."""
    robot = plan.drawn
    if robot.face is None or not plan.robot.cables:
        return ()
    if plan.method is not Method.PLUSH:
        return (f"Cables: {len(plan.robot.cables)}, {CableSide.MIDDLE.words}",)
    if robot.face is CableSide.PAIRS:
        return (f"Cables: {plural(len(robot.cables), 'pair')} on both faces, {len(plan.robot.cables)} to sew",)
    return (f"Cables: {len(plan.robot.cables)}, {describe_cable_side(robot)}",)


def _insert_summary(plan: KitPlan) -> tuple[str, ...]:
    """Return one line on parts and rods; empty without them."""
    kinds = [insert.kind.value for insert in plan.inserts]
    counts = ", ".join(plural(kinds.count(kind), kind) for kind in dict.fromkeys(kinds))
    return (f"In and on the body: {counts} (lists/inserts.csv)",) if kinds else ()


def _summary(plan: KitPlan, lists: Lists) -> tuple[str, ...]:
    """Return the summary of a kit, one line for each of its contents."""
    mass = sum(part.count * part.mass for part in plan.printed)
    used, packs = lists.cost
    share = f", {words}" if (words := drive_share(plan)) else ""
    return (
        *plan.work.summary,
        f"Winches: {len(plan.rigid.units)} x {plan.rigid.motor.title}" if plan.rigid.units else "Winches: none",
        *_insert_summary(plan),
        f"To print: {plan.pieces}, about {mass:.0f} g",
        f"Material used: about {used:.0f} USD{share}; to buy (full packs): {packs:.0f} USD",
    )
