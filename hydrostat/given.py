"""Checks of arguments and of fields of records: types, numbers, points and names.

A message about a field begins with the field, which the reader of a file looks up.
"""

import math
import os
import unicodedata
from collections.abc import Mapping
from numbers import Real
from pathlib import Path
from typing import Any, NoReturn

from hydrostat import units
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


Point = tuple[float, ...]  # coordinates [m] in the rest pose, two or three


def check_number(field: str, value: object, unit: str) -> None:
    """Reject a value that is no number, such as a text with a unit, which only robot.toml accepts."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InputError(f"{field} must be a number{f' in {unit}' if unit else ''}, not {value!r:.60}")


def check_positive(field: str, value: float, unit: str) -> None:
    """Reject a value that is no number, not finite or not above 0."""
    check_number(field, value, unit)
    if not 0 < value < math.inf:
        raise InputError(f"{field} must be finite and above 0, not {_with_unit(value, unit)}")


def check_not_negative(field: str, value: float, unit: str) -> None:
    """Reject a value that is no number, not finite or below 0."""
    check_number(field, value, unit)
    if not 0 <= value < math.inf:
        raise InputError(f"{field} must be finite and not negative, not {_with_unit(value, unit)}")


def _with_unit(value: float, unit: str) -> str:
    """Value as people write it: lengths in millimeters."""
    return f"{1e3 * value:g} mm" if unit == "m" else f"{value:g} {unit}".rstrip()


def check_point(field: str, point: Point) -> None:
    """Reject a value that is no point in the plane or in space."""
    try:
        count, finite = len(point), all(map(math.isfinite, point))
    except TypeError:
        raise InputError(f"{field} must be two or three coordinates [m], not {point!r:.60}") from None
    if count not in (2, 3):
        raise InputError(f"{field} has {count} coordinates; a point has two, or three in space")
    if not finite:
        raise InputError(f"{field} must have finite coordinates, not {[float(value) for value in point]}")


MAX_NAME = 60  # a name has at most this many characters


def check_name(name: str) -> str:
    """Check a name and return it.

    Raises InputError: it is empty, too long, has another character than letters (of any language), digits, space and .
    _ -, or begins with none of the first two.
    """
    if not name:
        raise InputError("a name must not be empty")
    if len(name) > MAX_NAME:
        raise InputError(f"{units.quote(name)} has {len(name)} characters; a name has at most {MAX_NAME}")
    wrong = next((letter for letter in name if not (_is_word(letter) or letter in " ._-")), None)
    if wrong is not None:
        raise InputError(
            f"{units.quote(name)} has {units.quote(wrong)} in it; a name has letters, digits, space and . _ -"
        )
    if name[0] in " ._-" or unicodedata.category(name[0]).startswith("M"):
        raise InputError(
            f"{units.quote(name)} begins with {units.quote(name[0])}; a name begins with a letter or digit"
        )
    return name


def _is_word(letter: str) -> bool:
    """Return True for a letter, a combining mark, as in many scripts, or a digit."""
    category = unicodedata.category(letter)
    return category[0] in "LM" or category == "Nd"


def check_unique(kind: str, names: list[str]) -> None:
    """Reject names that are given twice (InputError); `kind` is the key of their tables."""
    for index, name in enumerate(names):
        if name in names[:index]:
            raise InputError(f'{kind}[{index}].name: there are two of the name "{name}"; names must be unique')


def list_choices(kind: str, names: list[str], given: str = "") -> str:
    """Names that are available, in words, then the one that is most like `given`; `kind` is their plural."""
    from difflib import get_close_matches

    if not names:
        return f"The robot has no {kind}."
    near = get_close_matches(given[:60], names, n=1)
    return f"Available: {', '.join(names)}." + (f" Did you mean {units.quote(near[0])}?" if near else "")


class NamedParts(dict[str, Any]):
    """Parts by name; `parts[name]` raises an InputError that lists the names if there is none.

    Attributes:
        kind: noun for a part, such as "marker".
    """

    def __init__(self, kind: str, parts: Mapping[str, Any]) -> None:
        super().__init__(parts)
        self.kind = kind

    def __missing__(self, name: object) -> NoReturn:
        raise InputError(f'unknown {self.kind} "{name}". {list_choices(f"{self.kind}s", list(self), str(name))}')
