"""Exceptions: every error that a user can cause is a `HydrostatError`."""

from typing import Any


class HydrostatError(Exception):
    """Base of all errors of hydrostat. Its text is one line: place, problem, allowed values, fix."""


class InputError(HydrostatError):
    """Wrong input: a file, a key, a value or an argument."""


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
