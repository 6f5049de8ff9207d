"""`hydrostat calibrate`."""

import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import OwnRobotFolder, folder_of, require_writable
from hydrostat.cli.waiting import one_interrupt, patiently, read_robot
from hydrostat.errors import InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hydrostat.arrays import Vector
    from hydrostat.control import Bus, Calibration, SlackCalibration, SpoolCurve, WinchPull
    from hydrostat.robot import Robot

PAGE = "calibration.html"
SOFT, HARD = 0.5, 2.0  # cables that feel so much softer or stiffer than the model are told


def calibrate(
    robot: OwnRobotFolder,
    port: Annotated[
        str, typer.Option(metavar="KIND:PORT", help="Motors, such as dynamixel:/dev/ttyUSB0; or emulated.")
    ],
    spools: Annotated[
        str,
        typer.Option(metavar="NAMES", help="Also measure these spools by a ruler: winches with commas, or all."),
    ] = "",
) -> None:
    """Find out how far each motor stands from where its cables begin to pull.

    One motor after the other lets its cable out, takes it up at low current until it feels a pull, and measures that
    place twice. The body must be free to move and hold nothing. What is found is saved after each winch, in motors.toml
    beside robot.toml, of emulated motors in motors_emulated.toml; nothing is written into motors. Ctrl-C stops the
    motors; what was found until then is kept.

    The first time motors 1, 2, ... are on the winches in their order; edit motors.toml where they are not.

    With --spools each named winch then takes in all its travel in steps; you type where a mark on its cable is on a
    ruler.

    Example: hydrostat calibrate examples/starfish --port dynamixel:/dev/ttyUSB0
    """
    import numpy as np

    from hydrostat import control

    control.check_port(port)
    folder = folder_of(robot)
    require_writable(folder, str(robot))  # before anything turns
    loaded = read_robot(robot)
    if not loaded.winches:
        raise InputError(f"{robot}: has no winches; add some, or let `hydrostat design` find them")
    chosen = _chosen(spools, loaded)
    file = control.EMULATED_CALIBRATION if port == control.EMULATED else control.CALIBRATION
    new = not (folder / file).exists()
    calibration = control.usual_calibration(loaded) if new else control.read_calibration(folder, loaded, name=file)
    kind = port.partition(":")[0]
    with patiently(f"{kind}: finding out what each winch should feel ..."):
        model = control.winch_pulls(loaded)

    loads = [pull.at(np.arange(0.0, 0.1, 1e-4)).tolist() for pull in model]

    def tensions(contractions: "Vector") -> "Vector":
        places = [min(max(int(1e4 * taken), 0), 999) for taken in contractions.tolist()]
        return np.array([load[place] for load, place in zip(loads, places, strict=True)])

    truth = control.layered(calibration.known()) if port == control.EMULATED else calibration
    with one_interrupt(f"{kind}: stopped", signals=(signal.SIGINT, signal.SIGTERM)):
        bus = control.open_bus(port, loaded, truth, tensions)
        try:
            found, constants = _take_up(kind, bus, folder / file, calibration, model)
            curves = _measure(bus, folder / file, loaded, chosen, truth if port == control.EMULATED else None)
        finally:
            bus.close()
    _tell(kind, folder / file, loaded, found, model, constants, curves)


def _chosen(spools: str, robot: "Robot") -> list[int]:
    """Places of the winches whose spools are measured (InputError: no such winch)."""
    names = [winch.name for winch in robot.winches]
    wanted = names if spools == "all" else [name.strip() for name in spools.split(",") if name.strip()]
    for name in wanted:
        if name not in names:
            raise InputError(f"--spools {spools}: there is no winch {name}; there are: {', '.join(names)}, or all")
    return [names.index(name) for name in wanted]


def _take_up(
    kind: str, bus: "Bus", file: Path, calibration: "Calibration", model: "Sequence[WinchPull]"
) -> "tuple[tuple[SlackCalibration, ...], Vector]":
    """What is found on each winch, saved as soon as it is, and the constants of the motors."""
    import numpy as np

    from hydrostat import control

    known = {motor.winch: motor for motor in calibration.motors}
    facts = bus.identify()
    print(f"{kind}: {plural(len(facts), 'motor')} answered; they turn now, one after the other", flush=True)

    def save(taken: "SlackCalibration") -> None:
        before, known[taken.motor.winch] = known[taken.motor.winch], taken.motor
        control.write_calibration(file.parent, control.Calibration(tuple(known.values())), name=file.name)
        words = f"{1e3 * taken.slack:z.1f} mm taken up, measured {1e3 * taken.apart:.2f} mm apart"
        if before.zero is not None:
            words += f"; {1e3 * abs(before.contraction(taken.motor.zero or 0.0)):.1f} mm from where it was last time"
        print(f"{kind}: {taken.motor.winch}: {words}", flush=True)

    found = control.take_up_slack(bus, calibration.motors, model, save)
    bus.mark()
    return found, np.array([fact.constant for fact in facts])


def _measure(
    bus: "Bus", file: Path, robot: "Robot", chosen: "Sequence[int]", truth: "Calibration | None"
) -> "list[SpoolCurve]":
    """Curves of the chosen spools, each saved as soon as it is known; emulated ones have a truth for the ruler."""
    from hydrostat import control

    if not chosen:
        return []
    calibration, curves = control.read_calibration(file.parent, robot, name=file.name), list["SpoolCurve"]()
    link = control.BusLink(bus, robot.winches, calibration)
    try:
        link.identify()
        for place in chosen:
            motor, travel = calibration.motors[place], robot.winches[place].travel
            print(f"{bus.kind}: {motor.winch}: make a mark on its cable where it is bare, and lay a ruler beside it")

            def read(thought: float, place: int = place, name: str = motor.winch) -> float:
                if truth is None:
                    return _asked(name)
                taken = truth.motors[place].contraction(float(bus.read().angles[place]))
                shown = 5e-4 * round(taken / 5e-4)
                by_motor = f"{1e3 * thought:z.1f} mm by its motor"
                print(f"{bus.kind}: {name}: {by_motor}, {1e3 * shown:z.1f} by the emulated ruler")
                return shown

            curves.append(control.measure_spool(link, motor, place, travel, read))
            motors = [*calibration.motors]
            motors[place] = curves[-1].motor
            calibration = control.Calibration(tuple(motors))
            control.write_calibration(file.parent, calibration, name=file.name)
            print(
                f"{bus.kind}: {motor.winch}: radius {1e3 * curves[-1].motor.radius:.2f} mm at its zero; at most "
                f"{1e3 * curves[-1].more:+.1f} mm beside what was thought; readings {1e3 * curves[-1].scatter:.2f} mm "
                "beside the curve",
                flush=True,
            )
    finally:
        link.close()
    return curves


def _asked(name: str) -> float:
    """Where a person sees the mark on the ruler [m] (InputError: there is nobody to ask)."""
    while True:
        try:
            told = input(f"{name}: where is the mark on the ruler [mm]? ")
        except EOFError:
            raise InputError("--spools asks for readings of a ruler; run it in a terminal") from None
        try:
            value = float(told.strip().removesuffix("mm").replace(",", "."))
        except ValueError:
            value = float("nan")
        if abs(value) < 1e4:
            return 1e-3 * value
        print(f"{told.strip()!r} is no number; write millimetres, such as 12.5")


def _tell(
    kind: str,
    file: Path,
    robot: "Robot",
    found: "Sequence[SlackCalibration]",
    model: "Sequence[WinchPull]",
    constants: "Vector",
    curves: "Sequence[SpoolCurve]",
) -> None:
    """Compare with the model, in words and on a page."""
    from hydrostat.control import EMULATED
    from hydrostat.plot import reach, write_calibration_page

    notes = []
    for taken, pull, constant in zip(found, model, constants.tolist(), strict=True):
        wanted = pull.stiffness(reach(taken))
        felt = wanted * taken.gain * constant / taken.motor.radius
        if felt < SOFT * wanted or felt > HARD * wanted:
            notes.append(
                f"{taken.motor.winch} feels {felt:.0f} N/m where the simulation has {wanted:.0f} N/m: "
                "look whether motor, cable and material are those of robot.toml"
            )
    page = write_calibration_page(
        robot, found, model, constants, notes, file.parent / PAGE, curves, emulated=kind == EMULATED
    )
    for note in notes:
        print(f"{kind}: note: {note}")
    print(f"{kind}: saved {file}; open {page} to see what was felt")
