"""A link to emulated motors. Oracles: where the emulated servos are in truth, in their own time; words told."""

import threading
import time

import numpy as np
import pytest
from emulation import NAMES, Rig

from hydrostat.control.bus_link import DEADLINE, LinkState
from hydrostat.control.dynamixel_bus import TORQUE
from hydrostat.control.emulated_servos import InjectedFaults
from hydrostat.errors import HydrostatError

STANDS = 0.25  # motors stand so long after the last command [s]


def moved_after(rig: Rig, seconds: float) -> float:
    """How far any motor moves from so long from now on [m]."""
    rig.chain.wait(seconds)
    before = rig.places
    rig.chain.wait(2.0)
    return float(np.abs(rig.places - before).max())


def test_nothing_turns_before_it_is_armed() -> None:
    rig = Rig()
    with pytest.raises(HydrostatError, match="do not turn: closed"):
        rig.link.send(np.full(3, 0.01), 0.0, speed=0.05)
    rig.link.identify()
    assert rig.link.state is LinkState.CALIBRATED
    with pytest.raises(HydrostatError, match="do not turn: calibrated"):
        rig.link.send(np.full(3, 0.01), 0.0, speed=0.05)
    assert rig.places == pytest.approx(0.0, abs=1e-5)
    assert not any(servo.table[TORQUE] for servo in rig.servos)


def test_it_goes_where_it_is_told_at_its_speed_and_within_limits() -> None:
    rig = Rig()
    rig.begin()
    begin = rig.chain.now
    rig.go(0.01, 0.1, speed=0.02)
    assert rig.places == pytest.approx(0.02 * (rig.chain.now - begin), abs=8e-4)  # it begins gently
    assert rig.go(0.01, 1.0, speed=0.02) == pytest.approx(0.01, abs=3e-5)
    assert rig.places == pytest.approx(0.01, abs=3e-5)
    rig.go((0.09, -0.5, 0.01), 1.5)
    assert rig.places == pytest.approx((0.04, -0.002, 0.01), abs=3e-5)


@pytest.mark.parametrize("silent", [1, 2, 3])
def test_who_is_silent_is_named_and_nothing_is_armed(silent: int) -> None:
    rig = Rig()
    rig.servos[silent - 1].ails = InjectedFaults(deaf=True)
    with pytest.raises(HydrostatError, match=f"motor {silent} does not answer"):
        rig.link.identify()
    assert rig.link.state is LinkState.FAULT
    with pytest.raises(HydrostatError):
        rig.link.send(np.zeros(3), 0.0, speed=0.05)


def test_watchdogs_are_tried_and_one_that_fails_is_told() -> None:
    rig = Rig()
    rig.servos[0].ails = InjectedFaults(deaf_watchdog=True)
    assert [fact.watchdog for fact in rig.link.identify()] == [False, True, True]
    assert "index flexor: motor 1, XL330-M288, firmware 52, does not stop by itself" in "\n".join(rig.log)
    assert rig.places == pytest.approx(0.0, abs=1e-5)


def test_a_dead_host_leaves_motors_standing_by_the_watchdog_alone() -> None:
    rig = Rig()
    rig.begin()
    rig.go(0.03, 0.3)
    rig.bus.write(np.full(3, 1.0 + 0.035 / 0.008), np.full(3, 6.0))  # far ahead, past what the link would tell
    assert moved_after(rig, STANDS) == 0.0
    assert (rig.places < 0.03).all()


def test_a_dead_host_leaves_motors_standing_without_any_watchdog() -> None:
    rig = Rig()
    for servo in rig.servos:
        servo.ails = InjectedFaults(deaf_watchdog=True)
    rig.begin()
    rig.go(0.03, 0.3)
    assert moved_after(rig, STANDS) == 0.0
    assert (rig.places < 0.03).all()


def test_the_deadline_of_the_host_alone_stops_them() -> None:
    rig = Rig()
    for servo in rig.servos:
        servo.ails = InjectedFaults(deaf_watchdog=True)
    rig.begin()
    rig.go(0.03, 0.2)
    rig.bus.write(np.full(3, 1.0 + 0.035 / 0.008), np.full(3, 1.0))
    end = rig.chain.now + STANDS
    while rig.chain.now < end:
        rig.chain.wait(0.02)
        rig.link.check_deadline()
    assert rig.link.state is LinkState.HOLD
    assert moved_after(rig, 0.0) == 0.0
    with pytest.raises(HydrostatError, match=r"no command for 0\.2"):
        rig.link.send(np.full(3, 0.03), 0.0, speed=0.05)


def test_the_watch_runs_beside_a_busy_program(monkeypatch: pytest.MonkeyPatch) -> None:
    """Arming begins it, on the clock that links have."""
    rig = Rig()
    monkeypatch.setattr("hydrostat.control.bus_link.steady", rig.link._clock)
    rig.begin()
    rig.go(0.03, 0.1)
    rig.chain.now += DEADLINE + 0.1  # the program did not come to tell anything
    until = time.monotonic() + 120.0
    while rig.link.state is LinkState.ARMED and time.monotonic() < until:
        time.sleep(0.01)
    assert rig.link.state is LinkState.HOLD
    rig.link.close()
    assert threading.active_count() < 50


def test_a_computer_held_up_while_it_writes_goals_goes_on() -> None:
    """Watchdogs fire before the goals arrive and refuse them; motors stood until they were told to have lost power."""
    rig = Rig()
    rig.begin()
    rig.go(0.03, 0.2)
    write = rig.bus.write

    def write_late(*goals: np.ndarray) -> None:
        rig.chain.wait(0.11)
        rig.bus.write = write
        write(*goals)

    rig.bus.write = write_late
    assert rig.go(0.01, 1.5) == pytest.approx(0.01, abs=3e-5)


def test_a_suspended_computer_finds_its_motors_on_hold() -> None:
    rig = Rig()
    rig.begin()
    rig.go(0.03, 0.2)
    rig.chain.wait(3600.0 / 1000)
    with pytest.raises(HydrostatError, match="re-arm the motors"):
        rig.link.send(np.full(3, 0.03), 0.0, speed=0.05)
    before = rig.places
    rig.link.arm()
    assert rig.places == pytest.approx(before, abs=3e-4)  # a watchdog that is reset lets it go on for an instant
    assert rig.go(0.03, 1.5) == pytest.approx(0.03, abs=3e-5)


@pytest.mark.parametrize(
    ("ails", "told"),
    [
        (InjectedFaults(deaf=True), "the motor of index extensor has not answered for 0.2"),
        (InjectedFaults(stuck=True), "index extensor does not follow: it stands at"),
        (InjectedFaults(hot=True), "the motor of index extensor reports: too hot"),
    ],
)
def test_a_motor_that_fails_is_named_and_all_stand(ails: InjectedFaults, told: str) -> None:
    rig = Rig(guarded=False)
    rig.begin()
    rig.go(0.02, 0.2)
    rig.servos[1].ails = ails
    with pytest.raises(HydrostatError, match=told):
        rig.go(0.04, 3.0)
    assert rig.link.state is LinkState.FAULT
    assert told in "\n".join(rig.log)
    assert moved_after(rig, STANDS) == 0.0


@pytest.mark.parametrize("models", [(1200, 1220, 1060), (777, 777, 777)])
@pytest.mark.parametrize("guarded", [False, True])
def test_a_motor_that_restarts_is_not_told_as_a_broken_cable(models: tuple[int, int, int], guarded: bool) -> None:
    """Where its cable pulls, a guard misses that pull before the motor is seen not to follow."""
    rig = Rig(guarded=guarded, models=models)
    rig.begin()
    rig.go(0.03, 1.5)
    rig.servos[2].begin_anew()
    with pytest.raises(HydrostatError, match="the motor of thumb lost power and restarted: its torque is off"):
        rig.go(0.04, 3.0)


@pytest.mark.parametrize("late", [0.12, 0.18])
def test_a_computer_that_is_late_again_and_again_loses_no_motor(late: float) -> None:
    """Watchdogs of servos fire after 0.1 s; until the deadline of 0.2 s motors go on with the next command."""
    rig = Rig()
    rig.begin()
    for _ in range(12):
        rig.go(0.03, 0.1)
        rig.chain.wait(late)
    assert rig.go(0.03, 1.5) == pytest.approx(0.03, abs=3e-5)
    assert rig.link.state is LinkState.ARMED
    rig.chain.wait(0.3)
    with pytest.raises(HydrostatError, match=r"this computer is late: no command for 0\.3"):
        rig.link.send(np.full(3, 0.03), 0.0, speed=0.05)


def test_a_late_computer_does_not_count_against_a_held_motor() -> None:
    """A motor is held for 0.6 s, but for 0.54 s of them this computer is late: the 0.5 s of patience last."""
    rig = Rig(guarded=False)
    rig.begin()
    rig.go(0.01, 0.1)
    rig.servos[0].ails = InjectedFaults(stuck=True)
    for _ in range(3):
        rig.go(0.03, 0.02)
        rig.chain.wait(0.18)
    rig.servos[0].ails = InjectedFaults()
    assert rig.go(0.03, 1.5) == pytest.approx(0.03, abs=3e-5)


def test_an_unplugged_line_is_told() -> None:
    rig = Rig()
    rig.begin()
    rig.go(0.02, 0.2)
    rig.chain.gone = True
    with pytest.raises(HydrostatError, match="the line to the motors is gone"):
        rig.go(0.04, 0.1)
    assert moved_after(rig, STANDS) == 0.0


def test_a_cut_cable_is_named_within_a_second() -> None:
    rig = Rig()
    rig.begin()
    rig.go(0.02, 1.0)
    rig.servos[0].load = lambda angle: 0.0
    begin = rig.chain.now
    with pytest.raises(
        HydrostatError, match=r"index flexor: cable slack or broken, or its motor lost power \(0\.0 N measured"
    ):
        rig.go(0.02, 3.0)
    assert rig.chain.now - begin < 1.0


def test_a_cable_that_is_held_holds_the_motors() -> None:
    rig = Rig()
    rig.begin()
    rig.go(0.02, 1.0)
    rig.servos[0].load = lambda angle: 0.008 * 12.0
    with pytest.raises(HydrostatError, match=r"index flexor: measured tension 1.\.. N, expected 4\.. N"):
        rig.go(0.02, 3.0)
    assert rig.link.state is LinkState.FAULT


def test_stopped_by_hand_it_stands_and_can_be_armed_anew() -> None:
    rig = Rig()
    rig.begin()
    rig.go(0.03, 0.2)
    rig.link.stop()
    rig.link.stop()
    assert rig.link.state is LinkState.STOPPED
    assert moved_after(rig, STANDS) == 0.0
    rig.link.arm()
    rig.go(0.03, 1.0)
    rig.link.close()
    rig.link.close()
    assert rig.link.state is LinkState.CLOSED


def test_the_log_tells_each_state_once() -> None:
    rig = Rig()
    rig.begin()
    rig.go(0.01, 0.5)
    rig.link.close()
    words = [line.split(": ", 2)[2] for line in rig.log]
    assert [word.split(":")[0] for word in words if word.split(":")[0] not in NAMES] == [
        "calibrated",
        "armed",
        "stopped",
        "closed",
    ]


def test_no_motor_is_told_a_speed_above_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the limit of the link over the radius of the spools, for a command ten times as fast."""
    rig, told = Rig(), [0.0]
    rig.begin()
    write = rig.bus.write

    def note(angles: np.ndarray, speeds: np.ndarray) -> None:
        told.append(float(max(speeds)))
        write(angles, speeds)

    monkeypatch.setattr(rig.bus, "write", note)
    rig.go(0.03, 0.4, speed=10 * rig.link.limits.speed)
    assert max(told) == pytest.approx(rig.link.limits.speed / 0.008)
