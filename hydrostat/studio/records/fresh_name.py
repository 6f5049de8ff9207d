"""`fresh_name`: a name that no other part has."""

from collections.abc import Collection


def fresh_name(stem: str, taken: Collection[str]) -> str:
    """The first of stem_1, stem_2 ... that is not taken."""
    number = 1
    while f"{stem}_{number}" in taken:
        number += 1
    return f"{stem}_{number}"
