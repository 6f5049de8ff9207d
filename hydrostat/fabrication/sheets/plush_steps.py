"""`plush_steps`: steps of a plush robot, from its files to the stuffed body. Times are estimates; none was measured."""

from hydrostat.fabrication.cable_work import CableWork
from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.passage import find_open_seam, find_stuck_marks
from hydrostat.fabrication.sheets.steps import (
    AssemblyStep,
    held_text,
    insert_steps,
    marks_on,
    marks_text,
    minutes_text,
    tie_step,
    winch_steps,
)
from hydrostat.fabrication.winch_marks import winch_marks_of
from hydrostat.robot import Mount, Robot


def plush_steps(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    """Steps from the folder of files to a robot that is sewn up."""
    cables = len(plan.robot.cables)
    return (
        *_prints(plan),
        AssemblyStep(
            "Cut the cloth",
            20,
            f"{_sheet_size(plan)}"
            "Laser pattern/pattern.svg or pattern/pattern.dxf: marks first, then pinholes, edges last. Or print "
            f"pattern/pattern_{plan.options.paper}.pdf at 100 %, check that the bar measures 100 mm, cut by hand and "
            "punch the pinholes. Keep the grain arrows along the cloth. Green guides would show on the toy: draw them "
            "with a washable pen, or leave them out and follow the map.",
        ),
        *_decorate(plan.robot),
        *(_cables(plan) if cables else ()),
        *_zipper_steps(plan),
        _sew(plan),
        *winch_steps(plan),
        *((tie_step(plan),) if cables else ()),
        *insert_steps(plan),
        _stuff(plan),
        AssemblyStep(
            "Close and calibrate" if cables else "Close it",
            10 + 5 * cables,
            _closing_sentence(plan) + _pair_sentence(plan) + held_text(plan.robot),
        ),
    )


def _has_zipper(plan: KitPlan) -> bool:
    """Return True unless the pattern has no opening."""
    return plan.work.pattern is None or plan.work.pattern.opening is not None


def _zipper_steps(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    """Step that sews the zipper in; none without it."""
    words = "Slit the back panel along its opening mark. Sew the zipper in, its slider on the outside, and open it."
    return (AssemblyStep("Put the zipper in", 25, words),) if _has_zipper(plan) else ()


def _closing_sentence(plan: KitPlan) -> str:
    """Return how to close the body and when to calibrate; without a zipper its open seam is closed by hand."""
    if _has_zipper(plan):
        wires = ", lead the wires out at its end, then calibrate" if plan.robot.cables else ""
        return f"Close the zipper{wires}. "
    wires = ", the wires led out at its end" if marks_on(plan, Mount.BODY) else ""
    then = " Then calibrate." if plan.robot.cables else ""
    return f"Close the open seam by hand with ladder stitch{wires}.{then} "


_STUFFING_SEAM = 80  # length of seam left open to turn and stuff a body without a zipper [mm], about


def _sheet_size(plan: KitPlan) -> str:
    """Sentence on the size of the sheet of felt that holds all panels."""
    pattern = plan.work.pattern
    return "" if pattern is None else f"All panels fit on felt of {pattern.width:.0f} × {pattern.height:.0f} mm. "


def _decorate(robot: Robot) -> tuple[AssemblyStep, ...]:
    """Step for the lines that are drawn on the body, such as a face; none without them."""
    if not robot.body.marks:
        return ()
    words = (
        "Embroider or applique the thin lines that are drawn in the outline, such as eyes and a mouth, while the panel "
        "is flat. Keep the pinholes free."
    )
    return (AssemblyStep("Decorate", 10 + 2 * len(robot.body.marks), words),)


def _pair_sentence(plan: KitPlan) -> str:
    """Return a sentence on how to set the two cables of a pair; empty without pairs."""
    if not plan.pairs:
        return ""
    return (
        f"Set the two cables of a pair (C1 with C{plan.pairs + 1}, and so on) equally tight: a limb leans to the "
        "tighter one. "
    )


def _prints(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    if not plan.printed:
        return ()
    return (
        AssemblyStep(
            "Print the parts",
            20,
            f"Print all plates, from parts/plate_1.3mf on: {plan.pieces}, in "
            "PLA, 0.2 mm layers, no supports, as they lie. Check every fit before you go on: spools turn freely, "
            "motors "
            "slide in without force.",
            wait=f"about {minutes_text(60 * plan.print_hours)} of printing",
        ),
    )


def _cables(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    work = CableWork.of_robot(plan.drawn, plan.options)
    tubes = sum(len(cable.sheathed) for cable in plan.robot.cables)
    sheaths = "Tie sheaths to the inside of the cloth at both ends, the line in them. " if tubes else ""
    grommets = (
        " Grommets are optional: sew one behind a hole that frays."
        if _grommets(plan)
        else " Edge each hole with buttonhole stitch, or set an eyelet of 2 mm: felt frays under a line."
    )
    return (
        AssemblyStep(
            "Cut cables and sheaths" if tubes else "Cut the cables",
            work.cut,
            "Cut each line to lists/cable_cuts.csv, pulled straight. Mark its spool mark with a pen, measured "
            "from the end that "
            "gets the stopper, and tape the cable's number to it."
            + (" Cut tubes to lists/sheath_cuts.csv, square, with a sharp blade." if tubes else ""),
        ),
        AssemblyStep(
            "Stitch the cables",
            work.route,
            f"{_panel_sentence(plan)} (lists/stitching.csv). Begin at the winch and follow the numbers of the map: "
            f"solid runs outside, dashed inside. {sheaths}"
            f"End outside; behind the last hole, {plan.rigid.begin_stopper}.{grommets}",
        ),
    )


def _panel_sentence(plan: KitPlan) -> str:
    """Return a sentence on the panel to lay flat and the order in which its cables are sewn."""
    cables = len(plan.robot.cables)
    if plan.pairs:
        return (
            f"Lay the front panel flat, right side up, and take {_row(1, plan.pairs)} in order. Then the back panel, "
            f"as its marks show: {_row(plan.pairs + 1, cables)}, each behind its twin"
        )
    panel = plan.panels[0] if plan.panels else "front"
    what = f"the {panel} panel" if _flat(plan) else "each patch"
    return f"Lay {what} flat, right side up. Take {_row(1, cables)} in order"


def _row(first: int, last: int) -> str:
    """C1; C1 to C6."""
    return f"C{first}" if first == last else f"C{first} to C{last}"


def _flat(plan: KitPlan) -> bool:
    """Return True if the body is a front and a back; else it is a skin of patches."""
    return plan.robot.body.mesh.dim == 2


def _grommets(plan: KitPlan) -> bool:
    return any(part.name.startswith("grommet") for part in plan.printed)


def _sew(plan: KitPlan) -> AssemblyStep:
    sides = "front and back" if _flat(plan) else "neighboring patches"
    between = "Sew the gusset strips between them, notch to notch" if plan.work.gusset else "Match the notches"
    tucked = ", all lines tucked inside, clear of the seam" if plan.robot.cables else ""
    way = "zipper" if _has_zipper(plan) else "open seam"
    gap = f"but for {find_open_seam(plan)} mm next to the winches" if find_stuck_marks(plan) else "and leave no gap"
    if not (_has_zipper(plan) or find_stuck_marks(plan)):
        gap = f"but for about {_STUFFING_SEAM} mm, through which you turn and stuff it"
    return AssemblyStep(
        "Sew the body",
        45,
        f"Lay {sides} right sides together{tucked}. {between}; sew twice along the seam line {gap}. "
        f"Snip the allowance in inner corners. Turn the body right side out through the {way}.",
    )


def _lying_text(plan: KitPlan) -> str:
    """Return how each unit lies in a flat body, seen from the front; empty in space."""
    marks = winch_marks_of(plan.robot)
    laid: dict[str, list[str]] = {}
    for unit in plan.rigid.units:
        if unit.place is not None:
            laid.setdefault(unit.place.instruction, []).append(marks[unit.winch])
    lying = "; ".join(f"{marks_text(tuple(own))} {words}" for words, own in laid.items())
    return f", seen from the front: {lying}" if lying else ""


def _stuff(plan: KitPlan) -> AssemblyStep:
    inside, thickness = marks_on(plan, Mount.BODY), plan.robot.body.thickness
    full = f"about {1e3 * thickness:.0f} mm thick" if thickness else "as large as on page 1"
    them = "it" if len(inside) == 1 else "them"
    ways = f"Bring {marks_text(find_stuck_marks(plan))} in through the open seam. " if find_stuck_marks(plan) else ""
    places = (
        f"{ways}Set {marks_text(inside)} where the map shows {them}{_lying_text(plan)}. Tie {them} to the front cloth. "
        if inside
        else ""
    )
    winches = ", then around the winches," if inside else ""
    lumps = " Leave no lumps next to the cables." if plan.robot.cables else ""
    last = " Close the open seam by hand with ladder stitch." if find_stuck_marks(plan) and _has_zipper(plan) else ""
    words = f"{places}Fill the limbs first{winches} softly and evenly, until the body is {full}.{lumps}{last}"
    return AssemblyStep("Stuff the body", 30, words)
