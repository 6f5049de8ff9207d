"""`hydrostat calibrate`."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.design_results import kit_motor
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


def calibrate(
    robot: OwnRobotFolder,
    port: Annotated[
        str,
        typer.Option(
            "--motors", metavar="KIND:PORT", help="Motor connection, e.g. dynamixel:/dev/ttyUSB0, or emulated."
        ),
    ],
    spools: Annotated[
        str,
        typer.Option(
            metavar="NAMES", help="Also measure these spools with a ruler: winch names separated by commas, or all."
        ),
    ] = "",
    restart: Annotated[
        bool,
        typer.Option(
            "--restart", help="First restart motors that were switched off by overload or heat, after they have cooled."
        ),
    ] = False,
) -> None:
    """Tension each cable and record the motor zero positions.

    Each motor in turn pays out its cable, then reels it in at low current until the cable is taut, twice. The body must
    be free to move and hold nothing. The result of each winch is saved in motors.toml next to robot.toml
    (motors_emulated.toml for emulated motors). Nothing is written to the motors. Ctrl-C stops the motors and keeps the
    results so far.

    On the first run, motors 1, 2, ... belong to the winches in order. Edit motors.toml to change this.

    With --spools, each named winch then reels in its full travel in steps. At each step, read the position of a mark on
    its cable from a ruler and type it.

    Example: hydrostat calibrate examples/starfish --motors dynamixel:/dev/ttyUSB0
    """
    import numpy as np

    from hydrostat import control

    control.check_port(port)
    folder = folder_of(robot)
    require_writable(folder, str(robot))  # before anything turns
    loaded = read_robot(robot)
    if not loaded.winches:
        raise InputError(f"{robot}: no winches. Add winches and cables, or run `hydrostat design`.")
    if loaded.drives:
        raise InputError(
            f"{robot}: drive {loaded.drives[0].name} has no cable that is slack. Calibrate a copy without drives, then "
            "write a [[motor]] with a zero for each drive in motors.toml."
        )
    if back := [cable.winch for cable in loaded.cables if cable.reverse]:
        raise InputError(
            f'{robot}: winch "{back[0]}" pulls both ways, so it is never slack. Write its zero in motors.toml.'
        )
    chosen, kind = _winch_indices(spools, loaded), port.partition(":")[0]
    file = control.EMULATED_CALIBRATION if port == control.EMULATED else control.CALIBRATION
    new = not (folder / file).exists()
    calibration = control.Calibration.usual(loaded) if new else control.Calibration.read(folder, loaded, name=file)
    with patiently(f"{kind}: computing expected tensions ..."):
        model = control.WinchPull.of_robot(loaded)

    loads = [pull.at(np.arange(0.0, 0.1, 1e-4)).tolist() for pull in model]

    def tensions(contractions: "Vector") -> "Vector":
        places = [min(max(int(1e4 * taken), 0), 999) for taken in contractions.tolist()]
        return np.array([load[place] for load, place in zip(loads, places, strict=True)])

    emulated = replace(loaded, motor=kit_motor(loaded, folder))
    truth = control.add_cable_layers(calibration.assume_zeros(emulated)) if port == control.EMULATED else calibration
    with one_interrupt(f"{kind}: stopped"):
        bus = control.open_bus(port, emulated, truth, tensions)
        try:
            if restart:
                calibration = _restart(kind, bus, folder / file, calibration)
            found, constants = _take_up(kind, bus, folder / file, calibration, model)
            curves = _measure(bus, folder / file, loaded, chosen, truth if port == control.EMULATED else None)
        finally:
            bus.close()
    _tell(kind, folder / file, loaded, found, model, constants, curves)


def _winch_indices(spools: str, robot: "Robot") -> list[int]:
    """Places of the winches whose spools are measured (InputError: no such winch)."""
    names = [winch.name for winch in robot.winches]
    wanted = names if spools == "all" else [name.strip() for name in spools.split(",") if name.strip()]
    for name in wanted:
        if name not in names:
            raise InputError(f'--spools {spools}: unknown winch "{name}". Available: {", ".join(names)}, or all.')
    return [names.index(name) for name in wanted]


def _restart(kind: str, bus: "Bus", file: Path, calibration: "Calibration") -> "Calibration":
    """Restart motors that are off; return the calibration without their zeros, saved before anything is restarted."""
    from dataclasses import replace

    from hydrostat import control

    motors = [*calibration.motors]

    def forget(places: "Sequence[int]") -> None:
        for place in places:
            motors[place] = replace(motors[place], zero=None)
        control.Calibration(tuple(motors)).write(file.parent, name=file.name)

    names = [motor.winch for motor in motors]
    again = control.restart_motors(bus, names, lambda line: print(f"{kind}: {line}", flush=True), forget)
    print(f"{kind}: restarted: {', '.join(again) or 'none, as no motor was off'}", flush=True)
    return control.Calibration(tuple(motors))


def _take_up(
    kind: str, bus: "Bus", file: Path, calibration: "Calibration", model: "Sequence[WinchPull]"
) -> "tuple[tuple[SlackCalibration, ...], Vector]":
    """Return each winch's slack calibration, saved as soon as it is found, and the constants of the motors."""
    import numpy as np

    from hydrostat import control

    known = {motor.winch: motor for motor in calibration.motors}
    facts = bus.identify()
    models = ", ".join(sorted({fact.model for fact in facts}))
    print(f"{kind}: {plural(len(facts), 'motor')} found ({models}); they turn now, one by one", flush=True)

    def save(taken: "SlackCalibration") -> None:
        before, known[taken.motor.winch] = known[taken.motor.winch], taken.motor
        control.Calibration(tuple(known.values())).write(file.parent, name=file.name)
        words = f"slack {1e3 * taken.slack:z.1f} mm, repeatability {1e3 * taken.apart:.2f} mm"
        if before.zero is not None:
            words += f"; zero moved {1e3 * abs(before.contraction(taken.motor.zero or 0.0)):.1f} mm since the last run"
        print(f"{kind}: {taken.motor.winch}: {words}", flush=True)

    found = control.find_cable_zeros(bus, calibration.motors, model, save)
    bus.mark(np.array([known[motor.winch].zero for motor in calibration.motors]))
    if bus.kind == "firmware" and {motor.counts for motor in calibration.motors} <= set(control.SERVO_STEPS.values()):
        print("Zeros changed. To play moves without a computer, run hydrostat firmware again and upload.")
    return found, np.array([fact.constant for fact in facts])


def _measure(
    bus: "Bus", file: Path, robot: "Robot", chosen: "Sequence[int]", truth: "Calibration | None"
) -> "list[SpoolCurve]":
    """Curves of the chosen spools, each saved as soon as it is known; emulated ones have a truth for the ruler."""
    from hydrostat import control

    if not chosen:
        return []
    calibration, curves = control.Calibration.read(file.parent, robot, name=file.name), list["SpoolCurve"]()
    link = control.BusLink(bus, robot.winches, calibration)
    try:
        link.identify()
        for place in chosen:
            motor, travel = calibration.motors[place], robot.winches[place].travel
            print(f"{bus.kind}: {motor.winch}: mark its bare cable and lay a ruler next to it")

            def read(thought: float, place: int = place, name: str = motor.winch) -> float:
                if truth is None:
                    return _ask_mark(name)
                taken = truth.motors[place].contraction(float(bus.read().angles[place]))
                shown = 5e-4 * round(taken / 5e-4)
                by_motor = f"motor {1e3 * thought:z.1f} mm"
                print(f"{bus.kind}: {name}: {by_motor}, emulated ruler {1e3 * shown:z.1f} mm")
                return shown

            curves.append(control.SpoolCurve.measure(link, motor, place, travel, read))
            motors = [*calibration.motors]
            motors[place] = curves[-1].motor
            calibration = control.Calibration(tuple(motors))
            calibration.write(file.parent, name=file.name)
            print(
                f"{bus.kind}: {motor.winch}: spool radius {1e3 * curves[-1].motor.radius:.2f} mm at zero, "
                f"max correction {1e3 * curves[-1].more:+.1f} mm, fit residual {1e3 * curves[-1].scatter:.2f} mm",
                flush=True,
            )
    finally:
        link.close()
    return curves


def _ask_mark(name: str) -> float:
    """Ask for the position of the mark on the ruler [m] (InputError: there is nobody to ask)."""
    while True:
        try:
            told = input(f"{name}: position of the mark on the ruler [mm]: ")
        except EOFError:
            raise InputError("--spools: needs a terminal to type ruler readings. Run it in one.") from None
        try:
            value = float(told.strip().removesuffix("mm").replace(",", "."))
        except ValueError:
            value = float("nan")
        if abs(value) < 1e4:
            return 1e-3 * value
        print(f"{told.strip()!r} is not a number. Write millimeters, e.g. 12.5")


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
    from hydrostat.plot import write_calibration_page

    notes = []
    soft, hard = 0.5, 2.0  # cables that feel so much softer or stiffer than the model are told
    for taken, pull, constant in zip(found, model, constants.tolist(), strict=True):
        wanted = pull.stiffness(taken.reeled_length)
        felt = wanted * taken.gain * constant / taken.motor.radius
        if felt < soft * wanted or felt > hard * wanted:
            notes.append(
                f"{taken.motor.winch}: measured stiffness {felt:.0f} N/m, expected {wanted:.0f} N/m. "
                "Check that motor, cable and material match robot.toml"
            )
    page = write_calibration_page(
        robot, found, model, constants, notes, file.parent / PAGE, curves, emulated=kind == EMULATED
    )
    for note in notes:
        print(f"{kind}: warning: {note}")
    print(f"{kind}: saved {file}. Measurements: {page}")
