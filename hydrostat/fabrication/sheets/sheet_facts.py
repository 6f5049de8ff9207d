"""`sheet_facts`: the words and numbers of a sheet, as plain data for its template."""

from collections.abc import Iterable, Mapping

from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.lists.table import Align, Table
from hydrostat.fabrication.moulds.mould import Mould
from hydrostat.fabrication.moulds.mould_options import MouldKind
from hydrostat.fabrication.patterns.stitches import CableStitches
from hydrostat.fabrication.sheets import foam_steps, plush_steps
from hydrostat.fabrication.sheets.bill_facts import Facts, bill_facts, cost_of, shortened
from hydrostat.fabrication.sheets.cable_map import winch_letter
from hydrostat.fabrication.sheets.sheet_input import SheetInput
from hydrostat.fabrication.sheets.step import Step, count_text, minutes_text
from hydrostat.fabrication.solids.assembly import Placed

_NAME, _SHORT, _SENTENCE = 60, 26, 260
"""Longest name of the robot, of a winch, of a sentence, in letters."""

_MOST_MINDS = 7
"""Sentences in the box on the first page."""

_POURS = ("first", "second")

_CABLES = {
    "cable": "cable",
    "cut to": "cut to",
    "stopper from exit": "stopper",
    "slack": "slack",
    "spool mark from end": "spool mark",
}
"""Columns of the list of cables, and what the sheet calls them."""

_TUBES = {"cable": "cable", "from": "from", "to": "to", "cut to": "cut to"}
"""The same of the list of tubes."""

_PLACES = {"where the cable begins": "body"}
"""What the list of tubes calls a place, and the sheet, which has less room."""


def sheet_facts(given: SheetInput) -> Facts:
    """All words and numbers, long ones shortened."""
    plush = given.method is Method.PLUSH
    steps = _all_steps(given)
    return {
        "paper": given.paper.value,
        "method": given.method.value,
        "title": shortened(given.robot.name, _NAME),
        "kind": "Plush robot" if plush else "Foam robot",
        "facts": _about(given, steps),
        "mind": _minds(given),
        "forced": bool(given.problems),
        "bill": bill_facts(given),
        "cables": _table(given, "cable_cuts", _CABLES),
        "log": [f"C{number}" for number in range(1, len(given.robot.cables) + 1)],
        "tubes": _table(given, "sheath_cuts", _TUBES),
        "winches": _winches(given),
        "pieces": _pieces(given),
        "shown": f"C{stitches.cable}" if (stitches := shown_stitches(given)) else "",
        "motor": shortened(given.motor, 80),
        "steps": [[_step(step) for step in page] for page in steps],
        "calibration": list(plush_steps.calibration(outside=given.outside)),
        "safety": list(plush_steps.PLUSH_SAFETY if plush else foam_steps.foam_safety(given.mould)),
        "checklist": list(plush_steps.PLUSH_CHECKLIST if plush else foam_steps.FOAM_CHECKLIST),
        "checks": [
            {"what": check.what, "measured": check.measured, "allowed": check.allowed, "passed": check.passed}
            for check in given.checks
        ],
        "mould": _mould(given.mould),
        "silicone_steps": list(foam_steps.SILICONE_STEPS),
        "cures": [list(cure) for cure in foam_steps.cures(given.mould)],
    }


def shown_stitches(given: SheetInput) -> CableStitches | None:
    """Of the cable whose stitches are drawn: of those with the most holes the first."""
    sewn = [stitches for stitches in given.stitches if stitches.passes]
    return max(sewn, key=lambda stitches: (len(stitches.passes), -stitches.cable)) if sewn else None


def _all_steps(given: SheetInput) -> list[tuple[Step, ...]]:
    """The steps, page by page."""
    if given.method is Method.PLUSH:
        return [plush_steps.plush_steps(given)]
    before = [foam_steps.mould_steps(given, given.mould)] if given.mould is not None else []
    return [*before, foam_steps.skin_steps(given)]


def _about(given: SheetInput, steps: Iterable[Iterable[Step]]) -> list[str]:
    """What kind of robot it is, a line each."""
    robot = given.robot
    nodes = 1e3 * robot.body.mesh.nodes
    sides = [*(nodes.max(axis=0) - nodes.min(axis=0)).tolist()]
    if robot.body.thickness is not None:
        sides.append(1e3 * robot.body.thickness)
    busy = sum(step.minutes for page in steps for step in page)
    cost = cost_of(given)
    return [
        " × ".join(f"{side:.0f}" for side in sides) + " mm",
        f"{count_text(len(robot.winches), 'winch', 'winches')}, {count_text(len(robot.cables), 'cable')}",
        f"about {minutes_text(busy)} of work" + (f", {cost:.0f} USD" if cost is not None else ""),
    ]


def _minds(given: SheetInput) -> list[str]:
    """Problems first, then warnings; how many more there are, if there are many."""
    sentences = [*given.problems, *given.warnings]
    shown = [shortened(sentence(words), _SENTENCE) for words in sentences[:_MOST_MINDS]]
    if len(sentences) > _MOST_MINDS:
        shown.append(f"… and {len(sentences) - _MOST_MINDS} more in manifest.json")
    return shown


def _table(given: SheetInput, name: str, titles: Mapping[str, str]) -> Facts | None:
    """Some columns of a list, as text; all of them if it has none of these. None if there is no such list or no row."""
    table: Table | None = given.tables.get(name)
    if table is None or not table.rows:
        return None
    known = [column.title for column in table.columns]
    places = [known.index(title) for title in titles if title in known] or list(range(len(known)))
    return {
        "file": f"{name}.csv",
        "heads": [titles.get(known[place], table.columns[place].heading) for place in places],
        "right": [table.columns[place].align is Align.RIGHT for place in places],
        # What stands in brackets after the number of a point is seen on the map.
        "rows": [
            [shortened(_PLACES.get(row[place], row[place]).partition(" (")[0], 20) for place in places]
            for row in table.texts
        ],
    }


def _winches(given: SheetInput) -> list[Facts]:
    """Letter, name, cables and spool of each winch."""
    robot = given.robot
    return [
        {
            "letter": winch_letter(index),
            "name": shortened(winch.name, _SHORT),
            "cables": ", ".join(
                f"C{number}" for number, cable in enumerate(robot.cables, start=1) if cable.winch == winch.name
            ),
            "spool": f"{2e3 * robot.largest_spool(winch):.3g}",
            "travel": f"{1e3 * winch.travel:.0f}",
        }
        for index, winch in enumerate(robot.winches)
    ]


def piece_numbers(given: SheetInput) -> tuple[dict[str, int], dict[str, int]]:
    """Numbers of the pieces of the winch and of the stopper by name; pieces of one title share a number."""
    numbers: list[dict[str, int]] = []
    count = 0
    for assembly in (given.winch, given.stopper):
        titles: dict[str, int] = {}
        for placed in assembly.pieces if assembly else ():
            if placed.title not in titles:
                count += 1
                titles[placed.title] = count
        numbers.append({placed.name: titles[placed.title] for placed in assembly.pieces} if assembly else {})
    return numbers[0], numbers[1]


def _pieces(given: SheetInput) -> list[Facts]:
    """Every piece of the pictures with its number and how many are needed in all, then what else is printed."""
    units = (len(given.robot.winches), len(given.robot.cables))
    of_mould = {part.name for part in given.mould.printed} if given.mould else set()
    kinds: dict[str, int] = {}
    for part in given.printed:
        kind = _kind(part.title)
        if part.name in of_mould and "positive" not in kind:
            kind = f"Mould, {kind[:1].lower()}{kind[1:]}"
        kind = kind[:1].upper() + kind[1:]
        kinds[kind] = kinds.get(kind, 0) + part.count
    pieces: dict[int, Facts] = {}
    for assembly, numbers, unit in zip((given.winch, given.stopper), piece_numbers(given), units, strict=True):
        for placed in assembly.pieces if assembly else ():
            number = numbers[placed.name]
            entry = pieces.get(number)
            if entry is None:
                entry = {"number": str(number), "title": _called(placed), "printed": placed.printed, "count": 0}
                pieces[number] = entry
            entry["count"] += 0 if placed.printed and placed.title in kinds else unit
    for entry in pieces.values():
        entry["count"] += kinds.pop(entry["title"], 0) if entry["printed"] else 0
    rest = [{"number": "", "title": title, "count": count, "printed": True} for title, count in kinds.items()]
    return [
        {**entry, "title": shortened(entry["title"], 44), "count": str(entry["count"])}
        for entry in (*pieces.values(), *rest)
    ]


def _called(placed: Placed) -> str:
    """A bought piece without its details, which are in the bill."""
    return placed.title if placed.printed else placed.title.partition(",")[0]


def _kind(title: str) -> str:
    """What a printed part is, without for which winches, or which of several pieces."""
    for mark in (" of winch", " of every winch", ", piece", ", part"):
        title = title.partition(mark)[0]
    return title.removeprefix("mould, ").removeprefix("Mould, ")


def _step(step: Step) -> Facts:
    return {"title": step.title, "time": step.time, "text": step.text}


def _mould(mould: Mould | None) -> Facts | None:
    """What is said of a mould beside its steps."""
    if mould is None:
        return None
    body, casting = mould.casting.body, mould.casting
    amounts = [
        ["closed mould", " × ".join(f"{side:.0f}" for side in mould.box) + " mm"],
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
        "silicone": mould.kind is MouldKind.SILICONE,
        "undercut": _undercut(mould.share),
        "amounts": amounts,
        "ratio": sentence(body.ratio),
        "release": sentence(casting.release),
        "pieces": [f"{number} {placed.title}" for number, placed in enumerate(mould.assembly.pieces, start=1)],
    }


def _undercut(share: float) -> str:
    if share < 5e-4:
        return "The arrow is the pull. All of the surface slides out."
    return (
        f"The arrow is the pull. Hatched: {100 * share:.1f} % of the surface cannot slide out. Squeeze the body there."
    )


def sentence(words: str) -> str:
    """Words with a capital letter in front and a full stop behind."""
    line = " ".join(words.split())
    return line and line[0].upper() + line[1:] + ("" if line.endswith((".", "!", "?")) else ".")
