"""`mold_steps`, `skin_steps`: from the files of a mold to a robot of foam or silicone.

Times of cure are those of R52 and N5, all others are estimates.
"""

import math
from collections.abc import Mapping, Sequence

from hydrostat.fabrication.cable_work import DRAW, SEW, CableWork
from hydrostat.fabrication.inserts import displaced_volume
from hydrostat.fabrication.kit_options import MoldKind
from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.lists.lists import Lists
from hydrostat.fabrication.lists.stitching import CableDepths, DepthRow, PointAccess, Stitching
from hydrostat.fabrication.moulds.casting import cures_in_silicone
from hydrostat.fabrication.moulds.mould import Mold
from hydrostat.fabrication.sheets.steps import (
    AssemblyStep,
    cables_text,
    insert_steps,
    minutes_text,
    tie_step,
    winch_steps,
)
from hydrostat.units import plural

_SILICONE_CURE = ("Mold Max 30 silicone", "24 h, or 6 h at 60 °C")

_MODEL_CURES = (("alginate", "less than 5 min"), ("plaster", "several hours"))  # for casting a positive

_OTHER_MOULD = (
    "For this, run “hydrostat fabricate” with “--mould silicone”. It writes a positive and frames to print, "
    "amounts and steps. positive/plate_1.3mf is the body alone: this mold does not need it."
)

_MODEL_FIRST = (
    "From a model, as Chang (2018) casts a hand (Fig. 4.1): hold the model still in alginate, draw it out, and fill "
    "the hole with plaster. Bed this positive up to its parting line in clay instead of the first half. Press "
    "keys into "
    "the clay. After the first pour, remove all clay, spray, and pour the second half. For a single body, pour the "
    "foam straight into the alginate (4.2), which sets in less than 5 min and can be used once."
)

_PARTS_TOO = " Print the parts of the robot too: all plates, from parts/plate_1.3mf on, in PLA, without supports."
_STIR_FOAM = "Stir with a whisk on a drill as long as the label says, not longer: the foam rises immediately."
_STIR_SILICONE = "Stir slowly, scrape sides and bottom, and let the bubbles rise, in a vacuum if you have one."
_POUR_FOAM = "Pour immediately, in a thin stream down the sprue. Tape each vent when foam appears, then the sprue."
_POUR_SILICONE = (
    "Pour in a thin stream down the sprue, until silicone stands in all vents. Tap the mold; refill as bubbles rise."
)
_OPEN = (
    "Slowly lift the halves apart along the arrow. Where the body sticks (hatched), squeeze it and roll it out. Trim "
    "flash, sprue and vents with scissors."
)
_GLUE_FOAM = (
    "Spray the foam thinly with contact adhesive (3M Super 77), outdoors. "
    "Pull on a knitted glove or sleeve, {}and press."
)
_SLIP_SILICONE = (
    "Pull on a knitted glove or sleeve that fits tightly, {}and sew its opening closed around the body. Use no spray "
    "adhesive: it does not hold on silicone."
)
_OPEN_FOAM = " Squeeze the body all over to open its cells."


def foam_expansion(mould: Mold) -> bool:
    """Return True if the casting material is a foam; the others are silicones."""
    return mould.casting.expansion > 1


def other_way(mould: Mold) -> tuple[str, ...]:
    """Return the title and the text on another method to make the mold; empty if there is none."""
    if mould.kind is MoldKind.PRINTED:
        return ("Or a mold of silicone", _OTHER_MOULD) if cures_in_silicone(mould.casting.body.material) else ()
    return "Or from a model, without a printed positive", _MODEL_FIRST


def cure_times(mould: Mold | None) -> tuple[tuple[str, str], ...]:
    """Cure time of each material, that of the body last."""
    if mould is None:
        return ()
    what, time = mould.casting.times[-1]
    body = (what.removesuffix(" cures"), time.partition(" (")[0])
    return (body,) if mould.kind is MoldKind.PRINTED else (_SILICONE_CURE, *_MODEL_CURES, body)


def body_mass(plan: KitPlan, mould: Mold) -> float:
    """Mass of the body with its parts and rods, without sprue, vents and what is spare [g]."""
    mix = mould.casting.body
    poured = mould.volumes.get("cavity", mix.volume) - displaced_volume(plan.robot.body)
    return mix.density * poured + sum(insert.mass or 0.0 for insert in plan.inserts)


def mold_steps(plan: KitPlan, lists: Lists, mould: Mold) -> tuple[AssemblyStep, ...]:
    """Steps from the files of the mold to a body of foam."""
    printed = mould.kind is MoldKind.PRINTED
    mix, foams = mould.casting.body, foam_expansion(mould)
    return (
        *(_printed_first(plan) if printed else _silicone_first(plan, mould)),
        AssemblyStep(
            "Spray release agent",
            10,
            "Spray both halves, keys, sprue and vents with two thin coats. Let the solvent dry.",
            wait="10 min",
        ),
        *_tubes_first(CableDepths.of(lists.stitching, len(plan.robot.cables))),
        *insert_steps(plan),
        AssemblyStep("Close it", 10, f"{_closing(mould)} {mould.stands}"),
        AssemblyStep(
            "Weigh and stir",
            5,
            f"Weigh {mix.part_a:.0f} g of part A and {mix.part_b:.0f} g of part B of {mix.material}, each in its "
            "own cup, if "
            "your cans ask for this ratio. " + (_STIR_FOAM if foams else _STIR_SILICONE),
        ),
        AssemblyStep("Pour", 5, _POUR_FOAM if foams else _POUR_SILICONE, wait="its cure"),
        AssemblyStep("Open", 20, _OPEN + (_OPEN_FOAM if foams else "")),
    )


def _in_pieces(plan: KitPlan) -> bool:
    """Return True if a half of the mold is printed in pieces that are joined."""
    return any(part.kind for part in plan.work.printed)


def _printed_first(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    glue = (
        " Join the pieces of a half with glue and 3 mm dowels in the holes; never glue the two halves together."
        if _in_pieces(plan)
        else ""
    )
    return (
        AssemblyStep(
            "Print the mold",
            20,
            "Print all plates, from mould/plate_1.3mf on: PLA, 0.2 mm layers, three walls, as the pieces lie, no "
            "supports in the cavity." + glue + _PARTS_TOO,
            wait=f"about {minutes_text(60 * plan.print_hours)} of printing, all parts",
        ),
        AssemblyStep(
            "Seal the cavity",
            30,
            "Sand the ridges of the layers. Brush on two coats of sealer or shellac: otherwise "
            f"{plan.cast_material} creeps between the layers.",
            wait="1 h for each coat",
        ),
    )


def _silicone_first(plan: KitPlan, mould: Mold) -> tuple[AssemblyStep, ...]:
    glue = " Join what is in pieces with glue and 3 mm dowels in the holes." if _in_pieces(plan) else ""
    masses = [f"{mix.mass:.0f} g" for mix in mould.casting.silicone] or ["the amount"]
    return (
        AssemblyStep(
            "Print positive and frames",
            30,
            "Print all plates, from mould/plate_1.3mf on: positive, two frames, four key domes."
            + glue
            + " Fill and sand marks that the silicone should not copy. Leave the two halves of the positive apart."
            + _PARTS_TOO,
            wait=f"about {minutes_text(60 * plan.print_hours)} of printing, all parts",
        ),
        AssemblyStep(
            "Pour the first half",
            30,
            "Lay the lower half of the positive on a flat board, flat side down, the lower frame around it, a dome in "
            "each corner. Seal frame and joints to the board with tape or clay. Spray release agent. Pour "
            f"{masses[0]} of mixed silicone in a thin stream, from one corner.",
            wait="its cure",
        ),
        AssemblyStep(
            "Pour the second half",
            30,
            "Turn over the frame, silicone and positive. Take the domes out. Put the upper half of the positive on the "
            "lower with dowels of 3 mm, no glue, and the upper frame on the lower; seal the joint. Spray silicone and "
            f"positive twice: silicone sticks to silicone. Pour {masses[-1]}.",
            wait="its cure",
        ),
        AssemblyStep(
            "Take the positive out",
            15,
            "Open the halves, draw the positive out, and clear the sprue"
            + (f" and punch {plural(mould.vents, 'vent')} of 3 mm at the high points." if mould.vents else "."),
        ),
    )


def _tubes_first(depths: CableDepths) -> tuple[AssemblyStep, ...]:
    """Tubes that no needle reaches later."""
    if not depths.laid:
        return ()
    return (
        AssemblyStep(
            "Lay tubes in the cavity",
            10 * len(depths.laid),
            f"{cables_text(depths.laid)} {'runs' if len(depths.laid) == 1 else 'run'} too deep for a needle: where "
            f"lists/stitching.csv says “{PointAccess.LAID}”, lay a PTFE tube through these points on a straight "
            "rod, its ends closed with tape. Hold the rod at both ends: in a hole drilled through the wall, or on "
            "pins in it.",
        ),
    )


def _closing(mould: Mold) -> str:
    if mould.bolts:
        return f"Push the keys home and close the mold with {plural(mould.bolts, 'bolt')} M4; no light may pass."
    return "Push the keys home and strap the mold between two boards, not so tightly that it bulges."


def skin_steps(plan: KitPlan, lists: Lists) -> tuple[AssemblyStep, ...]:
    """Steps from a cast body to a robot."""
    cables, fixed = len(plan.robot.cables), _SLIP_SILICONE if plan.is_silicone else _GLUE_FOAM
    ends = f" Lead the end of each line out through it at the last point of the line; {plan.rigid.begin_stopper}."
    return (
        *(_cable_steps(plan, lists) if cables else ()),
        AssemblyStep(
            "Fix the skin",
            20,
            fixed.format("align its marks, " if cables else "") + (ends if cables else ""),
            wait="" if plan.is_silicone else "15 min",
        ),
        *winch_steps(plan),
        *((tie_step(plan),) if cables else ()),
        *coupler_steps(plan),
    )


def channel_ways(stitching: Stitching | None, cables: int) -> dict[str, list[tuple[str, float]]]:
    """Points of each cable that is sewn on the skin, as (name, distance from the winch [mm])."""
    sewn = set(CableDepths.of(stitching, cables).sewn)
    rows = [row for row in stitching.rows if isinstance(row, DepthRow)] if stitching is not None else []
    ways: dict[str, list[tuple[str, float]]] = {}
    for row in rows:
        if row.cable in sewn and row.how in (PointAccess.SKIN, PointAccess.TUBE_END):
            ways.setdefault(row.cable, []).append((row.point, row.along))
    return {cable: points for cable, points in ways.items() if len(points) > 1}


def coupler_steps(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    """Steps for a core that is swapped; none where its lines go on to the spools in one piece."""
    base = plan.rigid.base
    if base is None or not base.bare > 0:
        return ()
    lines, plates = len(base.tubes), sum(part.count for part in base.printed if part.title == "Core plate")
    minutes = math.ceil((20 * lines + 30 * plates) / 60)
    return (
        AssemblyStep(
            "Couple the lines",
            4 * lines,
            "Cut each line 30 mm behind the core plate. Tie a 5 mm loop, 10 mm behind the plate, and one in the "
            "other piece. "
            "Hook both into a line_coupler, which is at the plate when the winch is at zero. To swap the core "
            f"({minutes} min, estimated), pay out the lines, unhook them, and undo the wing nuts.",
        ),
    )


def _cable_steps(plan: KitPlan, lists: Lists) -> tuple[AssemblyStep, ...]:
    """Steps that bring cables in or on the body, by their depth."""
    depths = CableDepths.of(lists.stitching, len(plan.robot.cables))
    tubes = bool(lists.tubes.rows)
    deep = sorted({*depths.drawn, *depths.laid, *depths.tubed}, key=lambda cable: int(cable[1:]))
    steps = [
        AssemblyStep(
            "Cut cables and tubes" if tubes else "Cut the cables",
            CableWork.of_robot(plan.drawn, plan.options).cut,
            "Cut lines to lists/cable_cuts.csv"
            + (" and PTFE tubes to lists/sheath_cuts.csv" if tubes else "")
            + ". Mark the spool mark with a pen, from the end that gets the stopper; tape numbers to the ends.",
        )
    ]
    if deep:
        steps.append(_drawn_step(depths, deep, plan.cast_material, flat=plan.robot.body.mesh.dim == 2))
    if depths.sewn:
        steps.append(_sewn_step(depths, channel_ways(lists.stitching, len(plan.robot.cables)), tubes=tubes))
    return tuple(steps)


def _drawn_step(depths: CableDepths, deep: list[str], poured: str, *, flat: bool) -> AssemblyStep:
    """Step that draws cables through what was poured, of a flat body in the middle of its thickness."""
    pins = "points" if flat else "“skin” points"
    where = "in the middle of the thickness" if flat else "at the depth listed, under the pins"
    tubes = (
        f" Push the tube of {cables_text(depths.tubed)} along the needle's channel, with its ends where the list "
        "has them."
        if depths.tubed
        else ""
    )
    laid = " Where a tube was laid, pull the line through it." if depths.laid else ""
    return AssemblyStep(
        f"Draw cables through the {poured}",
        DRAW * len(deep),
        f"Draw {cables_text(deep)} before the skin is on. Pins at the {pins} of lists/stitching.csv show the way "
        f"(so do dents). Draw the line from point to point with a long needle, {where}."
        + tubes
        + laid
        + " On the skin, a cable would have a different lever arm from the simulated one.",
    )


def _sewn_step(depths: CableDepths, ways: Mapping[str, Sequence[tuple[str, float]]], *, tubes: bool) -> AssemblyStep:
    tube = ", each tube sewn at both of its ends with the line in it" if tubes else ""
    pace = 30.0  # of a seam by hand [mm/min], two for each channel. Estimated, as the 5 minutes to pin one
    minutes = sum(5 + 2 * (points[-1][1] - points[0][1]) / pace for points in ways.values())
    channels = (
        f" Or sew channels, which guide the line all along (about {minutes_text(minutes)} by hand in all): cut "
        "the strips of "
        "pattern/channels.svg, pin each cross line to the point with its number, sew both seams, and pull the "
        "line through."
    )
    return AssemblyStep(
        "Sew cables on the skin",
        SEW * len(depths.sewn),
        f"{cables_text(depths.sewn)}. Pull the skin over the body, pin every point of the map through it, mark it with "
        "its number. Take the skin off over a rolled sheet of paper. Sew each line on, from the winch to its "
        "stopper, with a "
        f"stitch at every number and the line free to slide{tube}." + (channels if ways else ""),
    )
