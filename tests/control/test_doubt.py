"""What a hostile review asked of a link: does anything turn when it should not? Oracles: emulated motors, and words."""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import count
from math import inf, nan

import numpy as np
import pytest
from emulation import CURRENT, NAMES, RADIUS, Rig, together
from firmware_bench import Board

from hydrostat.control import BusLink, Calibration, DynamixelBus, LinkLimits, LinkState, WinchMotor, bus
from hydrostat.control.dynamixel_bus import TORQUE, WATCHDOG
from hydrostat.control.emulated_servos import EmulatedChain, EmulatedServo, InjectedFaults
from hydrostat.control.firmware_bus import FirmwareBus
from hydrostat.control.guard import TensionGuard
from hydrostat.control.joined_bus import JoinedBus
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Winch

WINCHES = [Winch(name=name, at=(0.0, 0.0), spool_radius=RADIUS, travel=0.04, release=0.002) for name in NAMES]
SPOOLS = tuple(WinchMotor(winch=name, number=n, zero=1.0, radius=RADIUS) for n, name in enumerate(NAMES, 1))


def test_who_was_never_identified_is_not_armed_after_a_fault() -> None:
    """A fault is not a way around what comes before arming."""
    rig = Rig()
    rig.servos[0].ails = InjectedFaults(deaf=True)
    with pytest.raises(HydrostatError, match="motor 1 does not answer"):
        rig.link.identify()
    rig.servos[0].ails = InjectedFaults()
    with pytest.raises(HydrostatError, match="first identify the motors"):
        rig.link.arm()
    assert not any(servo.table[TORQUE] for servo in rig.servos)


def test_who_was_never_calibrated_is_not_armed_after_a_fault() -> None:
    rig = Rig()
    spools = (replace(SPOOLS[0], zero=None), *SPOOLS[1:])
    link = BusLink(rig.bus, WINCHES, Calibration(spools), clock=rig.chain.clock)
    link.identify()
    rig.servos[1].ails = InjectedFaults(hot=True)
    with pytest.raises(HydrostatError, match="too hot"):
        link.read(0.0)
    rig.servos[1].ails = InjectedFaults()
    with pytest.raises(HydrostatError, match="first calibrate them"):
        link.arm()
    assert not any(servo.table[TORQUE] for servo in rig.servos)


@pytest.mark.parametrize(
    ("goal", "speed"),
    [
        (np.array([0.01, nan, 0.0]), 0.05),
        (np.array([0.01, inf, 0.0]), 0.05),
        (np.array([0.01]), 0.05),
        (np.full(3, 0.01), nan),
        (np.full(3, 0.01), -0.05),
    ],
    ids=["nan", "infinite", "too few", "speed nan", "speed below 0"],
)
def test_what_is_no_goal_stops_motors_and_nothing_of_it_is_sent(goal: np.ndarray, speed: float) -> None:
    rig = Rig()
    rig.begin()
    rig.go(0.01, 0.3)
    with pytest.raises(HydrostatError, match="motors must be told 3 finite contractions"):
        rig.link.send(goal, rig.chain.now, speed=speed)
    assert rig.link.state is LinkState.HOLD
    rig.chain.wait(0.1)
    before = rig.places
    rig.chain.wait(0.5)
    assert rig.places == pytest.approx(before, abs=1e-6)


@pytest.mark.parametrize(("speed", "rise"), [(nan, 1.0), (inf, 1.0), (0.0, 1.0), (5.0, 1.0), (0.06, nan)])
def test_limits_that_limit_nothing_are_refused(speed: float, rise: float) -> None:
    """Goals lie as far ahead as a motor turns in 0.12 s: with no speed to speak of they would lie anywhere."""
    with pytest.raises(InputError, match="limits of motors"):
        LinkLimits(speed=speed, rise=rise)


def test_a_stop_between_the_look_and_the_word_is_not_overtaken() -> None:
    """Another thread stops while a goal is on its way: the motors are stopped after it, too."""
    rig = Rig()
    rig.begin()
    rig.go(0.01, 0.2)
    write = rig.bus.write

    def late(angles: np.ndarray, speeds: np.ndarray) -> None:
        rig.link.stop()
        write(angles, speeds)

    rig.bus.write = late  # type: ignore[method-assign]
    with pytest.raises(HydrostatError, match="the motors do not turn: stopped"):
        rig.link.send(np.full(3, 0.03), rig.chain.now, speed=0.05)
    before = rig.places
    rig.chain.wait(0.5)
    assert rig.places == pytest.approx(before, abs=1.5e-3)  # what it takes to stand; the goal lay 6 mm ahead
    assert rig.link.state is LinkState.STOPPED


def test_a_stop_while_motors_are_armed_is_not_lost() -> None:
    rig = Rig()
    rig.link.identify()
    arm = rig.bus.arm

    def late(currents: np.ndarray) -> None:
        arm(currents)
        rig.link.stop()

    rig.bus.arm = late  # type: ignore[method-assign]
    with pytest.raises(HydrostatError, match="stopped while they were armed"):
        rig.link.arm()
    assert rig.link.state is LinkState.STOPPED


@pytest.mark.parametrize("name", ["read", "write"])
def test_an_error_of_any_kind_stops_motors(name: str) -> None:
    """Not ours alone: whatever is raised below the link, or in what the guard asks."""
    rig = Rig()
    rig.begin()
    rig.go(0.03, 0.2)
    kept = getattr(rig.bus, name)

    def broken(*_: object) -> None:
        setattr(rig.bus, name, kept)
        raise ZeroDivisionError

    setattr(rig.bus, name, broken)
    with pytest.raises(ZeroDivisionError):
        rig.go(0.03, 0.1)
    assert rig.link.state is LinkState.FAULT
    assert "ZeroDivisionError" in rig.link.why


def test_a_computer_that_slept_finds_its_motors_on_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    """The clock of `time.monotonic` stands still while Linux sleeps: the link asks one that does not."""
    slept, ticks = [0.0], count()
    monkeypatch.setattr(time, "clock_gettime", lambda _: 1e-4 * next(ticks) + slept[0])
    if bus._AWAKE is None:
        pytest.skip("time.monotonic counts sleep here")
    rig = Rig()
    rig.bus._clock = bus.steady
    link = BusLink(rig.bus, WINCHES, Calibration(SPOOLS))
    link.identify()
    link.arm()
    link.send(np.full(3, 0.01), 0.0, speed=0.05)
    slept[0] = 3600.0
    with pytest.raises(HydrostatError, match="no command for 36"):
        link.send(np.full(3, 0.03), 0.0, speed=0.05)


@pytest.mark.parametrize("models", [(1200, 1220, 1060), (777, 777, 777)], ids=["dynamixel", "feetech"])
def test_a_servo_that_lost_its_turns_is_not_armed_again(models: tuple[int, ...]) -> None:
    """It counts from within one turn when it is switched on: its zero is wrong by 50 mm of cable here."""
    rig = Rig(models=models, guarded=False)
    rig.link._low, rig.link._high = rig.link._low - 0.1, rig.link._high + 0.1  # a winch of many turns
    for servo in rig.servos:
        servo.angle = 7.0
    rig.begin()
    rig.go(rig.places, 0.1)
    rig.servos[1].begin_anew()
    with pytest.raises(HydrostatError, match="index extensor reports: lost power for a moment"):
        rig.go(rig.places, 0.1)
    with pytest.raises(HydrostatError, match="calibrate them again, as a motor"):
        rig.link.arm()


def test_a_board_that_was_reset_is_told_and_not_armed_again() -> None:
    """It counts from 0 wherever its motors are: armed, it would take in what they have once more."""
    board = Board()
    line = FirmwareBus(board, [1000.0, 1000.0], clock=board.clock, wait=board.run)
    line.identify()
    line.mark()
    link = BusLink(
        line,
        WINCHES[:2],
        Calibration(tuple(replace(each, zero=0.0) for each in SPOOLS[:2])),
        clock=board.clock,
    )
    link.identify()
    link.arm()

    def go(times: int) -> None:
        for _ in range(times):
            link.send(np.full(2, 0.02), 0.0, speed=0.06)
            board.run(0.01)
            link.read(0.0)

    go(30)
    board.hang()  # its hardware watchdog resets it
    with pytest.raises(HydrostatError, match=r"has not answered|switched off or reset, and its motors count again"):
        go(60)
    board.run(0.3)
    with pytest.raises(HydrostatError, match=r"was switched off or reset|calibrate them again"):
        link.arm()
    where = board.winches[0].angle
    board.run(0.5)
    assert board.winches[0].angle == pytest.approx(where, abs=5)


def test_a_board_that_fell_silent_on_hold_is_armed_again() -> None:
    """Motors that stand are told nothing, and their board says so: that is no fault."""
    board = Board()
    line = FirmwareBus(board, [1000.0, 1000.0], clock=board.clock, wait=board.run)
    line.identify()
    line.mark()
    spools = tuple(replace(each, zero=0.0) for each in SPOOLS[:2])
    link = BusLink(line, WINCHES[:2], Calibration(spools), clock=board.clock)
    link.identify()
    link.arm()
    board.run(1.0)
    with pytest.raises(HydrostatError, match="no command for"):
        link.send(np.full(2, 0.01), 0.0, speed=0.06)
    board.run(1.0)
    link.arm()
    for _ in range(60):
        link.send(np.full(2, 0.01), 0.0, speed=0.06)
        board.run(0.01)
        places = link.read(0.0)
    assert places == pytest.approx([0.01, 0.01], abs=2e-4)


def two_lines(*, first: int = 1, second: int = 8) -> tuple[BusLink, list[EmulatedServo], list[EmulatedChain]]:
    """A link to two lines of servos with working watchdogs, the second one slow to arm."""
    servos = [[EmulatedServo(n, angle=1.0, model=1060) for n in range(1, count + 1)] for count in (first, second)]
    chains = [EmulatedChain(each) for each in servos]
    together(chains)
    numbers = [[servo.number for servo in each] for each in servos]
    parts = [
        DynamixelBus(chain, each, clock=chains[0].clock, wait=chains[0].wait)
        for chain, each in zip(chains, numbers, strict=True)
    ]
    places = [list(range(first)), list(range(first, first + second))]
    winches = [replace(WINCHES[0], name=f"winch {n}") for n in range(first + second)]
    spools = [
        WinchMotor(winch=winch.name, number=number, board=board, zero=1.0, radius=RADIUS, current=CURRENT)
        for winch, (board, number) in zip(
            winches, [(1 + b, n) for b, each in enumerate(numbers) for n in each], strict=True
        )
    ]
    line = JoinedBus(list(zip(parts, places, strict=True)))
    link = BusLink(line, winches, Calibration(tuple(spools)), clock=chains[0].clock)
    return link, [servo for each in servos for servo in each], chains


def test_watchdogs_of_the_first_line_do_not_fire_while_the_last_is_armed() -> None:
    link, servos, chains = two_lines()
    chains[1].back = lambda data: (chains[0].wait(0.003), data)[1]  # a slow line
    assert all(fact.watchdog for fact in link.identify())
    link.arm()
    assert all(servo.get(WATCHDOG, 1) > 0 for servo in servos)
    chains[1].back = lambda data: data
    for _ in range(60):
        begin = chains[0].now
        link.send(np.full(9, 0.01), begin, speed=0.05)
        link.read(begin)
        chains[0].wait(max(0.0, 0.02 - (chains[0].now - begin)))
    assert [RADIUS * (servo.angle - 1.0) for servo in servos] == pytest.approx([0.01] * 9, abs=1e-4)


def unplugged(servos: list[EmulatedServo], chains: list[EmulatedChain]) -> None:
    chains[1].gone = True


def deaf(servos: list[EmulatedServo], chains: list[EmulatedChain]) -> None:
    servos[4].ails = InjectedFaults(deaf=True)


def hot(servos: list[EmulatedServo], chains: list[EmulatedChain]) -> None:
    servos[4].ails = InjectedFaults(hot=True)


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (unplugged, "board 2: the line to the motors is gone"),
        (deaf, r"the motor of winch 4 \(board 2\) has not answered"),
        (hot, r"the motor of winch 4 \(board 2\) reports: too hot"),
    ],
)
def test_what_happens_to_one_line_is_told_with_its_board_and_stops_all(harm: Callable, words: str) -> None:
    link, servos, chains = two_lines(first=2, second=3)
    link.identify()
    link.arm()

    def go(seconds: float) -> None:
        end = chains[0].now + seconds
        while chains[0].now < end:
            begin = chains[0].now
            link.send(np.full(5, 0.04), begin, speed=0.05)
            link.read(begin)
            chains[0].wait(max(0.0, 0.02 - (chains[0].now - begin)))

    go(0.2)
    harm(servos, chains)
    with pytest.raises(HydrostatError, match=words):
        go(1.0)
    chains[0].wait(0.25)
    before = [servo.angle for servo in servos]
    chains[0].wait(0.5)
    assert [servo.angle for servo in servos] == pytest.approx(before, abs=1e-4)
    assert max(before) < 1.0 + 0.035 / RADIUS


def test_a_mute_line_keeps_no_other_from_standing() -> None:
    """The first line is asked three times in vain; the second has been told before, and goes no further meanwhile."""
    link, servos, chains = two_lines(first=2, second=2)
    link.identify()
    link.arm()
    for _ in range(15):
        link.send(np.full(4, 0.04), chains[0].now, speed=0.05)
        chains[0].wait(0.02)
        link.read(chains[0].now)
    link.send(np.full(4, 0.04), chains[0].now, speed=0.05)
    chains[0].wait(0.01)
    for servo in servos[:2]:
        servo.ails = InjectedFaults(deaf=True)
    began, before, farthest = chains[0].now, [servo.angle for servo in servos[2:]], 0.0

    def look() -> None:
        nonlocal farthest
        farthest = max(farthest, *(abs(s.angle - was) for s, was in zip(servos[2:], before, strict=True)))

    chains[1].watch = look
    link.stop()
    assert chains[0].now - began > 0.05  # so long the first line was asked
    chains[0].wait(0.15)
    stood = [servo.angle for servo in servos[2:]]
    chains[0].wait(0.3)
    assert [servo.angle for servo in servos[2:]] == pytest.approx(stood, abs=1e-6)
    assert RADIUS * farthest < 1e-3  # 0.8 mm to stand at 200 rad/s^2; 3.2 mm when the second line was told last


def test_closing_leaves_no_gap_between_the_stop_and_the_line() -> None:
    """A thread that tells goals while another closes comes too late: the last word on the line is to stand."""
    rig = Rig()
    rig.begin()
    rig.go(0.02, 0.2)
    ended = list[str]()

    def tell() -> None:
        try:
            rig.bus.write(np.full(3, 1.0 + 0.03 / RADIUS), np.full(3, 1.0))
            ended.append("told")
        except HydrostatError as error:
            ended.append(str(error))

    thread, stop = threading.Thread(target=tell), rig.bus.stop

    def stop_and_be_slow() -> None:
        stop()
        thread.start()
        thread.join(0.3)

    rig.bus.stop = stop_and_be_slow  # type: ignore[method-assign]
    rig.bus.close()
    thread.join()
    assert len(ended) == 1
    assert "the line to the motors is gone" in ended[0]


@pytest.mark.parametrize("speed", [0.501, 5.0, 0.0, -0.1])
def test_no_speed_above_half_a_meter_a_second_is_allowed(speed: float) -> None:
    with pytest.raises(InputError, match=r"speed must be above 0 and at most 0\.5"):
        LinkLimits(speed=speed)
    assert LinkLimits(speed=0.5).speed == 0.5


def test_a_motor_above_75_degrees_stops_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: the largest temperature that docs/motors.md allows."""
    rig, heat = Rig(), [75.0]
    heard = rig.bus.read
    monkeypatch.setattr(rig.bus, "read", lambda: replace(heard(), temperatures=np.array([30.0, heat[0], 30.0])))
    rig.begin()
    rig.go(0.005, 0.2)
    heat[0] = 76.0
    with pytest.raises(HydrostatError, match="76 degrees"):
        rig.go(0.005, 0.2)
    assert not any(servo.table[TORQUE] for servo in rig.servos) or rig.link.state is LinkState.FAULT


def test_a_guard_forgets_a_cable_that_is_felt_again() -> None:
    """Oracle: the time limit of the guard: two short losses are not one long one."""
    guard = TensionGuard(lambda taken: 1e3 * taken, np.ones(1), ("left",))
    taken, radius = np.array([0.01]), np.array([0.01])
    felt, lost = np.array([0.1]), np.array([0.0])
    for now, currents in ((0.0, lost), (0.4, lost), (0.45, felt), (0.5, lost), (0.9, lost)):
        assert guard.fault(taken, currents, radius, now) == ""
    assert "left" in guard.fault(taken, lost, radius, 1.01)
    guard.begin()
    assert guard.fault(taken, lost, radius, 1.1) == ""
