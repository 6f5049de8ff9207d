"""`Jobs`: long work in a process of its own, so that dragging stays smooth and work can be stopped."""

import os
import signal
from collections.abc import Callable
from dataclasses import dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from threading import Lock, Thread
from typing import Any, Protocol, runtime_checkable

from hydrostat.errors import HydrostatError, InputError
from hydrostat.studio.bell import Bell, Topic


@runtime_checkable
class Report(Protocol):
    """How work in another process tells of itself."""

    def progress(self, stage: str, done: int, total: int) -> None:
        """How far it is."""
        ...

    def part(self, value: Any) -> None:
        """Something found on the way."""
        ...


@dataclass(frozen=True, kw_only=True)
class JobState:
    """How far the work is.

    Attributes:
        title: such as "Designing cables".
        stage: what is done just now.
        done: how much of it.
        total: of how much; 0: not known.
        running: whether it goes on.
        stopping: whether it was asked to stop.
        error: why it failed; "" if it did not.
    """

    title: str
    stage: str = "starting"
    done: int = 0
    total: int = 0
    running: bool = True
    stopping: bool = False
    error: str = ""


class Jobs:
    """One long work at a time.

    Attributes:
        state: of the work that runs or ran last; None before the first.
    """

    def __init__(self, bell: Bell) -> None:
        self.state: JobState | None = None
        self._bell = bell
        self._lock = Lock()
        self._process: BaseProcess | None = None

    @property
    def running(self) -> bool:
        """Whether there is work in progress."""
        return self.state is not None and self.state.running

    def start(
        self,
        title: str,
        function: Callable[..., Any],
        *arguments: Any,
        on_part: Callable[[Any], None] | None = None,
        on_done: Callable[[Any], None] | None = None,
        on_end: Callable[[], None] | None = None,
    ) -> None:
        """Run `function(report, *arguments)` in a process of its own.

        Args:
            title: as a person would say it.
            function: of a module, so that the process finds it; a KeyboardInterrupt asks it to end with what it has.
            arguments: values that can be pickled, as must be what it returns.
            on_part: called with each part that it reports, in a thread of this process.
            on_done: called with what it returns, likewise.
            on_end: called in the end, whatever came of it.

        Raises:
            InputError: other work is in progress.
        """
        with self._lock:
            if self.running:
                assert self.state is not None
                raise InputError(f"{self.state.title} is still in progress; wait for it or stop it")
            context = get_context("spawn")
            here, there = context.Pipe(duplex=False)
            self._process = context.Process(target=_run, args=(there, function, arguments), daemon=True)
            self.state = JobState(title=title)
            self._process.start()
            there.close()
        calls = (on_part or _nothing, on_done or _nothing, on_end)
        Thread(target=self._listen, args=(here, *calls), name=title, daemon=True).start()
        self._bell.ring(Topic.JOB)

    def stop(self) -> None:
        """Ask the work to end with what it has; asked again, it is ended at once."""
        with self._lock:
            process, state = self._process, self.state
            if process is None or state is None or not state.running:
                return
            if state.stopping:
                process.kill()
            elif process.pid is not None:
                self.state = replace(state, stopping=True)
                os.kill(process.pid, signal.SIGINT)
        self._bell.ring(Topic.JOB)

    def close(self) -> None:
        """End all work at once."""
        process = self._process
        if process is not None and process.is_alive():
            process.kill()
            process.join(timeout=5.0)

    def _listen(
        self,
        pipe: Connection,
        on_part: Callable[[Any], None],
        on_done: Callable[[Any], None],
        on_end: Callable[[], None] | None,
    ) -> None:
        """Hear what the process says until it ends."""
        error = "it ended without a result"
        try:
            while True:
                kind, value = pipe.recv()
                if kind == "progress":
                    self._note(stage=value[0], done=value[1], total=value[2])
                elif kind == "part":
                    on_part(value)
                elif kind == "done":
                    on_done(value)
                    error = ""
                else:
                    error = value
        except EOFError:
            pass
        except HydrostatError as refused:
            error = str(refused)
        finally:
            pipe.close()
            stopped = self.state is not None and self.state.stopping
            self._note(running=False, error="stopped" if error and stopped else error)
            if on_end is not None:
                on_end()

    def _note(self, **changes: Any) -> None:
        with self._lock:
            if self.state is not None:
                self.state = replace(self.state, **changes)
        self._bell.ring(Topic.JOB)


class _Report:
    """Tells the process that waits."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe = pipe

    def progress(self, stage: str, done: int, total: int) -> None:
        self._pipe.send(("progress", (stage, done, total)))

    def part(self, value: Any) -> None:
        self._pipe.send(("part", value))


def _run(pipe: Connection, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    """What the other process does."""
    try:
        pipe.send(("done", function(_Report(pipe), *arguments)))
    except HydrostatError as error:
        pipe.send(("error", str(error)))
    except KeyboardInterrupt:
        pipe.send(("error", "stopped"))
    except Exception as error:  # noqa: BLE001 whatever it was, the person who waits must hear of it
        pipe.send(("error", f"{type(error).__name__}: {error}"))
    finally:
        pipe.close()


def _nothing(value: Any) -> None:
    """Nobody asked."""
