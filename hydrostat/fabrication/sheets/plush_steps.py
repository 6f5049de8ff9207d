"""What to do for a plush robot, in order. Times are estimates; none was measured."""

from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.sheets.steps import (
    AssemblyStep,
    held_text,
    marks_on,
    marks_text,
    minutes_text,
    tie_step,
    winch_steps,
)
from hydrostat.robot import Mount
from hydrostat.units import plural


def plush_steps(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    """Steps from the folder of files to a robot that is sewn up."""
    cables = len(plan.robot.cables)
    return (
        *_prints(plan),
        AssemblyStep(
            "Cut the cloth",
            20,
            "Laser pattern/pattern.svg or pattern/pattern.dxf: marks first, then pinholes, edges last. Or print "
            f"pattern/pattern_{plan.options.paper}.pdf at 100 %, check that the bar measures 100 mm, cut by hand and "
            "punch the pinholes. Keep the grain arrows along the cloth.",
        ),
        *(_cables(plan) if cables else ()),
        AssemblyStep(
            "Put the zipper in",
            25,
            "Slit the back panel along its opening mark. Sew the zipper in, its slide on the outside, and open it.",
        ),
        _sew(plan),
        *winch_steps(plan),
        *((tie_step(cables),) if cables else ()),
        _stuff(plan),
        AssemblyStep(
            "Close and calibrate" if cables else "Close it",
            10 + 5 * cables,
            ("Close the zipper, lead the wires out at its end, then calibrate. " if cables else "Close the zipper. ")
            + _matched(plan)
            + held_text(plan.robot),
        ),
    )


def _matched(plan: KitPlan) -> str:
    """How the two of a pair are set."""
    if not plan.pairs:
        return ""
    return (
        f"Set the two of a pair (C1 with C{plan.pairs + 1}, and so on) equally tight: a limb leans to the tighter one. "
    )


def _prints(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    if not plan.printed:
        return ()
    count = plural(sum(part.count for part in plan.printed), "part")
    return (
        AssemblyStep(
            "Print the parts",
            20,
            f"All plates from parts/plate_1.3mf on: {count} of "
            "PLA, 0.2 mm layers, no supports, as they lie. Try every fit before you go on: spools turn freely, motors "
            "slide in without force.",
            wait=f"about {minutes_text(60 * plan.print_hours)} of printing",
        ),
    )


def _cables(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    cables = len(plan.robot.cables)
    tubes = sum(len(cable.sheathed) for cable in plan.robot.cables)
    sheaths = "Tie sheaths to the inside of the cloth at both ends, the line in them. " if tubes else ""
    grommets = " Grommets are optional: sew one behind a hole that frays." if _grommets(plan) else ""
    return (
        AssemblyStep(
            "Cut cables and sheaths" if tubes else "Cut the cables",
            3 * (cables + tubes),
            "Cut each line to lists/cable_cuts.csv, pulled straight. Mark its spool mark with a pen, from the end that "
            "gets the stopper, and tape the cable's number to it."
            + (" Cut tubes to lists/sheath_cuts.csv, square, with a sharp blade." if tubes else ""),
        ),
        AssemblyStep(
            "Stitch the cables",
            10 * cables,
            f"{_laid(plan)} (lists/stitching.csv). Begin at the winch and follow the numbers of the map: solid runs "
            f"outside, dashed inside. {sheaths}End outside; put the stopper on loosely behind the last hole.{grommets}",
        ),
    )


def _laid(plan: KitPlan) -> str:
    """What is laid flat, and which cables are sewn on it in which order."""
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
    """Whether it is a front and a back; else a skin of patches."""
    return plan.robot.body.mesh.dim == 2


def _grommets(plan: KitPlan) -> bool:
    return any(part.name.startswith("grommet") for part in plan.printed)


def _sew(plan: KitPlan) -> AssemblyStep:
    sides = "front and back" if _flat(plan) else "neighbouring patches"
    between = "Sew the gusset strips between them, notch to notch" if plan.work.gusset else "Match the notches"
    tucked = ", all lines tucked inside, clear of the seam" if plan.robot.cables else ""
    return AssemblyStep(
        "Sew the body",
        45,
        f"Lay {sides} right sides together{tucked}. {between}; sew twice along the seam line, leave no gap. "
        "Snip the allowance in inner corners. Turn it out through the zipper.",
    )


def _stuff(plan: KitPlan) -> AssemblyStep:
    inside, thickness = marks_on(plan, Mount.BODY), plan.robot.body.thickness
    full = f"about {1e3 * thickness:.0f} mm thick" if thickness else "as large as on page 1"
    them = "it" if len(inside) == 1 else "them"
    places = (
        f"Set {marks_text(inside)} where the map has {them} and tie {them} to the cloth in front. " if inside else ""
    )
    winches = ", then round the winches," if inside else ""
    lumps = " No lumps by the cables." if plan.robot.cables else ""
    return AssemblyStep(
        "Stuff the body", 30, f"{places}Fill limbs first{winches} softly and evenly, until the body is {full}." + lumps
    )
