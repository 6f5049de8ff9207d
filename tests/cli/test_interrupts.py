"""What signals do. Oracle: real signals in processes of their own, which begin with SIGINT as usual, or ignored."""

import os
import pty
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from hydrostat.cli.sample import sample
from hydrostat.cli.waiting import one_interrupt

PROGRAM = """
import os, signal
from hydrostat.cli.waiting import heed_interrupts, one_interrupt

def interrupt(number=signal.SIGINT):
    os.kill(os.getpid(), number)

heed_interrupts() if {heed} else None
try:
    with one_interrupt("stopping", signals=(signal.SIGINT, signal.SIGTERM)) as pass_over:
        try:
            {body}
        except (KeyboardInterrupt, SystemExit) as stop:
            print("stopped", *stop.args)
        pass_over()
        interrupt()
        interrupt(signal.SIGTERM)
        print("written")
    interrupt()
    print("ignored as before")
except KeyboardInterrupt:
    print("raised as before")
"""

IGNORED = partial(signal.signal, signal.SIGINT, signal.SIG_IGN)
USUAL = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)

HANDLER = """
#include <signal.h>
#include <unistd.h>
static void answer(int number) { (void)number; if (write(1, "host\\n", 5)) {} }
__attribute__((constructor)) static void set(void) { signal(SIGINT, answer); }
"""


def lines(*, body: str, heed: bool, begun: Callable[[], object], **environment: str) -> tuple[list[str], str]:
    """What the program prints, and what it says beside."""
    found = subprocess.run(
        [sys.executable, "-uc", PROGRAM.format(body=body, heed=heed)],
        capture_output=True,
        text=True,
        check=True,
        preexec_fn=begun,
        env=os.environ | environment,
    )
    return found.stdout.splitlines(), found.stderr


@pytest.mark.parametrize(
    ("body", "words"),
    [("interrupt()", ["stopped"]), ("interrupt(signal.SIGTERM)", ["stopped 143"]), ("pass", [])],
)
@pytest.mark.parametrize(
    ("begun", "heed", "after"),
    [
        (USUAL, False, "raised as before"),
        (USUAL, True, "raised as before"),
        (IGNORED, False, "ignored as before"),
        (IGNORED, True, "raised as before"),
    ],
)
def test_one_signal_stops_and_then_all_is_as_before(
    body: str, words: list[str], begun: Callable[[], object], heed: bool, after: str
) -> None:
    printed, beside = lines(body=body, heed=heed, begun=begun)
    assert printed == [*words, "written", after]
    assert ("stopping" in beside) == bool(words)


@pytest.mark.parametrize("block", ["nullcontext()", 'one_interrupt("stopping")'])
@pytest.mark.parametrize("work", ["import met", "del gone"])
def test_a_signal_waits_where_it_would_do_harm(block: str, work: str, tmp_path: Path) -> None:
    """Oracle: a library that aborts where Ctrl-C raises in its import, as PyTorch does, and a finalizer.

    The signal ends a sleep of ten minutes that follows.
    """
    body = "import os, signal\ntry:\n    os.kill(os.getpid(), signal.SIGINT)\nexcept BaseException:\n    os.abort()\n"
    (tmp_path / "met.py").write_text(body)
    code = f"""
import os, signal, time
from contextlib import nullcontext
from hydrostat.cli.waiting import heed_interrupts, one_interrupt
class Gone:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)
gone = Gone()
heed_interrupts()
with {block}:
    {work}
    print("whole", flush=True)
    time.sleep(600)
"""
    found = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])},
        preexec_fn=USUAL,
        timeout=300,
    )
    assert found.stdout == "whole\n"
    assert "KeyboardInterrupt" in found.stderr
    assert found.returncode == -signal.SIGINT


@pytest.mark.parametrize("heed", [False, True])
def test_a_handler_that_was_not_set_from_python_stays(tmp_path: Path, heed: bool) -> None:
    """Oracle: a handler in C that stands before Python begins, which Python cannot put back."""
    (tmp_path / "host.c").write_text(HANDLER)
    subprocess.run(["gcc", "-shared", "-fPIC", "-o", tmp_path / "host.so", tmp_path / "host.c"], check=True)
    printed, beside = lines(body="interrupt()", heed=heed, begun=USUAL, LD_PRELOAD=str(tmp_path / "host.so"))
    assert printed == ["host", "host", "written", "host", "ignored as before"]
    assert beside == ""


def test_elsewhere_than_in_the_main_thread_nothing_is_changed() -> None:
    code = """
from threading import Thread
from hydrostat.cli.waiting import heed_interrupts, one_interrupt
def work():
    heed_interrupts()
    with one_interrupt("stopping") as pass_over:
        pass_over()
    print("written")
Thread(target=work).start()
"""
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "written\n"


def test_sampling_that_is_interrupted_says_that_it_can_go_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, starfish: Path
) -> None:
    def stopped(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("hydrostat.learning.sample_robot", stopped)
    with pytest.raises(KeyboardInterrupt):
        sample(starfish, tmp_path / "out", count=3)
    assert capsys.readouterr().err == "interrupted: run the same command again to resume\n"


@pytest.mark.parametrize("begun", [USUAL, IGNORED])
@pytest.mark.slow
def test_a_command_that_is_interrupted_says_so(begun: Callable[[], object], tmp_path: Path) -> None:
    """Oracle: exit code 130 and one line; in the background of a script, too, where SIGINT comes ignored."""
    code = "from hydrostat.cli.main import main; main()"
    words = ["simulate", "examples/starfish", "--dynamic", "--duration", "1000s", "--out", str(tmp_path / "out")]
    work = subprocess.Popen(
        [sys.executable, "-c", code, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=begun,
    )
    assert work.stderr is not None
    assert "simulating" in work.stderr.readline()
    time.sleep(0.1)
    work.send_signal(signal.SIGINT)
    printed, beside = work.communicate(timeout=300)
    assert work.returncode == 130
    assert beside == "hydrostat: interrupted; files written so far are complete\n"
    assert "Wrote" not in printed


def test_an_interrupt_while_options_are_read_is_one_line(
    run: Callable[..., tuple[int, str, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("typer.core.TyperGroup.parse_args", interrupt)
    assert run("check") == (130, "", "hydrostat: interrupted; files written so far are complete\n")


def test_an_interrupt_while_commands_are_read_is_one_line() -> None:
    """Oracle: exit code 130 and one line, without a traceback."""
    code = """
import builtins, signal
read = builtins.__import__
def interrupt(name, *rest):
    if name == "typer":
        signal.raise_signal(signal.SIGINT)
    return read(name, *rest)
builtins.__import__ = interrupt
from hydrostat.cli.start import start_program
start_program()
"""
    work = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, preexec_fn=USUAL)
    assert (work.returncode, work.stderr) == (130, "hydrostat: interrupted; nothing was begun\n")


CLOSING = """
import signal, sys, time
from pathlib import Path
from hydrostat.cli.waiting import one_interrupt
with one_interrupt("stopping", interrupt=True):
    try:
        print("begun", flush=True)
        time.sleep(60)
    except KeyboardInterrupt:
        print("kept", flush=True)
        Path(sys.argv[1]).write_text("kept")
"""


@pytest.mark.parametrize("ignored", [False, True], ids=["usual", "nohup"])
def test_a_closed_terminal_stops_work_and_keeps_it(tmp_path: Path, ignored: bool) -> None:
    """Oracle: a terminal whose other end is closed; under nohup it stops nothing, and a polite kill does."""
    kept = tmp_path / "kept"
    child, terminal = pty.fork()
    if child == 0:
        signal.signal(signal.SIGHUP, signal.SIG_IGN if ignored else signal.SIG_DFL)  # tests may run under nohup
        os.execv(sys.executable, [sys.executable, "-c", CLOSING, str(kept)])
    assert b"begun" in os.read(terminal, 100)
    os.close(terminal)
    if ignored:
        os.kill(child, signal.SIGHUP)
        assert os.waitpid(child, os.WNOHANG) == (0, 0)
        os.kill(child, signal.SIGTERM)
    os.waitpid(child, 0)
    assert kept.read_text() == "kept"


def test_another_signal_ends_a_search_as_an_interrupt_does() -> None:
    """SIGTERM raises KeyboardInterrupt where that is asked for, once; later ones are passed over."""
    with one_interrupt("", signals=(signal.SIGTERM,), interrupt=True):
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGTERM)
        os.kill(os.getpid(), signal.SIGTERM)
