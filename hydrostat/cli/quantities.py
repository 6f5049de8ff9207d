"""Options that are text with a unit."""

from typing import TYPE_CHECKING

from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.units import Dimension


def positive(option: str, text: str, dimension: "Dimension", *, zero: bool = False) -> float:
    """Value in SI of an option.

    Args:
        option: its name, for complaints.
        text: such as "20 N".
        dimension: what it measures.
        zero: 0 is allowed as well.

    Raises:
        InputError: no such quantity, or one that is not above 0.
    """
    from hydrostat.units import parse_quantity

    try:
        value = parse_quantity(text, dimension)
    except InputError as error:
        raise InputError(f"{option} {text}: {error}") from None
    if value < 0 or (value == 0 and not zero):
        raise InputError(f"{option} {text}: must be {'0 or more' if zero else 'above 0'}, such as {dimension.example}")
    return value


def winch_groups(option: str, texts: list[str]) -> list[list[str]]:
    """Groups of winches, from texts such as "left,right".

    Raises:
        InputError: a group of fewer than two.
    """
    groups = [[name.strip() for name in text.split(",") if name.strip()] for text in texts]
    for text, names in zip(texts, groups, strict=True):
        if len(names) < 2:
            raise InputError(f'{option} {text}: name two winches or more, such as "left,right"')
    return groups
