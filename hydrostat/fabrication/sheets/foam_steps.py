"""What to do for a robot of foam, in order. Times of cure are those of R52 and N5; the others are estimates."""

from hydrostat.fabrication.moulds.mould import Mould
from hydrostat.fabrication.moulds.mould_options import MouldKind
from hydrostat.fabrication.sheets.sheet_input import SheetInput
from hydrostat.fabrication.sheets.step import Step, count_text, minutes_text

CURES = (
    ("alginate", "less than 5 min"),
    ("plaster", "several hours"),
    ("Mold Max 30 silicone", "24 h, or 6 h at 60 °C"),
)
"""How long each material of the nine steps cures."""

SILICONE_STEPS = (
    "Stir alginate with water and hold the model in it without moving (or print the positive and begin with 3).",
    "Draw the model out and fill the alginate with plaster: the positive.",
    "Bed the positive to its parting line in clay, in a box with two fingers of room; press keys into the clay.",
    "Pour the first half of silicone in a thin stream, from one corner.",
    "Turn the box over and take all clay away; leave the positive where it is.",
    "Spray release agent on positive and silicone, twice.",
    "Pour the second half of silicone.",
    "Open, take the positive out, cut sprue and vents, spray, close, and strap between two boards.",
    "Stir the foam with an egg mixer, pour it in, and open after its cure.",
)
"""The nine steps by which a mould of silicone is cast round a positive."""


_STIR_FOAM = "Stir with an egg mixer as long as the label says, not longer: it rises at once."
_STIR_SILICONE = "Stir slowly, scrape sides and bottom, and let the bubbles rise, in a vacuum if you have one."
_POUR_FOAM = (
    "At once, in a thin stream down the sprue. Close a vent with tape when foam looks out of it; the sprue last."
)
_POUR_SILICONE = (
    "In a thin stream down the sprue, until it stands in all vents. Tap the mould; fill up what sinks as bubbles rise."
)
_OPEN = (
    "Lift the halves apart along the arrow, slowly. Where the body holds (hatched), squeeze it and roll it out. Trim "
    "flash, sprue and vents with scissors."
)
_OPEN_FOAM = " Squeeze the body all over to open its cells."


def rises(mould: Mould | None) -> bool:
    """Whether what is poured is a foam; what else is cast is silicone."""
    return mould is None or mould.casting.expansion > 1


def cures(mould: Mould | None) -> tuple[tuple[str, str], ...]:
    """How long each material cures, that of the body last."""
    if mould is None:
        return CURES
    what, time = mould.casting.times[-1]
    return (*CURES, (what.removesuffix(" cures"), time.partition(" (")[0]))


def mould_steps(given: SheetInput, mould: Mould) -> tuple[Step, ...]:
    """From the files of the mould to a body of foam."""
    printed = mould.kind is MouldKind.PRINTED
    mix, foams = mould.casting.body, rises(mould)
    return (
        *(_printed_first(given, mould) if printed else _silicone_first(mould)),
        Step(
            "Spray release agent",
            10,
            "On both halves and on keys, sprue and vents: two thin coats. Let the solvent dry.",
            wait="10 min",
        ),
        Step("Close it", 10, f"{_closing(mould)} {mould.stands}"),
        Step(
            "Weigh and stir",
            5,
            f"{mix.part_a:.0f} g of part A and {mix.part_b:.0f} g of part B of {mix.material}, each in its own cup, if "
            "your tins ask for this ratio. " + (_STIR_FOAM if foams else _STIR_SILICONE),
        ),
        Step("Pour", 5, _POUR_FOAM if foams else _POUR_SILICONE, wait="its cure"),
        Step("Open", 20, _OPEN + (_OPEN_FOAM if foams else "")),
    )


def _printed_first(given: SheetInput, mould: Mould) -> tuple[Step, ...]:
    glue = f" Join the pieces with {count_text(mould.dowels, 'dowel')} of 3 mm and glue." if mould.dowels else ""
    return (
        Step(
            "Print the mould",
            20,
            "PLA, 0.2 mm layers, three walls, as the pieces lie in the files, no supports in the cavity." + glue,
            wait=f"about {minutes_text(60 * given.print_hours)} of printing, all parts",
        ),
        Step(
            "Seal the cavity",
            30,
            "Sand the ridges of the layers. Brush on two coats of sealer or shellac, or the foam creeps between the "
            "layers.",
            wait="1 h for each coat",
        ),
    )


def _silicone_first(mould: Mould) -> tuple[Step, ...]:
    pours = " and ".join(f"{mix.mass:.0f} g" for mix in mould.casting.silicone)
    return (
        Step(
            "Cast the silicone",
            90,
            f"Follow the nine steps on this page, with the printed positive and frames. {pours} of silicone make "
            "the halves.",
            wait="two cures",
        ),
        Step("Clean the cavity", 10, "Take out crumbs of clay with a brush. Cut sprue and vents open."),
    )


def _closing(mould: Mould) -> str:
    if mould.bolts:
        return f"Push the keys home and close it with {count_text(mould.bolts, 'bolt')} M4; no light may shine through."
    return "Push the keys home and strap it between two boards, not so hard that it bulges."


def _outside(cables: int, winches: int) -> tuple[Step, ...]:
    return (
        Step(
            "Put the winches together",
            15 * winches,
            f"Build {count_text(winches, 'winch', 'winches')} as drawn on page 1, write the letter on each, screw them "
            "to the base plate in the order of the letters.",
        ),
        Step(
            "Lay the tubes",
            5 * cables,
            "Push each tube into its holder on the base and lead it to where its cable begins, in wide bends, none "
            "tighter than a cup. Both ends must be held: only so does the tube keep the cable's length.",
        ),
    )


def _inside(winches: int) -> tuple[Step, ...]:
    return (
        Step(
            "Put the winches in",
            20 * winches,
            f"Build {count_text(winches, 'winch', 'winches')} as drawn on page 1, write the letter on each, and push "
            "each into its pocket in the foam. Lead the wires out together; sew the skin round them.",
        ),
    )


def skin_steps(given: SheetInput) -> tuple[Step, ...]:
    """From a body of foam to a robot."""
    cables, winches = len(given.robot.cables), len(given.robot.winches)
    return (
        Step(
            "Cut cables and tubes",
            3 * 2 * cables,
            "Cut lines and PTFE tubes to their lists. Mark stopper, exit and spool points with a pen; tape numbers "
            "to the ends.",
        ),
        Step(
            "Mark the skin",
            5 * cables,
            "Pull a knitted glove or sleeve over the body. Pin every point of the map through it and mark it with "
            "its number.",
        ),
        Step(
            "Sew the cables on",
            12 * cables,
            "Take the skin off over a rolled sheet of paper. Sew each line on from the winch to its stopper: a "
            "stitch at every "
            "number, the line free to slide. Where the map shows a tube, sew the tube on at both ends, with the "
            "line in it.",
        ),
        Step(
            "Fix the skin",
            20,
            "Spray the foam thinly with contact adhesive (3M Super 77), outdoors. Pull the skin on, marks to their "
            "places, and "
            "press. Clamp the stoppers loosely at their marks.",
            wait="15 min",
        ),
        *(_outside(cables, winches) if given.outside else _inside(winches)),
        Step(
            "Tie the cables on",
            5 * cables,
            "Knot each line at the spool's tie hole so that the spool mark meets the spool. Wind the spare turns "
            "on, all the "
            "same way. Then calibrate.",
        ),
    )


def foam_safety(mould: Mould | None) -> tuple[str, ...]:
    """What to mind, of a body of foam or silicone."""
    return (*(_FOAM if rises(mould) else ()), *FOAM_SAFETY)


_FOAM = (
    "Foam is made of isocyanate: nitrile gloves, goggles, long sleeves, an open window or a hood. Who has asthma does "
    "not pour. Cured foam is harmless.",
    "Foam rises with force and warmth: never close the last opening, never use a glass vessel.",
)

FOAM_SAFETY = (
    "Silicone and release spray: gloves and fresh air, no flame, no food vessels.",
    "Plaster grows hot as it sets: never round a hand or any skin. Alginate only is for skin.",
    "Spray adhesive outdoors, away from flames and motors.",
    "Keep fingers, hair and strings away from spools and taut lines while the power is on.",
    "Have a switch that cuts the power. Stop at once if a motor stalls, hums or grows hot.",
    "Small parts, screws and lines are no toys: keep them away from children under three.",
)
"""What to mind in any case."""

FOAM_CHECKLIST = (
    "Parts A and B weighed, not measured by eye",
    "The body came out whole, no hole larger than a pea",
    "Body and skin weigh what the bill says, within a tenth",
    "Every cable in its own channel, every tube held at both ends",
    "All spools turn freely by hand",
    "Stoppers tight, tails trimmed",
    "Each winch ran to full travel and back",
    "Power switch within reach",
)
"""What to tick before the first pose."""
