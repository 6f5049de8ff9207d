"""While a person waits: what takes long, how far it is, and what Ctrl-C does."""

import os
import signal
import sys
import time
from _thread import interrupt_main, start_new_thread
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Timer, current_thread, get_ident, main_thread
from types import FrameType
from typing import TYPE_CHECKING, Any

from hydrostat.progress import Progress

if TYPE_CHECKING:
    from hydrostat.robot import Robot
    from hydrostat.simulation import Simulation

NOTICE_DELAY = 3.0  # seconds after which a waiting person reads what is computed
STOP_SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Signals that end work and keep what it has: Ctrl-C, a polite kill, a terminal that closes."""


@contextmanager
def patiently(words: str) -> Iterator[None]:
    """Say what is done if it takes long."""
    word = Timer(NOTICE_DELAY, lambda: print(words, flush=True))
    word.daemon = True
    word.start()
    try:
        yield
    finally:
        word.cancel()


def read_robot(path: Path) -> "Robot":
    """Robot from its folder or robot.toml; a body from a surface is meshed."""
    from hydrostat.robot import load_robot

    with patiently("meshing the body (about 1 s per 2,000 nodes) ..."):
        return load_robot(path)


def prepare_physics(robot: "Robot") -> "Simulation":
    """Build the physics of a robot; solve it once if pins hold it."""
    from hydrostat.simulation import Simulation, rests_at_first

    simulation = Simulation(robot)
    if rests_at_first(robot):
        simulation.solve({}, strict=False)
    return simulation


@contextmanager
def progress_bar() -> Iterator[Progress]:
    """A function to call with the stage, how much of it is done, and how much there is."""
    if not sys.stderr.isatty():
        yield _lines()
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bars

    columns = (TextColumn("{task.description:<22}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    # without a thread of its own: a search shares its work with a copy of this process only while it has one thread
    with Bars(*columns, console=Console(stderr=True), auto_refresh=False) as bar:
        tasks: dict[str, int] = {}

        def tell(stage: str, done: int, total: int) -> None:
            if stage not in tasks:
                tasks[stage] = bar.add_task(stage, total=total)
            bar.update(tasks[stage], completed=done, total=total, refresh=True)  # type: ignore[arg-type]

        yield tell


def report_progress() -> Progress:
    """Return a function that prints progress, speed and the remaining time, or the stage alone if that is not known."""
    begin: dict[str, tuple[float, int]] = {}
    seen: dict[str, int] = {}
    last = [0.0]

    often, seldom = 0.5, 20.0  # so often progress is told on a terminal, and in a log [s]

    def tell(stage: str, done: int, total: int) -> None:
        now = time.monotonic()
        if done < seen.get(stage, 0):
            del begin[stage]  # the next one of its kind
        seen[stage] = done
        since, first = begin.setdefault(stage, (now, done))
        terminal = sys.stderr.isatty()
        if (done < total or not total) and now - last[0] < (often if terminal else seldom):
            return
        last[0] = now
        seconds, made = now - since, done - first
        words = f"{stage}: {done} of {total}" if total else stage
        if made and seconds > 0:
            rate = made / seconds
            words += f", {rate:.3g}/s" + (f", {_span((total - done) / rate)} left" if done < total else "")
        end = "\n" if done == total or not terminal else ""
        print(f"{chr(13)}{words:<70}" if terminal else words, end=end, file=sys.stderr, flush=True)

    return tell


def _span(seconds: float) -> str:
    minutes = seconds / 60
    return f"{seconds:.0f} s" if minutes < 2 else f"{minutes:.0f} min" if minutes < 120 else f"{minutes / 60:.1f} h"


@contextmanager
def show_search(title: str) -> Iterator[Callable[[int, float], None]]:
    """A function to call with the steps of a search and its error [m]: after a while it says how the search goes."""
    last, shown = time.monotonic(), False

    def tell(steps: int, error: float) -> None:
        nonlocal last, shown
        if time.monotonic() - last < NOTICE_DELAY:
            return
        last = time.monotonic()
        words = f"{title}: step {steps}, rms error {1e3 * error:.2f} mm ..."
        print(
            f"\r{words:<60}" if sys.stderr.isatty() else words, end="" if sys.stderr.isatty() else "\n", file=sys.stderr
        )
        sys.stderr.flush()
        shown = sys.stderr.isatty()

    yield tell
    if shown:
        print(f"\r{'':<60}\r", end="", file=sys.stderr, flush=True)


def _lines() -> Progress:
    """Print each stage when it begins, once, however often it comes again."""
    seen: set[str] = set()

    def tell(stage: str, _done: int, _total: int) -> None:
        if stage not in seen:
            seen.add(stage)
            print(f"{stage} ...", file=sys.stderr, flush=True)

    return tell


@contextmanager
def one_interrupt(
    words: str, *, signals: Sequence[int] = STOP_SIGNALS, interrupt: bool = False
) -> Iterator[Callable[[], None]]:
    """Let the first Ctrl-C stop the work, and no later one spoil how it ends; some words, if any, are printed then.

    The first signal raises KeyboardInterrupt, or SystemExit for another signal than SIGINT unless `interrupt`; every
    later one is passed over until the block ends. Then signals do again what they did before, whatever that was. A
    handler that was not set from Python cannot be put back by it, so where there is such a one it stays, and answers.
    A SIGHUP that came ignored, as under nohup, stays ignored. From the first signal on, output that nobody reads any
    more, as of a closed terminal or pipe, is dropped, and does not end the work that is still to be kept.

    Gives what to call where the work is over: from there on every signal is passed over, so that results are whole.
    """
    before = {number: signal.getsignal(number) for number in signals}
    hangup = getattr(signal, "SIGHUP", None)
    ours = [
        number
        for number, handler in before.items()
        if handler is not None and not (number == hangup and handler == signal.SIG_IGN)
    ]
    if current_thread() is not main_thread():  # where no signal arrives
        ours = []

    def pass_over() -> None:
        outlive_readers(errors=OSError)
        for number in ours:
            signal.signal(number, signal.SIG_IGN)

    def stop(number: int, frame: FrameType | None) -> None:
        if _put_off(number, frame):
            return
        pass_over()
        if words:
            print(words, file=sys.stderr, flush=True)
        raise KeyboardInterrupt if interrupt or number == signal.SIGINT else SystemExit(128 + number)

    try:
        for number in ours:
            signal.signal(number, stop)
        yield pass_over
    finally:
        for number in ours:
            signal.signal(number, before[number])


def _put_off(number: int, frame: FrameType | None) -> bool:
    """Tell whether a signal must wait for the end of an import or a finalizer, and send it again soon.

    A compiled library aborts if a signal raises in its import. Callbacks of the import system and `__del__` drop what
    is raised in them.
    """
    while frame and not (frame.f_code.co_filename.startswith("<frozen importlib") or frame.f_code.co_name == "__del__"):
        frame = frame.f_back
    if frame:
        thread = get_ident()  # the main one, where handlers run
        start_new_thread(lambda: (time.sleep(0.02), _send(number, thread)), ())
    return frame is not None


def _send(number: int, thread: int) -> None:
    """Send a signal to the main thread, and wake it there if it sleeps or waits for a file (not on Windows)."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(thread, number)
    else:
        interrupt_main(signal.Signals(number))


class _LastingOutput:
    """Text stream that drops what it cannot write for some errors: work outlives a closed terminal or pipe."""

    def __init__(self, stream: Any, errors: type[OSError]) -> None:
        self._stream, self.dropped = stream, errors

    def write(self, text: str) -> int:
        """Write text, to nowhere if nobody reads it any more."""
        self._try(lambda: self._stream.write(text))
        return len(text)

    def flush(self) -> None:
        """Hand on what was written."""
        self._try(self._stream.flush)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def _try(self, act: Callable[[], object]) -> None:
        try:
            act()
        except self.dropped:
            with suppress(OSError, ValueError):
                nowhere = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nowhere, self._stream.fileno())
                os.close(nowhere)


def outlive_readers(*, errors: type[OSError] = BrokenPipeError) -> None:
    """Let output fail in silence from here on: where its reader has gone, such as `head`, or for all errors."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if isinstance(stream, _LastingOutput):
            stream.dropped = errors
        elif stream is not None:
            setattr(sys, name, _LastingOutput(stream, errors))


def heed_interrupts() -> None:
    """Let SIGINT raise KeyboardInterrupt, after an import that it meets, and also where it came ignored.

    A shell without job control starts `command &` with SIGINT ignored, and Python leaves that so; whoever sends it to
    such a job means it. A handler that stands already stays.
    """

    def interrupt(number: int, frame: FrameType | None) -> None:
        if not _put_off(number, frame):
            raise KeyboardInterrupt

    ours = (signal.SIG_IGN, signal.default_int_handler)
    if signal.getsignal(signal.SIGINT) in ours and current_thread() is main_thread():
        signal.signal(signal.SIGINT, interrupt)
