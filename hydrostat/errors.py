"""Exceptions: every error that a user can cause is a `HydrostatError`."""

import re
from typing import Any

_LONG_WORD = re.compile(r"[^\s/\\]{120,}")


class HydrostatError(Exception):
    """Base of all errors of hydrostat. Its text is one line: place, problem, allowed values, fix.

    Words that are longer than the name of a file may be are cut: they come from broken files.
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
    """Solver that stopped before it reached its tolerance.

    Attributes:
        result: result of the solver, with its stop reason and the best point found.
    """

    def __init__(self, message: str, result: object) -> None:
        super().__init__(message)
        self.result = result


class HydrostatWarning(UserWarning):
    """Pose that is computed but that the robot cannot take, such as one beyond the travel of a winch."""


NO_KIT = "no kit can be made of this body: "
"""Before a reason that holds whatever the winches and cables of a robot are."""

_NAMED = re.compile(r"\b(winch|marker)\[\d+\](?= )")
_POINT = re.compile(r"\bcable\[(\d+)\]\.points\[(\d+)\]")
_RUN = re.compile(r"\bcable\[(\d+)\] between points (\d+) and (\d+)")
_PART = re.compile(r"\b(pin|winch|cable|marker|pose|part|rod|load|sensor|drive|obstacle)\[(\d+)\](\.(?=\w))?")


def in_words(text: str) -> str:
    """Sentence in plain words: "cable 1, point 3" for "cable[0].points[2]", "winch left" for "winch[0] left"."""
    text = _POINT.sub(lambda match: f"cable {_next(match[1])}, point {_next(match[2])}", _NAMED.sub(r"\1", text))
    text = _RUN.sub(lambda run: f"cable {_next(run[1])} between points {_next(run[2])} and {_next(run[3])}", text)
    return _PART.sub(lambda match: f"{match[1]} {_next(match[2])}{', ' if match[3] else ''}", text)


def _next(number: str) -> int:
    return int(number) + 1
