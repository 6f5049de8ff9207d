"""Errors that name the option they come from."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

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


_FAULTS = {
    "greater_than_equal": "too small. Allowed: {ge:g} or more",
    "less_than_equal": "too large. Allowed: at most {le:g}",
    "int_parsing": "not a whole number",
    "int_from_float": "not a whole number",
    "float_parsing": "not a number",
}
"""Words for pydantic's kinds of errors, with the fields of their context."""


def describe_usage_error(error: Any) -> str:
    """Return a usage error of typer in words, with the value of an option out of its range."""
    words = " ".join(error.format_message().split()).rstrip(".").replace("Value error, ", "")
    words = re.sub(r"^Invalid value for '(-[^']+)':", r"\1:", words)
    if words == "Missing option '--from'":
        shape = Path((error.ctx and error.ctx.params.get("name")) or "")
        words += f". Did you mean: hydrostat new {shape.stem} --from {shape}?" if shape.suffix else ""
    list_faults = getattr(error.__cause__, "errors", None)
    fault = list_faults()[0] if list_faults else {}
    if not words.startswith("-") or fault.get("type") not in _FAULTS:
        return words
    option = words.partition(":")[0]
    return f"{option} {fault['input']}: {_FAULTS[fault['type']].format(**fault.get('ctx', {}))}"
