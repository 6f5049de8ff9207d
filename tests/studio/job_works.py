"""Work for other processes, as `test_jobs` has it done there."""

import os
import sys
import threading
from typing import Any

from hydrostat.errors import InputError
from hydrostat.studio.jobs import Report


def add(report: Report, *numbers: int) -> int:
    report.progress("Adding", 0, len(numbers))
    for number in numbers:
        report.part(number)
    report.progress("Adding", len(numbers), len(numbers))
    return sum(numbers)


def refuse(report: Report) -> None:
    raise InputError("2 winches and 1 cable: ask for more")


def stumble(report: Report) -> None:
    raise ZeroDivisionError("by nothing")


def unpicklable(report: Report) -> Any:
    return threading.Lock()


def die(report: Report) -> None:
    os._exit(7)


def leave(report: Report) -> None:
    sys.exit(3)


def wait(report: Report) -> str:
    """Until it is stopped."""
    report.part(os.getpid())
    try:
        threading.Event().wait()
    except KeyboardInterrupt:
        return "what there was"
    return "the end"


def chatter(report: Report) -> int:
    """Sends large parts without end, until it is stopped."""
    count = 0
    try:
        while True:
            report.part(b"x" * 200_000)
            count += 1
    except KeyboardInterrupt:
        return count


def stubborn(report: Report) -> None:
    """Does not stop."""
    report.part("begun")
    while True:
        try:
            threading.Event().wait()
        except KeyboardInterrupt:
            report.part("no")


def finishing(report: Report, parts: int) -> str:
    """Is asked to stop when it is done already."""
    report.finish()
    report.part("finished")
    for number in range(parts):
        report.part(number)
    return "whole"


def loaded(report: Report, name: str) -> tuple[int, bool]:
    """Its process, and whether a module was there before it was asked for."""
    return os.getpid(), name in sys.modules


def orphan(report: Report) -> None:
    """A process of its own studio: begins work that waits, tells its number, and dies without a word."""
    from hydrostat.studio.bell import Bell
    from hydrostat.studio.jobs import Jobs

    heard = threading.Event()
    told: list[int] = []

    def hear(pid: int) -> None:
        told.append(pid)
        heard.set()

    Jobs(Bell()).start("Waiting", wait, on_part=hear)
    heard.wait(60)
    report.part(told[0])
    os._exit(0)
