"""Words of a sheet beside its steps: calibration, safety, and the checklist before the first pose."""

from hydrostat.fabrication.kit_options import Method, MoldKind
from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.sheets.foam_steps import body_mass, foam_expansion
from hydrostat.fabrication.sheets.steps import turn_words

SURFACES = {Method.PLUSH: "cloth", Method.FOAM: "skin", Method.PRINT: "body"}
"""Surface that a stopper touches."""


def list_calibration(plan: KitPlan) -> list[str]:
    """Steps that set the zero of each cable; empty without cables."""
    ends = plan.rigid.stopper
    if ends is None or not plan.robot.cables:
        return []
    both = any(cable.reverse for cable in plan.robot.cables)
    return [
        "Turn all winches to zero: the spool mark of each cable must be where the line meets the spool. "
        + turn_words(plan),
        "Pull the first cable straight by its tail, not tight: the body must not move.",
        f"{ends.place.format(surface=SURFACES[plan.method])}; then move it back by the listed slack, and {ends.fix}.",
        "Do the same for the other cables. Then reel in 10 mm with one winch after the other. Each limb must move, "
        "and return when you pay out.",
        f"If a limb moves late, its cable is slack: {ends.reset}. If it is bent at zero, move the stopper "
        "outward. Then trim the tail to 30 mm.",
        "A winch that pulls both ways is never slack, so hydrostat calibrate cannot find its zero. Write the angle of "
        "each such winch at its spool marks as its zero in motors.toml."
        if both
        else "If a computer drives the motors, hydrostat calibrate measures where the cables of each winch begin "
        "to pull.",
    ]


_AWAY = "fingers, hair and strings away from spools and taut lines while the power is on."
_STOP = "ave a switch that cuts the power. Stop immediately if a motor stalls, hums or gets hot."
_SMALL = "Choking hazard: keep small parts, screws and lines away from children under three."


def list_hazards(plan: KitPlan) -> list[str]:
    """Safety lines of a method, the hazard first."""
    if plan.method is Method.PLUSH:
        return [
            "Laser: cut only felt of known fiber. Never cut PVC, vinyl or unknown cloth: chlorine gas. Extract "
            "the fumes, "
            "stay next to it, keep an extinguisher at hand.",
            "Needles and blades: push them away from your hand, and count them before you close the zipper.",
            f"Pinching: keep {_AWAY}",
            f"Motors: h{_STOP}",
            _SMALL,
        ]
    if plan.method is Method.PRINT:
        return [
            "Hot: the nozzle and bed burn skin. Let the bed cool before you take the body off.",
            "Fumes: print in a room with an open window.",
            f"Keep {_AWAY}",
            f"H{_STOP}",
            _SMALL,
        ]
    mould = plan.work.mould
    foam = [
        "Foam contains isocyanate: wear nitrile gloves, goggles and long sleeves, and open a window or use a "
        "hood. Do not pour "
        "foam if you have asthma. Cured foam is harmless.",
        "Foam rises with force and warmth: never close the last opening, never use a glass vessel.",
    ]
    plaster = ["Hot: plaster heats up as it sets. Never cast it on skin; use alginate only."]
    return [
        *(foam if mould is None or foam_expansion(mould) else []),
        *(plaster if mould is not None and mould.kind is MoldKind.SILICONE else []),
        "Silicone and release spray: use gloves and fresh air, no flame, no food vessels.",
        *([] if plan.is_silicone else ["Spray adhesive outdoors, away from flames and motors."]),
        f"Keep {_AWAY}",
        f"H{_STOP}",
        _SMALL,
    ]


def list_last_checks(plan: KitPlan) -> list[str]:
    """List what to look at before the first pose."""
    first = {
        Method.PLUSH: ["The printed bar measured 100 mm", "Needles counted, zipper closed"],
        Method.PRINT: [
            "No string or blob closes a slit",
            "Each line slides in its hole under its own weight and a small pull",
        ],
        Method.FOAM: ["Parts A and B weighed, not judged by eye", _whole_body(plan)],
    }[plan.method]
    ends = plan.rigid.stopper
    if ends is None or not plan.robot.cables:
        return first
    plush, spools = plan.method is Method.PLUSH, "All spools turn freely by hand"
    own = "no two crossed" if plush else "every tube held at both ends"
    return [
        *first,
        *(["No line caught in the seam", spools] if plush else []),
        f"Every cable in its own channel, {own}",
        *([f"Stoppers outside, {ends.check}"] if plush else [spools, f"Stoppers: {ends.check}, trimmed"]),
        "Each winch ran to full travel and back",
        "Power switch within reach",
    ]


def _whole_body(plan: KitPlan) -> str:
    mould = plan.work.mould
    words = "The body came out whole, no hole larger than a pea"
    return words if mould is None else f"{words}, and weighs about {body_mass(plan, mould):.0f} g after trimming"
