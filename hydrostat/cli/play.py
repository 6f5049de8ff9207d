"""`hydrostat play`."""

import shutil
import sys
import time
from collections.abc import Callable
from functools import partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.design_results import kit_motor
from hydrostat.cli.folders import RobotFolder, folder_of
from hydrostat.cli.measure import KnownLens, TagHeight, TagSide, photo_options
from hydrostat.cli.options import MotorPort
from hydrostat.cli.play_camera import CameraFeedback, CameraOptions, open_camera, require_rest
from hydrostat.cli.waiting import one_interrupt, read_robot
from hydrostat.errors import HydrostatError, InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.control import Motors, Player
    from hydrostat.simulation import ContractionProfile, ProfileTable

SHOWN, LISTED = 0.1, 2.0  # time from one word on the progress to the next [s]: on a terminal, and where lines are kept


def play(
    robot: RobotFolder,
    moves: Annotated[
        Path, typer.Argument(metavar="MOVES.csv", help="Table of contractions: columns time_s, WINCH ... [mm].")
    ],
    loop: Annotated[
        int, typer.Option("--repeat", metavar="N", help="Number of repetitions. 0 = until you stop it.")
    ] = 1,
    speed: Annotated[float, typer.Option(metavar="TIMES", help="Playback speed factor.")] = 1.0,
    port: MotorPort = None,
    camera: Annotated[
        str | None,
        typer.Option(
            metavar="CAMERA", help="Camera that sees the tags, to correct contractions: number, device or address."
        ),
    ] = None,
    lag: Annotated[
        str, typer.Option(metavar="TIME", help="Time from a command until a frame with its effect arrives.")
    ] = "100ms",
    lost: Annotated[
        str,
        typer.Option(metavar="hold|continue", help="If no marker is in sight, hold or continue without correction."),
    ] = "hold",
    tag: TagSide = "15mm",
    height: TagHeight = None,
    lens: KnownLens = None,
) -> None:
    """Play a table of contractions on the motors in real time.

    Without --motors the motors are simulated, and every line starts with "simulated". `hydrostat trajectory` and the
    studio write such tables. Motors stop at the end, on Ctrl-C, on SIGTERM, when the terminal closes and on any error.
    With --motors, Dynamixel servos also stop if a cable tension is far above the simulated one, or missing; boards and
    Feetech servos have no such guard. With --camera, the command reads the tags of `hydrostat measure --print` and
    keeps the markers on their simulated paths.

    Example: hydrostat play gallery:starfish build/dance/trajectory.csv --repeat 3
    """
    import numpy as np

    from hydrostat import control
    from hydrostat.simulation import ProfileTable

    if port is not None:
        control.check_port(port)
    seen_by = None if camera is None else CameraOptions.read(camera, port, lag, lost, photo_options(tag, height, lens))
    if loop < 0:
        raise InputError(f"--repeat {loop}: must be 0 or more. 0 plays until you stop it.")
    player = control.Player()
    player.rounds = loop or inf
    try:
        player.set_speed(speed)
    except InputError as error:
        raise InputError(f"--speed {speed:g}: {error}") from None
    given = read_robot(robot)
    if given.drives and camera is not None:
        raise InputError(f"--camera: not available with drives, such as {given.drives[0].name}. Remove --camera.")
    loaded, kind = control.motor_stand(given), "simulated" if port is None else port.partition(":")[0]
    if not loaded.winches:
        raise InputError(f"{robot}: no winches. Add winches and cables, or run `hydrostat design`.")
    asked = ProfileTable.open(moves, given)
    table = control.stand_table(asked, given)
    for column in control.list_moved_loads(asked, given):
        _say(kind, f"warning: no motor changes column {column}. Apply this load by hand, or the poses differ")
    fastest = control.DEFAULT_MAX_SPEED if port is None else control.LinkLimits().speed
    motors = control.Motors(loaded.winches, control.SimulatedLink(np.zeros(len(loaded.winches))), fastest=fastest)
    motors.check(table, speed=speed)  # before anything turns
    if port is not None:
        _check_corrected(motors, control.correct_table(table, folder_of(robot), loaded), speed)
    pulls, known = (None, None) if port is None else control.stand_tensions(given, asked)
    eye = open_camera(seen_by, loaded, table.profile, partial(_say, kind))
    with one_interrupt(""), eye as seen:  # arming turns motors, too
        if port is not None and pulls is not None:
            log = partial(print, flush=True)
            chosen = kit_motor(given, robot)
            motors = control.arm_motors(folder_of(robot), loaded, port, pulls, known=known, motor=chosen, log=log)
        try:
            if seen is not None:
                require_rest(motors)
            often = {0: "until stopped", 1: "once"}.get(loop, f"{loop} times")
            seconds, winches = float(table.profile.times[-1]), plural(len(motors.names), "winch")
            _say(kind, f"{moves} on {loaded.name}, {winches}: {seconds:.2f} s, {often}, at {speed:g}x")
            _play(kind, motors, table.profile, player, seen)
        finally:
            motors.link.close()
        for line in [] if seen is None else seen.report():
            _say(kind, line)
    _say(kind, f"finished; motors holding at {_places(motors)}")


def _check_corrected(motors: "Motors", table: "ProfileTable", speed: float) -> None:
    """Refuse a table that motors cannot play once correction.json has changed it."""
    try:
        motors.check(table, speed=speed)
    except InputError as error:
        raise InputError(f"{error}, as correction.json corrects it") from None


def _play(
    kind: str, motors: "Motors", profile: "ContractionProfile", player: "Player", seen: CameraFeedback | None
) -> None:
    """Play, and say how it was stopped, if it was."""
    import numpy as np

    back = float(np.abs(profile.values[-1] - profile.at(0.0)).max())
    if player.rounds != 1 and back > 1e-6:
        _say(
            kind, f"warning: the table does not end at its start: a winch jumps {1e3 * back:.1f} mm at each repetition"
        )
    tell, newline = _progress(kind, motors, player, float(profile.times[-1]))
    try:
        if seen is None:
            player.run(motors, profile, tell=tell)
        else:  # frames have the time of this computer
            player.run(motors, profile, feedback=seen.feedback, tell=tell, clock=time.monotonic)
    except (KeyboardInterrupt, SystemExit) as stop:
        newline()
        _say(kind, f"stopped at {player.time:.2f} s; motors holding at {_places(motors)}")
        code = 130 if isinstance(stop, KeyboardInterrupt) else stop.code
        raise typer.Exit(code if isinstance(code, int) else 1) from None
    except HydrostatError as error:
        newline()
        raise HydrostatError(f"{kind}: motors stopped at {player.time:.2f} s: {error}") from None
    newline()


def _progress(
    kind: str, motors: "Motors", player: "Player", seconds: float
) -> tuple[Callable[[], None], Callable[[], None]]:
    """Give what to call after each command, and what to call before another line is printed."""
    shown, terminal = -inf, sys.stdout.isatty()

    def tell() -> None:
        nonlocal shown
        now = time.monotonic()
        if now - shown < (SHOWN if terminal else LISTED):
            return
        shown = now
        which = "" if player.rounds == 1 else f", round {min(player.done + 1, player.rounds):g}"
        which += f" of {player.rounds:g}" if 1 < player.rounds < inf else ""
        text = f"{kind}: {player.time:6.2f} of {seconds:.2f} s{which}: {_places(motors)}"
        if terminal:
            width = shutil.get_terminal_size().columns - 1
            print(f"\r{text[:width]:<{width}}", end="", flush=True)
        else:
            print(text, flush=True)

    def newline() -> None:
        if terminal and shown > -inf:
            print(flush=True)

    return tell, newline


def _places(motors: "Motors") -> str:
    """Contractions of the winches, in words."""
    rows = zip(motors.names, motors.places, motors.units, strict=True)
    return ", ".join(f"{name} {1e3 * taken:z.1f} {unit}" for name, taken, unit in rows)


def _say(kind: str, text: str) -> None:
    print(f"{kind}: {text}", flush=True)
