"""Whether this computer let anything run: processes on each core that only sleep, before all other programs."""

import multiprocessing as mp
import os
import time
from contextlib import suppress

STOOD = 5e-3
"""A heart that beats so much late says that its core stood still [s]."""
BEAT = 1e-3
FIRST = 9
"""Priority of the hearts among programs that go first; those that are measured have less."""


def beat(core: int, pipe, first: bool) -> None:
    """Sleep and wake on a core until told, then tell when it stood still."""
    with suppress(AttributeError, OSError):
        os.sched_setaffinity(0, {core})
        if first:
            os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(FIRST))
    stood, before = [], time.monotonic()
    while not pipe.poll():
        time.sleep(BEAT)
        now = time.monotonic()
        if now - before > BEAT + STOOD:
            stood.append((before, now))
        before = now
    with suppress(OSError):
        pipe.send(stood)


class Hearts:
    """A heart on each core; `stop` gives the times in which a core stood still."""

    def __init__(self, *, first: bool) -> None:
        context, self._hearts = mp.get_context("spawn"), []
        for core in sorted(os.sched_getaffinity(0)):
            ours, theirs = context.Pipe()
            process = context.Process(target=beat, args=(core, theirs, first), daemon=True)
            process.start()
            self._hearts.append((ours, process))

    def stop(self) -> list[tuple[float, float]]:
        """Begins and ends on the clock that only runs forward [s]."""
        stood: list[tuple[float, float]] = []
        for pipe, process in self._hearts:
            pipe.send("stop")
            stood += pipe.recv()
            process.join(5)
        return stood


def overlap(spans: list[tuple[float, float]], begin: float, end: float) -> bool:
    """Whether any of the spans lies within some time."""
    return any(one < end and other > begin for one, other in spans)
