"""`start_worker`: processes that work for a studio begin within milliseconds where the system can fork."""

import sys
from collections.abc import Callable
from functools import cache
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, SpawnContext
from multiprocessing.process import BaseProcess

PRELOADED = (
    "hydrostat.geometry.files.outline_file",
    "hydrostat.geometry.tetrahedra.tetrahedralize",
    "hydrostat.plot",
    "hydrostat.studio.designing.design_work",
    "hydrostat.studio.exporting.kit_work",
    "hydrostat.studio.posing.proposal_work",
    "hydrostat.studio.starting.sketch",
    "hydrostat.studio.work_process",
)
"""Modules that most work imports: a process that is forked has them at once."""


def start_worker(target: Callable[[Connection], None]) -> tuple[BaseProcess, Connection]:
    """Start a process that calls `target` with a pipe; returns it and the other end of the pipe.

    Raises OSError: no process can be started.
    """
    context = _context()
    here, there = context.Pipe()
    process = context.Process(target=target, args=(there,), daemon=True)
    process.start()
    there.close()
    return process, here


@cache
def _context() -> ForkServerContext | SpawnContext:
    """The way to start processes: by forking one that has one thread and all modules; spawning is for other systems.

    Apple's libraries may not be used after a fork.
    """
    if not sys.platform.startswith("linux"):
        return get_context("spawn")
    context = get_context("forkserver")
    context.set_forkserver_preload(list(PRELOADED))
    return context
