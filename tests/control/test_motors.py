"""Oracles: the commands that arrive at a link, and what a motor that goes at its speed has taken in by then."""

import time
from dataclasses import replace
from functools import partial
from math import inf
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from builders import gallery_robot, strip_robot

from hydrostat.arrays import Vector
from hydrostat.control import EMULATED, Calibration, Link, Motors, Player, SimulatedLink, arm_motors
from hydrostat.control.link import WATCHDOG_TIMEOUT
from hydrostat.errors import HydrostatError, InputError
from hydrostat.identification import ContractionMap
from hydrostat.robot import Robot, Winch
from hydrostat.simulation import ContractionProfile, ProfileTable

WINCHES = (Winch(name="left", at=(0.0, 0.0), travel=0.06, release=0.01), Winch(name="feet", at=(0.0, 0.0), travel=0.04))


class Noted(Link):
    """Motors that are at once where they shall be; they note what they hear, and fail when told to."""

    def __init__(self) -> None:
        self.heard: list[tuple[list[float], float, float]] = []
        self.stops = 0
        self.send_error: BaseException | None = None
        self.places: Vector | None = None

    def send(self, contractions: Vector, now: float, *, speed: float) -> None:
        if self.send_error is not None:
            raise self.send_error
        self.heard.append((contractions.tolist(), now, speed))

    def read(self, now: float) -> Vector:
        return np.array(self.heard[-1][0]) if self.places is None else self.places

    def stop(self) -> None:
        self.stops += 1

    def close(self) -> None:
        self.stop()


def test_commands_keep_to_the_limits_and_the_speed() -> None:
    link = Noted()
    motors = Motors(WINCHES, link, fastest=0.05)
    assert motors.ask(np.array([0.09, -0.01])) == "left is at its limit of 60.0 mm and was asked for 90.0 mm"
    assert motors.is_moving
    assert motors.drive(3.0)
    motors.turn("left", -1.0)
    motors.set_fastest(0.02)
    motors.drive(3.1)
    assert link.heard == [([0.06, 0.0], 3.0, 0.05), ([-0.01, 0.0], 3.1, 0.02)]
    assert not motors.is_moving
    assert motors.ask(np.array([0.06, 0.04])) == ""


@pytest.mark.parametrize("speed", [0.0, 0.9e-3, 1.1, float("nan")])
def test_speeds_out_of_range_are_refused(speed: float) -> None:
    with pytest.raises(InputError, match="from 1 to 1000 mm/s"):
        Motors(WINCHES, Noted()).set_fastest(speed)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_what_is_no_number_changes_no_command(value: float) -> None:
    motors = Motors(WINCHES, Noted(), places=np.array([0.02, 0.0]))
    with pytest.raises(InputError, match="feet: the contraction must be a finite number"):
        motors.ask(np.array([0.01, value]))
    with pytest.raises(InputError, match="left: the contraction"):
        motors.turn("left", value)
    assert motors.command.tolist() == [0.02, 0.0]


def test_in_silence_they_hold_and_must_be_asked_anew() -> None:
    link = SimulatedLink(np.zeros(2))
    motors = Motors(WINCHES, link, fastest=0.1)
    motors.ask(np.array([0.06, 0.0]))
    motors.drive(10.0)
    motors.drive(10.1)
    with pytest.raises(HydrostatError, match=r"told nothing for 0\.6 s, longer than 0\.5 s, and hold"):
        motors.drive(10.7)
    assert motors.command.tolist() == pytest.approx([0.01, 0.0])
    motors.drive(11.5)  # nothing is asked: the silence is over
    assert motors.places == pytest.approx([0.01, 0.0])
    motors.ask(np.array([0.02, 0.0]))
    motors.drive(11.6)
    motors.drive(11.65)
    assert motors.places == pytest.approx([0.015, 0.0])


def test_just_before_the_silence_they_go_on() -> None:
    motors = Motors(WINCHES, Noted())
    motors.drive(0.0)
    motors.drive(WATCHDOG_TIMEOUT)
    motors.hold()
    motors.drive(99.0)


def test_with_patience_gaps_are_no_silence() -> None:
    motors = Motors(WINCHES, Noted(), command_timeout=inf)
    motors.drive(0.0)
    motors.drive(99.0)


@pytest.mark.parametrize("error", [HydrostatError("unplugged"), ZeroDivisionError(), KeyboardInterrupt()])
def test_on_any_error_they_hold(error: BaseException) -> None:
    link = Noted()
    motors = Motors(WINCHES, link, places=np.array([0.01, 0.0]))
    motors.ask(np.array([0.05, 0.0]))
    link.send_error = error
    with pytest.raises(type(error)):
        motors.drive(0.0)
    assert link.stops == 1
    assert motors.command.tolist() == motors.places.tolist() == [0.01, 0.0]


@pytest.mark.parametrize("places", [[0.0], [0.0, float("nan")]])
def test_motors_that_do_not_tell_where_they_are_hold(places: list[float]) -> None:
    link = Noted()
    link.places = np.array(places)
    motors = Motors(WINCHES, link)
    with pytest.raises(HydrostatError, match="do not tell where each of them is"):
        motors.drive(0.0)
    assert link.stops == 1
    assert motors.places.tolist() == [0.0, 0.0]


@pytest.fixture(scope="module")
def strip() -> Robot:
    robot = strip_robot(columns=4, rows=2)
    up, down = robot.winches
    return replace(robot, winches=(replace(up, release=0.01), replace(down, travel=0.04)))


@pytest.mark.parametrize(
    ("rows", "speed", "words"),
    [
        ("0,0\n1,60", 1.0, ""),
        ("0,0\n1,-10", 1.0, ""),
        (
            "0,0\n\n1,60.1",
            1.0,
            "line 4, column up: 60.1 mm is beyond what the winch can take in, -10 to 60 mm",
        ),
        ("0,-10.1\n1,0", 1.0, "moves.csv, line 2, column up: -10.1 mm is beyond"),
        ("0,0\n1,10\n1.1,40", 0.5, ""),
        (
            "0,0\n1,10\n1.1,40",
            0.6,
            "moves at 180 mm/s, the motors at 150 mm/s at most; play it at 0.5 times",
        ),
        ("0,0\n1,30\n1.1,0", 1.0, "line 4, column up: moves at 300 mm/s"),
        ("-1,0\n1,10", 1.0, "moves.csv, line 2, column time_s: times count from 0 s, not from -1"),
    ],
)
def test_tables_are_checked_row_by_row(strip: Robot, rows: str, speed: float, words: str) -> None:
    table = ProfileTable.read(f"time_s,up\n{rows}\n".encode(), strip, name="moves.csv")
    motors = Motors(strip.winches, Noted())
    if words:
        with pytest.raises(InputError) as caught:
            motors.check(table, speed=speed)
        assert words in str(caught.value)
    else:
        motors.check(table, speed=speed)


@pytest.mark.slow
def test_armed_motors_follow_a_correction(tmp_path: Path) -> None:
    """Emulated motors of a robot whose model wants 10 % more than is commanded. Oracle: the map, and what is read."""
    robot = gallery_robot("starfish")
    count = len(robot.winches)
    weights = np.zeros((count + count * (count + 1) // 2, count))
    weights[:count] = 0.1 * np.eye(count)
    names, travel = tuple(winch.name for winch in robot.winches), np.array([winch.travel for winch in robot.winches])
    lengths = np.array([cable.length for cable in robot.cables])
    made = ContractionMap(winches=names, travel=travel, lengths=lengths, weights=weights, before=1.0, after=0.5)
    (tmp_path / "correction.json").write_bytes(made.text())
    lines = list[str]()
    motors = arm_motors(tmp_path, robot, EMULATED, lambda taken: 0.0 * taken, log=lines.append)
    try:
        assert "correction.json corrects contractions" in lines
        motors.ask(np.array([0.0055, 0.0, 0.0]))
        until = time.monotonic() + 20
        while motors.drive(time.monotonic()) or motors.is_moving:
            assert time.monotonic() < until
            time.sleep(0.02)
        inner = motors.link._link.read(time.monotonic())
        assert inner[0] == pytest.approx(0.005, abs=3e-4)
    finally:
        motors.link.close()


def own_time(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """Give emulated servos a clock that runs only where somebody looks at it or sleeps."""
    now = [0.0]

    def pass_time(seconds: float) -> float:
        now[0] += seconds
        return now[0]

    clock = SimpleNamespace(monotonic=partial(pass_time, 1e-4), sleep=partial(pass_time))
    monkeypatch.setattr("hydrostat.control.emulated_servos.time", clock)
    return clock


def test_emulated_motors_live_slower_on_a_late_computer(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Each wait takes 0.6 s, longer than all deadlines. Oracle: the end of the table."""
    clock = own_time(monkeypatch)
    motors = arm_motors(tmp_path, gallery_robot("starfish"), EMULATED, lambda taken: 0.0 * taken)
    ends = np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]])
    profile, player = ContractionProfile(times=np.array([0.0, 1.0]), values=ends), Player()
    player.rounds = 1
    player.run(motors, profile, wait=lambda _: clock.sleep(0.6))
    assert motors.places == pytest.approx(ends[1], abs=3e-4)
    motors.link.close()


def test_an_emulated_servo_of_300_degrees_pays_out(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Its spool is mounted as the kit says: at step 34 all 14 mm are paid out. Oracle: the end of the move."""
    clock = own_time(monkeypatch)
    robot = replace(gallery_robot("finger"), motor="auto")
    motors = arm_motors(tmp_path, robot, EMULATED, lambda taken: 0 * taken, motor="scs0009")
    assert [motor.model for motor in motors.link.facts] == ["SCS0009"] * 2  # type: ignore[attr-defined]
    ends = np.array([[0.0, 0.0], [13.9e-3, -13.9e-3]])
    player = Player()
    player.rounds = 1
    profile = ContractionProfile(times=np.array([0.0, 2.0]), values=ends)
    player.run(motors, profile, wait=lambda _: clock.sleep(0.02))
    assert motors.places == pytest.approx(ends[1], abs=3e-4)
    motors.link.close()


@pytest.mark.parametrize("turns", [1, -1])
def test_an_assumed_zero_leaves_room_for_payout_and_travel(turns: int) -> None:
    """Oracle: steps 34 to 990 of 1024 on 300 degrees."""
    robot = replace(gallery_robot("finger"), motor="scs0009")
    usual = Calibration.usual(robot).motors
    motors = Calibration(tuple(replace(motor, turns=turns) for motor in usual)).assume_zeros(robot)
    steps = motors.angles(np.full(2, -14e-3)) * 180 / np.pi / 300 * 1024
    assert steps == pytest.approx(34 if turns > 0 else 990)


@pytest.mark.parametrize(
    ("motor", "model"),
    [
        ("auto", "XL330-M288"),
        ("n20", "XL330-M288"),
        ("xc330", "XC330-M288"),
        ("sts3215-12v", "STS3215"),
        ("st3020", "STS3020"),
        ("scs0009", "SCS0009"),
    ],
)
def test_emulated_motors_are_those_of_the_robot(
    motor: str, model: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """They say who they are, and follow. Oracle: the names of both makers, the end of the move."""
    clock = own_time(monkeypatch)
    robot, lines = replace(gallery_robot("starfish"), motor=motor), list[str]()
    motors = arm_motors(tmp_path, robot, EMULATED, lambda taken: 500.0 * taken, log=lines.append)
    assert any(line.startswith("emulated: ") and f"{model}," in line for line in lines), lines
    ends = np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.005]])
    player = Player()
    player.rounds = 1
    profile = ContractionProfile(times=np.array([0.0, 1.0]), values=ends)
    player.run(motors, profile, wait=lambda _: clock.sleep(0.02))
    assert motors.places == pytest.approx(ends[1], abs=3e-4)
    motors.link.close()
