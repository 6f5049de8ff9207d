"""Programs that turn motors and die, sleep or lose their line. Oracle: when emulated servos outside them last moved."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from emulation import RADIUS

import hydrostat
from hydrostat.control import EmulatedChain, EmulatedLine, EmulatedServo
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedSts
from hydrostat.control.emulated_servos import InjectedFaults

STANDS = 0.25  # motors stand so long after the last command [s]
HOST = Path(__file__).with_name("host.py")
SLOW = (1, 4, 16)
"""A machine that is too busy lets motors stop for want of commands, before anything happens: then all is tried again in
a time that passes more slowly, for the program and for the servos."""


def chain(kind: str) -> EmulatedChain:
    """Servos at the other end; of Dynamixel's one has a watchdog that does not stop it."""
    if kind == "feetech":
        made: EmulatedChain = EmulatedFeetechChain([EmulatedSts(number, angle=1.0) for number in (1, 2, 3)])
    else:
        ails = [InjectedFaults(), InjectedFaults(deaf_watchdog=True), InjectedFaults()]
        models = (1200, 1220, 1060)
        made = EmulatedChain(
            [EmulatedServo(n + 1, model=models[n], angle=1.0, ails=ails[n]) for n in range(3)],
        )
    made.STEP = 4e-3
    return made


def until(done: Callable[[], object], seconds: float = 300.0) -> None:
    """Wait for something."""
    end = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < end, "it never came to that"
        time.sleep(0.01)


def slower(slow: int) -> SimpleNamespace:
    """The clock of servos in such a time."""
    return SimpleNamespace(monotonic=lambda: time.monotonic() / slow)


def happens(event: str, process: subprocess.Popen[str], line: EmulatedLine) -> None:
    """Let it happen."""
    if event == "unplugged":
        line.unplug()
    elif event in ("SIGINT", "SIGTERM", "SIGHUP", "SIGKILL", "SIGSTOP"):
        process.send_signal(getattr(signal, event))  # nothing to one that a busy machine has ended


TOLD = {
    "SIGKILL": (-9, ""),
    "SIGINT": (-2, "KeyboardInterrupt"),
    "SIGTERM": (143, ""),
    "SIGHUP": (129, ""),
    "SIGSTOP": (1, "told nothing for"),
    "crash": (1, "ZeroDivisionError"),
    "unplugged": (1, "the line to the motors is gone"),
}


def ends(event: str, kind: str, slow: int) -> tuple[int, str, list[float]]:
    """How a program ends to which that happens, its last words, and where the motors then are [m].

    Whatever else it says, the motors must stand in time.
    """
    with EmulatedLine(chain(kind)) as line:
        servos, asleep = line.chain.servos, list[float]()
        process = subprocess.Popen(
            [sys.executable, HOST, line.path, kind, event, str(slow)],
            stderr=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | {"PYTHONPATH": str(Path(hydrostat.__file__).parents[1])},
            preexec_fn=partial(signal.signal, signal.SIGHUP, signal.SIG_DFL),  # tests may run under nohup
        )
        try:
            until(lambda: process.poll() is not None or RADIUS * (servos[0].angle - 1.0) > 0.003)
            happens(event, process, line)
            at = line.chain.now
            if event == "SIGSTOP":
                until(lambda: line.chain.now > at + 1.0)
                assert max(line.moved) - at < STANDS
                asleep = [servo.angle for servo in servos]
                process.send_signal(signal.SIGCONT)
            out, told = process.communicate(timeout=300)
        finally:
            process.kill()
        until(lambda: line.chain.now > at + 1.5)
        if event == "SIGSTOP":  # awake again it tells them to stand, for which a watchdog may have to be reset
            assert [servo.angle for servo in servos] == pytest.approx(asleep, abs=2e-4 / RADIUS)
        told_late = event in ("crash", "SIGSTOP", "clock jumps")
        last = max(servo.heard for servo in servos) if told_late else at
        assert max(line.moved) - last < STANDS
        return process.returncode, out + told, [RADIUS * (servo.angle - 1.0) for servo in servos]


def end_at_once(slow: int, cases: list[tuple[str, str]]) -> list[tuple[int, str, list[float]]]:
    """Let some programs run to their ends at the same time: most of it is waiting."""
    with pytest.MonkeyPatch.context() as patch, ThreadPoolExecutor(3) as pool:
        patch.setattr("hydrostat.control.emulated_feetech.time", slower(slow))
        return list(pool.map(lambda case: ends(*case, slow), cases))


@pytest.mark.slow
def test_motors_stand_whatever_happens_to_the_program() -> None:
    cases = [(event, "dynamixel") for event in TOLD] + [("SIGKILL", "feetech"), ("unplugged", "feetech")]
    left = list[tuple[str, str, str]]()
    for slow in SLOW:
        left = []
        for case, (code, told, places) in zip(cases, end_at_once(slow, cases), strict=True):
            assert "played" not in told, case
            assert max(places) < 0.025, case
            if code != TOLD[case[0]][0] or TOLD[case[0]][1] not in told:
                left.append((*case, told))
        cases = [(event, kind) for event, kind, _ in left]
        if not cases:
            return
    pytest.fail(str(left))


@pytest.mark.slow
def test_a_clock_that_jumps_by_a_year_changes_nothing() -> None:
    told = ""
    for slow in SLOW:
        ((code, told, places),) = end_at_once(slow, [("clock jumps", "dynamixel")])
        if code == 0 and told.strip() == "played":
            assert places == pytest.approx([0.0096] * 3, abs=5e-5)
            return
    pytest.fail(told)
