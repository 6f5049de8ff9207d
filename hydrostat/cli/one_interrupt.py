"""`one_interrupt`: the first Ctrl-C stops a search; while what was found is finished and written, none does."""

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def one_interrupt() -> Iterator[Callable[[], None]]:
    """Raise KeyboardInterrupt once; say so, and pass over every later one, until the block ends.

    Gives what to call where the search is over: from there on every Ctrl-C is passed over, so that results are whole.
    """
    before = signal.getsignal(signal.SIGINT)

    def pass_over() -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)

    def stop(number: int, frame: FrameType | None) -> None:
        del number, frame
        pass_over()
        print("stopping: the best network so far is solved and written ...", file=sys.stderr, flush=True)
        raise KeyboardInterrupt

    try:
        signal.signal(signal.SIGINT, stop)
    except ValueError:  # not in the main thread, where no signal arrives
        yield _nothing
        return
    try:
        yield pass_over
    finally:
        signal.signal(signal.SIGINT, before)


def _nothing() -> None:
    """No signal has to be passed over."""
