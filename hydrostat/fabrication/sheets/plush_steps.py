"""What to do for a plush robot, in order. Times are estimates; none was measured."""

from hydrostat.fabrication.sheets.sheet_input import SheetInput
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


def plush_steps(given: SheetInput) -> tuple[AssemblyStep, ...]:
    """Steps from the folder of files to a robot that is sewn up."""
    cables = len(given.robot.cables)
    return (
        *_prints(given),
        AssemblyStep(
            "Cut the cloth",
            20,
            "Laser pattern/pattern.svg or pattern/pattern.dxf: marks first, then pinholes, edges last. Or print "
            f"pattern/pattern_{given.paper}.pdf at 100 %, check that the bar measures 100 mm, cut by hand and punch "
            "the pinholes. Keep the grain arrows along the cloth.",
        ),
        *(_cables(given) if cables else ()),
        AssemblyStep(
            "Put the zipper in",
            25,
            "Slit the back panel along its opening mark. Sew the zipper in, its slide on the outside, and open it.",
        ),
        _sew(given),
        *winch_steps(given),
        *((tie_step(cables),) if cables else ()),
        _stuff(given),
        AssemblyStep(
            "Close and calibrate" if cables else "Close it",
            10 + 5 * cables,
            ("Close the zipper, lead the wires out at its end, then calibrate. " if cables else "Close the zipper. ")
            + _matched(given)
            + held_text(given.robot),
        ),
    )


def _matched(given: SheetInput) -> str:
    """How the two of a pair are set."""
    if not given.pairs:
        return ""
    return (
        f"Set the two of a pair (C1 with C{given.pairs + 1}, and so on) equally tight: a limb leans to the tighter "
        "one. "
    )


def _prints(given: SheetInput) -> tuple[AssemblyStep, ...]:
    if not given.printed:
        return ()
    count = plural(sum(part.count for part in given.printed), "part")
    return (
        AssemblyStep(
            "Print the parts",
            20,
            f"All plates from parts/plate_1.3mf on: {count} of "
            "PLA, 0.2 mm layers, no supports, as they lie. Try every fit before you go on: spools turn freely, motors "
            "slide in without force.",
            wait=f"about {minutes_text(60 * given.print_hours)} of printing",
        ),
    )


def _cables(given: SheetInput) -> tuple[AssemblyStep, ...]:
    cables = len(given.robot.cables)
    tubes = sum(len(cable.sheathed) for cable in given.robot.cables)
    sheaths = "Tie sheaths to the inside of the cloth at both ends, the line in them. " if tubes else ""
    grommets = " Grommets are optional: sew one behind a hole that frays." if _grommets(given) else ""
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
            f"{_laid(given)} (lists/stitching.csv). Begin at the winch and follow the numbers of the map: solid runs "
            f"outside, dashed inside. {sheaths}End outside; put the stopper on loosely behind the last hole.{grommets}",
        ),
    )


def _laid(given: SheetInput) -> str:
    """What is laid flat, and which cables are sewn on it in which order."""
    cables = len(given.robot.cables)
    if given.pairs:
        return (
            f"Lay the front panel flat, right side up, and take {_row(1, given.pairs)} in order. Then the back panel, "
            f"as its marks show: {_row(given.pairs + 1, cables)}, each behind its twin"
        )
    panel = given.panels[0] if given.panels else "front"
    what = f"the {panel} panel" if _flat(given) else "each patch"
    return f"Lay {what} flat, right side up. Take {_row(1, cables)} in order"


def _row(first: int, last: int) -> str:
    """C1; C1 to C6."""
    return f"C{first}" if first == last else f"C{first} to C{last}"


def _flat(given: SheetInput) -> bool:
    """Whether it is a front and a back; else a skin of patches."""
    return given.robot.body.mesh.dim == 2


def _grommets(given: SheetInput) -> bool:
    return any(part.name.startswith("grommet") for part in given.printed)


def _sew(given: SheetInput) -> AssemblyStep:
    sides = "front and back" if _flat(given) else "neighbouring patches"
    between = "Sew the gusset strips between them, notch to notch" if given.gusset else "Match the notches"
    tucked = ", all lines tucked inside, clear of the seam" if given.robot.cables else ""
    return AssemblyStep(
        "Sew the body",
        45,
        f"Lay {sides} right sides together{tucked}. {between}; sew twice along the seam line, leave no gap. "
        "Snip the allowance in inner corners. Turn it out through the zipper.",
    )


def _stuff(given: SheetInput) -> AssemblyStep:
    inside, thickness = marks_on(given, Mount.BODY), given.robot.body.thickness
    full = f"about {1e3 * thickness:.0f} mm thick" if thickness else "as large as on page 1"
    them = "it" if len(inside) == 1 else "them"
    places = (
        f"Set {marks_text(inside)} where the map has {them} and tie {them} to the cloth in front. " if inside else ""
    )
    winches = ", then round the winches," if inside else ""
    lumps = " No lumps by the cables." if given.robot.cables else ""
    return AssemblyStep(
        "Stuff the body", 30, f"{places}Fill limbs first{winches} softly and evenly, until the body is {full}." + lumps
    )
