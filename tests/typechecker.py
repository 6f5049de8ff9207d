"""The type checker of the import hook: beartype, with what Python itself allows."""

from collections.abc import Callable
from typing import Any

from beartype import BeartypeConf, beartype
from beartype.roar import BeartypeDecorHintPep673Exception

_beartype = beartype(conf=BeartypeConf(is_pep484_tower=True))
"""An int is a float, as PEP 484 says."""


def checked(function: Callable[..., Any]) -> Callable[..., Any]:
    """Check a function's arguments and what it returns; one that returns Self cannot be checked outside its class."""
    try:
        return _beartype(function)
    except BeartypeDecorHintPep673Exception:
        return function
