"""`run_bounded`: work on a file of unknown origin in a process of its own, ended when it takes too long or too much."""

import os
import pickle
import select
import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from hydrostat.cli.waiting import NOTICE_DELAY
from hydrostat.errors import InputError

MEMORY = 1_800_000_000
"""The most memory that a file may take [bytes]."""

_Result = TypeVar("_Result")


def run_bounded(work: Callable[[], _Result], *, file: str, words: str, seconds: float, memory: int = MEMORY) -> _Result:
    """Run work in a child process and return its result; compiled loops cannot be interrupted, but a process can.

    Ctrl-C ends it at once. Where processes cannot be forked the work is done here, without a limit.

    Args:
        work: function to run; its result can be pickled.
        file: name of the file for error messages.
        words: said when it takes long.
        seconds: the most processor time.
        memory: the most beyond that of this process [bytes].

    Raises:
        InputError: it took longer or more; and all that the work raises.
    """
    if not hasattr(os, "fork"):
        return work()
    sys.stdout.flush()
    sys.stderr.flush()
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        _work(work, writer, seconds)
    os.close(writer)
    try:
        content = _read_child(child, reader, file, words, seconds, memory)
    finally:
        os.close(reader)
        with suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
    if not content:
        raise InputError(f"{file}: reading failed ({_describe_exit(status)}). Simplify the file or export it again.")
    done, value = pickle.loads(content)  # of our own child
    if not done:
        raise value
    return value


def _work(work: Callable[[], Any], writer: int, seconds: float) -> NoReturn:
    """In the child: do it, send what came of it, and end."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.alarm(int(10 * seconds) + 60)  # should nobody watch any more
    code = 1
    try:
        try:
            answer: tuple[bool, Any] = (True, work())
        except MemoryError:
            answer = (False, InputError("out of memory. Simplify the file."))
        except Exception as error:  # noqa: BLE001  # the parent raises it again
            answer = (False, error)
        with os.fdopen(writer, "wb") as pipe:
            pipe.write(pickle.dumps(answer))
        code = 0
    finally:
        os._exit(code)


def _read_child(child: int, reader: int, file: str, words: str, seconds: float, memory: int) -> bytes:
    """Return the bytes that the child sends; end it when it takes longer or more memory."""
    parts: list[bytes] = []
    began = told = time.monotonic()
    usage, inherited = Path(f"/proc/{child}"), _usage_of(Path("/proc/self"), 0.0)[1]
    look, again = 0.05, 5.0  # seconds between looks, and between words
    while True:
        ready, _, _ = select.select([reader], [], [], look)
        if ready:
            part = os.read(reader, 1 << 20)
            if not part:
                return b"".join(parts)
            parts.append(part)
            continue
        now = time.monotonic()
        spent, taken = _usage_of(usage, now - began)
        if spent > seconds:
            raise InputError(
                f"{file}: time limit reached ({seconds:.3g} s). Simplify it or allow more time, e.g. --timeout 2min."
            )
        if taken - inherited > memory:
            raise InputError(f"{file}: memory limit reached ({1e-9 * memory:.2g} GB). Simplify the file.")
        if now - told > (NOTICE_DELAY if told == began else again):
            told = now
            print(words if now - began < 2 * NOTICE_DELAY else f"{words} {now - began:.0f} s", flush=True)


def _usage_of(usage: Path, waited: float) -> tuple[float, int]:
    """Processor time [s] and memory [bytes] of a process; the time waited and 0 where the system does not say."""
    try:
        fields = (usage / "stat").read_text().rpartition(")")[2].split()
        taken = int((usage / "statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, IndexError, ValueError):
        return waited, 0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), taken


def _describe_exit(status: int) -> str:
    code = os.waitstatus_to_exitcode(status)
    return f"signal {-code}" if code < 0 else f"code {code}"
