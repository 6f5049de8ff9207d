"""Names of robots, winches, markers and poses: they become names of files, so not every text will do."""

import unicodedata

from hydrostat import units
from hydrostat.errors import InputError

LONGEST_NAME = 60
"""A name has at most this many characters."""


def check_name(name: str) -> str:
    """The name itself.

    Raises:
        InputError: it is empty, too long, has another character than letters (of any language), digits, space and
            . _ -, or begins with none of the first two.
    """
    if not name:
        raise InputError("a name must not be empty")
    if len(name) > LONGEST_NAME:
        raise InputError(f"{units.quote(name)} has {len(name)} characters; a name has at most {LONGEST_NAME}")
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
    """Letters, the marks that many scripts write with them, and digits."""
    category = unicodedata.category(letter)
    return category[0] in "LM" or category == "Nd"
