"""Firmware of one robot. Oracles: limits by hand, `board.h`, a false avrdude, the built file in simavr."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from firmware_bench import FIRMWARE, Board, two_winch_strip
from typer.testing import CliRunner

from hydrostat.cli.main import app
from hydrostat.control import BusLink, Calibration, LinkState, WinchMotor
from hydrostat.control.firmware_build import BOARDS, build_firmware, firmware_settings, flash, flash_command, robot_word
from hydrostat.control.firmware_bus import FirmwareBus
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Robot

COUNTS = 1000.0


@pytest.fixture
def robot() -> Robot:
    return two_winch_strip()


@pytest.fixture
def motors(robot: Robot) -> Calibration:
    """Motor 2 on the first winch, motor 1 on the second."""
    usual = Calibration.usual(robot).motors
    return Calibration(tuple(replace(each, number=3 - each.number, counts=COUNTS) for each in usual))


def test_settings_are_the_robots_limits_in_counts(robot: Robot, motors: Calibration) -> None:
    """By hand: a turn of 31.4 mm has 1,000 counts, so a millimeter has 31.8; of 2 A at stall a tenth is for speed."""
    text = firmware_settings(robot, motors, rpm=60.0)
    assert f'#define ROBOT "{robot_word(robot, motors)}"' in text
    assert "#define DCS 2\n#define SERVOS 0" in text
    assert "#define FREE_SPEED 1000 " in text
    rows = re.findall(r"\{(-?\d+), (\d+), (\d+), (\d+), 1, (\d+)\}, /\* (.*) \*/", text)
    assert rows == [("-796", "1751", "1910", "5000", "400", name) for name in (w.name for w in robot.winches[::-1])]


def test_words_of_boards_change_with_what_they_hold(robot: Robot, motors: Calibration) -> None:
    word = robot_word(robot, motors)
    assert re.fullmatch(r"[\w-]+\.[0-9a-f]{8}", word)
    longer = replace(robot, winches=(replace(robot.winches[0], travel=0.05), *robot.winches[1:]))
    assert robot_word(longer, motors) != word
    found = Calibration(tuple(replace(each, zero=1.0) for each in motors.motors))
    assert robot_word(robot, found) == word
    turned = Calibration((replace(motors.motors[0], turns=-1), *motors.motors[1:]))  # limits of servos differ
    assert robot_word(robot, turned) != word


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"counts": None}, "needs counts"),
        ({"turns": -1}, "swap the two wires of the motor"),
        ({"number": 5}, "numbered 1, 2, ..."),
    ],
)
def test_motors_that_a_board_cannot_turn_are_refused(
    robot: Robot, motors: Calibration, change: dict, told: str
) -> None:
    wrong = Calibration((replace(motors.motors[0], **change), *motors.motors[1:]))
    with pytest.raises(InputError, match=re.escape(told)):
        firmware_settings(robot, wrong, rpm=60.0)


def test_a_board_bears_so_many_motors(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="board uno drives 2 motors, the robot has 3"):
        build_firmware("#define DCS 3\n", "uno", tmp_path / "none")
    assert not (tmp_path / "none").exists()
    with pytest.raises(InputError, match=r"--board due: unknown board\. Available: uno, mega, esp32s3"):
        build_firmware("#define DCS 1\n", "due", tmp_path)


def test_an_esp32_gets_a_sketch(robot: Robot, motors: Calibration, tmp_path: Path) -> None:
    """The Arduino IDE wants a file named as its folder; C++ beside it is compiled as it stands."""
    settings = firmware_settings(robot, motors, rpm=60.0)
    sketch = build_firmware(settings, "esp32s3", tmp_path)
    assert sketch == tmp_path / "winches" / "winches.ino"
    written = {path.name: path.read_text() for path in sketch.parent.iterdir()}
    assert sorted(written) == ["esp32s3.h", "geared.h", "moves.h", "settings.h", "winches.cpp", "winches.ino"]
    assert written["settings.h"] == settings
    assert written["winches.cpp"] == (FIRMWARE / "winches.c").read_text()
    command = flash_command("esp32s3", "/dev/ttyACM0", sketch)
    assert command[:6] == ["arduino-cli", "compile", "-b", "esp32:esp32:esp32s3", "-u", "-p"]
    with pytest.raises(HydrostatError, match=r"winches\.ino in the Arduino IDE"):
        flash(["arduino-cli-of-nobody", *command[1:]])
    with pytest.raises(InputError, match="board esp32s3 drives 4 motors, the robot has 5"):
        build_firmware("#define DCS 5\n", "esp32s3", tmp_path)


def test_pins_that_are_told_are_those_of_the_boards() -> None:
    """Oracle: the remarks beside the registers in avr.h, the pins themselves in esp32s3.h."""
    text, sketch = (FIRMWARE / "avr.h").read_text(), (FIRMWARE / "esp32s3.h").read_text()
    lines = [line.split("/*")[1] for line in text.splitlines() if "&TCCR" in line and "/*" in line]
    lines += re.findall(r"    \{([\d, ]+)\},", sketch)
    told = [re.findall(r"A?\d+", line) for line in lines]
    assert told == [list(pins) for kind in BOARDS.values() for pins in kind.wiring]
    buttons = re.findall(r"#define BUTTON \d /\* between pin (\d+) and GND", text + sketch)
    assert buttons == [kind.button for kind in BOARDS.values()]
    supplies = re.findall(r"#define SUPPLY (\d) ", text + sketch)
    line = re.findall(r"#define LINE_(?:OUT|IN) (\d+)", sketch)
    assert tuple(line) == BOARDS["esp32s3"].servo_pins
    assert supplies == [kind.supply.removeprefix("A") for kind in BOARDS.values()]


def test_a_robot_on_its_board_is_driven_within_its_limits(robot: Robot, motors: Calibration) -> None:
    """The built file in simavr behind a link, from a board that knows nothing to winches that arrive."""
    board = Board(settings=firmware_settings(robot, motors, rpm=216.0))
    numbers = [each.number for each in motors.motors]

    def link_of(word: str, calibration: Calibration) -> tuple[FirmwareBus, BusLink]:
        bus = FirmwareBus(board, [COUNTS] * 2, numbers, robot=word, clock=board.clock, wait=board.run)
        return bus, BusLink(bus, robot.winches, calibration, clock=board.clock)

    with pytest.raises(HydrostatError, match=r"was built for .*, not for another\.0 as it is now"):
        link_of("another.0", motors)[1].identify()
    found = Calibration(tuple(replace(each, zero=0.0) for each in motors.motors))
    bus, link = link_of(robot_word(robot, found), found)
    assert [fact.number for fact in link.identify()] == [2, 1]
    with pytest.raises(HydrostatError, match="calibrate them again, as a motor or its board was switched off or reset"):
        link.arm()
    bus.mark()
    bus, link = link_of(robot_word(robot, found), found)
    link.identify()
    assert link.state is LinkState.CALIBRATED
    link.arm()
    goal = np.array([0.02, 0.005])
    for _ in range(60):
        link.send(goal, 0.0, speed=0.05)
        board.run(0.02)
        places = link.read(0.0)
    assert places == pytest.approx(goal, abs=2e-4)
    turned = [COUNTS * taken / (2 * np.pi * 0.005) for taken in goal]  # motor 2 has the first winch
    assert [board.winches[1].angle, board.winches[0].angle] == pytest.approx(turned, abs=6)
    link.close()


def test_firmware_is_built_shown_and_flashed(robot: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program in place of avrdude notes how it is called; nothing is written without --flash."""
    Board()  # skips where avr-gcc is not there
    folder = tmp_path / "starfish"
    run = CliRunner().invoke
    assert run(app, ["new", str(folder), "--from", "gallery:starfish"]).exit_code == 0
    tool, noted = tmp_path / "bin" / "avrdude", tmp_path / "noted"
    tool.parent.mkdir()
    tool.write_text(f'#!/bin/sh\necho "$@" >> {noted}\n')
    tool.chmod(0o755)
    monkeypatch.setenv("PATH", str(tool.parent), prepend=":")
    few = run(
        app, ["firmware", str(folder), "--board", "uno", "--flash", "/dev/ttyACM7", "--out", str(tmp_path / "few")]
    )
    assert "1 port for 2 boards" in str(few.exception)
    assert not (tmp_path / "few").exists()
    given = ["firmware", str(folder), "--board", "mega", "--out", str(tmp_path / "built")]
    shown = run(app, given)
    assert shown.exit_code == 0, shown.output
    assert "avrdude -p atmega2560 -c wiring" in shown.output
    assert not noted.exists()
    assert all(each.counts == 8245.92 for each in Calibration.read(folder, robot_of(folder)).motors)
    gone = run(app, [*given, "--flash", "/dev/ttyACM7"])  # avrdude would try it for ever
    assert "/dev/ttyACM7 is not there; look at the plug" in str(gone.exception)
    port, *others = (tmp_path / name for name in ("ttyACM7", "ttyACM8", "ttyACM9"))
    for each in (port, *others):
        each.touch()
    done = run(app, [*given, "--flash", str(port)])
    assert done.exit_code == 0, done.output
    image = tmp_path / "built" / "winches.hex"
    assert noted.read_text().split() == f"-p atmega2560 -c wiring -b 115200 -D -P {port} -U flash:w:{image}:i".split()
    assert image.read_text().startswith(":10")
    noted.unlink()
    both = run(
        app, [*given[:2], "--board", "uno", "--out", str(tmp_path / "two"), "--flash", ",".join(map(str, others))]
    )
    assert both.exit_code == 0, both.output
    assert "board 2, uno: 1 motor, wiring" in both.output
    many = run(app, [*given[:2], "--board", "uno,uno,uno", "--out", str(tmp_path / "many")])
    assert "--board uno,uno,uno: 3 boards for motors that fit on 2. Remove the others." in str(many.exception)
    written = [line.split("flash:w:")[1] for line in noted.read_text().splitlines()]
    assert written == [f"{tmp_path}/two/board_{number}/winches.hex:i" for number in (1, 2)]
    assert [each.board for each in Calibration.read(folder, robot_of(folder)).motors] == [1, 1, 2]
    (tmp_path / "dance.csv").write_text("time_s\n0\n2\n")
    dance = run(app, [*given, "--moves", str(tmp_path / "dance.csv")])
    assert "dance.csv: 2.0 s, 0.3 kB. Button between pin 12 and GND" in dance.output  # 51 rows of 3 motors
    small = run(app, [*given, "--motor", "n20"])
    assert "3575.04 counts per spool turn" in small.output
    assert "micro metal gearmotor" in run(app, given).output  # what motors.toml tells is not called another motor
    assert all(each.counts == 3575.04 for each in Calibration.read(folder, robot_of(folder)).motors)


def robot_of(folder: Path) -> Robot:
    from hydrostat.robot import load_robot

    return load_robot(folder)


def test_counts_stand_in_motors_toml() -> None:
    with pytest.raises(InputError, match="counts must be from 1 to a million"):
        WinchMotor(winch="left", number=1, radius=0.005, counts=0.0)


def test_a_current_that_a_board_cannot_measure_is_refused(tmp_path: Path) -> None:
    """An ESP32-S3 reads up to 3.1 V, 1.1 V for an ampere."""
    line = "#define MOTORS {{ \\\n    {{0, 1, 1, 1, 1, {}}}, /* left */ \\\n}}\n#define DCS 1\n"
    with pytest.raises(InputError, match=r"current too large for board esp32s3 \(4 A\)"):
        build_firmware(line.format(4000), "esp32s3", tmp_path)
    assert build_firmware(line.format(2800), "esp32s3", tmp_path).name == "winches.ino"


def test_a_line_has_at_most_16_servos(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"esp32s3 drives 16 servos, the robot has 17\. Use fewer winches, or two"):
        build_firmware("#define DCS 17\n#define FEETECH 1\n", "esp32s3", tmp_path)
