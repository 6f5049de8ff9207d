"""`hydrostat calibrate`."""

import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import RobotFolder, folder_of
from hydrostat.cli.waiting import one_interrupt, patiently, read_robot
from hydrostat.errors import InputError
from hydrostat.units import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hydrostat.arrays import Vector
    from hydrostat.control import Bus, Calibration, TakenUp, WinchPull
    from hydrostat.robot import Robot

PAGE = "calibration.html"
SOFT, HARD = 0.5, 2.0  # cables that feel so much softer or stiffer than the model are told


def calibrate(
    robot: RobotFolder,
    port: Annotated[
        str, typer.Option(metavar="KIND:PORT", help="Motors, such as dynamixel:/dev/ttyUSB0; or emulated.")
    ],
) -> None:
    """Find out how far each motor stands from where its cables begin to pull.

    One motor after the other lets its cable out, takes it up at low current until it feels a pull, and measures that
    place twice. The body must be free to move and hold nothing. What is found is saved after each winch, in motors.toml
    beside robot.toml; nothing is written into motors. Ctrl-C stops the motors; what was found until then is kept.

    The first time motors 1, 2, ... are on the winches in their order; edit motors.toml where they are not.

    Example: hydrostat calibrate examples/starfish --port dynamixel:/dev/ttyUSB0
    """
    import numpy as np

    from hydrostat import control

    control.check_port(port)
    folder = folder_of(robot)
    loaded = read_robot(robot)
    if not loaded.winches:
        raise InputError(f"{robot}: has no winches; add some, or let `hydrostat design` find them")
    new = not (folder / control.CALIBRATION).exists()
    calibration = control.usual_calibration(loaded) if new else control.read_calibration(folder, loaded)
    kind = port.partition(":")[0]
    with patiently(f"{kind}: finding out what each winch should feel ..."):
        model = control.winch_pulls(loaded)

    loads = [pull.at(np.arange(0.0, 0.1, 1e-4)).tolist() for pull in model]

    def tensions(contractions: "Vector") -> "Vector":
        places = [min(max(int(1e4 * taken), 0), 999) for taken in contractions.tolist()]
        return np.array([load[place] for load, place in zip(loads, places, strict=True)])

    emulated = calibration.known() if port == control.EMULATED else calibration
    with one_interrupt(f"{kind}: stopped", signals=(signal.SIGINT, signal.SIGTERM)):
        bus = control.open_bus(port, loaded, emulated, tensions)
        try:
            found, constants = _take_up(kind, bus, folder, calibration, model)
        finally:
            bus.close()
    _tell(kind, folder, loaded, found, model, constants)


def _take_up(
    kind: str, bus: "Bus", folder: Path, calibration: "Calibration", model: "Sequence[WinchPull]"
) -> "tuple[tuple[TakenUp, ...], Vector]":
    """What is found on each winch, saved as soon as it is, and the constants of the motors."""
    import numpy as np

    from hydrostat import control

    known = {motor.winch: motor for motor in calibration.motors}
    facts = bus.identify()
    print(f"{kind}: {counted(len(facts), 'motor')} answered; they turn now, one after the other", flush=True)

    def save(taken: "TakenUp") -> None:
        before, known[taken.motor.winch] = known[taken.motor.winch], taken.motor
        control.write_calibration(folder, control.Calibration(tuple(known.values())))
        words = f"{1e3 * taken.slack:.1f} mm taken up, measured {1e3 * taken.apart:.2f} mm apart"
        if before.zero is not None:
            words += f"; {1e3 * abs(before.contraction(taken.motor.zero or 0.0)):.1f} mm from where it was last time"
        print(f"{kind}: {taken.motor.winch}: {words}", flush=True)

    found = control.take_up_slack(bus, calibration.motors, model, save)
    bus.mark()
    return found, np.array([fact.constant for fact in facts])


def _tell(
    kind: str,
    folder: Path,
    robot: "Robot",
    found: "Sequence[TakenUp]",
    model: "Sequence[WinchPull]",
    constants: "Vector",
) -> None:
    """Compare with the model, in words and on a page."""
    from hydrostat import control
    from hydrostat.plot.calibration_page import reach, write_calibration_page

    notes = []
    for taken, pull, constant in zip(found, model, constants.tolist(), strict=True):
        wanted = pull.stiffness(reach(taken))
        felt = wanted * taken.gain * constant / taken.motor.radius
        if felt < SOFT * wanted or felt > HARD * wanted:
            notes.append(
                f"{taken.motor.winch} feels {felt:.0f} N/m where the simulation has {wanted:.0f} N/m: "
                "look whether motor, cable and material are those of robot.toml"
            )
    page = write_calibration_page(robot, found, model, constants, notes, folder / PAGE)
    for note in notes:
        print(f"{kind}: note: {note}")
    print(f"{kind}: saved {folder / control.CALIBRATION}; open {page} to see what was felt")
