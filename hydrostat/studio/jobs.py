"""`Jobs`: long work in a process of its own, so that dragging stays smooth and work can be stopped."""

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import inf
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from threading import Condition, Lock, Semaphore, Thread
from typing import Any

from hydrostat.errors import HydrostatError, InputError
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.work_process import Report, run_work
from hydrostat.studio.worker_context import start_worker

__all__ = ["JobState", "Jobs", "Report", "Slots"]

POLL_INTERVAL = 1.0  # time from one look at the line of others to the next [s]
END_TIMEOUT = 5.0  # a process that has told what came of its work is given so long to end [s]


@dataclass(frozen=True, kw_only=True)
class JobState:
    """State of the work: how far it is."""

    title: str  # such as "Designing cables"
    stage: str = "starting"  # what is done just now
    done: int = 0  # how much of it
    total: int = 0  # of how much; 0: not known
    running: bool = True  # whether it goes on
    stopping: bool = False  # whether it was asked to stop
    yielded: bool = False  # whether it was asked to stop as its turn was over and others waited
    error: str = ""  # why it failed; "" if it did not


class Slots:
    """Number of long jobs that may run at a time in all sessions that share these slots; more wait in line.

    Work that goes on for as long as a person likes has as many of its own: it would keep the line waiting.
    """

    def __init__(self, count: int) -> None:
        self._news, self._free, self._line = Condition(), count, list[object]()
        self._live = Semaphore(count)

    def wait(self, given_up: Callable[[], bool], tell: Callable[[int], None]) -> bool:
        """Stand in line until one is free; whether it came to that. Each is given back.

        Args:
            given_up: function that returns True once the job is abandoned; called twice a second.
            tell: is told how many are before this one, at first and whenever that changes; not if one is free.
        """
        turn, told = object(), -1
        with self._news:
            self._line.append(turn)
            try:
                while (before := self._line.index(turn)) or not self._free:
                    if given_up():
                        return False
                    if before != told:
                        tell(told := before)
                    self._news.wait(0.5)
                self._free -= 1
                return True
            finally:
                self._line.remove(turn)
                self._news.notify_all()

    @property
    def are_wanted(self) -> bool:
        """True if work stands in line."""
        return bool(self._line)

    def give(self) -> None:
        """One has ended."""
        with self._news:
            self._free += 1
            self._news.notify_all()

    def take_live(self) -> None:
        """Begin work that goes on for as long as a person likes (InputError: too many do)."""
        if not self._live.acquire(blocking=False):
            raise InputError("this machine is busy with other rooms. Try again when they have finished")

    def give_live(self) -> None:
        """Such work has ended."""
        self._live.release()


class Jobs:
    """One long work at a time."""

    def __init__(self, bell: Bell, slots: Slots | None = None) -> None:
        """Work beside other sessions that share slots, where no process stands ready; None: there are no others."""
        self.slots = slots  # that other sessions share; None: there are no others
        self.state: JobState | None = None  # of the work that runs or ran last; None before the first
        self._bell = bell
        self._lock = Lock()
        self._worker: _Worker | None = None
        self._spare: _Worker | None = None
        self._closed = False
        self._turn_time = inf  # for which the work may keep others waiting [s]

    @property
    def is_running(self) -> bool:
        """True if a job is running."""
        state = self.state
        return state is not None and state.running

    def warm(self, *modules: str) -> None:
        """Start a process ahead, if there is none, that imports modules, so that the next work begins at once."""
        with self._lock:
            if self._spare is not None and self._spare.process.is_alive():
                return
            if self._closed or self.slots is not None:
                return
            self._spare = _Worker.start()
            self._spare.pipe.send(("import", modules))

    def start(
        self,
        title: str,
        function: Callable[..., Any],
        *arguments: Any,
        on_part: Callable[[Any], None] | None = None,
        on_done: Callable[[Any], None] | None = None,
        on_end: Callable[[str], None] | None = None,
        turn: float = inf,
    ) -> None:
        """Run `function(report, *arguments)` in a process of its own (InputError: other work is in progress).

        The function is one of a module, so that the process finds it; a KeyboardInterrupt asks it to end with what it
        has. What it is given and what it returns can be pickled. What comes of it, and why if nothing does, is in
        `state`. In a thread of this process `on_part` is called with each part that it reports, `on_done` with what it
        returns, and in the end `on_end`, whatever came of it, with why nothing did, "" if something did; other work may
        have begun by then. After its turn [s] it is asked to end with what it has, if others wait for its slot.
        """
        with self._lock:
            if self.is_running:
                assert self.state is not None
                raise InputError(f"{self.state.title} is still running. Wait or stop it")
            if self._closed:
                raise InputError("the studio is closing")
            self._turn_time = turn
            self._worker, self.state = (self._ready() if self.slots is None else None), JobState(title=title)
        self._bell.ring(Topic.JOB)
        calls = (on_part or _nothing, on_done or _nothing, on_end or _nothing)
        Thread(target=self._follow, args=(function, arguments, *calls), name=title, daemon=True).start()

    def stop(self) -> None:
        """Ask the work to end with what it has; asked again, it is ended at once."""
        self._ask_to_end(yielded=False)

    def _ask_to_end(self, *, yielded: bool) -> None:
        """Ask once, whether a person asks or the turn is over; only a person who asks again ends it at once."""
        with self._lock:
            worker, state = self._worker, self.state
            if state is None or not state.running or (yielded and state.stopping):
                return
            self.state = replace(state, stopping=True, yielded=yielded)
            if worker is not None and state.stopping and not state.yielded:
                worker.process.kill()
            elif worker is not None and worker.begun and not state.stopping:
                worker.say_stop()
        self._bell.ring(Topic.JOB)

    def close(self) -> None:
        """End all work immediately; there will be no more."""
        with self._lock:
            self._closed = True
            if self.is_running and self.state is not None:
                self.state = replace(self.state, stopping=True)
            workers = [worker for worker in (self._worker, self._spare) if worker is not None]
            self._spare = None
        for worker in workers:
            worker.end(0.0)

    def _ready(self) -> "_Worker":
        """A process to work in."""
        spare, self._spare = self._spare, None
        return spare if spare is not None and spare.process.is_alive() else _Worker.start()

    def _follow(
        self,
        function: Callable[..., Any],
        arguments: tuple[Any, ...],
        on_part: Callable[[Any], None],
        on_done: Callable[[Any], None],
        on_end: Callable[[str], None],
    ) -> None:
        """Have the work done when its turn comes; in a thread of its own."""
        slots, error = self.slots, "stopped"
        if slots is None or slots.wait(self._given_up, self._in_line):
            try:
                error = self._turn((function, arguments), on_part, on_done)
            except OSError as failed:
                error = f"cannot start a process ({failed}). Try again in a moment"
            finally:
                if slots is not None:
                    slots.give()
        with self._lock:
            self._worker = None
        self._note(running=False, error=error)
        on_end(error)

    def _given_up(self) -> bool:
        """True if the job was asked to stop."""
        return self.state is not None and self.state.stopping

    def _in_line(self, before: int) -> None:
        """Tell that work of other rooms comes first."""
        self._note(stage=f"waiting for other rooms, {before} before this one" if before else "waiting for other rooms")

    def _turn(
        self,
        work: tuple[Callable[..., Any], tuple[Any, ...]],
        on_part: Callable[[Any], None],
        on_done: Callable[[Any], None],
    ) -> str:
        """Do the work, unless it was given up meanwhile; why it failed, or "" (OSError: no process can be begun)."""
        with self._lock:
            if self._worker is None and not self._given_up():
                self._worker = self._ready()
            worker = self._worker
        return "stopped" if worker is None else self._work(worker, work, on_part, on_done)

    def _work(
        self,
        worker: "_Worker",
        work: tuple[Callable[..., Any], tuple[Any, ...]],
        on_part: Callable[[Any], None],
        on_done: Callable[[Any], None],
    ) -> str:
        """Hand the work over and hear what the process says until it ends; why it failed, or ""."""
        timeout = 0.0
        try:
            worker.pipe.send(("work", *work))
            self._on_begin(worker)
            error = self._receive(worker.pipe, on_part, on_done)
            timeout = END_TIMEOUT
        except (EOFError, OSError):
            error = _why(worker.process)
        except HydrostatError as refused:
            error = str(refused)
        except Exception as failed:
            logging.getLogger("hydrostat").exception("work in another process failed")
            error = f"{type(failed).__name__}: {failed}"
        worker.end(timeout)
        return "stopped" if error and self._given_up() else error

    def _on_begin(self, worker: "_Worker") -> None:
        """The process has its work: it can be asked to stop."""
        with self._lock:
            worker.begun = True
            if self.state is not None and self.state.stopping:
                worker.say_stop()

    def _receive(self, pipe: Connection, on_part: Callable[[Any], None], on_done: Callable[[Any], None]) -> str:
        """Hear the process until it says what came of its work; why it failed, or ""."""
        over = time.monotonic() + self._turn_time
        while True:
            while not pipe.poll(POLL_INTERVAL):
                self._end_turn(over)
            self._end_turn(over)
            kind, *rest = pipe.recv()
            if kind == "progress":
                self._note(stage=rest[0], done=rest[1], total=rest[2])
            elif kind == "part":
                on_part(rest[0])
            elif kind == "done":
                on_done(rest[0])
                return ""
            else:
                return rest[0]

    def _end_turn(self, over: float) -> None:
        """Ask the work to end with what it has if its turn is over and others wait."""
        if self.slots is not None and self.slots.are_wanted and time.monotonic() > over:
            self._ask_to_end(yielded=True)

    def _note(self, **changes: Any) -> None:
        with self._lock:
            if self.state is not None:
                self.state = replace(self.state, **changes)
        self._bell.ring(Topic.JOB)


@dataclass(eq=False)
class _Worker:
    """A process and the pipe to it; it ends when the pipe is closed on this side, so it never outlives the studio."""

    process: BaseProcess  # that works
    pipe: Connection  # to it
    begun: bool = field(default=False)  # whether it was handed its work

    @classmethod
    def start(cls) -> "_Worker":
        """Start a process. Its work follows through the pipe: arguments would have to wait until it runs."""
        return cls(*start_worker(run_work))

    def say_stop(self) -> None:
        """Ask it to end with what it has."""
        try:
            self.pipe.send(("stop",))
        except OSError:
            return  # it has just ended

    def end(self, timeout: float) -> None:
        """End it, after some time to end by itself [s]."""
        self.process.join(timeout=timeout)
        if self.process.is_alive():
            self.process.kill()
            self.process.join(timeout=END_TIMEOUT)


def _why(process: BaseProcess) -> str:
    """Why a process has said nothing more."""
    process.join(timeout=END_TIMEOUT)
    return f"worker crashed (exit code {process.exitcode}), probably out of memory. Try a coarser mesh"


def _nothing(value: Any) -> None:
    """Nobody asked."""
