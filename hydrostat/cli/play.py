"""`hydrostat play`."""

import shutil
import sys
import time
from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import RobotFolder, folder_of
from hydrostat.cli.options import MotorPort
from hydrostat.cli.waiting import one_interrupt, read_robot
from hydrostat.errors import HydrostatError, InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.control import Motors, Player
    from hydrostat.simulation import ContractionProfile

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
) -> None:
    """Play a table of contractions on the motors in real time.

    Without --motors the motors are simulated, and every line starts with "simulated". `hydrostat trajectory` and the
    studio write such tables. Motors stop at the end, on Ctrl-C, on SIGTERM, when the terminal closes and on
    any error. With --motors they also stop if a cable tension is far above the simulated one, or missing.

    Example: hydrostat play gallery:starfish build/dance/trajectory.csv --repeat 3
    """
    import numpy as np

    from hydrostat import control
    from hydrostat.simulation import ProfileTable

    if port is not None:
        control.check_port(port)
    if loop < 0:
        raise InputError(f"--repeat {loop}: must be 0 or more. 0 plays until you stop it.")
    player = control.Player()
    player.rounds = loop or inf
    try:
        player.set_speed(speed)
    except InputError as error:
        raise InputError(f"--speed {speed:g}: {error}") from None
    loaded = read_robot(robot)
    if not loaded.winches:
        raise InputError(f"{robot}: no winches. Add winches and cables, or run `hydrostat design`.")
    table, kind = ProfileTable.open(moves, loaded), "simulated" if port is None else port.partition(":")[0]
    fastest = control.FASTEST if port is None else control.LinkLimits().speed
    motors = control.Motors(loaded.winches, control.SimulatedLink(np.zeros(len(loaded.winches))), fastest=fastest)
    motors.check(table, speed=speed)  # before anything turns
    pulls = None if port is None else control.tensions_along(loaded, table.profile)
    with one_interrupt(""):  # arming turns motors, too
        if port is not None and pulls is not None:
            motors = control.arm_motors(folder_of(robot), loaded, port, pulls, log=lambda line: print(line, flush=True))
        try:
            often = {0: "until stopped", 1: "once"}.get(loop, f"{loop} times")
            seconds, winches = float(table.profile.times[-1]), plural(len(motors.names), "winch")
            _say(kind, f"{moves} on {loaded.name}, {winches}: {seconds:.2f} s, {often}, at {speed:g}x")
            _play(kind, motors, table.profile, player)
        finally:
            motors.link.close()
    _say(kind, f"finished; motors holding at {_places(motors)}")


def _play(kind: str, motors: "Motors", profile: "ContractionProfile", player: "Player") -> None:
    """Play, and say how it was stopped, if it was."""
    import numpy as np

    back = float(np.abs(profile.values[-1] - profile.at(0.0)).max())
    if player.rounds != 1 and back > 1e-6:
        _say(
            kind, f"warning: the table does not end at its start: a winch jumps {1e3 * back:.1f} mm at each repetition"
        )
    tell, newline = _progress(kind, motors, player, float(profile.times[-1]))
    try:
        player.run(motors, profile, tell=tell)
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
    return ", ".join(f"{name} {1e3 * taken:z.1f} mm" for name, taken in zip(motors.names, motors.places, strict=True))


def _say(kind: str, text: str) -> None:
    print(f"{kind}: {text}", flush=True)
