"""Type checks of arguments at the public interface; an error says in one line what is wanted."""

import os
from pathlib import Path

from hydrostat.errors import InputError


def check_type(given: object, kind: type | tuple[type, ...], wanted: str) -> None:
    """Raise an error unless a value has the required type.

    Args:
        given: value to check.
        kind: required type.
        wanted: the sentence before ", not ...", such as "a kit is made of a Robot".
    """
    if not isinstance(given, kind):
        raise InputError(f"{wanted}, not {given!r:.60}")


def path_of(given: object, wanted: str) -> Path:
    """Convert a text or a path to a path (InputError: as for `check_type`)."""
    if not isinstance(given, str | os.PathLike) or isinstance(os.fspath(given), bytes):
        raise InputError(f"{wanted}, not {given!r:.60}")
    return Path(given)
