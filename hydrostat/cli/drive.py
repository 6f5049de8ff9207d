"""`hydrostat drive`."""

import shutil
import sys
import time
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.design_results import kit_motor
from hydrostat.cli.folders import RobotFolder, folder_of
from hydrostat.cli.learned import read_model
from hydrostat.cli.options import MotorPort
from hydrostat.cli.waiting import one_interrupt, prepare_physics, read_robot
from hydrostat.errors import HydrostatError, InputError

if TYPE_CHECKING:
    from hydrostat.control import Motors
    from hydrostat.learning import LearnedModel
    from hydrostat.robot import Robot
    from hydrostat.simulation import Simulation
    from hydrostat.teleop import CommandMapper, DriveLoop, DriveSource

BAR = 24  # letters of a full bar


def drive(
    robot: RobotFolder,
    source: Annotated[
        str,
        typer.Option(
            metavar="KIND",
            help="Input device: keys, gamepad, midi:NAME@KNOB, osc:PORT, glove:/dev/ttyUSB0, glove:emulated, "
            "camera:FILE.task or camera:PORT.",
        ),
    ] = "keys",
    port: MotorPort = None,
    markers: Annotated[bool, typer.Option("--markers", help="Move fingertips (markers) instead of winches.")] = False,
    model: Annotated[
        Path | None, typer.Option(metavar="MODEL", help="Trained model to warm-start each move, with --markers.")
    ] = None,
    known: Annotated[
        Path | None, typer.Option("--map", metavar="FILE", help="Hand-to-robot map written by `hydrostat mimic`.")
    ] = None,
    smoothing: Annotated[
        float, typer.Option(metavar="HZ", help="Cutoff frequency for smoothing a resting hand. 0 = no smoothing.")
    ] = 1.5,
    seconds: Annotated[float, typer.Option(metavar="SECONDS", help="Duration. 0 = until you stop it.")] = 0.0,
) -> None:
    """Drive winches with keys, gamepad, MIDI, OSC, glove or camera.

    Without --motors the motors are simulated, and every line starts with "simulated". With --motors, the limits of the
    winches protect the robot; so do a watchdog and a tension guard, if the motors have them. Motors hold when the input
    is lost, and stop at the end, on Ctrl-C, on SIGTERM, when the terminal closes and on any error.

    With --markers you move markers, and inverse kinematics computes the contractions while you drive.

    Example: hydrostat drive gallery:starfish --source keys
    """
    from hydrostat import control, teleop

    if port is not None:
        control.check_port(port)
    if model is not None and not markers:
        raise InputError("--model: needs --markers. Add it.")
    if not seconds >= 0:
        raise InputError(f"--seconds {seconds:g}: must not be negative")
    smooth = teleop.Smoothing(least=smoothing) if smoothing else None
    loaded = read_robot(robot)
    networks, loaded = (None, loaded) if model is None else read_model(model, loaded)
    learned = None if known is None else teleop.HandMap.open(known)
    simulation, kind = prepare_physics(loaded), "simulated" if port is None else port.partition(":")[0]
    way = _way(simulation, networks, markers=markers, guarded=port is not None)
    with one_interrupt(""):  # arming turns motors, too
        asked: DriveSource | None = None
        motors: Motors | None = None
        try:
            wearer = teleop.EmulatedHand(teleop.WinchMapper.list_channels(loaded))
            asked = teleop.open_source(source, way.channels, learned, wearer, smoothing=smooth)
            motors = _motors(folder_of(robot), loaded, port, way)
            shown = _Shown(kind, motors)
            _run(
                shown,
                f"driving {'fingertips' if markers else 'winches'} of {loaded.name} with {source}",
                way,
                asked,
                seconds,
            )
        finally:
            if motors is not None:  # before all that may take its time
                motors.link.close()
            if asked is not None:
                asked.close()
            way.close()


def _run(shown: "_Shown", what: str, way: "CommandMapper", source: "DriveSource", seconds: float) -> None:
    """DriveLoop, and say how it ended."""
    from hydrostat import teleop

    shown.say(what)
    try:
        teleop.drive(shown.motors, way, source, seconds=seconds or inf, tell=shown.tell)
    except (KeyboardInterrupt, SystemExit) as stop:
        shown.end("stopped")
        code = 130 if isinstance(stop, KeyboardInterrupt) else stop.code
        raise typer.Exit(code if isinstance(code, int) else 1) from None
    except HydrostatError as error:
        raise HydrostatError(f"{shown.kind}: motors stopped: {error}") from None
    shown.end("ended")


def _way(simulation: "Simulation", networks: "LearnedModel | None", *, markers: bool, guarded: bool) -> "CommandMapper":
    """From what is asked for to contractions, from where the body is at rest."""
    from hydrostat import control, teleop

    begin = teleop.WinchMapper.list_channels(simulation.robot).rest
    if markers:
        rate = control.LinkLimits().speed if guarded else control.DEFAULT_MAX_SPEED
        return teleop.MarkerMapper(simulation, begin, model=networks, rate=rate)
    return teleop.WinchMapper(simulation, begin, solves=guarded)


def _motors(folder: Path, robot: "Robot", port: str | None, way: "CommandMapper") -> "Motors":
    """The motors, armed."""
    from hydrostat import control

    if port is None:
        return control.Motors(robot.winches, control.SimulatedLink(way.contractions))
    pulls = way.known
    return control.arm_motors(
        folder,
        robot,
        port,
        pulls.nearest,
        known=pulls,
        motor=kit_motor(robot, folder),
        log=lambda line: print(line, flush=True),
    )


class _Shown:
    """Display of the motors: bars that are redrawn on a terminal, a line now and then elsewhere."""

    def __init__(self, kind: str, motors: "Motors") -> None:
        self.kind, self.motors, self._last, self._lines = kind, motors, -inf, 0
        self._terminal, self._silent = sys.stdout.isatty(), False

    def tell(self, driven: "DriveLoop") -> None:
        """Show where the motors are, if it is time to."""
        now = time.monotonic()
        # time from one word on the motors to the next [s]: on a terminal, and where lines are kept
        shown, listed = 0.1, 2.0
        if now - self._last < (shown if self._terminal else listed) and driven.silent == self._silent:
            return
        self._last, self._silent = now, driven.silent
        state = "input lost: motors holding" if driven.silent else "hold" if driven.wish.hold else ""
        if self._terminal:
            told = "; ".join(part for part in (state, driven.way.words) if part)
            self._draw([*self._bars(), told, driven.wish.words])
        else:
            self.say(f"{self._places()}{f'; {state}' if state else ''}")

    def say(self, words: str) -> None:
        """Print a line."""
        print(f"{self.kind}: {words}", flush=True)

    def end(self, word: str) -> None:
        """Say how it ended."""
        self.say(f"{word}; motors holding at {self._places()}")

    def _bars(self) -> list[str]:
        motors, currents = self.motors, self.motors.link.currents
        widest = max(map(len, motors.names))
        lines = []
        for index, name in enumerate(motors.names):
            low, high = float(motors.low[index]), float(motors.high[index])
            share = (float(motors.places[index]) - low) / max(high - low, 1e-9)
            full = round(BAR * min(max(share, 0.0), 1.0))
            current = "" if currents is None else f"  {float(currents[index]):6.3f} A"
            bar = "#" * full + "-" * (BAR - full)
            lines.append(f"{self.kind}: {name:<{widest}} [{bar}] {1e3 * motors.places[index]:6.1f} mm{current}")
        return lines

    def _draw(self, lines: list[str]) -> None:
        width = shutil.get_terminal_size().columns - 1
        back = f"\x1b[{self._lines}A" if self._lines else ""
        print(back + "\n".join(f"\r{line[:width]}\x1b[K" for line in lines), flush=True)
        self._lines = len(lines)

    def _places(self) -> str:
        motors = self.motors
        return ", ".join(
            f"{name} {1e3 * taken:z.1f} mm" for name, taken in zip(motors.names, motors.places, strict=True)
        )
