"""Exceptions: every error that a user can cause is a `HydrostatError`."""

import re
from typing import Any

_LONG_WORD = re.compile(r"[^\s/\\]{120,}")


class HydrostatError(Exception):
    """Base of all errors of hydrostat. Its text is one line: place, problem, allowed values, fix.

    Very long words, which come from corrupt files, are cut to the maximum length of a file name.
    """

    def __init__(self, message: str = "") -> None:
        super().__init__(_LONG_WORD.sub(lambda word: f"{word[0][:40]}...", message))


class InputError(HydrostatError):
    """Wrong input: a file, a key, a value or an argument."""


GIVE_SIZE = 'give its size, e.g. --size 130mm, or size = "130 mm" in [body]'
"""Remedy for a drawing or surface without a credible size."""


class OutlineError(InputError):
    """Outline that cannot be a body: it is open, crosses itself, is empty or too thin."""


class SeveralPartsError(OutlineError):
    """Drawing of several closed shapes, none of which is surely the body.

    Attributes:
        parts: corners of each by its number, (corners, 2) [m].
    """

    def __init__(self, message: str, parts: dict[int, Any] | None = None) -> None:
        super().__init__(message)
        self.parts = parts or {}


class SurfaceError(InputError):
    """Surface that cannot be a body: it encloses nothing, is too thin for its elements, or is no surface at all."""


class NotConvergedError(HydrostatError):
    """Error of a solver that stopped before it reached its tolerance.

    Attributes:
        result: result of the solver, with its stop reason and the best point found.
    """

    def __init__(self, message: str, result: object) -> None:
        super().__init__(message)
        self.result = result


class HydrostatWarning(UserWarning):
    """Warning about a computed pose that the robot cannot take, such as one beyond the travel of a winch."""


NO_KIT = "no kit can be made of this body: "
"""Before a reason that holds whatever the winches and cables of a robot are."""

_START = r"(?<![\w./\\~\"'-])"
"""Start of a word that is no part of a path or a quote."""

_END = r"(?=[:,;)\s]|\.?$|\.\s)"
"""End of a word that is no part of a path."""

PART_KEYS = (
    "name|at|axis|slide|min|max|radius|box|stiffness|drive|spool_radius|travel|release|mount|body|winch|"
    "points|smoothing|slack|sheathed|friction|reverse|targets|shape|to|normal|mass|path|file|marker|force|"
    "pressure|moment|diameter|young|axial_stiffness|bending_stiffness|torsional_stiffness|material|thickness|"
    "on|wrinkles|kind|noise|label|rigid|density"
)
"""Keys of the parts of a robot in its file. Other words after a part and a dot may be the name of a file."""

_QUOTED = re.compile(r'("[^"]*")')
_NAMED = re.compile(_START + r"(winch|marker)\[\d+\](?= )")
_POINT = re.compile(_START + r"cable\[(\d+)\]\.points\[(\d+)\]" + _END)
_RUN = re.compile(_START + r"cable\[(\d+)\] between points (\d+) and (\d+)")
_KINDS = "pin|winch|cable|marker|pose|part|rod|load|sensor|drive|obstacle|sheet"
_KEY = rf"\.(?=(?:{PART_KEYS})\b|\w+: unknown key)"
_PART = re.compile(_START + rf"(?:body\.)?({_KINDS})\[(\d+)\](?:({_KEY})|{_END})")


def in_words(text: str) -> str:
    """Sentence in plain words: "cable 1, point 3" for "cable[0].points[2]", "winch left" for "winch[0] left".

    Paths and quoted words stay as they are.
    """
    return "".join(words if words.startswith('"') else _count_from_one(words) for words in _QUOTED.split(text))


def _count_from_one(text: str) -> str:
    text = _POINT.sub(lambda match: f"cable {_next(match[1])}, point {_next(match[2])}", _NAMED.sub(r"\1", text))
    text = _RUN.sub(lambda run: f"cable {_next(run[1])} between points {_next(run[2])} and {_next(run[3])}", text)
    return _PART.sub(lambda match: f"{match[1]} {_next(match[2])}{', ' if match[3] else ''}", text)


def _next(number: str) -> int:
    return int(number) + 1
