"""Shapes and types of the package's public functions are checked while the tests run, in the first calls of each test.

jaxtyping's import hook decorates every function and class. Checking each call made the tests four times as slow, nearly
all of it in inner loops and private functions, whose arrays come from public ones. So only what is public is wrapped;
its check is made when it is first called, and each test checks the first `CALLS` calls of each function anew, so that
what a test catches does not depend on the tests before it.
"""

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any

import jaxtyping
from beartype import BeartypeConf, beartype
from beartype.roar import BeartypeDecorHintPep673Exception
from jaxtyping import config, install_import_hook, jaxtyped

CALLS = 10
"""Calls of each function that a test checks."""

_beartype = beartype(conf=BeartypeConf(is_pep484_tower=True))
"""An int is a float, as PEP 484 says."""

_tests = 0
"""How many tests have begun."""


def install(package: str) -> None:
    """Check a package that is imported from now on."""
    jaxtyping.jaxtyped = _decorator  # the name that the import hook writes above every function
    install_import_hook(package, "beartype.beartype")


def begin_test() -> None:
    """Check the first calls of each function again."""
    global _tests
    _tests += 1


def checked(function: Callable[..., Any]) -> Callable[..., Any]:
    """Check the first calls of a function in each test, then call it with nothing between but a counter."""
    checking: Callable[..., Any] | None = None
    test, calls = -1, 0

    @wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        nonlocal checking, test, calls
        if test != _tests:
            test, calls = _tests, 0
        calls += 1
        if calls > CALLS or config.jaxtyping_disable:
            return function(*args, **kwargs)
        if checking is None:
            checking = jaxtyped(function, typechecker=_typechecker)
        return checking(*args, **kwargs)

    return call


def is_public(qualified_name: str) -> bool:
    """Tell whether a function or class, with all that it stands in, may be used from outside its file."""
    return all(part.strip("_") and (part[0] != "_" or part.endswith("__")) for part in qualified_name.split("."))


def _decorator(*, typechecker: object) -> Callable[[Any], Any]:
    """Stand where `jaxtyped` stands in what the import hook writes."""

    def decorate(made: Any) -> Any:
        if "<locals>" in made.__qualname__ or not is_public(made.__qualname__) or hasattr(made, "__no_type_check__"):
            return made
        if not inspect.isclass(made):
            return checked(made)
        if (
            "__dataclass_fields__" in vars(made)
            and "__init__" in vars(made)
            and not hasattr(made.__init__, "__wrapped__")
        ):
            made.__init__ = checked(made.__init__)
        return made

    return decorate


def _typechecker(function: Callable[..., Any]) -> Callable[..., Any]:
    """Check a function's arguments and what it returns; one that returns Self cannot be checked outside its class."""
    try:
        return _beartype(function)
    except BeartypeDecorHintPep673Exception:
        return function
