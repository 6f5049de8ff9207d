"""`hydrostat firmware`."""

from dataclasses import replace
from pathlib import Path
from shlex import join
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import OutFolder, OwnRobotFolder
from hydrostat.cli.servo_zeros import SERVO_BOARD
from hydrostat.cli.waiting import read_robot
from hydrostat.errors import InputError
from hydrostat.given import list_choices
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.control import Calibration, WinchMotor
    from hydrostat.fabrication import Motor
    from hydrostat.robot import Robot


def firmware(
    robot: OwnRobotFolder,
    out: OutFolder,
    board: Annotated[
        str | None,
        typer.Option(
            metavar="uno|mega|esp32s3",
            help="Board types: an uno drives two motors, a mega six, an esp32s3 four, or 16 Feetech servos. "
            "Separate several by commas.",
            show_default="smallest that fit",
        ),
    ] = None,
    port: Annotated[
        str | None,
        typer.Option(
            "--flash",
            metavar="PORT,...",
            help="Flash the boards on these ports, e.g. /dev/ttyACM0.",
            show_default="none",
        ),
    ] = None,
    motor: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Motor model: n20 or 25d; on an esp32s3 also sts3215, sts3215-12v, st3020 or scs0009.",
            show_default="the one in robot.toml or motors.toml, else 25d",
        ),
    ] = None,
    counts: Annotated[
        float | None,
        typer.Option(metavar="N", help="Encoder counts per spool turn.", show_default="those of the motor"),
    ] = None,
    rpm: Annotated[
        float | None, typer.Option(metavar="N", help="No-load speed [turns/min].", show_default="that of the motor")
    ] = None,
    moves: Annotated[
        Path | None,
        typer.Option(metavar="MOVES.csv", help="Table of contractions that a button plays.", show_default="none"),
    ] = None,
    rate: Annotated[int, typer.Option(metavar="5|10|25|50", help="Rows of --moves stored per second.")] = 25,
    min_supply: Annotated[
        float | None,
        typer.Option(
            metavar="VOLTS",
            help="Stop the motors below this supply voltage [V]; needs the divider of the kit.",
            show_default="no such stop",
        ),
    ] = None,
) -> None:
    """Build Arduino firmware for geared motors or Feetech servos, and flash it.

    Limits come from robot.toml and motors.toml. Missing encoder counts are added to motors.toml; --motor or --counts
    replaces them. Robots with more motors than one board drives use several boards, each with its own port. Without
    --flash the command prints the flash command instead of running it. With --moves the board plays the table without a
    computer, after calibration. Needs Debian's gcc-avr and avr-libc, and avrdude to flash. For an ESP32-S3 the command
    writes an Arduino sketch instead; it drives Feetech servos over a bus adapter. Then run: hydrostat calibrate ROBOT
    --motors firmware:/dev/ttyACM0.

    Example: hydrostat firmware examples/starfish --board mega --out build/firmware
    """
    from hydrostat import control
    from hydrostat.robot import PinDrive

    _check_motor("--motor", motor or "auto", board)
    _check_alone(moves, rate, min_supply)
    folder = robot if robot.is_dir() else robot.parent
    loaded = read_robot(robot)
    PinDrive.require_none(loaded.drives, "firmware, whose boards turn winches")
    _check_motor(f"{robot}: motor", loaded.motor if motor is None and counts is None else "auto", board)
    if not loaded.winches:
        raise InputError(f"{robot}: no winches. Add winches and cables, or run `hydrostat design`.")
    has_file, reader = (folder / control.CALIBRATION).exists(), control.Calibration
    calibration = reader.read(folder, loaded) if has_file else reader.usual(loaded)
    chosen = _choose_motor(motor, loaded.motor, calibration, counts)
    known = control.SERVO_STEPS.get(chosen.bus, chosen.counts)
    usual, turns = known if counts is None else counts, chosen.speed if rpm is None else rpm
    for name, value in (("counts", usual), ("rpm", turns)):
        if not 0 < value < 1e6:
            raise InputError(f"--{name} {value:g}: must be above 0")
    boards = [SERVO_BOARD] if chosen.bus else _boards(board, calibration)
    given = calibration if chosen.bus else control.on_boards(calibration, boards)
    _check_count(board, given)
    is_known = bool(motor or chosen.bus)
    given = _set_counts(given, usual, is_new=bool(counts) or is_known, model=chosen.key if is_known else None)
    _check_turns(loaded, given, chosen)
    ports = port.split(",") if port else []
    if ports and len(ports) != given.boards:
        words = f"{plural(len(ports), 'port')} for {plural(given.boards, 'board')}"
        raise InputError(f"--flash {port}: {words}. Separate ports by commas.")
    places = [out if given.boards == 1 else out / f"board_{number}" for number in range(1, given.boards + 1)]
    control.check_ports(ports)
    shown = ", ".join(dict.fromkeys(f"{each.counts:g}" for each in given.motors))
    print(f"Motor: {chosen.title}{'' if motor else ' (check the kit; change with --motor)'}")
    print(f"{shown} counts per spool turn, no-load speed {turns:g} turns/min")
    speed = {"rate": rate, "rpm": turns if motor or rpm or chosen.bus else None}
    baked = None if moves is None else control.bake_moves(moves, folder, loaded, given, boards[0], **speed)
    text = "" if baked is None else baked.settings
    text += "" if min_supply is None else f"#define MIN_SUPPLY {round(1e3 * min_supply)} /* [mV] */\n"
    facts = {"rpm": turns, "stall": chosen.stall_current, "bus": chosen.bus}
    images = control.build_images(loaded, given, boards, places, moves=text, **facts)
    if given != calibration:
        print(f"Wrote {given.write(folder)}, next to the robot: motors and counts for calibrate, play and drive")
    _tell_changes(loaded, calibration, given, chosen.key)
    for number, (kind, image) in enumerate(zip(boards, images, strict=False), 1):
        _tell(kind, number, given, chosen.bus)
        _flash(kind, image, ports[number - 1] if ports else None)
    if baked is not None:
        words = f"{moves}: {baked.seconds:.1f} s, {baked.size / 1000:.1f} kB"
        _tell_moves(words, boards[0], loaded, given, chosen.bus)
    _tell_supply(boards[: given.boards], min_supply, chosen.bus, alone=baked is not None)
    if ports:
        print(f"{port}: flashed. Pay out all cables, then: hydrostat calibrate {folder} --motors firmware:{port}")


def _check_motor(where: str, key: str, board: str | None) -> None:
    """Reject a motor that boards do not drive, or that this board does not, or an unknown one."""
    from hydrostat.fabrication import ALL_MOTORS, BOARDS, check_board

    for kind in [] if board is None else board.split(","):
        check_board(kind.strip())
    motor = next((each for each in ALL_MOTORS if each.key == key), None)
    if motor is None and key != "auto":
        known = [each.key for each in ALL_MOTORS if each.counts or each.is_feetech]
        other = "" if any(each.key in key for each in ALL_MOTORS if each.bus) else " Or give --counts and --rpm."
        raise InputError(f"{where} {key}: unknown motor. {list_choices('motors', known, key)}{other}")
    if motor is None or not motor.bus:
        return
    if not motor.is_feetech:
        raise InputError(
            f"{where} {key}: boards drive no Dynamixel servos. Run `hydrostat play ROBOT MOVES --motors "
            f"{motor.bus}:PORT`, or build with --motor n20, 25d or a Feetech servo."
        )
    if board not in (None, SERVO_BOARD) and {each.strip() for each in board.split(",")} == {SERVO_BOARD}:
        most = BOARDS[SERVO_BOARD].servos
        raise InputError(f"--board {board}: one board drives up to {most} servos. Use --board {SERVO_BOARD}.")
    if board not in (None, SERVO_BOARD):
        raise InputError(
            f"{where} {key}: --board {board} drives no bus servos. Use --board {SERVO_BOARD}, or --motor n20 or 25d."
        )


def _choose_motor(asked: str | None, own: str, calibration: "Calibration", counts: float | None) -> "Motor":
    """The motor of the command; or a servo that the robot names; or the one whose counts motors have, else a usual one.

    Raises:
        InputError: servos with other counts than theirs, or on several boards.
    """
    from hydrostat.control import CALIBRATION, SERVO_STEPS
    from hydrostat.fabrication import ALL_MOTORS

    known = {each.key: each for each in ALL_MOTORS if each.counts or (each.is_feetech and (asked or counts is None))}
    if asked is None and counts is None and own == "auto" and calibration.model in known:
        own = calibration.model or own
    elif asked is None and not (own in known and known[own].bus):
        told = {each.counts for each in calibration.motors}
        steps = {key: SERVO_STEPS.get(each.bus, each.counts) for key, each in known.items()}
        own = next((key for key, each in steps.items() if told == {each}), own if own in known else _USUAL)
    motor = known[asked or own]
    if motor.bus and counts is not None:
        raise InputError(f"--counts: a {motor.key} has {SERVO_STEPS[motor.bus]:g}. Remove it.")
    if motor.bus and calibration.boards > 1:
        raise InputError(f"{CALIBRATION}: servos are on {calibration.boards} boards. Write board = 1 for all.")
    return motor


def _set_counts(calibration: "Calibration", counts: float, *, is_new: bool, model: str | None) -> "Calibration":
    """Motors with counts and a model: new ones, or those of motors.toml. Zeros in other counts are dropped."""

    def change(motor: "WinchMotor") -> "WinchMotor":
        if not is_new:
            return replace(motor, counts=motor.counts or counts)
        kept = motor.counts in (None, counts)
        return replace(motor, counts=counts, model=model, zero=motor.zero if kept else None)

    from hydrostat.control import Calibration

    return Calibration(tuple(change(motor) for motor in calibration.motors))


def _check_turns(robot: "Robot", given: "Calibration", motor: "Motor") -> None:
    """Reject spools that a servo does not turn far enough."""
    from hydrostat.fabrication import find_turn_problems

    pairs = zip(robot.winches, given.motors, strict=True)
    winches = [replace(winch, spool_radius=each.radius) for winch, each in pairs]
    if motor.bus and (problems := find_turn_problems(winches, motor)):
        raise InputError(problems[0] + ".")


def _tell_changes(robot: "Robot", before: "Calibration", after: "Calibration", key: str) -> None:
    """Warn of counts and zeros that are replaced, and of a motor and spools that differ from those of the robot."""
    from hydrostat.control import CALIBRATION

    if robot.motor not in ("auto", key):
        own = f'motor = "{robot.motor}" in robot.toml, which calibrate and play follow'
        print(f"warning: motor {key} of this firmware contradicts {own}. Correct one of the two.")
    for winch, old, new in zip(robot.winches, before.motors, after.motors, strict=True):
        if old.counts and old.counts != new.counts:
            lost = ", and its zero is removed" if old.zero is not None else ""
            print(f"warning: {CALIBRATION}, {winch.name}: counts {old.counts:g} replaced by {new.counts:g}{lost}")
        if not new.curve and abs(new.radius - winch.spool_radius) > 1e-6:
            print(
                f"warning: {winch.name}: spool radius {1e3 * new.radius:g} mm in {CALIBRATION}, "
                f"{1e3 * winch.spool_radius:g} mm in robot.toml. Firmware uses {CALIBRATION}. Correct one of the two."
            )


def _tell_moves(words: str, board: str, robot: "Robot", given: "Calibration", bus: str) -> None:
    """Say how moves start, and whether the sketch has the zeros of servos, else why not and what to do."""
    from hydrostat.control import find_zero_loss
    from hydrostat.fabrication import check_board

    print(f"{words}. Button {check_board(board).button_name} plays and stops it, after calibration.")
    if not bus:
        return
    if why := find_zero_loss(robot, given.motors, bus):
        print(f"No zeros in the sketch: {why}.")
        print("Calibrate from a computer after each start.")
    elif given.is_complete:
        print("Zeros are in the sketch: the robot plays after each start.")
    else:
        print("No zeros in the sketch: not calibrated. Calibrate, then run this command again and upload.")


def _check_alone(moves: Path | None, rate: int, min_supply: float | None) -> None:
    if moves is None and rate != 25:
        raise InputError("--rate: needs --moves. Add it, or remove --rate.")
    if min_supply is not None and not 3 <= min_supply <= 17:
        raise InputError(f"--min-supply {min_supply:g}: must be from 3 to 17 V.")


def _check_count(asked: str | None, given: "Calibration") -> None:
    """Reject more boards than the motors need."""
    count = 0 if asked is None else len(asked.split(","))
    if count > given.boards:
        raise InputError(
            f"--board {asked}: {plural(count, 'board')} for motors that fit on {given.boards}. Remove the others."
        )


def _tell_supply(kinds: list[str], min_supply: float | None, bus: str, *, alone: bool) -> None:
    from hydrostat.fabrication import check_board

    if bus:
        least = "the least supply in their memory" if min_supply is None else f"{min_supply:g} V"
        print(f"Motors stop below {least}, as the servos measure it.")
    elif min_supply is not None:
        pins = ", ".join(dict.fromkeys(check_board(kind).supply for kind in kinds))
        print(f"Motors stop below {min_supply:g} V. Divider: plus of the motors, 47 kΩ, pin {pins}, 10 kΩ, GND.")
    elif alone:
        print("note: no low-voltage stop. From a battery add the divider and --min-supply, 1 V per NiMH cell.")


_USUAL = "25d"
"""The motor that is meant where neither a command nor motors.toml tells one."""


def _boards(asked: str | None, calibration: "Calibration") -> list[str]:
    """Kinds of boards as asked for, the last again and again while motors are left; else the smallest that fit."""
    from hydrostat.fabrication import board_for, check_board

    found, motors = [each.strip() for each in asked.split(",")] if asked else [], len(calibration.motors)
    if not asked and calibration.boards > 1:
        return [board_for(len(calibration.places(number))) for number in range(1, calibration.boards + 1)]
    while (room := sum(check_board(each).motors for each in found)) < motors:
        found.append(found[-1] if asked else board_for(motors - room))
    return found


def _tell(kind: str, number: int, given: "Calibration", bus: str) -> None:
    """Say which motor is wired to which pins of a board."""
    from hydrostat.fabrication import check_board

    if bus:
        print(f"{kind}: {plural(len(given.motors), 'servo')} on a bus adapter, GND to GND, for UART.")
        out, back = check_board(kind).servo_pins
        wires = f"Waveshare: its TX to pin {out}, RX to {back}. Seeed: its RX to pin {out}, TX to {back}."
        print(f"{wires} See docs/motors.md.")
        for motor in sorted(given.motors, key=lambda one: one.number):
            print(f"  servo number {motor.number}: {motor.winch}")
        return
    motors = sorted((given.motors[place] for place in given.places(number)), key=lambda one: one.number)
    name = kind if given.boards == 1 else f"board {number}, {kind}"
    print(f"{name}: {plural(len(motors), 'motor')}, wiring (driver PWM, direction, encoder A and B, current):")
    for each, pins in zip(motors, check_board(kind).wiring, strict=False):
        print(f"  {each.number} {each.winch}: {', '.join(pins)}")


def _flash(kind: str, image: "Path", port: str | None) -> None:
    """Write an image to the board on a port, or say how."""
    from hydrostat.control import flash, flash_command

    command = flash_command(kind, port or "PORT", image)
    other = "" if image.suffix == ".hex" else ", or open it in the Arduino IDE with Espressif's board package esp32 3"
    print(f"Wrote {image}. {'Flashing the board' if port else 'To flash a board'}: {join(command)}{other}", flush=True)
    if port:
        flash(command)
