"""`all_steps`, `summary_rows`: the steps of a kit, and what building it asks of a person, on one page."""

from hydrostat.fabrication.cable_work import CableWork
from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.lists.lists import Lists
from hydrostat.fabrication.motor_choice import drive_price
from hydrostat.fabrication.sheets.foam_steps import mold_steps, skin_steps
from hydrostat.fabrication.sheets.legible import sentence
from hydrostat.fabrication.sheets.plush_steps import plush_steps
from hydrostat.fabrication.sheets.steps import (
    AssemblyStep,
    insert_steps,
    minutes_text,
    stretch_steps,
    tie_step,
    winch_steps,
)
from hydrostat.units import plural


def all_steps(plan: KitPlan, lists: Lists) -> list[tuple[AssemblyStep, ...]]:
    """The steps, page by page. Stretching the line comes first, because you wait for it."""
    first, *more = _body_steps(plan, lists)
    return [(*stretch_steps(plan), *first), *more]


def _body_steps(plan: KitPlan, lists: Lists) -> list[tuple[AssemblyStep, ...]]:
    """The steps by the method of the body, page by page."""
    if plan.method is Method.PLUSH:
        return [plush_steps(plan)]
    if plan.method is Method.PRINT:
        return [print_steps(plan)]
    mould = plan.work.mould
    before = [mold_steps(plan, lists, mould)] if mould is not None else []
    return [*before, skin_steps(plan, lists)]


def summary_rows(plan: KitPlan, lists: Lists) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Difficulty, time, cost, pieces, holes, the hardest step, tools and optional parts: headings with sentences."""
    steps = [step for page in all_steps(plan, lists) for step in page]
    busy, longest = sum(step.minutes for step in steps), max(steps, key=lambda step: step.minutes)
    mass = sum(part.count * part.mass for part in plan.printed)
    first = longest.text.partition(". ")[0].removesuffix(".")
    rows = (
        ("Difficulty", [find_difficulty(plan, lists, busy)]),
        ("Work", [f"about {minutes_text(busy)} in {plural(len(steps), 'step')}{_cable_work(plan)}. No step was timed"]),
        ("Waiting", [f"{step.title}: {step.wait}" for step in steps if step.wait]),
        ("Money", _money(plan, lists)),
        ("To print", [f"{plan.pieces}, {mass:.0f} g"] if plan.printed else []),
        ("To sew", _sewing(plan)),
        ("Hardest step", [f"{longest.title}: {minutes_text(longest.minutes)}, the longest. {first}"]),
        ("You must own", _tools(plan, lists)),
        ("Optional", _optional(plan)),
        ("Left out", plan.options.left_out),
    )
    return tuple((head, tuple(sentence(words) for words in told)) for head, told in rows if told)


def find_difficulty(plan: KitPlan, lists: Lists, minutes: float) -> str:
    """Easy, medium or hard, by the number of reasons against a first project."""
    afternoon, days = 4 * 60, 10 * 60
    reasons = {
        "several days of work": 2 * (minutes > days),
        "more work than an afternoon": afternoon < minutes <= days,
        f"{plan.cast_material} to weigh and pour": plan.method is Method.FOAM,
        "motors to wire pin by pin": lists.power is not None and not lists.power.servos,
    }
    level = ("easy", "medium", "medium", "hard", "hard")[sum(reasons.values())]
    told = [reason for reason, weight in reasons.items() if weight]
    return f"{level}: {', '.join(told) or 'one afternoon'}"


def _cable_work(plan: KitPlan) -> str:
    """Share of the work that cables take, the minutes that `design` and `check` print."""
    if not plan.drawn.cables:
        return ""
    return f", {CableWork.of_robot(plan.drawn, plan.options).minutes:.0f} min of them on cables"


def _money(plan: KitPlan, lists: Lists) -> list[str]:
    """Price of all, and of motors, power and cables, the one that `design` and `check` print."""
    used, packs = lists.cost
    share = f": {words}" if (words := drive_share(plan)) else ""
    return [f"about {packs:.0f} USD in whole packs, {used:.0f} USD used up{share}"]


def drive_share(plan: KitPlan) -> str:
    """Return the price of motors, power and cables, as used up, in words; empty without cables."""
    if not plan.drawn.cables:
        return ""
    price = drive_price(plan.drawn, plan.demand.torques.tolist(), plan.rigid.motor, options=plan.options)
    return f"{price:.0f} USD of them for {plural(plan.num_motors, 'motor')}, power and cables"


def _sewing(plan: KitPlan) -> list[str]:
    """Number of cables, of holes and length of seams."""
    count = len(plan.robot.cables)
    found = [plural(count, "cable")] if count else []
    if plan.work.cloth is not None:
        found += [plural(plan.work.holes, "hole")] if count else []
        found.append(f"{1e-3 * plan.work.cloth.seam:.1f} m of seam")
    return [", ".join(found)] if found else []


def _tools(plan: KitPlan, lists: Lists) -> list[str]:
    """Tools that the bill does not have."""
    x, y, z = plan.options.mould.bed
    tools = [f"3D printer of {x:g} × {y:g} × {z:g} mm, or a print service"] if plan.printed else []
    if plan.method is Method.PLUSH:
        tools += [
            "laser cutter, or paper printer, scissors and an awl",
            "sewing machine, or a needle and twice the time",
        ]
    elif plan.method is Method.FOAM:
        stirrer = "sticks to stir with" if plan.is_silicone else "whisk on a drill"
        tools += ["scale that reads 1 g", "gloves and goggles", stirrer, "cups and a sharp knife"]
    if sizes := {title.partition(" ")[0] for title in plan.rigid.screws if "screw" in title}:
        tools.append(f"screwdriver for {' and '.join(sorted(sizes))} screws")
    if lists.power is not None:
        tools.append("multimeter" if lists.power.servos else "soldering iron, multimeter")
        tools.append("computer with USB")
    return tools


def _optional(plan: KitPlan) -> list[str]:
    """Parts of the kit without which it works."""
    parts = plan.rigid
    found = []
    if parts.grommet is not None:
        found.append(
            f"{plural(parts.grommet.count, 'grommet')}: metal eyelets or buttonhole stitch around the holes also work"
        )
    if plan.robot.body.marks:
        found.append("decoration")
    if parts.base is not None:
        found.append("printed base: parts/base.svg cut from acrylic also works")
    if plan.work.spare:
        found.append("the files in positive/: only a mold of silicone needs them")
    return found


def print_steps(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    """Steps from the files to a robot."""
    work = CableWork.of_robot(plan.drawn, plan.options)
    material = plan.robot.body.material.name or "the material of the robot file"
    return (
        AssemblyStep(
            "Print body and parts",
            15,
            f"body/plate_1.3mf in {material}, as it lies: 0.2 mm layers, 100 % infill, no supports. Dry the filament. "
            "Print slowly, 20 to 30 mm/s: thin hinges must not string. Print the parts (parts/plate_1.3mf) in PLA.",
            wait=f"about {minutes_text(60 * sum(part.volume for part in plan.work.printed) / 7.5e3)} of printing",
        ),
        AssemblyStep("Clear slits and holes", 15, "Cut strings in the slits. Push a wire of 1 mm through each hole."),
        *insert_steps(plan),
        *(
            AssemblyStep(title, minutes, text)
            for title, minutes, text in (
                (
                    "Cut the cables",
                    work.cut,
                    "Cut lines to lists/cable_cuts.csv. Mark the spool mark with a pen, from the end that gets the "
                    "stopper; tape numbers to the ends.",
                ),
                (
                    "Thread the cables",
                    work.route,
                    "Push a thin wire through the hole from the last point to the first, tie the line to it and draw "
                    f"the line through. At the last point, {plan.rigid.begin_stopper}.",
                ),
            )
            if plan.robot.cables
        ),
        *winch_steps(plan),
        *((tie_step(plan),) if plan.robot.cables else ()),
    )
