"""`PrintableText`, `note_lines`: texts of users and checks, shortened and in letters that the fonts of a page have."""

import re
from functools import cache
from typing import Any

from hydrostat.errors import in_words
from hydrostat.fabrication.winch_marks import winch_marks_of
from hydrostat.robot import Robot

FONTS = ("Libertinus Serif", "DejaVu Sans Mono")
"""Come with typst: Latin, Greek, Cyrillic, Hebrew, signs of mathematics."""

_MISSING = "?"  # stands for a letter that no font has
_NAMES = ("title", "name")  # under which facts have names: their signs stay

_PAGE = f'#set text(font: ("{FONTS[0]}", "{FONTS[1]}"))\n#set page(width: auto, height: auto)\n#sys.inputs.letter'

_SIGNS = ((r"(?<=\d) C\b", " °C"), (r"\^3\b", "³"), (r"\^2\b", "²"))
"""Units in the plain letters of lists and files, and in the signs of a page."""

_POWER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]?\d+)\b")

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class PrintableText:
    """Text of the user with every letter printable.

    Args:
        robot: robot with the winches; their marks replace names that cannot be printed.
    """

    def __init__(self, robot: Robot) -> None:
        marks = {name: mark for name, mark in winch_marks_of(robot).items() if lacking(name)}
        self._marks = dict(sorted(marks.items(), key=lambda mark: (-len(mark[0]), mark[0])))
        self._robot = robot

    @property
    def warning(self) -> str:
        """A sentence on replaced letters; empty if none was replaced."""
        told = []
        if lacking(self._robot.name):
            told.append(f'letters of the robot\'s name stand as "{_MISSING}"')
        if self._marks:
            told.append(f"{', '.join(sorted(self._marks.values()))} stand for names of winches")
        return f"the fonts of these pages lack letters: {'; '.join(told)}" if told else ""

    def words(self, words: str) -> str:
        """Words with marks for names that cannot be printed, and a question mark for every other such letter."""
        for name, mark in self._marks.items():
            words = words.replace(name, mark)
        return legible(words)

    def facts(self, facts: Any) -> Any:
        """The same of all words in plain data, with the signs of a printed page."""
        if isinstance(facts, str):
            return typeset(self.words(facts))
        if isinstance(facts, dict):
            return {key: self.words(value) if key in _NAMES else self.facts(value) for key, value in facts.items()}
        return [self.facts(value) for value in facts] if isinstance(facts, list | tuple) else facts


def legible(words: str) -> str:
    """Words with a question mark for every letter that cannot be printed."""
    lost = lacking(words)
    return "".join(_MISSING if letter in lost else letter for letter in words)


def lacking(words: str) -> frozenset[str]:
    """Letters of which the fonts that come with typst have no picture; spaces are not counted."""
    return frozenset(letter for letter in words if not letter.isspace() and not _is_printable(letter))


def typeset(words: str) -> str:
    """Words with the signs of a printed page: °C, raised figures."""
    for plain, sign in _SIGNS:
        words = re.sub(plain, sign, words)
    return _POWER.sub(_power, words)


def _power(found: re.Match[str]) -> str:
    factor, power = found[1], f"10{str(int(found[2])).translate(_RAISED)}"
    return power if factor == "1" else f"{factor} × {power}"


@cache
def _is_printable(letter: str) -> bool:
    """Return True if a letter can be printed: typst rejects a PDF/A page if no font has the letter."""
    if letter.isascii():
        return letter.isprintable()
    import typst  # Imported here: few names need it.

    try:
        typst.compile(
            _PAGE.encode(), sys_inputs={"letter": letter}, ignore_system_fonts=True, pdf_standards=["a-2b"], timestamp=0
        )
    except RuntimeError:
        return False
    return True


_MAX_SENTENCE_LETTERS, _MAX_SENTENCES = 640, 7  # longest sentence in letters, and most sentences

_PLACE = re.compile(r"\[[^\]]*\]")
_CLOTH = re.compile(r"\b(cloth|seam|felt|fabric|snip|notch|skin)", re.IGNORECASE)
_MOTOR = re.compile(r"\b(motor|torque|N mm)\b")


def note_lines(problems: tuple[str, ...], warnings: tuple[str, ...], robot: Robot | None = None) -> list[str]:
    """Return problems first, then warnings on motors, on fits, on cloth, and the number of those left out."""
    ranked = (*merge_sentences(problems), *sorted(merge_sentences(warnings), key=_rank))
    ordered = [_mark_winches(in_words(words), robot) for words in ranked]
    shown = [shorten_text(sentence(words), _MAX_SENTENCE_LETTERS) for words in ordered[:_MAX_SENTENCES]]
    if len(ordered) > _MAX_SENTENCES:
        shown.append(f"… and {len(ordered) - _MAX_SENTENCES} more in manifest.json")
    return shown


def _mark_winches(words: str, robot: Robot | None) -> str:
    """Words with the mark of each winch before its name, as it stands on the map."""
    for name, mark in (winch_marks_of(robot) if robot else {}).items():
        if not lacking(name):  # else the mark will stand in its place
            words = words.replace(f'"{name}"', f'{mark} "{name}"')
    return words


def _rank(words: str) -> int:
    return 0 if _MOTOR.search(words) else 2 if _CLOTH.search(words) else 1


def merge_sentences(sentences: tuple[str, ...]) -> list[str]:
    """Merge sentences that differ only in one place in brackets into one with all places."""
    kinds: dict[str, list[str]] = {}
    for words in dict.fromkeys(sentences):
        key = _PLACE.sub("[]", words) if len(_PLACE.findall(words)) == 1 else words
        kinds.setdefault(key, []).append(words)
    told = []
    for alike in kinds.values():
        places = [place[0] for words in alike if (place := _PLACE.search(words))]
        told.append(_PLACE.sub(", ".join(places), alike[0]) if len(alike) > 1 else alike[0])
    return told


def sentence(words: str) -> str:
    """Words with a capital letter in front and a full stop behind."""
    line = " ".join(words.split())
    return line and line[0].upper() + line[1:] + ("" if line.endswith((".", "!", "?")) else ".")


def shorten_text(text: str, most: int) -> str:
    """Shorten a text to one line of a largest number of letters; a longer one ends with an ellipsis."""
    line = " ".join(text.split())
    return line if len(line) <= most else line[: most - 1].rstrip() + "…"
