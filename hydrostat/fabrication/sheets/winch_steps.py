"""Steps that robots of plush and of foam share: winches in the body and on their base, cables tied on."""

from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.sheets.cable_map import winch_mark
from hydrostat.fabrication.sheets.held import held_text
from hydrostat.fabrication.sheets.sheet_input import SheetInput
from hydrostat.fabrication.sheets.step import Step, count_text
from hydrostat.robot import Mount


def marks_on(given: SheetInput, mount: Mount) -> tuple[str, ...]:
    """Marks of the winches that are mounted so."""
    return tuple(winch_mark(index) for index, winch in enumerate(given.robot.winches) if winch.mount is mount)


def winch_steps(given: SheetInput) -> tuple[Step, ...]:
    """Put them together, set those on the base, then those in a body of foam; into plush they go with the filling."""
    inside, outside = marks_on(given, Mount.BODY), marks_on(given, Mount.WORLD)
    count = len(inside) + len(outside)
    steps = []
    if count:
        steps.append(
            Step(
                "Put the winches together",
                15 * count,
                f"Build {count_text(count, 'winch', 'winches')} as drawn on page 1, each with its own files (see "
                "Parts), and write the mark on it. Turn every motor to its zero before the spool goes on.",
            )
        )
    if outside:
        steps.append(_base_step(outside))
    if inside and given.method is Method.FOAM:
        steps.append(
            Step(
                "Put winches in",
                10 * len(inside),
                f"Push {marks_text(inside)} into {'its pocket' if len(inside) == 1 else 'their pockets'} in the foam. "
                "Lead the wires out together; sew the skin round them.",
            )
        )
    if (held := held_text(given.robot)) and given.method is Method.FOAM:
        steps.append(Step("Hold it", 5, held))
    return tuple(steps)


def _base_step(outside: tuple[str, ...]) -> Step:
    return Step(
        "Build the base",
        5 + 10 * len(outside),
        f"Screw {marks_text(outside)} to the base plate (print it, or cut parts/base.svg from acrylic), legs below. "
        "Push each tube into its holder and lead it to where its cable begins, in wide bends, none tighter than a cup. "
        "Hold both ends: only so does the tube keep the cable's length. The base stands anywhere the tubes reach.",
    )


def tie_step(cables: int) -> Step:
    """Lines come on their spools."""
    return Step(
        "Tie the cables on",
        5 * cables,
        "Lead each line through its own channel of the housing; push its tube, if it has one, into the seat. Knot it "
        "at the spool's tie hole so that the spool mark meets the spool. Wind the spare turns on, all the same way. "
        "Then calibrate.",
    )


def marks_text(marks: tuple[str, ...]) -> str:
    """W1; W1 and W2; W1 to W4 if they follow each other."""
    numbers = [int(mark[1:]) for mark in marks]
    if len(numbers) > 2 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return f"{marks[0]} to {marks[-1]}"
    return marks[0] if len(marks) == 1 else f"{', '.join(marks[:-1])} and {marks[-1]}"
