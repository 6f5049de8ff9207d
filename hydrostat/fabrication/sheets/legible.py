"""`Legible`: words of the user in letters that the fonts of the pages have, so that none prints as an empty box."""

import re
from functools import cache
from typing import Any

import typst

from hydrostat.fabrication.sheets.cable_map import winch_mark
from hydrostat.robot import Robot

FONTS = ("Libertinus Serif", "DejaVu Sans Mono")
"""Come with typst: Latin, Greek, Cyrillic, Hebrew, signs of mathematics."""

_MISSING = "?"
"""Stands for a letter that no font has."""

_NAMES = ("title", "name")
"""Under which facts have names: their signs stay."""

_PAGE = f'#set text(font: ("{FONTS[0]}", "{FONTS[1]}"))\n#set page(width: auto, height: auto)\n#sys.inputs.letter'

_SIGNS = ((r"(?<=\d) C\b", " °C"), (r"\^3\b", "³"), (r"\^2\b", "²"))
"""What lists and files write in plain letters, and how a page shows it."""

_POWER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]?\d+)\b")

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Legible:
    """Makes words of the user legible.

    Args:
        robot: whose winches are called by their marks if their names cannot be printed.
    """

    def __init__(self, robot: Robot) -> None:
        marks = {winch.name: winch_mark(index) for index, winch in enumerate(robot.winches) if lacking(winch.name)}
        self._marks = dict(sorted(marks.items(), key=lambda mark: (-len(mark[0]), mark[0])))
        self._robot = robot

    @property
    def warning(self) -> str:
        """What was replaced, a sentence; empty if nothing was."""
        told = []
        if lacking(self._robot.name):
            told.append(f'letters of the robot\'s name stand as "{_MISSING}"')
        if self._marks:
            told.append(f"{', '.join(sorted(self._marks.values()))} stand for names of winches")
        return f"the fonts of these pages lack letters: {'; '.join(told)}" if told else ""

    def words(self, words: str) -> str:
        """With a mark in place of a name that cannot be printed, and a question mark for every other such letter."""
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
    """With a question mark for every letter that cannot be printed."""
    lost = lacking(words)
    return "".join(_MISSING if letter in lost else letter for letter in words)


def lacking(words: str) -> frozenset[str]:
    """Letters of which the fonts that come with typst have no picture; spaces are not counted."""
    return frozenset(letter for letter in words if not letter.isspace() and not _drawn(letter))


def typeset(words: str) -> str:
    """With the signs of a printed page: °C, raised figures."""
    for plain, sign in _SIGNS:
        words = re.sub(plain, sign, words)
    return _POWER.sub(_power, words)


def _power(found: re.Match[str]) -> str:
    factor, power = found[1], f"10{str(int(found[2])).translate(_RAISED)}"
    return power if factor == "1" else f"{factor} × {power}"


@cache
def _drawn(letter: str) -> bool:
    """Whether a letter can be printed: a page for archives (PDF/A) is refused where no font has it."""
    if letter.isascii():
        return letter.isprintable()
    try:
        typst.compile(
            _PAGE.encode(), sys_inputs={"letter": letter}, ignore_system_fonts=True, pdf_standards=["a-2b"], timestamp=0
        )
    except RuntimeError:
        return False
    return True
