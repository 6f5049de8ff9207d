"""Errors that name the option they come from."""

from collections.abc import Iterator
from contextlib import contextmanager

from hydrostat.errors import InputError


@contextmanager
def naming_option(words: str) -> Iterator[None]:
    """Begin the errors of a block with an option and its value, such as "--pose dance"."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{words}: {error}") from None


@contextmanager
def naming_fields(*fields: str) -> Iterator[None]:
    """Begin errors that start with one of these fields with the option of the same name."""
    try:
        yield
    except InputError as error:
        field, separator, told = str(error).replace(":", " :", 1).partition(" ")
        if field not in fields or not separator:
            raise
        raise InputError(f"--{field.replace('_', '-')} {told}".replace(" :", ":", 1)) from None
