"""Motors on two boards behind one link. Oracles: where motors are on two chips in simavr, and the time of the chips."""

import shutil
from dataclasses import replace
from pathlib import Path

import firmware_bench
import numpy as np
import pytest
from builders import strip_robot
from firmware_bench import Board

from hydrostat.control import BusLink, Calibration, LinkState, open_bus
from hydrostat.control.firmware_build import firmware_settings, on_boards, robot_word
from hydrostat.control.firmware_bus import FirmwareBus
from hydrostat.control.joined_bus import JoinedBus
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Robot, Winch

COUNTS, RADIUS = 1000.0, 0.005


class TwinBoard(Board):
    """A board with a library of its own, as `winch_bench.c` knows one chip; time is the same on both."""

    twin: "TwinBoard | None" = None

    def run(self, seconds: float) -> None:
        """Let so much time pass, on the other one too."""
        super().run(seconds)
        if self.twin is not None and (behind := self.clock() - self.twin.clock()) > 1e-6:
            Board.run(self.twin, behind)


@pytest.fixture
def robot() -> Robot:
    """Three winches that take in 30 mm."""
    strip = strip_robot(columns=4, rows=1)
    first = replace(strip.winches[0], travel=0.03, release=0.0, spool_radius=RADIUS)
    winches: tuple[Winch, ...] = tuple(replace(first, name=name) for name in ("left", "middle", "right"))
    return replace(strip, winches=winches, cables=(replace(strip.cables[0], winch="left"),))


@pytest.fixture
def motors(robot: Robot) -> Calibration:
    """Two on the first board, one on the second, at zero."""
    spread = on_boards(Calibration.usual(robot), ["uno", "uno"])
    return Calibration(tuple(replace(each, counts=COUNTS, zero=0.0) for each in spread.motors))


@pytest.fixture
def boards(robot: Robot, motors: Calibration, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[TwinBoard]:
    """Both boards, switched on."""
    made, folder = [], firmware_bench.folder()
    for number in (1, 2):
        own = tmp_path / str(number)
        own.mkdir()
        shutil.copy(folder / "bench.so", own / "bench.so")
        settings = firmware_settings(robot, motors, rpm=216.0, board=number)
        firmware_bench.program("atmega328p", settings)  # built before the folder is another
        with monkeypatch.context() as patch:
            built = firmware_bench.program
            patch.setattr(firmware_bench, "folder", lambda own=own: own)
            patch.setattr(firmware_bench, "program", built)
            made.append(TwinBoard(settings=settings))
    made[0].twin, made[1].twin = made[1], made[0]
    return made


@pytest.fixture
def link(robot: Robot, motors: Calibration, boards: list[TwinBoard]) -> BusLink:
    """All motors, armed."""
    bus = joined(robot, motors, boards)
    bus.identify()
    bus.mark()
    link = BusLink(bus, robot.winches, motors, clock=boards[0].clock)
    link.identify()
    link.arm()
    return link


def joined(robot: Robot, motors: Calibration, boards: list[TwinBoard]) -> JoinedBus:
    """As `open_bus` joins them, on these lines."""
    parts = []
    for number, board in enumerate(boards, 1):
        places = motors.places(number)
        word = robot_word(robot, motors, number)
        numbers = [motors.motors[place].number for place in places]
        bus = FirmwareBus(board, [COUNTS] * len(places), numbers, robot=word, clock=board.clock, wait=board.run)
        parts.append((bus, places))
    return JoinedBus(parts)


def angles(boards: list[TwinBoard]) -> list[float]:
    """Where the three motors are in truth [counts]."""
    return [boards[0].winches[0].angle, boards[0].winches[1].angle, boards[1].winches[0].angle]


def test_motors_of_both_boards_arrive(link: BusLink, boards: list[TwinBoard]) -> None:
    goal = np.array([0.02, 0.005, 0.012])
    for _ in range(60):
        link.send(goal, 0.0, speed=0.05)
        boards[0].run(0.01)
        places = link.read(0.0)
    assert places == pytest.approx(goal, abs=2e-4)
    assert angles(boards) == pytest.approx([COUNTS * taken / (2 * np.pi * RADIUS) for taken in goal], abs=6)
    assert [fact.number for fact in link.facts] == [1, 2, 1]


def told(link: BusLink, boards: list[TwinBoard], seconds: float) -> None:
    """Tell the motors to go on for so long."""
    until = boards[0].clock() + seconds
    while boards[0].clock() < until:
        link.send(np.full(3, 0.03), 0.0, speed=0.05)
        boards[0].run(0.01)
        link.read(0.0)


@pytest.mark.parametrize("gone", [0, 1])
def test_a_board_that_falls_silent_stops_the_other(link: BusLink, boards: list[TwinBoard], gone: int) -> None:
    """Its motors stand by its own watchdog; those of the other are stopped when nothing was heard for 0.2 s."""
    told(link, boards, 0.15)
    silent = boards[gone]
    silent.write = lambda data: len(data)  # type: ignore[method-assign]
    began = silent.clock()
    with pytest.raises(HydrostatError, match="has not answered for"):
        told(link, boards, 1.0)
    assert link.state is LinkState.FAULT
    assert silent.clock() - began < 0.27  # one wait for an answer beyond 0.2 s
    boards[0].run(0.1)  # in which they come to rest
    stood = angles(boards)
    assert max(stood) < 0.9 * COUNTS * 0.03 / (2 * np.pi * RADIUS)  # on the way, not there
    boards[0].run(0.5)
    assert angles(boards) == pytest.approx(stood, abs=10)  # 0.3 mm of cable, in which they settle


def test_one_that_does_not_take_its_bounds_stops_all(
    robot: Robot, motors: Calibration, boards: list[TwinBoard]
) -> None:
    """The first board is armed already when the second refuses: it is told to stand, and the link sends nothing."""
    bus, greedy = joined(robot, motors, boards), replace(motors.motors[2], current=2.0)
    bus.identify()
    bus.mark()
    link = BusLink(bus, robot.winches, Calibration((*motors.motors[:2], greedy)), clock=boards[0].clock)
    link.identify()
    with pytest.raises(HydrostatError, match="bounds of current; it says: no current"):
        link.arm()
    with pytest.raises(HydrostatError, match="the motors do not turn"):
        link.send(np.full(3, 0.03), 0.0, speed=0.05)
    boards[0].run(0.3)
    assert max(angles(boards)) < 3
    assert bus.read().faults == ("",) * 3  # who was told to stand may be silent


def test_boards_in_another_order_are_named(robot: Robot, motors: Calibration, boards: list[TwinBoard]) -> None:
    parts = joined(robot, motors, boards[::-1])
    with pytest.raises(HydrostatError, match=r"built for \S+-2\.\w+, not for \S+-1\.\w+ as it is now; .* order of the"):
        parts.identify()


def test_damaged_motors_are_told(robot: Robot, tmp_path: Path) -> None:
    """Of two entries for a winch the last one was taken without a word."""
    file = Calibration.usual(robot).write(tmp_path)
    whole, winch = file.read_bytes(), robot.winches[0].name
    for content, words in (
        (2 * whole, f'winch "{winch}" has more than one'),
        (b"\xff" + whole, "not UTF-8 text"),
        (b"a = " + 9000 * b"[", "nested too deep|Invalid|Unclosed"),
        (whole.rpartition(b"=")[0], "motors.toml: "),
    ):
        file.write_bytes(content)
        with pytest.raises(InputError, match=words):
            Calibration.read(tmp_path, robot)


def test_motors_are_spread_and_kept(robot: Robot, motors: Calibration, tmp_path: Path) -> None:
    """By hand: two on the first Uno, one on the second; what fits stays as it is."""
    assert [(each.board, each.number) for each in motors.motors] == [(1, 1), (1, 2), (2, 1)]
    assert on_boards(motors, ["uno", "uno"]) is motors
    assert {each.board for each in on_boards(motors, ["mega"]).motors} == {1}
    assert all(each.zero is None for each in on_boards(motors, ["mega"]).motors)
    with pytest.raises(InputError, match="3 motors, and --board uno bears 2"):
        on_boards(Calibration.usual(robot), ["uno"])
    motors.write(tmp_path)
    assert Calibration.read(tmp_path, robot) == motors
    for port in ("firmware:/dev/none", "firmware:/dev/none,/dev/null,/dev/zero"):
        with pytest.raises(InputError, match="motors on 2 boards"):
            open_bus(port, robot, motors, lambda taken: taken)
    for port in ("firmware:/dev/none,", "firmware:/dev/none,/dev/none"):
        with pytest.raises(InputError, match="separate those of several"):
            open_bus(port, robot, motors, lambda taken: taken)
    gap = Calibration((*motors.motors[:2], replace(motors.motors[2], board=3)))
    with pytest.raises(InputError, match="none of the motors is on board 2"):
        gap.check(robot)
