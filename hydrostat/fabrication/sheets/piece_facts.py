"""`piece_facts`: every piece of a kit with its number on the pictures, its files, and how many are needed."""

from hydrostat.fabrication.sheets.bill_facts import Facts
from hydrostat.fabrication.sheets.minds import shortened
from hydrostat.fabrication.sheets.sheet_input import SheetInput
from hydrostat.fabrication.solids.assembly import Placed
from hydrostat.fabrication.solids.printed import Printed

_OF_ONE, _OF_MANY, _OF_ALL = " of winch ", " of winches ", " of every winch"
"""How the title of a printed part says for which winches it is."""

_BOUGHT = " (bought)"


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


def piece_facts(given: SheetInput) -> list[Facts]:
    """Every piece of the pictures with its number and how many are needed in all, then what else is printed."""
    units = (len(given.robot.winches), len(given.robot.cables))
    kinds: dict[str, list[Printed]] = {}
    for part in given.printed:
        kinds.setdefault(_kind_of(part, given), []).append(part)
    pieces: dict[int, Facts] = {}
    for assembly, numbers, unit in zip((given.winch, given.stopper), piece_numbers(given), units, strict=True):
        for placed in assembly.pieces if assembly else ():
            entry = pieces.setdefault(numbers[placed.name], {"title": _called(placed), "count": 0, "files": ""})
            if placed.printed and placed.title in kinds:
                entry |= _told(kinds.pop(placed.title))
            elif not entry["files"]:
                entry["count"] += unit
                entry["title"] += "" if placed.printed or entry["title"].endswith(_BOUGHT) else _BOUGHT
    drawn = [{"number": str(number), **entry} for number, entry in pieces.items()]
    rest = [{"number": "", "title": kind, **_told(parts)} for kind, parts in kinds.items()]
    return [{**entry, "count": str(entry["count"])} for entry in (*drawn, *rest)]


def winch_files(given: SheetInput, winch: str) -> list[str]:
    """Stems of the files that a winch does not share with all others."""
    found = []
    for part in given.printed:
        kind, _, names = part.title.partition(_OF_MANY)
        if names:
            mine = f", {winch}, " in f", {names}, "
        else:
            kind, _, name = part.title.partition(_OF_ONE)
            mine = name == winch
        if kind and mine and len(given.robot.winches) > 1:
            found.append(part.name)
    return found


def _told(parts: list[Printed]) -> Facts:
    """How many of a kind, and from which files."""
    files = [part.name + (f" × {part.count}" if len(parts) > 1 and part.count > 1 else "") for part in parts]
    return {"count": sum(part.count for part in parts), "files": shortened(", ".join(files), 90)}


def _kind_of(part: Printed, given: SheetInput) -> str:
    """What a printed part is called in the list."""
    kind = _kind(part.title)
    if given.mould and part.name in {piece.name for piece in given.mould.printed} and "positive" not in kind:
        kind = f"Mould, {kind[:1].lower()}{kind[1:]}"
    optional = ", optional" if part.name.startswith("grommet") else ""
    return shortened(kind[:1].upper() + kind[1:], 44) + optional


def _called(placed: Placed) -> str:
    """A bought piece without its details, which are in the bill."""
    return placed.title if placed.printed else placed.title.partition(",")[0]


def _kind(title: str) -> str:
    """What a printed part is, without for which winches, or which of several pieces."""
    for mark in (" of winch", " of every winch", ", piece", ", part"):
        title = title.partition(mark)[0]
    return title.removeprefix("mould, ").removeprefix("Mould, ")
