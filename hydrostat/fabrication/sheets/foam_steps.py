"""What to do with a body of foam until it is a robot, in order. Times are estimates; none was measured."""

from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.lists.lists import Lists
from hydrostat.fabrication.sheets.steps import AssemblyStep, CableDepths, cables_text, tie_step, winch_steps


def skin_steps(plan: KitPlan, lists: Lists) -> tuple[AssemblyStep, ...]:
    """Steps from a body of foam to a robot."""
    cables = len(plan.robot.cables)
    return (
        *(_cable_steps(plan, lists) if cables else ()),
        AssemblyStep(
            "Fix the skin",
            20,
            "Spray the foam thinly with contact adhesive (3M Super 77), outdoors. Pull a knitted glove or sleeve on, "
            + (
                "marks to their places, and press. Lead the end of each line out through it at its last point; put the "
                "stopper on loosely."
                if cables
                else "and press."
            ),
            wait="15 min",
        ),
        *winch_steps(plan),
        *((tie_step(cables),) if cables else ()),
    )


def _cable_steps(plan: KitPlan, lists: Lists) -> tuple[AssemblyStep, ...]:
    """How cables come in or on the body, by their depth."""
    cables = len(plan.robot.cables)
    depths = CableDepths.of(lists.stitching, cables)
    tubes = bool(lists.tubes.rows)
    deep = sorted({*depths.drawn, *depths.laid, *depths.tubed}, key=lambda cable: int(cable[1:]))
    steps = [
        AssemblyStep(
            "Cut cables and tubes" if tubes else "Cut the cables",
            3 * (2 if tubes else 1) * cables,
            "Cut lines to lists/cable_cuts.csv"
            + (" and PTFE tubes to lists/sheath_cuts.csv" if tubes else "")
            + ". Mark the spool mark with a pen, from the end that gets the stopper; tape numbers to the ends.",
        )
    ]
    if deep:
        steps.append(_drawn_step(depths, deep))
    if depths.sewn:
        steps.append(_sewn_step(depths, tubes=tubes))
    return tuple(steps)


def _drawn_step(depths: CableDepths, deep: list[str]) -> AssemblyStep:
    tubes = (
        f" Push the tube of {cables_text(depths.tubed)} along the needle's channel, ends where the list has them."
        if depths.tubed
        else ""
    )
    laid = " Where a tube was laid, pull the line through it." if depths.laid else ""
    return AssemblyStep(
        "Draw cables through the foam",
        15 * len(deep),
        f"{cables_text(deep)}, before the skin is on. Pins at the “skin” places of lists/stitching.csv show the way "
        "(so do dents). Draw the line with a long needle from point to point, at the depth listed, under the pins."
        + tubes
        + laid
        + " Sewn on the skin instead, it would have another lever than simulated.",
    )


def _sewn_step(depths: CableDepths, *, tubes: bool) -> AssemblyStep:
    tube = ", tubes at both ends with the line in them" if tubes else ""
    return AssemblyStep(
        "Sew cables on the skin",
        17 * len(depths.sewn),
        f"{cables_text(depths.sewn)}. Pull the skin over the body, pin every point of the map through it, mark it with "
        "its number. Take the skin off over a rolled sheet of paper. Sew each line on from the winch to its stopper: a "
        f"stitch at every number, the line free to slide{tube}.",
    )
