"""Compiled functions: `native`, those of the compiled core; and how numba compiles the others, once for a machine.

The core is C++ (folder native/, decision 0022). Where it could not be built, or HYDROSTAT_NATIVE=0 is set, numba's
kernels do the same, to rounding.

Compiling is half of what a first run costs, so: no wrappers that nobody calls. `KERNEL` is for what Python calls and
is kept on disk, `INNER` for what only other compiled code calls and thus lies in their files. What else is quick to
compile: docs/decisions/0013-cold-start.md. `Kernel` is for what the core has under the same name: numba then compiles
nothing (docs/decisions/0025-the-first-minute.md).
"""

import os
import threading
import warnings
from collections.abc import Callable
from functools import cached_property, update_wrapper
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from hydrostat.errors import InputError

native: Any = None
"""The compiled core; None where numba's kernels serve alone."""

INTERFACE = 2
"""Which functions, with which arguments, are asked of the core; `interface` in native/module.cpp is the same."""

if os.environ.get("HYDROSTAT_NATIVE", "1") != "0" and find_spec("hydrostat._native"):
    native = import_module("hydrostat._native")
    if getattr(native, "interface", 1) != INTERFACE:
        warnings.warn("hydrostat's compiled core is of another version; install hydrostat again", stacklevel=1)
        native = None


def _threads() -> int:
    """Number in HYDROSTAT_THREADS; without it the cores that this process may use."""
    given = os.environ.get("HYDROSTAT_THREADS", "")
    if not given:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not given.isdecimal() or not 1 <= int(given) <= 1024:
        raise InputError(f"HYDROSTAT_THREADS must be a whole number from 1 to 1024, not {given!r}")
    return int(given)


THREADS: int = _threads()
"""So many threads share one factorisation of a large body; its bytes do not depend on them."""

KERNEL: dict[str, Any] = {"cache": True, "error_model": "numpy", "no_cfunc_wrapper": True}
"""Options of `numba.njit` for a function that Python calls."""

LONG: dict[str, Any] = KERNEL | {"nogil": True}
"""The same for one that goes over a whole body: it lets other threads run, which short ones do not repay."""

INNER: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "no_cpython_wrapper": True}
"""Options of `numba.njit` for a function that only compiled code calls."""


class Late:
    """Something that compiled functions find among the names of their module, and that is made when it is first needed.

    numba takes a quarter of a second to load, and where the core serves nobody asks for it.
    """

    def __init__(self, make: Callable[[], Any]) -> None:
        """What makes it."""
        self._make = make

    @cached_property
    def now(self) -> Any:
        """The thing itself."""
        with _MAKING:
            return self._make()


class Compiled(Late):
    """A function that numba compiles when it is first called; it stands for numba's in all else."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        """The function in Python, and options of `numba.njit`."""
        super().__init__(self._compiled)
        self.py_func, self.options = function, options
        update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        """Call it."""
        return self.now(*arguments)

    def _compiled(self) -> Any:
        """Numba's function. What it calls must be numba's too when numba looks for it."""
        from numba import njit as by_numba

        names = self.py_func.__globals__
        for name in self.py_func.__code__.co_names:
            if isinstance(names.get(name), Late):
                names[name] = names[name].now
        try:
            return by_numba(**self.options)(self.py_func)
        except RuntimeError as error:  # neither the package nor the home folder can be written
            if "cannot cache" not in str(error):
                raise
            uncached: dict[str, Any] = self.options | {"cache": False}
            return by_numba(**uncached)(self.py_func)


_MAKING = threading.RLock()


def njit(**options: Any) -> Callable[[Callable[..., Any]], Compiled]:
    """Compile a function as `numba.njit` does, with the same options, but load numba only when it is called."""
    return lambda function: Compiled(function, options)


class Kernel:
    """A function that the compiled core has under the same name, less its underscore; numba's where there is no core.

    Attributes:
        by_numba: the function as numba compiles it.
        by_core: that of the core, or None. It has the same arguments, and fills in none that is of another type.
    """

    def __init__(self, function: Callable[..., Any], options: dict[str, Any] = KERNEL) -> None:
        """Take the core's function where there is one; numba compiles only what is called, with these options."""
        self.by_numba = Compiled(function, options)
        self.by_core = getattr(native, function.__name__.lstrip("_"), None)
        self.__doc__ = function.__doc__

    def __call__(self, *arguments: Any) -> Any:
        """Call one or the other."""
        return (self.by_core or self.by_numba)(*arguments)
