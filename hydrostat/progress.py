"""`Progress`: callback that reports how far a long computation is."""

from collections.abc import Callable

Progress = Callable[[str, int, int], None]
"""Callback for progress: name of the stage, number of its steps that are done, and number of its steps in all.

Both numbers are 0 where steps are not counted in advance; the name then says how far the work is.
"""


def no_progress(stage: str, done: int, total: int) -> None:
    """Report nothing."""
