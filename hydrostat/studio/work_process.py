"""`run_work`: what a process does that works for a studio."""

import os
import signal
import time
from _thread import interrupt_main
from collections.abc import Callable
from importlib import import_module
from multiprocessing.connection import Connection
from threading import Lock, Thread, main_thread
from types import FrameType
from typing import Any, Protocol, runtime_checkable

from hydrostat.errors import HydrostatError


@runtime_checkable
class Report(Protocol):
    """The way in which work in another process tells of itself."""

    def progress(self, stage: str, done: int, total: int) -> None:
        """Tell how far it is."""
        ...

    def part(self, value: Any) -> None:
        """Hand over something that was found on the way."""
        ...

    def finish(self) -> None:
        """Say that the work is done but for handing it over: from here on nothing interrupts it."""
        ...


def run_work(pipe: Connection) -> None:
    """Import what is asked for, do one piece of work, and tell of it; ends when the other side is gone.

    What comes through the pipe: ("import", names) as often as it likes, ("work", function, arguments) once, then
    perhaps ("stop",). What goes: ("progress", stage, done, total) and ("part", value) as often as they come, then
    ("done", value) or ("error", words).
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C in a terminal goes to all processes; the studio's own decides
    try:
        kind, *rest = pipe.recv()
        while kind == "import":
            for name in rest[0]:
                import_module(name)
            kind, *rest = pipe.recv()
    except EOFError:
        return
    except Exception as error:  # noqa: BLE001 such as work that cannot be unpickled
        pipe.send(("error", f"the job could not start: {_words(error)}"))
        return
    report = _Report(pipe)
    signal.signal(signal.SIGTERM, report.interrupt)
    Thread(target=report.handle, daemon=True).start()
    _send(pipe, _done(report, *rest))


def _done(report: "_Report", function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[str, Any]:
    """Do the work; what came of it."""
    try:
        value = function(report, *arguments)
        report.finish()
    except HydrostatError as error:
        report.finish()
        return "error", str(error)
    except KeyboardInterrupt:
        return "error", "stopped"
    except Exception as error:  # noqa: BLE001 whatever it was, the person who waits must hear of it
        report.finish()
        return "error", _words(error)
    return "done", value


def _send(pipe: Connection, message: tuple[str, Any]) -> None:
    try:
        pipe.send(message)
    except OSError:
        return  # nobody listens any more
    except Exception as error:  # noqa: BLE001 pickling fails in many ways
        pipe.send(("error", f"the result cannot be transferred: {_words(error)}"))


class _Report:
    """Tells the process that waits, and hears from it."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe, self._lock = pipe, Lock()
        self._stoppable, self._stopped = True, False
        self._stage, self._told = "", 0.0

    def progress(self, stage: str, done: int, total: int) -> None:
        now = time.monotonic()
        shortest = 0.03  # progress of one stage is not told more often than each so many seconds
        if stage == self._stage and now - self._told < shortest and done < total:
            return
        self._stage, self._told = stage, now
        with self._lock:
            self._pipe.send(("progress", stage, done, total))

    def part(self, value: Any) -> None:
        with self._lock:
            self._pipe.send(("part", value))

    def finish(self) -> None:
        with self._lock:
            self._stoppable = False

    def handle(self) -> None:
        """Wait for what the other side says, in a thread of its own."""
        try:
            while True:
                self._pipe.recv()
                self._stopped = True
                Thread(target=self._stop, daemon=True).start()
        except (EOFError, OSError):
            os._exit(1)

    def _stop(self) -> None:
        """Signal until it is heard: a signal that comes just before the main thread begins to wait does not wake it."""
        again = 0.02  # a stop that was not heard is said again after so many seconds
        while True:
            with self._lock:  # so that no message is cut in two
                if not self._stoppable:
                    return
                _wake()
            time.sleep(again)

    def interrupt(self, number: int, frame: FrameType | None) -> None:
        """Take a signal: a stop that was asked for, or the end from elsewhere."""
        if not self._stopped:
            os._exit(1)
        if self._stoppable:
            self._stoppable = False
            raise KeyboardInterrupt


def _wake() -> None:
    """Send the main thread the signal of a stop, which also ends its waiting for something."""
    if hasattr(signal, "pthread_kill") and (ident := main_thread().ident) is not None:
        signal.pthread_kill(ident, signal.SIGTERM)
    else:
        interrupt_main(signal.SIGTERM)


def _words(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"
