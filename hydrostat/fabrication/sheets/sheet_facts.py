"""`sheet_facts`: the words and numbers of a sheet, as plain data for its template."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby

from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.kit_plan import KitFindings, KitPlan
from hydrostat.fabrication.lists.cuts import AT_BODY
from hydrostat.fabrication.lists.lists import Lists
from hydrostat.fabrication.lists.table import Align, Table
from hydrostat.fabrication.moulds.mould import Mold
from hydrostat.fabrication.patterns.stitches import CableStitches
from hydrostat.fabrication.sheets.bench_words import list_calibration, list_hazards, list_last_checks
from hydrostat.fabrication.sheets.facts import MoldFacts, SheetFacts, StepFacts, TableFacts, WinchFacts
from hydrostat.fabrication.sheets.foam_steps import cure_times, other_way
from hydrostat.fabrication.sheets.legible import note_lines, sentence, shorten_text
from hydrostat.fabrication.sheets.list_facts import bill_facts, cost_text, piece_facts, power_facts, winch_files
from hydrostat.fabrication.sheets.steps import AssemblyStep, minutes_text
from hydrostat.fabrication.sheets.summary import all_steps, summary_rows
from hydrostat.fabrication.winch_marks import winch_marks_of
from hydrostat.units import plural

_NAME, _SHORT = 60, 26  # longest name of the robot, of a winch, in letters

_KINDS = {Method.PLUSH: "Plush robot", Method.FOAM: "Foam robot", Method.PRINT: "Printed robot"}
_POURS = ("first", "second")

_CABLES = {"cable": "cable", "cut": "cut to", "slack": "slack", "spool_mark": "spool mark"}
"""Fields of the list of cables that the sheet shows, with their headings there."""

_TUBES = {"cable": "cable", "start": "from", "end": "to", "length": "cut to"}
"""The same of the list of tubes."""

_PLACES = {AT_BODY: "body"}  # short names of places for the sheet, which has less room than the list of tubes


def sheet_facts(plan: KitPlan, lists: Lists, findings: KitFindings, *, letters: str = "") -> SheetFacts:
    """All words and numbers, long ones shortened; `letters`: a sentence on letters that cannot be printed."""
    steps, mould, stitches = all_steps(plan, lists), plan.work.mould, shown_stitches(plan)
    told = (*((letters,) if letters else ()), *findings.warnings, *findings.notes)
    return {
        "paper": plan.options.paper.value,
        "method": plan.method.value,
        "title": shorten_text(plan.robot.name, _NAME),
        "pairs": plan.pairs,
        "inserts": bool(plan.inserts),
        "flat": plan.robot.body.mesh.dim == 2,
        "kind": "Silicone robot" if plan.is_silicone else _KINDS[plan.method],
        "facts": _about(plan, lists, steps),
        "summary": [{"title": title, "lines": list(lines)} for title, lines in summary_rows(plan, lists)],
        "mind": note_lines(findings.problems, told, plan.robot),
        "forced": bool(findings.problems),
        "bill": bill_facts(lists),
        "cables": _table(lists.cables, _CABLES),
        "log": [f"C{number}" for number in range(1, len(plan.robot.cables) + 1)],
        "calibration": list_calibration(plan),
        "safety": list_hazards(plan),
        "checklist": list_last_checks(plan),
        "tubes": _table(lists.tubes, _TUBES),
        "winches": _winches(plan),
        "pieces": piece_facts(plan),
        "shown": f"C{stitches.cable}" if stitches else "",
        "motor": shorten_text(plan.rigid.motor.title, 80),
        "steps": [[_step(step) for step in page] for page in steps],
        "checks": [
            {"what": check.what, "measured": check.measured, "allowed": check.allowed, "passed": check.passed}
            for check in findings.checks
        ],
        "mould": _mould(mould),
        "power": power_facts(lists.power, plan.robot, plan.options.cautions),
        "other_way": list(other_way(mould)) if mould else [],
        "cures": [list(cure) for cure in cure_times(mould)],
    }


def shown_stitches(plan: KitPlan) -> CableStitches | None:
    """Stitches of the cable that is drawn: of those with the most holes the first."""
    sewn = [stitches for stitches in plan.work.stitches if stitches.passes]
    return max(sewn, key=lambda stitches: (len(stitches.passes), -stitches.cable)) if sewn else None


def _about(plan: KitPlan, lists: Lists, steps: Iterable[Iterable[AssemblyStep]]) -> list[str]:
    """Size, parts, time and cost of a robot, a line each."""
    robot = plan.robot
    nodes = 1e3 * robot.body.mesh.nodes
    sides = [*(nodes.max(axis=0) - nodes.min(axis=0)).tolist()]
    if robot.body.thickness is not None:
        sides.append(1e3 * robot.body.thickness)
    busy = sum(step.minutes for page in steps for step in page)
    return [
        " × ".join(f"{side:.0f}" for side in sides) + " mm",
        f"{plural(len(robot.winches), 'winch')}, {plural(len(robot.cables), 'cable')}"
        + (f" in {plural(plan.pairs, 'pair')}" if plan.pairs else ""),
        f"about {minutes_text(busy)} of work",
        *cost_text(lists),
    ]


def _table(table: Table, headings: Mapping[str, str]) -> TableFacts | None:
    """Some fields of a list, as text, under such headings; None if it has no row."""
    if not table.rows:
        return None
    columns = [[_short_place(text) for text in table.texts_of(field)] for field in headings]
    return {
        "file": f"lists/{table.name}.csv",
        "heads": list(headings.values()),
        "right": [table.columns[field].align is Align.RIGHT for field in headings],
        "rows": [list(row) for row in zip(*columns, strict=True)],
    }


def _short_place(text: str) -> str:
    """A text of a list in short; what stands in brackets after the number of a point is seen on the map."""
    return shorten_text(_PLACES.get(text, text).partition(" (")[0], 20)


def _winches(plan: KitPlan) -> list[WinchFacts]:
    """Mark, name, cables and spool of each winch."""
    robot, marks = plan.robot, winch_marks_of(plan.robot)
    return [
        {
            "mark": marks[winch.name],
            "files": ", ".join(winch_files(plan, winch.name)),
            "name": shorten_text(winch.name, _SHORT),
            "cables": ", ".join(
                _runs([i for i, cable in enumerate(robot.cables, start=1) if cable.winch == winch.name])
            ),
            "spool": f"{2e3 * robot.largest_spool(winch):.3g}",
        }
        for winch in robot.winches
    ]


def _runs(numbers: Iterable[int]) -> Iterator[str]:
    """Names of cables in their order, more than three in a row as one: C2 to C5."""
    for _, group in groupby(enumerate(numbers), key=lambda pair: pair[1] - pair[0]):
        row = [number for _, number in group]
        if len(row) > 3:
            yield f"C{row[0]} to C{row[-1]}"
        else:
            yield from (f"C{number}" for number in row)


def _step(step: AssemblyStep) -> StepFacts:
    return {"title": step.title, "time": step.time, "text": step.text}


def _mould(mould: Mold | None) -> MoldFacts | None:
    """Facts of a mold that are not in its steps."""
    if mould is None:
        return None
    body, casting = mould.casting.body, mould.casting
    amounts = [
        ["closed mold", " × ".join(f"{side:.0f}" for side in mould.box) + " mm"],
        ["to be filled", f"{body.volume / 1e3:.0f} ml"],
        [f"{body.material}, part A", f"{body.part_a:.0f} g"],
        [f"{body.material}, part B", f"{body.part_b:.0f} g"],
        *(
            [f"{mix.material}, {which} pour", f"{mix.mass:.0f} g"]
            for mix, which in zip(casting.silicone, _POURS, strict=False)
        ),
        *([["grows to", f"{casting.expansion:.1f} times its volume"]] if casting.expansion > 1 else []),
    ]
    return {
        "undercut": _undercut(mould.pull.share),
        "amounts": amounts,
        "ratio": sentence(body.ratio),
        "pieces": [f"{number} {placed.title}" for number, placed in enumerate(mould.assembly.pieces, start=1)],
    }


def _undercut(share: float) -> str:
    if share < 5e-4:
        return "The arrow is the pull direction. The whole surface slides out."
    return (
        f"The arrow is the pull direction. Hatched: {100 * share:.1f} % of the surface, which cannot slide out. "
        "Squeeze the body there."
    )
