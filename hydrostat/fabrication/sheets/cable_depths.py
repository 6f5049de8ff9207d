"""`CableDepths`: how each cable of a body in space is put in, as the list of stitches has it."""

from collections.abc import Iterable
from dataclasses import dataclass

from hydrostat.fabrication.lists.stitching import SKIN
from hydrostat.fabrication.sheets.sheet_input import SheetInput

_NEEDLE, _LAID = "long needle", "tube laid before casting"
_IN_TUBE = ("in its tube", "end of its tube")


@dataclass(frozen=True, kw_only=True)
class CableDepths:
    """Names of cables, C1, C2, ...

    Attributes:
        sewn: those that are sewn to the skin all along.
        drawn: those that are drawn through the body at some points.
        laid: those of which a point is too deep for a needle: a tube is laid before casting.
        tubed: those whose own tube runs in the body, deeper than the skin.
    """

    sewn: tuple[str, ...] = ()
    drawn: tuple[str, ...] = ()
    laid: tuple[str, ...] = ()
    tubed: tuple[str, ...] = ()

    @classmethod
    def of(cls, given: SheetInput) -> "CableDepths":
        """From the list; without one all cables are sewn on."""
        table = given.tables.get("stitching")
        titles = [column.title for column in table.columns] if table else []
        if table is None or "how" not in titles or "depth" not in titles:
            return cls(sewn=tuple(f"C{number}" for number in range(1, len(given.robot.cables) + 1)))
        found: dict[str, set[str]] = {}
        for cable, how, depth in zip(*(table.column(title) for title in ("cable", "how", "depth")), strict=True):
            deep = how in _IN_TUBE and isinstance(depth, float | int) and depth > SKIN
            found.setdefault(str(cable), set()).add("tube" if deep else str(how))
        inside = {_NEEDLE, _LAID}
        return cls(
            sewn=tuple(cable for cable, hows in found.items() if not hows & {*inside, "tube"}),
            drawn=tuple(cable for cable, hows in found.items() if _NEEDLE in hows),
            laid=tuple(cable for cable, hows in found.items() if _LAID in hows),
            tubed=tuple(cable for cable, hows in found.items() if "tube" in hows),
        )


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
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""
