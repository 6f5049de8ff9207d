"""`map_in_order`: independent pieces of a search, shared by two processes, with the results of one."""

import io
import os
import pickle
import signal
import struct
import sys
import threading
import warnings
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from typing import Any, NoReturn, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def map_in_order(
    work: Callable[[Item], Result], items: Sequence[Item], *, cores: int = 1, known: Sequence[object] = ()
) -> Generator[Result, None, None]:
    """Yield the results of some work in the order of its items, every other one computed by a second process.

    Results depend on their items alone, so they are the same for one core and for two, byte for byte. The second
    process begins as a copy of this one, without the threads of its libraries: work must use none that has some, such
    as typst, which would wait for them forever. Close the iterator where not all results are needed, which ends that
    process.

    Args:
        work: computes a result, or raises; the error is raised here in its turn.
        items: given to the work.
        cores: 1 to compute them all here, when they are asked for.
        known: large objects that results refer to; results of the second process refer to those of this one.
    """
    if cores < 2 or len(items) < 2 or not can_share():
        yield from map(work, items)
        return
    reader, writer = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 warns of threads, such as those of BLAS
        child = os.fork()
    if child == 0:
        os.close(reader)
        _work_aside(work, items[1::2], writer, known)
    os.close(writer)
    try:
        with os.fdopen(reader, "rb") as pipe:
            for index, item in enumerate(items):
                if index % 2 == 0:
                    yield work(item)
                    continue
                answer = _read_answer(pipe, known)
                if answer is None:  # the system ended that process: its work is done here
                    yield work(item)
                else:
                    done, value = answer
                    if not done:
                        raise value
                    yield value
    finally:
        with suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)


def can_share() -> bool:
    """Return True where a copy of this process can be made safely: on Linux, while it has one Python thread."""
    return sys.platform == "linux" and threading.active_count() == 1


def _work_aside(work: Callable[[Any], Any], items: Sequence[Any], writer: int, known: Sequence[object]) -> NoReturn:
    """Work in the copied process: send the answers one by one, and end without any cleaning up."""
    try:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, signal.SIG_DFL)
        with os.fdopen(writer, "wb") as pipe:
            for item in items:
                try:
                    answer: tuple[bool, Any] = (True, work(item))
                except BaseException as error:  # noqa: BLE001  # raised again by the other process
                    answer = (False, error)
                content = io.BytesIO()
                _TrialPickler(content, known).dump(answer)
                pipe.write(struct.pack("<Q", content.tell()) + content.getvalue())
                pipe.flush()
                if not answer[0]:
                    break
    finally:
        os._exit(0)


def _read_answer(pipe: io.BufferedReader, known: Sequence[object]) -> tuple[bool, Any] | None:
    """Read one answer; None if the other process ended before it was whole, or it cannot be made again here."""
    head = pipe.read(8)
    size = struct.unpack("<Q", head)[0] if len(head) == 8 else 0
    content = pipe.read(size)
    if not size or len(content) != size:
        return None
    try:
        return _TrialUnpickler(io.BytesIO(content), known).load()
    except Exception:  # noqa: BLE001  # an error with arguments of its own: the work is done here, and raises it
        return None


class _TrialPickler(pickle.Pickler):
    """Writes objects that both processes know as their numbers."""

    def __init__(self, file: io.BytesIO, known: Sequence[object]) -> None:
        super().__init__(file, protocol=pickle.HIGHEST_PROTOCOL)
        self._numbers = {id(one): number for number, one in enumerate(known)}

    def persistent_id(self, one: object) -> int | None:
        return self._numbers.get(id(one))


class _TrialUnpickler(pickle.Unpickler):
    """Reads what `_TrialPickler` wrote in a copy of this process."""

    def __init__(self, file: io.BytesIO, known: Sequence[object]) -> None:
        super().__init__(file)
        self._known = known

    def persistent_load(self, number: int) -> object:
        return self._known[number]
