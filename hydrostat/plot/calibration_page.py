"""`write_calibration_page`: what calibration has found on each winch, for a browser."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from hydrostat.arrays import Vector
from hydrostat.control import SlackCalibration, SpoolCurve, WinchPull
from hydrostat.drawing import Color, Html, tag
from hydrostat.files import replace_file
from hydrostat.plot.chart import new_chart
from hydrostat.plot.report_tables import NARROW_WIDTH, grid, number, page, picture, table
from hydrostat.robot import Robot
from hydrostat.units import MILLIMETERS


def write_calibration_page(
    robot: Robot,
    found: Sequence[SlackCalibration],
    model: Sequence[WinchPull],
    constants: Vector,
    notes: Sequence[str],
    path: Path,
    curves: Sequence[SpoolCurve] = (),
    *,
    emulated: bool = False,
) -> Path:
    """Write a page: a table of the winches, what each felt beside what the simulation says, notes, and spools.

    Args:
        robot: calibrated robot.
        found: on each winch.
        model: simulated tension of each winch.
        constants: torque of each motor by its current [N m/A]; NaN where it is not known.
        notes: notes for the reader.
        path: path of the page.
        curves: curves of the spools measured with a ruler.
        emulated: True if the motors were emulated.
    """
    rows, pictures = [], []
    for index, (each, wanted, constant) in enumerate(zip(found, model, constants.tolist(), strict=True)):
        stiff = wanted.stiffness(each.reeled_length)
        felt = stiff * each.gain * constant / each.motor.radius
        rows.append(
            (
                each.motor.winch,
                str(each.motor.number),
                number(MILLIMETERS * each.slack, 1),
                number(MILLIMETERS * each.apart, 2),
                f"{felt:.0f}" if np.isfinite(felt) else "not known",
                f"{stiff:.0f}",
                f"{each.seconds:.1f}",
            )
        )
        words = ": each point is a reading; the line is the simulation"
        pictures.append(picture(_draw(each, wanted, constant), f"winch{index}", each.motor.winch, words))
    heads = ("winch", "motor", "taken up [mm]", "apart [mm]", "felt [N/m]", "model [N/m]", "seconds")
    told = [tag("p", note, class_="note") for note in notes] or [tag("p", "Nothing stands out.", class_="note")]
    content = (
        tag("p", "hydrostat \N{MIDDLE DOT} calibration", class_="eyebrow"),
        tag("h1", robot.name),
        *((tag("p", "Emulated motors: nothing here was measured on a robot.", class_="note"),) if emulated else ()),
        tag("p", "Each motor took up the slack of its cables at low current, twice, while the others stood."),
        *told,
        table(heads, rows, numbers=range(1, len(heads))),
        grid(*pictures),
        *(_spools(curves) if curves else ()),
    )
    return replace_file(path, page(f"{robot.name}: calibration", tag("section", *content)).encode())


def _spools(curves: Sequence[SpoolCurve]) -> tuple[Html, ...]:
    """Ruler measurements of spools: a table, and a picture of each."""
    rows, pictures = [], []
    for index, each in enumerate(curves):
        lengths = (each.motor.radius, each.motor.reach(float(each.readings[-1])), each.more, each.scatter)
        rows.append((each.motor.winch, *(number(MILLIMETERS * length, 2) for length in lengths)))
        words = ": cable taken in beside what was thought; points are readings of the ruler, the line is kept"
        pictures.append(picture(_draw_spool(each), f"spool{index}", each.motor.winch, words))
    heads = ("winch", "radius at the zero [mm]", "at the end [mm]", "beside at most [mm]", "scatter [mm]")
    words = (
        "Cable that lies on cable runs on further out. What a mark on each cable did is kept as a curve in motors.toml."
    )
    return tag("h2", "Spools"), tag("p", words), table(heads, rows, numbers=range(1, 5)), grid(*pictures)


def _draw_spool(found: SpoolCurve) -> Figure:
    """Cable beside what was thought before, by turns of the spool."""
    figure, axes = new_chart("turns of the spool", "more than thought [mm]", width=NARROW_WIDTH, height=2.4)
    turns = found.turned / (2 * np.pi)
    axes.plot(turns, MILLIMETERS * (found.readings - found.before), "o", color=Color.WINCHES[0], markersize=4)
    axes.plot(turns, MILLIMETERS * (found.fitted_lengths - found.before), color=Color.MUTED, linewidth=1.2)
    return figure


def _draw(found: SlackCalibration, model: WinchPull, constant: float) -> Figure:
    """Pull by cable taken in; current where the motor's constant is not known."""
    known = np.isfinite(constant)
    figure, axes = new_chart(
        "cable beyond the edge [mm]", "pull [N]" if known else "current [mA]", width=NARROW_WIDTH, height=2.4
    )
    scale = constant / found.motor.radius if known else 1e3
    axes.plot(
        MILLIMETERS * found.places, scale * (found.currents - found.floor), ".", color=Color.WINCHES[0], markersize=4
    )
    if known:
        way = np.linspace(min(0.0, float(found.places.min())), found.reeled_length, 40)
        axes.plot(MILLIMETERS * way, model.at(model.taut + way), color=Color.MUTED, linewidth=1.2)
    return figure
