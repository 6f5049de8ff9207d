"""Moves that play alone. Oracles: the table played by the computer, equations of motors, numbers by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from firmware_bench import Board, folder, two_winch_strip

from hydrostat.control import BusLink, Calibration, Motors, Player, bake_moves
from hydrostat.control.firmware_build import BOARDS, build_firmware, firmware_settings, robot_word
from hydrostat.control.firmware_bus import FirmwareBus
from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.simulation import ProfileTable

COUNTS = 1000.0
ROWS = ((0, 3, 0), (1, 18, 6), (1.6, 18, 6), (2.4, 4, 20), (3, 4, 20), (3.3, 4, 14))
"""Time [s] and contractions [mm]; the motors stand from 1 to 1.6 s and from 2.4 to 3 s."""
ZEROS = (-40.0, -25.0)
"""Counts of motors 1 and 2 at the zeros of their winches."""


@pytest.fixture
def robot() -> Robot:
    return two_winch_strip()


@pytest.fixture
def motors(robot: Robot) -> Calibration:
    """Motor 2 on the first winch, motor 1 on the second, on layers that make the spool larger."""
    usual = Calibration.usual(robot).motors
    curve = ((2.0, 0.0102), (5.0, 0.0264))
    zeros = [2 * np.pi * zero / COUNTS for zero in ZEROS[::-1]]
    return Calibration(
        tuple(
            replace(each, number=3 - each.number, counts=COUNTS, curve=curve, zero=zero)
            for each, zero in zip(usual, zeros, strict=True)
        )
    )


def table_of(robot: Robot, folder: Path, rows: tuple = ROWS) -> Path:
    names = ",".join(winch.name for winch in robot.winches)
    lines = [f"time_s,{names}", *(",".join(map(str, row)) for row in rows)]
    (folder / "dance.csv").write_text("\n".join(lines) + "\n")
    return folder / "dance.csv"


@pytest.fixture
def settings(robot: Robot, motors: Calibration, tmp_path: Path) -> str:
    moves = bake_moves(table_of(robot, tmp_path), tmp_path, robot, motors, "uno")
    return firmware_settings(robot, motors, rpm=216.0) + moves.settings


@pytest.fixture(params=["atmega328p", "esp32s3"])
def chip(request: pytest.FixtureRequest) -> str:
    return request.param


def alone(chip: str, settings: str, zeros: tuple[float, float] = ZEROS) -> Board:
    """A board that was told its zeros and let go."""
    board = Board(chip, settings=settings)
    assert board.ask("M {:.0f} {:.0f}".format(*zeros)) == "ok"
    return board


def test_a_board_alone_moves_as_with_a_computer(
    chip: str, robot: Robot, motors: Calibration, settings: str, tmp_path: Path
) -> None:
    """Poses of both, from the first row on: within 0.1 mm where motors stand, 1 mm where they turn."""
    board = Board(chip, settings=settings)
    numbers = [each.number for each in motors.motors]
    bus = FirmwareBus(board, [COUNTS] * 2, numbers, robot=robot_word(robot, motors), clock=board.clock, wait=board.run)
    link = BusLink(bus, robot.winches, motors, clock=board.clock)
    bus.lost_position = False
    link.identify()
    bus.mark(np.array([motor.zero for motor in motors.motors]))
    link.arm()
    profile = ProfileTable.open(tmp_path / "dance.csv", robot).profile
    player, seen = Player(), list[tuple[float, ...]]()
    player.rounds = 1

    def note() -> None:
        if player.time > 0:
            seen.append((player.time, *(winch.angle for winch in board.winches)))

    player.run(
        Motors(robot.winches, link, places=link.read(0.0), fastest=0.06), profile, tell=note,
        clock=board.clock, wait=board.run,
    )  # fmt: skip
    link.close()
    guided = np.array(seen)

    board = alone(chip, settings)
    assert board.is_lit()
    board.press()
    found = list[tuple[float, ...]]()
    while board.ask("R").startswith("ok armed") and len(found) < 800:
        found.append((board.clock(), *(winch.angle for winch in board.winches)))
    free = np.array(found)
    free[:, 0] -= free[0, 0]
    assert 5.2 < free[-1, 0] < 6.0  # 3.3 s and 2 s to hold, after it went to the first row
    assert board.ask("R").startswith("ok off 0 ")
    assert all(abs(winch.current) < 0.05 for winch in board.winches)

    def differ(late: float, times: np.ndarray) -> float:
        pairs = ((np.interp(times, *guided[:, [0, k]].T), np.interp(times + late, *free[:, [0, k]].T)) for k in (1, 2))
        return max(float(np.abs(one - other).max()) for one, other in pairs)

    times = np.linspace(0.3, 3.2, 200)  # the computer starts where it stands, while the board has got to the first row
    late = min(np.arange(-0.4, 0.8, 0.01).tolist(), key=lambda each: differ(each, times))
    assert differ(late, times) < 32  # a millimeter
    assert differ(late, np.array([1.5, 2.9])) < 3
    assert abs(free[-1, 1:] - guided[-1, 1:]).max() < 10


def test_a_second_press_stops_and_a_third_starts_again(chip: str, settings: str) -> None:
    """Motors stand where they were, hold for 2 s, and let go; a press begins at the first row."""
    board = alone(chip, settings)
    board.press()
    board.run(0.9)
    board.press()
    where = [winch.angle for winch in board.winches]
    assert max(where) > 150
    assert board.ask("R").startswith("ok armed 0 ")
    assert board.ask("G 0 100 0 100") == "no alone"
    board.run(1.7)
    assert board.ask("R").startswith("ok armed 0 ")
    board.run(0.3)
    assert board.ask("R").startswith("ok off 0 ")
    assert [winch.angle for winch in board.winches] == pytest.approx(where, abs=25)
    board.press()
    assert board.ask("R").startswith("ok armed 0 ")
    assert board.ask("A 1500 1500") == "no current"  # more than motors.toml allows: it goes on alone
    assert board.ask("A 400 400") == "ok"  # the computer takes over
    assert not board.is_lit()
    assert board.ask("G 0 300 0 300") == "ok"
    board.run(0.4)
    assert board.ask("R").startswith("ok silent 0 ")


def test_stops_stay_in_force_without_a_computer(chip: str, settings: str) -> None:
    """A shaft that is held, then a program that hangs; who is reset knows no zeros, and plays nothing."""
    board = alone(chip, settings)
    board.winches[1].block = 1
    board.winches[1].wire = 30.0  # less current than its bound
    board.press()
    board.run(0.6)
    assert board.ask("R").startswith("ok stall 2 ")
    assert all(abs(winch.current) < 0.05 for winch in board.winches)
    board.winches[1].block = 0
    board.winches[1].wire = 0.0
    board.press()
    board.run(0.3)
    assert board.ask("R").startswith("ok armed 0 ")
    board.hang()
    board.run(0.25)
    where = board.winches[0].angle
    assert board.ask("I").endswith(" watchdog new")
    board.press()
    assert not board.is_lit()
    assert board.winches[0].angle == where
    assert board.ask("R").startswith("ok off 0 ")


@pytest.mark.parametrize(
    ("chip", "told"),
    [
        ("atmega328p", "M"),
        ("atmega328p", "M 3"),
        ("atmega328p", "M 1500 0"),
        ("atmega2560", "M -900 0"),
        ("esp32s3", "M"),
    ],
)
def test_a_board_without_zeros_in_its_limits_plays_nothing(settings: str, chip: str, told: str) -> None:
    """By hand: its settings allow counts from -796 to 1,751, and 20 mm are more than 600."""
    board = Board(chip, settings=settings)
    assert board.ask(told) == ("no zeros" if told == "M 3" else "ok")
    board.press()
    assert not board.is_lit()
    assert board.ask("R").startswith("ok off 0 ")
    assert board.ask("M 0 0") == "ok"
    assert board.is_lit()
    board.press(0.012)  # no press, but a contact that bounces
    assert board.ask("R").startswith("ok off 0 ")
    board.press()
    assert board.ask("R").startswith("ok armed 0 ")


def test_a_battery_that_sags_stops_moves(chip: str, settings: str) -> None:
    """A dip of 0.3 s, as motors start, is none; one of 0.8 s lets go, blinks, and no press or computer goes on."""
    board = alone(chip, settings + "#define MIN_SUPPLY 9600\n")
    assert int(board.ask("R").split()[-1]) == pytest.approx(12_000, abs=40)
    board.press()
    board.feed(9.3)
    board.run(0.3)
    board.feed(11.0)
    board.run(0.3)
    assert board.ask("R").startswith("ok armed 0 ")
    board.feed(9.3)
    board.run(0.8)
    assert board.ask("R").startswith("ok supply 0 ")
    assert int(board.ask("R").split()[-1]) == pytest.approx(9_300, abs=40)
    assert all(abs(winch.current) < 0.05 for winch in board.winches)
    seen = set[bool]()
    for _ in range(6):
        board.run(0.1)
        seen.add(board.is_lit())
    assert seen == {False, True}
    board.press()
    assert board.ask("A 400 400") == "no supply"
    board.feed(12.0)  # a battery recovers when nothing pulls: it is still empty
    board.run(0.1)
    board.press()
    assert board.ask("R").startswith("ok supply 0 ")
    assert board.ask("A 400 400") == "no supply"
    assert board.ask("O") == "ok"
    board.press()
    assert board.ask("R").startswith("ok off 0 ")


def test_an_encoder_that_jumps_takes_the_zeros(chip: str, settings: str) -> None:
    """Also while motors are off, as a hand turns them: two counts in one step are none that it can make."""
    board = alone(chip, settings)
    board.winches[0].angle += 2
    board.run(0.02)
    assert not board.is_lit()
    board.press()
    assert board.ask("R").startswith("ok off 0 ")


def test_moves_are_baked_as_counts_from_the_zero(robot: Robot, motors: Calibration, tmp_path: Path) -> None:
    """By hand: 10.2 mm are 2 rad, 318.3 of 1,000 counts; motor 1 turns the second winch. Large counts get a step."""
    path = table_of(robot, tmp_path, ((0, 0, 10.2), (1, 10.2, 0)))
    moves = bake_moves(path, tmp_path, robot, motors, "uno", rate=5)
    assert (moves.step, moves.size) == (1, 28)
    assert moves.seconds == pytest.approx(6 * 50 * 62 * 64e-6)  # ticks are 62 counts of 64 microseconds, not 4 ms
    assert moves.steps[2].tolist() == pytest.approx([318.3 * (1 - 0.3968), 318.3 * 0.3968], abs=0.6)
    assert moves.steps[[0, -1]].tolist() == [[318, 0], [0, 318]]
    fine = Calibration(tuple(replace(each, counts=250_000.0) for each in motors.motors))
    moves = bake_moves(path, tmp_path, robot, fine, "uno")
    assert (moves.step, moves.steps.max()) == (3, round(250_000 / np.pi / 3))


def test_moves_that_a_board_cannot_play_are_refused(robot: Robot, motors: Calibration, tmp_path: Path) -> None:
    """By hand: 23,000 bytes are 5,750 rows of two motors, each of ten ticks of 3.968 ms at 25 rows/s."""
    path = table_of(robot, tmp_path, ((0, 0, 0), (250, 5, 5)))
    with pytest.raises(
        InputError, match=r"dance.csv: 250.0 s at 25 rows/s exceed .* uno. Longest: 228.1 s, or 1140.6 s"
    ):
        bake_moves(path, tmp_path, robot, motors, "uno")
    assert bake_moves(path, tmp_path, robot, motors, "uno", rate=10).seconds == pytest.approx(250.0, abs=0.1)
    with pytest.raises(InputError, match="--rate 7: unknown rate"):
        bake_moves(path, tmp_path, robot, motors, "uno", rate=7)
    slow = r'moves at 20 mm/s, the motor at 10\.5 mm/s without load\. .* --max-speed "10 mm/s"'
    with pytest.raises(InputError, match=slow):  # 20 turns/min of 5 mm
        bake_moves(table_of(robot, tmp_path), tmp_path, robot, motors, "uno", rpm=20.0)
    with pytest.raises(InputError, match="moves at 100 mm/s"):
        bake_moves(table_of(robot, tmp_path, ((0, 0, 0), (0.1, 10, 5))), tmp_path, robot, motors, "uno")
    apart = Calibration((motors.motors[0], replace(motors.motors[1], board=2)))
    with pytest.raises(InputError, match="--moves plays on one board, and this robot has 2"):
        bake_moves(path, tmp_path, robot, apart, "uno")


@pytest.mark.parametrize(("board", "memory"), [("uno", 32_256), ("mega", 253_952)])
def test_the_longest_moves_fit(robot: Robot, motors: Calibration, tmp_path: Path, board: str, memory: int) -> None:
    """Oracle: program memory beside the bootloader, and the length of the built image."""
    room = BOARDS[board].room // 4
    path = table_of(robot, tmp_path, ((0, 0, 0), ((room - 1) * 0.03968, 5, 5)))
    moves = bake_moves(path, tmp_path, robot, motors, board)
    assert len(moves.steps) == room
    folder()
    image = build_firmware(firmware_settings(robot, motors, rpm=216.0) + moves.settings, board, tmp_path / "built")
    taken = sum(int(line[1:3], 16) for line in image.read_text().splitlines() if line[7:9] == "00")
    assert moves.size < taken < memory
