"""What to do for a plush robot, in order. Times are estimates; none was measured."""

from hydrostat.fabrication.sheets.sheet_input import SheetInput
from hydrostat.fabrication.sheets.step import Step, count_text, minutes_text


def plush_steps(given: SheetInput) -> tuple[Step, ...]:
    """From the folder of files to a robot that is sewn up."""
    robot = given.robot
    cables, winches = len(robot.cables), len(robot.winches)
    tubes = sum(len(cable.sheathed) for cable in robot.cables)
    thickness = 1e3 * (robot.body.thickness or 0.0)
    between = "Sew the gusset strips between them, notch to notch" if given.gusset else "Match the notches"
    return (
        Step(
            "Print the parts",
            20,
            f"{count_text(sum(part.count for part in given.printed), 'part')} of PLA, 0.2 mm layers, no supports, "
            "as they "
            "lie in the files. Try every fit before you go on: spools turn freely, motors slide in without force.",
            wait=f"about {minutes_text(60 * given.print_hours)} of printing",
        ),
        Step(
            "Cut the cloth",
            20,
            "Laser pattern.svg or pattern.dxf: marks first, then pinholes, edges last. Or print the pages of the "
            "pattern at 100 %, check that the bar measures 100 mm, cut by hand and punch the pinholes. Keep the grain "
            "arrows along the cloth.",
        ),
        Step(
            "Cut cables and sheaths",
            3 * (cables + tubes),
            "Cut each line to its list, pulled straight. Mark the stopper, exit and spool points with a pen, and "
            "tape the "
            "cable's number to its end. Cut tubes square with a sharp blade.",
        ),
        Step(
            "Stitch the cables",
            10 * cables,
            f"Lay the front panel flat, right side up. Take {'C1' if cables == 1 else f'C1 to C{cables}'} in order. "
            "Begin "
            "at the winch and follow the numbers of the map: solid runs outside, dashed inside. Tie sheaths to the "
            "inside of the cloth at both ends, the line in them. End outside; clamp the stopper loosely at its mark.",
        ),
        Step(
            "Put the zipper in",
            25,
            "Slit the back panel along its opening mark. Sew the zipper in, its slide on the outside, and open it.",
        ),
        Step(
            "Sew the body",
            45,
            f"Lay front and back right sides together, all lines and tubes tucked inside, clear of the seam. "
            f"{between}; "
            "sew twice along the seam line, leave no gap. Snip the allowance in inner corners. Turn it out through "
            "the zipper.",
        ),
        Step(
            "Put the winches together",
            15 * winches,
            f"Build {count_text(winches, 'winch', 'winches')} as drawn on page 1 and write the letter on each. Turn "
            "every "
            "motor to its zero before the spool goes on.",
        ),
        Step(
            "Tie the cables on",
            5 * cables,
            "Lead each cable through its own channel of the housing; push its tube into the seat. Knot it at the "
            "spool's "
            "tie hole so that the spool mark meets the spool. Wind the spare turns on, all the same way.",
        ),
        Step(
            "Stuff the body",
            30,
            f"Set the winches where their letters are and tie them to the front panel. Fill limbs first, then round "
            "the "
            f"winches, softly and evenly, until the body is about {thickness:.0f} mm thick. No lumps by the cables.",
        ),
        Step(
            "Close and calibrate", 10 + 5 * cables, "Close the zipper, lead the wires out at its end, then calibrate."
        ),
    )


PLUSH_SAFETY = (
    "Laser: cut only felt of known fibre. Never PVC, vinyl or unknown cloth: chlorine gas. Extract the fumes, stay "
    "beside "
    "it, keep an extinguisher at hand.",
    "Needles and blades: push away from your hand, count them before you close the zipper.",
    "Pinching: keep fingers, hair and strings away from spools and taut lines while the power is on.",
    "Motors: have a switch that cuts the power. Stop at once if a motor stalls, hums or grows hot.",
    "Small parts, screws and lines are no toys: keep them away from children under three.",
)
"""What to mind."""


def calibration(*, outside: bool) -> tuple[str, ...]:
    """How the stoppers are set; with motors outside the body the exits are those of the base."""
    place = "where its tube leaves the base" if outside else "the exit of the winch"
    return (
        "Turn all winches to zero: the spool mark of each cable stands where the line meets the spool.",
        "Pull the first cable straight by its tail, not hard: the body must not move.",
        f"Clamp its stopper at the stopper mark: “stopper” in the list is how far it is from {place}, along the line. "
        "The list's slack is in it: so much the line stays loose.",
        "Do the next cable; then take in 10 mm with every winch, one after the other. Each limb must begin to move, "
        "and come back when you let out.",
        "Moves late: shift the stopper towards the winch. Is bent at zero: shift it away. Then trim the tail to 30 mm.",
    )


PLUSH_CHECKLIST = (
    "The printed bar measured 100 mm",
    "All spools turn freely by hand",
    "Every cable in its own channel, no two crossed",
    "Stoppers outside, screws tight",
    "No line caught in the seam",
    "Needles counted, zipper closed",
    "Each winch ran to full travel and back",
    "Power switch within reach",
)
"""What to tick before the first pose."""
