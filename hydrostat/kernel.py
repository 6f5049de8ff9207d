"""The compiled core (folder native/): `native`, its functions on plain arrays, and its number of threads.

`HYDROSTAT_LEVEL` (base, v3 or v4) picks a lower set of vector instructions than the processor has.
"""

import os
from importlib import import_module
from typing import Any

from hydrostat.errors import InputError


def _load() -> Any:
    """Load the compiled core (InputError: it is missing, of another version, or HYDROSTAT_LEVEL is wrong)."""
    try:
        core = import_module("hydrostat._native")
    except ModuleNotFoundError:
        raise InputError("hydrostat's compiled core is missing; run pip install --editable . in its folder") from None
    except ImportError as error:
        raise InputError(str(error.__cause__ or error)) from None
    interface = 9  # Version of the functions that are called here; `interface` in native/module.cpp is the same
    if getattr(core, "interface", 1) != interface:
        raise InputError("hydrostat's compiled core is of another version; install hydrostat again")
    return core


native: Any = _load()


def _threads() -> int:
    """Number in HYDROSTAT_THREADS; without it the cores that this process may use."""
    given = os.environ.get("HYDROSTAT_THREADS", "")
    if not given:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not given.isdecimal() or not 1 <= int(given) <= 1024:
        raise InputError(f"HYDROSTAT_THREADS must be a whole number from 1 to 1024, not {given!r}")
    return int(given)


THREADS: int = _threads()
"""Threads that share one factorization of a large body; its bytes do not depend on them."""
