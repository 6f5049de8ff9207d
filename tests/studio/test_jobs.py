"""Work in processes of their own. Oracles: what the work is written to do, and which processes the system has."""

import os
import select
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from multiprocessing import active_children
from pathlib import Path
from typing import Any

import job_works as works
import pytest

from hydrostat.errors import InputError
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.jobs import Jobs, JobState, Slots
from hydrostat.studio.worker_context import PRELOADED

TIMEOUT = 60.0


class Heard:
    """All that was told of one work."""

    def __init__(self, jobs: Jobs) -> None:
        self.jobs, self.parts, self.results, self.errors = jobs, [], [], []
        self.begun = False
        self.ended, self.parted = threading.Event(), threading.Event()

    def begin(self, function: Callable[..., Any], *arguments: Any) -> "Heard":
        self.begun = True
        self.jobs.start(
            "Working", function, *arguments, on_part=self.part, on_done=self.results.append, on_end=self.over
        )
        return self

    def over(self, error: str) -> None:
        self.errors.append(error)
        self.ended.set()

    def part(self, value: Any) -> None:
        self.parts.append(value)
        self.parted.set()

    def end(self) -> JobState:
        assert self.ended.wait(TIMEOUT)
        state = self.jobs.state
        assert state is not None
        assert not state.running
        return state


@pytest.fixture
def jobs() -> Iterator[Jobs]:
    made = Jobs(Bell())
    yield made
    made.close()


@pytest.fixture
def heard(jobs: Jobs) -> Heard:
    return Heard(jobs)


def lives(pid: int) -> bool:
    """Whether there is a process of this number."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_parts_come_in_order_then_the_result(heard: Heard) -> None:
    state = heard.begin(works.add, 1, 2, 3).end()
    assert heard.parts == [1, 2, 3]
    assert heard.results == [6]
    assert (state.error, state.stage, state.done, state.total) == ("", "Adding", 3, 3)


def test_a_slot_is_given_back_where_no_process_can_be_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> None:
        raise BlockingIOError("too many processes")

    slots = Slots(1)
    heard = Heard(Jobs(Bell(), slots))
    monkeypatch.setattr("hydrostat.studio.jobs._Worker.start", refuse)
    assert "cannot start a process (too many processes)" in heard.begin(works.add, 1).end().error
    assert slots.wait(lambda: True, print)


def test_work_ends_with_what_it_has_once_its_turn_is_over_and_others_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hydrostat.studio.jobs.POLL_INTERVAL", 0.02)
    slots = Slots(1)
    first, second = (Heard(Jobs(Bell(), slots)) for _ in range(2))
    first.jobs.start("Working", works.wait, on_done=first.results.append, on_part=first.part, on_end=first.over, turn=0)
    assert first.parted.wait(TIMEOUT)
    assert not first.ended.wait(0.2)  # nobody waits
    assert second.begin(works.add, 1).end().error == ""
    assert first.end().yielded
    assert first.results == ["what there was"]
    assert not second.end().yielded


def test_a_person_who_stops_as_the_turn_ends_keeps_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """The worst moment: a person stops just as the turn is over."""
    monkeypatch.setattr("hydrostat.studio.jobs.POLL_INTERVAL", 0.02)
    slots, bell, pressed = Slots(1), Bell(), list[bool]()
    first, second = Heard(Jobs(bell, slots)), Heard(Jobs(Bell(), slots))

    def press(topic: Topic) -> None:
        if first.jobs.state is not None and first.jobs.state.yielded and not pressed:
            pressed.append(True)
            first.jobs.stop()

    bell.listen(press)
    first.jobs.start("Working", works.wait, on_done=first.results.append, on_part=first.part, on_end=first.over, turn=0)
    assert first.parted.wait(TIMEOUT)
    second.begin(works.add, 1).end()
    first.end()
    assert pressed
    assert first.results == ["what there was"]


def test_nothing_is_running_at_first(jobs: Jobs) -> None:
    assert not jobs.is_running
    jobs.stop()
    assert jobs.state is None


def test_all_who_listen_are_told() -> None:
    bell, rung = Bell(), []
    bell.listen(rung.append)
    heard = Heard(Jobs(bell)).begin(works.add, 1)
    heard.end()
    assert set(rung) == {Topic.JOB}


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (works.refuse, "2 winches and 1 cable: ask for more"),
        (works.stumble, "ZeroDivisionError: by nothing"),
        (works.unpicklable, "the result cannot be transferred"),
        (works.die, "exit code 7"),
        (works.leave, "exit code 3"),
    ],
)
def test_why_work_failed_is_told_and_the_next_is_done(heard: Heard, function: Any, words: str) -> None:
    state = heard.begin(function).end()
    assert words in state.error
    assert heard.results == []
    again = Heard(heard.jobs).begin(works.add, 4)
    assert again.end().error == ""
    assert again.results == [4]


def test_the_end_is_told_of_its_own_work_though_other_work_has_begun(jobs: Jobs) -> None:
    """The worst moment: other work begins when the state says that none runs, just before the end is told."""
    first, second = Heard(jobs), Heard(jobs)

    def hear(topic: Topic) -> None:
        if not jobs.is_running and not second.begun:
            second.begin(works.add, 1)

    first.begin(works.refuse)
    jobs._bell.listen(hear)
    assert first.ended.wait(TIMEOUT)
    second.end()
    assert first.errors == ["2 winches and 1 cable: ask for more"]
    assert second.errors == [""]


def test_arguments_that_cannot_be_sent(heard: Heard) -> None:
    state = heard.begin(works.add, threading.Lock()).end()
    assert "pickle" in state.error


def test_what_goes_wrong_on_this_side_ends_the_work(heard: Heard) -> None:
    ended = threading.Event()
    pids = []

    def refuse(pid: int) -> None:
        pids.append(pid)
        raise InputError("not this one")

    heard.jobs.start("Waiting", works.wait, on_part=refuse, on_end=lambda error: ended.set())
    assert ended.wait(TIMEOUT)
    assert heard.jobs.state is not None
    assert heard.jobs.state.error == "not this one"
    assert not lives(pids[0])


def test_one_at_a_time(heard: Heard) -> None:
    heard.begin(works.wait)
    with pytest.raises(InputError, match=r"Working is still running\. Wait or stop it"):
        heard.jobs.start("Other", works.add)
    heard.jobs.stop()
    heard.end()


def test_stopped_work_returns_what_it_has(heard: Heard) -> None:
    heard.begin(works.wait)
    assert heard.parted.wait(TIMEOUT)
    heard.jobs.stop()
    state = heard.end()
    assert state.stopping
    assert state.error == ""
    assert heard.results == ["what there was"]


def test_stopped_before_its_process_is_born(heard: Heard) -> None:
    heard.begin(works.wait)
    heard.jobs.stop()
    state = heard.end()
    assert heard.results == ["what there was"] or state.error == "stopped"


def test_a_stop_cuts_no_message_in_two(heard: Heard) -> None:
    heard.begin(works.chatter)
    assert heard.parted.wait(TIMEOUT)
    heard.jobs.stop()
    assert heard.end().error == ""
    assert heard.results == [pytest.approx(len(heard.parts), abs=1)]
    assert {len(part) for part in heard.parts} == {200_000}


def test_a_stop_when_all_is_done_loses_nothing(heard: Heard) -> None:
    heard.begin(works.finishing, 2000)
    assert heard.parted.wait(TIMEOUT)
    heard.jobs.stop()
    heard.end()
    assert heard.results == ["whole"]


def test_stopped_twice_is_ended_at_once(heard: Heard) -> None:
    heard.begin(works.stubborn)
    assert heard.parted.wait(TIMEOUT)
    heard.jobs.stop()
    assert heard.jobs.is_running
    heard.jobs.stop()
    assert heard.end().error == "stopped"
    heard.jobs.stop()  # nothing runs: nothing happens


def test_a_killed_process_is_told_of(heard: Heard) -> None:
    heard.begin(works.wait)
    assert heard.parted.wait(TIMEOUT)
    os.kill(heard.parts[0], signal.SIGKILL)
    assert "exit code -9" in heard.end().error


def test_closing_ends_all(heard: Heard) -> None:
    others = set(active_children())
    heard.jobs.warm()
    heard.begin(works.wait)
    heard.jobs.warm()
    assert heard.parted.wait(TIMEOUT)
    heard.jobs.close()
    assert heard.end().error == "stopped"
    assert not lives(heard.parts[0])
    with pytest.raises(InputError, match="closing"):
        heard.jobs.start("Other", works.add)
    assert set(active_children()) <= others


def test_a_process_that_was_warmed_has_its_modules(heard: Heard) -> None:
    heard.jobs.warm("wave")
    heard.begin(works.loaded, "wave").end()
    assert heard.results[0][1]
    again = Heard(heard.jobs).begin(works.loaded, "wave")
    again.end()
    assert not again.results[0][1]
    assert heard.results[0][0] != again.results[0][0]


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems do not fork")
@pytest.mark.parametrize("name", PRELOADED)
def test_a_process_begins_with_what_work_imports(heard: Heard, name: str) -> None:
    heard.begin(works.loaded, name).end()
    assert heard.results[0][1]


@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="waits for a process of another by a Linux call")
def test_no_process_outlives_its_studio() -> None:
    """A studio that dies without a word; oracle: the number of its worker is no longer a process that lives."""
    code = (
        "import sys; sys.path[:0] = sys.argv[1:]\n"
        "class Told:\n    def part(self, value): print(value, flush=True)\n"
        "import job_works\nif __name__ == '__main__': job_works.orphan(Told())"
    )
    here = str(Path(__file__).parent)
    told = subprocess.run([sys.executable, "-c", code, here], capture_output=True, text=True, timeout=TIMEOUT)
    pid = int(told.stdout)
    with suppress(ProcessLookupError):  # it may be gone already
        ended = select.select([os.pidfd_open(pid)], [], [], TIMEOUT)[0]
        assert ended


def test_ctrl_c_in_the_terminal_leaves_work_to_the_studio(heard: Heard) -> None:
    heard.begin(works.wait)
    assert heard.parted.wait(TIMEOUT)
    os.kill(heard.parts[0], signal.SIGINT)
    assert lives(heard.parts[0])
    heard.jobs.stop()
    heard.end()
    assert heard.results == ["what there was"]
