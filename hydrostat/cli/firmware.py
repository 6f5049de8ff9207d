"""`hydrostat firmware`."""

from dataclasses import replace
from shlex import join
from typing import Annotated

import typer

from hydrostat.cli.folders import OutFolder, RobotFolder
from hydrostat.cli.waiting import read_robot
from hydrostat.errors import InputError
from hydrostat.units import counted


def firmware(
    robot: RobotFolder,
    out: OutFolder,
    board: Annotated[str, typer.Option(metavar="uno|mega", help="Which board: two motors, or six.")] = "uno",
    port: Annotated[str | None, typer.Option(metavar="PORT", help="Write it to this board: /dev/ttyACM0.")] = None,
    motor: Annotated[str, typer.Option(metavar="KEY", help="Motor with an encoder, of the kit's table.")] = "25d",
    counts: Annotated[float | None, typer.Option(metavar="N", help="Of the encoder in a turn of the spool.")] = None,
    rpm: Annotated[float | None, typer.Option(metavar="N", help="Turns a minute without load.")] = None,
) -> None:
    """Build the firmware of a robot for an Arduino with geared motors, and write it to the board.

    Its limits come from robot.toml and motors.toml; where a motor there has no counts they are added. Without --port
    nothing is written to a board, and the command that would do it is shown. Needs Debian's gcc-avr and avr-libc, and
    avrdude to write. Then: hydrostat calibrate ROBOT --port firmware:/dev/ttyACM0.

    Example: hydrostat firmware examples/starfish --board mega --out build/firmware
    """
    from hydrostat import control
    from hydrostat.control import firmware_build as build
    from hydrostat.fabrication import MOTORS

    known = {each.key: each for each in MOTORS if each.counts}
    if motor not in known:
        raise InputError(f"--motor {motor}: those with an encoder are: {', '.join(known)}; or give --counts and --rpm")
    usual, turns = known[motor].counts if counts is None else counts, known[motor].speed if rpm is None else rpm
    for name, value in (("counts", usual), ("rpm", turns)):
        if not 0 < value < 1e6:
            raise InputError(f"--{name} {value:g}: must be above 0")
    kind, folder = build.board_kind(board), robot if robot.is_dir() else robot.parent
    loaded = read_robot(robot)
    if not loaded.winches:
        raise InputError(f"{robot}: has no winches; add some, or let `hydrostat design` find them")
    if (folder / control.CALIBRATION).exists():
        calibration = control.read_calibration(folder, loaded)
    else:
        calibration = control.usual_calibration(loaded)
    given = control.Calibration(
        tuple(replace(each, counts=counts or each.counts or usual) for each in calibration.motors)
    )
    image = build.build_firmware(build.firmware_settings(loaded, given, rpm=turns), board, out)
    if given != calibration:
        print(f"{control.write_calibration(folder, given)}: {usual:g} counts in a turn of each spool")
    print(
        f"{board}: {counted(len(given.motors), 'motor')}, wired so (driver's PWM, direction, encoder A and B, current):"
    )
    for each, pins in zip(sorted(given.motors, key=lambda one: one.number), kind.wiring, strict=False):
        print(f"  {each.number} {each.winch}: {', '.join(pins)}")
    command = build.flash_command(board, port or "PORT", image)
    print(f"Wrote {image}; {'writing it to the board' if port else 'to write it to a board'}: {join(command)}")
    if port:
        build.flash(command)
        print(f"{port}: written. Let all cables out, then: hydrostat calibrate {folder} --port firmware:{port}")
