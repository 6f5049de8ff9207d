"""Firmware of one robot: its settings, built by Debian's avr-gcc or as an Arduino sketch, and how a board gets it."""

import re
import shutil
import subprocess
import zlib
from collections.abc import Sequence
from dataclasses import replace
from importlib import resources
from math import inf, pi
from pathlib import Path

from hydrostat.control.bus_link import LinkLimits
from hydrostat.control.calibration import CALIBRATION, Calibration, WinchMotor
from hydrostat.control.firmware_servos import servo_settings
from hydrostat.errors import HydrostatError, InputError
from hydrostat.fabrication import BOARDS, check_board
from hydrostat.files import replace_file
from hydrostat.robot import Robot

SPARE_LENGTH = 0.025
"""Cable length that a motor may turn beyond travel and release [m]: slack that calibration takes up."""


def on_boards(calibration: Calibration, boards: Sequence[str]) -> Calibration:
    """Return the motors unchanged if they fit the boards; else fill the boards in order, zeros unknown.

    Raises:
        InputError: too few places on the boards.
    """
    room = [check_board(board).motors for board in boards]
    if calibration.boards <= len(room) and all(
        len(calibration.places(number)) <= most for number, most in enumerate(room, 1)
    ):
        return calibration
    places = [(board, number) for board, most in enumerate(room, 1) for number in range(1, most + 1)]
    if len(places) < len(calibration.motors):
        raise InputError(
            f"the robot has {len(calibration.motors)} motors, and --board {','.join(boards)} bears {len(places)}"
        )
    pairs = zip(calibration.motors, places, strict=False)
    return Calibration(tuple(replace(motor, board=board, number=n, zero=None) for motor, (board, n) in pairs))


def robot_word(robot: Robot, calibration: Calibration, board: int = 1) -> str:
    """Return the identifier that a board reports: robot name, board number, and checksum of its settings."""
    name = re.sub(r"[^A-Za-z0-9_-]+", "-", robot.name)[:20] or "robot"
    which = f"-{board}" if calibration.boards > 1 else ""
    turns = [motor.turns for motor in _motors_of_board(calibration, board)]
    told = _numbers(robot, calibration, board, inf) + (
        "" if set(turns) == {1} else f" {turns}"
    )  # servos turn both ways
    return f"{name}{which}.{zlib.crc32(told.encode()):08x}"


SPIN_UP, EFFORT = 0.02, 0.5
"""Time in which a motor without load comes to two thirds of its speed [s], as `winches.c` assumes; and the share of its
bound of current that it may take to gain speed."""


def firmware_settings(
    robot: Robot, calibration: Calibration, *, rpm: float, stall: float = 2.0, board: int = 1, bus: str = ""
) -> str:
    """Return the text of settings.h for one board of a robot.

    Args:
        robot: robot with the limits.
        calibration: boards and maximum currents of the motors.
        rpm: no-load speed [turns/min].
        stall: stall current [A]; acceleration leaves half of the current limit for the load.
        board: board number.
        bus: kind of servo bus, a key of `SERVO_STEPS`; empty for DC motors.

    Raises:
        InputError: motors that are not numbered from 1 without gaps, turn the wrong way, or have no counts.
    """
    ordered = _motors_of_board(calibration, board)
    if [motor.number for motor in ordered] != list(range(1, len(ordered) + 1)):
        raise InputError(f"{CALIBRATION}: motors of a board are numbered 1, 2, ... as they are plugged in")
    for motor in ordered:
        if motor.counts is None:
            raise InputError(f'{CALIBRATION}: motor of "{motor.winch}" needs counts, those of its encoder in a turn')
        if motor.turns != 1 and not bus:
            raise InputError(
                f'{CALIBRATION}: "{motor.winch}" has turns = {motor.turns}; on a board swap the two wires of the '
                "motor and those of its encoder, A for B, and write 1"
            )
    most = max(motor.counts or 0.0 for motor in ordered)
    servos = servo_settings(robot, ordered, bus) if bus else ""
    rows = _servo_numbers(robot, ordered, rpm) if bus else ""
    gain = EFFORT * rpm / 60 / SPIN_UP / stall  # turns/s2 for an ampere of the bound
    return (
        f"/* Settings of {robot.name}, made by hydrostat firmware from robot.toml and {CALIBRATION}. */\n"
        f'#define ROBOT "{robot_word(robot, calibration, board)}"\n'
        f"#define DCS {len(ordered)}\n#define SERVOS 0\n#define DEADLINE_MS 200\n"
        f"#define FREE_SPEED {round(rpm / 60 * most)} /* of a motor without load [1/s] */\n"
        "/* least and greatest place, greatest speed [1/s], acceleration [1/s2], sign of the encoder, current [mA] */\n"
        f"#define MOTORS {{ \\\n{rows or _numbers(robot, calibration, board, gain)}}}\n{servos}"
    )


def build_firmware(settings: str, board: str, folder: Path) -> Path:
    """Build the firmware with settings into a folder: settings.h, winches.elf, winches.hex; returns the last.

    For a board that the Arduino IDE builds for, write the sketch winches/winches.ino instead, and return that.

    Raises:
        InputError: no such board, or fewer motors than the settings have.
        HydrostatError: avr-gcc is not there, or it refuses.
    """
    kind = check_board(board)
    asked = int((re.search(r"#define DCS (\d+)", settings) or [0, 0])[1])
    has_servos = "#define FEETECH" in settings
    if has_servos and asked > kind.servos:
        fix = "Use fewer winches, or two robots" if kind.servos else "Use --board esp32s3"
        raise InputError(f"board {board} drives {kind.servos} servos, the robot has {asked}. {fix}.")
    if not has_servos and asked > kind.motors:
        more = " Use --board mega (six motors)." if board == "uno" and asked <= BOARDS["mega"].motors else ""
        raise InputError(f"board {board} drives {kind.motors} motors, the robot has {asked}.{more}")
    if not kind.loader:
        if not has_servos:
            _check_currents(settings, board)
        return _write_sketch(settings, board, folder / "winches")
    if not (shutil.which("avr-gcc") and shutil.which("avr-objcopy")):
        raise HydrostatError("avr-gcc not found. On Debian/Ubuntu: sudo apt install gcc-avr avr-libc")
    folder.mkdir(parents=True, exist_ok=True)
    given = replace_file(folder / "settings.h", settings.encode())
    built, image = folder / "winches.elf", folder / "winches.hex"
    with resources.as_file(resources.files("hydrostat.control") / "firmware") as sources:
        flags = ["-std=gnu11", "-Os", "-Wall", "-Wextra", "-Werror", "-DF_CPU=16000000UL", f"-mmcu={kind.chip}"]
        _run(["avr-gcc", *flags, "-include", str(given), "-o", str(built), str(sources / "winches.c"), "-lm"])
    _run(["avr-objcopy", "-O", "ihex", "-R", ".eeprom", str(built), str(image)])
    return image


def build_images(
    robot: Robot,
    calibration: Calibration,
    boards: Sequence[str],
    folders: Sequence[Path],
    *,
    rpm: float,
    stall: float,
    moves: str = "",
    bus: str = "",
) -> list[Path]:
    """Compile the firmware of each board into its folder, and return the images.

    Arguments as for `firmware_settings`; `moves` is text that is added to the settings of each board.
    """
    texts = [
        firmware_settings(robot, calibration, rpm=rpm, stall=stall, board=number + 1, bus=bus) + moves
        for number in range(len(folders))
    ]
    return [build_firmware(*each) for each in zip(texts, boards, folders, strict=False)]


def flash_command(board: str, port: str, image: Path) -> list[str]:
    """Return the avrdude command that writes an image to a board, or the arduino-cli command for a sketch."""
    kind = check_board(board)
    if not kind.loader:
        return ["arduino-cli", "compile", "-b", f"esp32:esp32:{kind.chip}", "-u", "-p", port, str(image.parent)]
    return ["avrdude", "-p", kind.chip, *kind.loader, "-P", port, "-U", f"flash:w:{image}:i"]


def check_ports(ports: Sequence[str]) -> None:
    """Reject missing ports, because avrdude retries them forever (HydrostatError)."""
    for port in ports:
        if port.startswith("/") and not Path(port).exists():
            raise HydrostatError(f"{port} is not there; look at the plug and the name")


def flash(command: Sequence[str]) -> None:
    """Write firmware to a board (HydrostatError: the program is missing, or it failed)."""
    if not shutil.which(command[0]):
        fix = "On Debian/Ubuntu: sudo apt install avrdude"
        if command[0] != "avrdude":
            fix = f"Open {command[-1]}/winches.ino in the Arduino IDE, with Espressif's package esp32 3.x"
        raise HydrostatError(f"{command[0]} not found. {fix}")
    _run(command)


def _write_sketch(settings: str, board: str, folder: Path) -> Path:
    """Write an Arduino sketch: the sources of the firmware as C++, since Arduino's serial line is."""
    folder.mkdir(parents=True, exist_ok=True)
    sources, layer = resources.files("hydrostat.control") / "firmware", f"{board}.h"
    backend = "feetech.h" if "#define FEETECH" in settings else "geared.h"
    for name, new in (("winches.c", "winches.cpp"), (backend, backend), ("moves.h", "moves.h"), (layer, layer)):
        replace_file(folder / new, (sources / name).read_bytes())
    replace_file(folder / "settings.h", settings.encode())
    words = b"/* Made by hydrostat firmware: settings.h has the robot, winches.cpp the program. */\n"
    return replace_file(folder / "winches.ino", words)


def _check_currents(settings: str, board: str) -> None:
    """Refuse a current limit that the board's inputs of 3.1 V cannot tell from more, at 1.1 V for an ampere."""
    largest = max((int(text) for text in re.findall(r", (\d+)}, /\*", settings)), default=0)
    if largest > 2800:
        raise InputError(
            f"{CALIBRATION}: current too large for board {board} ({largest / 1000:g} A). Maximum: 2.8 A, the most that "
            "it measures."
        )


def _motors_of_board(calibration: Calibration, board: int) -> list[WinchMotor]:
    return sorted((calibration.motors[place] for place in calibration.places(board)), key=lambda motor: motor.number)


def _numbers(robot: Robot, calibration: Calibration, board: int, gain: float) -> str:
    """Limits of the motors in their order, counted from where they stand when the board is switched on."""
    winches, limits, lines = {winch.name: winch for winch in robot.winches}, LinkLimits(), ""
    for motor in _motors_of_board(calibration, board):
        winch, counts = winches[motor.winch], (motor.counts or 0.0) / (2 * pi * motor.radius)
        numbers = [-counts * (winch.release + SPARE_LENGTH), counts * (winch.travel + SPARE_LENGTH)]
        numbers += [counts * limits.speed, min(counts * limits.rise, gain * motor.current * (motor.counts or 0.0))]
        text = ", ".join(str(round(number)) for number in (*numbers, 1, 1e3 * motor.current))
        lines += f"    {{{text}}}, /* {_plain(winch.name)} */ \\\n"
    return lines


def _servo_numbers(robot: Robot, motors: Sequence[WinchMotor], rpm: float) -> str:
    """Limits of servos in their order, counted from their zeros; the board adds spares."""
    winches, limits, lines = {winch.name: winch for winch in robot.winches}, LinkLimits(), ""
    for motor in motors:
        winch, steps = winches[motor.winch], motor.counts or 0.0
        scale = steps / (2 * pi * motor.radius)
        low, high = sorted((-motor.turns * scale * winch.release, motor.turns * scale * winch.travel))
        numbers = (low, high, min(scale * limits.speed, rpm / 60 * steps), scale * limits.rise, 1, 1e3 * motor.current)
        lines += f"    {{{', '.join(str(round(number)) for number in numbers)}}}, /* {_plain(winch.name)} */ \\\n"
    return lines


def _plain(name: str) -> str:
    """A name that may stand in a remark of C."""
    return re.sub(r"[^ -)+-~]", " ", name)


def _run(command: Sequence[str]) -> None:
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=_MAX_SECONDS)
    except subprocess.TimeoutExpired:
        raise HydrostatError(
            f"{command[0]} took more than {_MAX_SECONDS:g} s; look at the board and its port"
        ) from None
    if done.returncode:
        told = (done.stderr or done.stdout).strip().splitlines() or ["without a word"]
        why = next((line for line in told if "error" in line.lower()), told[-1])
        raise HydrostatError(f"{command[0]} failed: {why.strip()}")


_MAX_SECONDS = 120.0
"""Neither a compiler nor avrdude takes so long [s]."""
