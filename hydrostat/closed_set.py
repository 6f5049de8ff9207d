"""`parse_choice`, `make_member`: texts that name a member of an enum, such as the measure of a body's volume."""

from enum import StrEnum
from typing import TypeVar

from hydrostat.errors import InputError
from hydrostat.units import quote

_Member = TypeVar("_Member", bound=StrEnum)


def parse_choice(kind: type[_Member], given: object, *, what: str) -> _Member:
    """Find the member of an enumeration that a text names; a member gives itself.

    Args:
        kind: the closed set.
        given: a member or its text.
        what: name of the field or argument, with which the complaint begins.

    Raises:
        InputError: the text names none.
    """
    try:
        return kind(given)
    except ValueError:
        raise InputError(f"{what} must be one of {', '.join(kind)}, not {quote(given)}") from None


def make_member(record: object, field: str, kind: type[StrEnum], *, what: str = "") -> None:
    """Replace the text in a field of a frozen record by the enum member that it names.

    Args:
        record: a frozen dataclass in its `__post_init__`.
        field: name of the field.
        kind: the closed set.
        what: name of the value in errors, if the name of the field does not say it.

    Raises:
        InputError: the text names none.
    """
    object.__setattr__(record, field, parse_choice(kind, getattr(record, field), what=what or field))
