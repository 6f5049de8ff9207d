"""`sheet_text`: the words of an assembly sheet as plain text, for screen readers and editors."""

from collections.abc import Iterable, Iterator

from hydrostat.fabrication.sheets.facts import SheetFacts, TableFacts


def sheet_text(facts: SheetFacts) -> str:
    """Paragraphs of one line each, under headings; tables as sentences. Pictures are left out."""
    return "\n".join([*_lines(facts), ""])


def _lines(facts: SheetFacts) -> Iterator[str]:
    yield f"{facts['title']}. {facts['kind']}, assembly sheet as text"
    yield from _section("Before you begin", (f"{row['title']}: {' '.join(row['lines'])}" for row in facts["summary"]))
    yield from _section("Warnings", facts["mind"])
    yield from _section("Safety", facts["safety"])
    yield from _table("You need", facts["bill"])
    yield from _section(
        "Winches",
        (
            f"{winch['mark']} {winch['name']}: {winch['cables']}, spool {winch['spool']} mm"
            for winch in facts["winches"]
        ),
    )
    yield from _section(
        "Parts",
        (f"{piece['title']}: {piece['count']}. {piece['files']}".removesuffix(". ") for piece in facts["pieces"]),
    )
    if facts["mould"] is not None:
        amounts = (": ".join(row) for row in facts["mould"]["amounts"])
        yield from _section("The mold", (*amounts, facts["mould"]["ratio"], facts["mould"]["undercut"]))
    steps = [step for page in facts["steps"] for step in page]
    yield from _number_lines("Steps", (f"{step['title']} ({step['time']}). {step['text']}" for step in steps))
    yield from _section("Cures", (": ".join(row) for row in facts["cures"]))
    yield from _table("Cables, in mm", facts["cables"])
    yield from _table("Tubes, in mm", facts["tubes"])
    yield from _section(
        "Holes", ["For their positions, and the side on which each cable continues, see lists/stitching.csv"]
    )
    yield from _number_lines("Calibrate", facts["calibration"])
    yield from _section("Before the first pose", facts["checklist"])
    power = facts["power"]
    if power is not None:
        yield from _section("Power", (": ".join(row) for row in power["rows"]))
        yield from _section("Wires", power["warnings"])
        heads = power["heads"]
        yield from _table(power["title"], {"file": "", "heads": heads, "right": [], "rows": power["pins"]})
        yield from _number_lines("First start", power["start"])
    told = (
        f"{'passed' if check['passed'] else 'FAILED'}: {check['what']}, {check['measured']} "
        f"(allowed: {check['allowed']})"
        for check in facts["checks"]
    )
    yield from _section("Quality checks", told)


def _section(title: str, lines: Iterable[str]) -> Iterator[str]:
    """A heading after an empty line, and its paragraphs; nothing without any."""
    found = list(lines)
    if found:
        yield from ("", title.upper(), *found)


def _number_lines(title: str, lines: Iterable[str]) -> Iterator[str]:
    return _section(title, (f"{number}. {line}" for number, line in enumerate(lines, start=1)))


def _table(title: str, table: TableFacts | None) -> Iterator[str]:
    """Each row as a sentence that repeats the headings after the first."""
    if table is None:
        return
    rows = (
        ", ".join([first, *(f"{head} {cell}" for head, cell in zip(table["heads"][1:], cells, strict=True) if cell)])
        for first, *cells in table["rows"]
    )
    yield from _section(title, rows)
