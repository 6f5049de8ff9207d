"""How compiled functions are compiled: once for a machine, and fast.

Compiling is half of what a first run costs, so: no wrappers that nobody calls. `KERNEL` is for what Python calls and
is kept on disk, `INNER` for what only other compiled code calls and thus lies in their files. What else is quick to
compile: docs/decisions/0013-cold-start.md.
"""

from typing import Any

KERNEL: dict[str, Any] = {"cache": True, "error_model": "numpy", "no_cfunc_wrapper": True}
"""Options of `numba.njit` for a function that Python calls."""

INNER: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "no_cpython_wrapper": True}
"""Options of `numba.njit` for a function that only compiled code calls."""
