"""Steps that robots of plush and of foam share. Times are estimates; none was measured."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from hydrostat.fabrication.inserts import Insert, InsertKind, insert_title
from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.lists.line import line_for
from hydrostat.fabrication.parts.base_plate import BasePlate
from hydrostat.fabrication.winch_marks import winch_marks_of
from hydrostat.robot import Mount, Pin, Robot, SheetSide
from hydrostat.units import list_words, plural


@dataclass(frozen=True)
class AssemblyStep:
    """Assembly step."""

    title: str  # title of the step
    minutes: float  # about how long it keeps a person busy
    text: str  # instructions, in short sentences
    wait: str = ""  # waiting time after it, in words; empty for none

    @property
    def time(self) -> str:
        """About how long it takes, in words."""
        busy = minutes_text(self.minutes)
        return f"{busy}, then {self.wait}" if self.wait else busy


def minutes_text(minutes: float) -> str:
    """A time in minutes up to an hour and a half, to full five; then in half hours; in full ones from ten on."""
    if minutes <= 90:
        return f"{max(5 * round(minutes / 5), 5)} min"
    hours = round(minutes / 30) / 2 if minutes < 600 else round(minutes / 60)
    return f"{hours:g} h"


def held_text(robot: Robot) -> str:
    """Return a sentence on where to clamp or strap a robot; empty if it has no pins."""
    if not robot.pins:
        return ""
    places = "; ".join(_pin_text(pin) for pin in robot.pins)
    drawn = ", dotted on the map" if robot.body.mesh.dim == 2 else ""
    return f"The simulation holds the robot {places} (coordinates of the robot file{drawn}): clamp or strap it there."


def _pin_text(pin: Pin) -> str:
    if pin.box is not None:
        axes = zip("xyz", *pin.box, strict=False)
        spans = ", ".join(f"{axis} {_mm(min(one, two))} to {_mm(max(one, two))}" for axis, one, two in axes)
        return f"within {spans} mm"
    at = ", ".join(f"{axis} {_mm(value)}" for axis, value in zip("xyz", pin.at or (), strict=False))
    return f"around {at} mm" + (f", up to {_mm(pin.radius)} mm from there" if pin.radius else "")


def _mm(value: float) -> str:
    return f"{1e3 * value:z.0f}".replace("-", "−")


def cables_text(cables: Iterable[str]) -> str:
    """Cables in a row: C1; C1 and C2; C1 to C4; C1, C3 and C7."""
    numbers = [int(cable.removeprefix("C")) for cable in cables]
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = [
        word
        for run in runs
        for word in ([f"C{run[0]} to C{run[-1]}"] if len(run) > 2 else [f"C{number}" for number in run])
    ]
    return list_words(words)


def marks_on(plan: KitPlan, mount: Mount) -> tuple[str, ...]:
    """Marks of the winches that are mounted so."""
    marks = winch_marks_of(plan.robot)
    return tuple(marks[winch.name] for winch in plan.robot.winches if winch.mount is mount)


def stretch_steps(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    """The step that stretches new line before it is cut; none without cables."""
    if not plan.robot.cables:
        return ()
    mass = line_for(plan.options.parts.cable).stretch_mass
    words = (
        f"Hang the uncut line from a hook with a bottle of {mass:g} L of water at its end. Hang a line that is too "
        "long in several pieces. New braid gets longer under load: cables would go slack in the first days."
    )
    return (AssemblyStep("Stretch the line", 5, words, wait="24 h under this weight"),)


def winch_steps(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    """Steps for the winches: put together, on the base, then in a body of foam; into plush they go with the filling."""
    inside, outside = marks_on(plan, Mount.BODY), marks_on(plan, Mount.WORLD)
    count, has_horn = len(inside) + len(outside), plan.rigid.motor.horn is not None
    steps = []
    if count:
        steps.append(
            AssemblyStep(
                "Put the winches together",
                15 * count,
                f"Build {plural(count, 'winch')} as drawn on page 2, each from its own files (see Parts), and write "
                "its mark on each. Screw the plate onto the "
                f"motor{' and the coupling onto its horn' if has_horn else ''}. "
                f"Push the spool on, then screw the housing on: {_housing_screws(plan)}.",
            )
        )
    steps += [_base_step(outside, plan.rigid.base)] if outside else []
    if inside and plan.method is Method.FOAM:
        steps.append(
            AssemblyStep(
                "Put winches in",
                10 * len(inside),
                f"Push {marks_text(inside)} into {'its pocket' if len(inside) == 1 else 'their pockets'} in the "
                f"{plan.cast_material}. Lead the wires out together; sew the skin around them.",
            )
        )
    if plan.rigid.seat_assembly is not None:
        steps.append(_seat_step(plan.robot, swapped=plan.options.parts.swap))
    elif (held := held_text(plan.robot)) and plan.method is not Method.PLUSH:
        steps.append(AssemblyStep("Hold it", 5, held))
    return tuple(steps)


def _housing_screws(plan: KitPlan) -> str:
    """Screws of the housings, such as "M2 x 12 mm for W1, M2 x 18 mm for W2 and W3"."""
    marks = winch_marks_of(plan.robot)
    kinds: dict[str, list[str]] = {}
    for unit in plan.rigid.units:
        kinds.setdefault(unit.housing.screw.title.partition(" mm")[0] + " mm", []).append(marks[unit.winch])
    if len(kinds) == 1:
        return next(iter(kinds))
    return ", ".join(f"{screw} for {marks_text(tuple(own))}" for screw, own in kinds.items())


def _base_step(outside: tuple[str, ...], base: BasePlate | None) -> AssemblyStep:
    held = (
        "Push each tube into its bore of the core plate, to the stop, with a drop of glue. Screws M3 x 25 come from "
        "below, wing nuts on top. Lead each tube to where its cable begins, bend radius at least 40 mm. "
        if base is not None and base.bare > 0
        else "Push each tube into its holder and lead it to where its cable begins, bend radius at least 40 mm. "
    )
    return AssemblyStep(
        "Build the base",
        5 + 10 * len(outside),
        f"Screw {marks_text(outside)} to the base plate (print it, or cut parts/base.svg from acrylic), legs below. "
        + held
        + "Fix both ends: only then does the tube keep the cable's length. The base may stand anywhere the tubes "
        "reach.",
    )


def _seat_step(robot: Robot, *, swapped: bool) -> AssemblyStep:
    another = " For a second core, print seat_cup again. To swap cores, untie the lines and undo the screws of the cup."
    ends = any(cable.bare[0] for cable in robot.cables)
    tubes = "up to the lip, where it ends" if ends else "through the plate and on to the body"
    return AssemblyStep(
        "Seat the body",
        30,
        "Screw the cup on its posts, the posts on the plate, the legs under it: screws M3. Push each tube from below "
        f"into its bore, {tubes}, with a drop of glue. Press the end of the body down to the floor of the cup, lines "
        "through its openings, and sew it there through the holes of the cup, all around. To hang the robot, hang the "
        "seat upside down from a shelf by its legs." + ("" if swapped else another),
    )


def turn_words(plan: KitPlan) -> str:
    """Sentences on who turns a spool before a computer does."""
    if plan.rigid.motor.bus:
        return "With the power off, turn the spools slowly by hand."
    return "To turn a geared motor, connect a 1.5 V cell to its two wires."


def tie_step(plan: KitPlan) -> AssemblyStep:
    """The step by which lines come on their spools."""
    robot = plan.robot
    back = [f"C{index + 1}" for index, cable in enumerate(robot.cables) if cable.reverse]
    then = "" if plan.method is Method.PLUSH else " Then calibrate."  # plush is calibrated once it is stuffed
    ways = f"all in one direction, but these in the other: {', '.join(back)}" if back else "all in one direction"
    return AssemblyStep(
        "Tie the cables on",
        5 * len(robot.cables),
        "Lead each line through its own channel of the housing; push its tube, if it has one, into the seat. Knot it "
        f"at the spool's tie hole so that the spool mark meets the spool. Wind the spare turns on, {ways}. "
        f"{turn_words(plan)}{then}",
    )


def marks_text(marks: tuple[str, ...]) -> str:
    """W1; W1 and W2; W1 to W4 if they follow each other."""
    numbers = [int(mark[1:]) for mark in marks]
    if len(numbers) > 2 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return f"{marks[0]} to {marks[-1]}"
    return list_words(marks)


def insert_steps(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    """Steps that put parts and rods into the body, and sheets on it; none without them."""
    inserts = [insert for insert in plan.inserts if insert.kind is not InsertKind.SHEET]
    sheets = [insert for insert in plan.inserts if insert.kind is InsertKind.SHEET]
    return (*_part_steps(plan, inserts), *(_sheet_step(plan, insert) for insert in sheets))


def _sheet_step(plan: KitPlan, insert: Insert) -> AssemblyStep:
    """Step that fixes a sheet on the skin."""
    flat = plan.robot.body.mesh.dim == 2
    sheet = plan.robot.sheets[int(insert.mark[1:]) - 1]
    faces = "; the face twice, once turned over" if flat and sheet.on is not SheetSide.OUTLINE else ""
    file = f"by pattern/sheet_{insert.mark}.svg or .dxf, which has no seam allowance{faces}"
    verb = "Sew" if plan.method is Method.PLUSH else "Glue"
    fixed = f"{verb} its rim on, so that it can wrinkle" if sheet.wrinkles else f"{verb} it on all over"
    words = f"Cut {insert.words} {file if flat else 'to the skin by eye'}. {fixed}, {insert.where}. Keep cables free."
    return AssemblyStep(f"Fix sheet {insert.mark}", 20, words)


def _part_steps(plan: KitPlan, inserts: Sequence[Insert]) -> tuple[AssemblyStep, ...]:
    """Step that puts parts and rods into the body; none without them."""
    if not inserts:
        return ()
    shown = 4  # parts and rods that are named; the list has all
    named = "; ".join(insert.words for insert in inserts[:shown]) + ("; ..." if len(inserts) > shown else "")
    rods = [insert for insert in inserts if insert.kind is InsertKind.ROD]
    sharp = " Sharp: round the ends of each rod and cap them." if rods else ""
    if plan.method is Method.PLUSH:
        channel = " Push each rod into a channel or tube that is sewn to the cloth along its line." if rods else ""
        tied = " Tie each part to the cloth in front and back." if len(rods) < len(inserts) else ""
        held = f"Set them where the map shows them (lists/inserts.csv).{tied}{channel}"
    else:
        held = "Hold them at their places (lists/inserts.csv) with pins or line through the wall, clear of the tubes."
    return (AssemblyStep(insert_title(inserts), 15 * len(inserts), f"Make {named}. {held}{sharp}"),)
