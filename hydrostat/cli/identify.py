"""`hydrostat identify`."""

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import RobotFolder, folder_of, require_folder
from hydrostat.cli.options import MostTension, parse_optional, positive
from hydrostat.cli.waiting import read_robot, report_progress
from hydrostat.errors import InputError
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.identification import IdentifiedRobot, Measurements
    from hydrostat.robot import Robot


def identify(
    robot: RobotFolder,
    measurements: Annotated[
        Path | None,
        typer.Argument(
            metavar="TABLE.csv",
            help="Columns left_mm per winch, tip_x_mm ... per marker, tip_load_g, tip_to_root_mm, left_force_n.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Output folder (created if missing).")
    ] = None,
    fit: Annotated[
        str | None,
        typer.Option(
            "--fit", metavar="NAMES", help="Parameters to fit, separated by commas.", show_default="all that are common"
        ),
    ] = None,
    in_order: Annotated[
        bool, typer.Option("--in-order", help="The rows are one motion: each pose starts from the previous one.")
    ] = False,
    profile: Annotated[
        bool, typer.Option("--profile", help="Check the intervals by profile likelihood. Takes several times longer.")
    ] = False,
    save_material: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Add the fitted material of the body to your own materials."),
    ] = None,
    suggest: Annotated[int | None, typer.Option(metavar="N", help="Print the N most informative measurements.")] = None,
    hang: Annotated[
        list[str] | None,
        typer.Option(metavar="MASS", help="Mass that you can hang at a marker, for --suggest, e.g. 50g. Repeatable."),
    ] = None,
    tension: MostTension = None,
) -> None:
    """Fit a robot's parameters to measured marker positions.

    Parameters: young, poisson, density, thickness, hysteresis (scale of its moduli), stiffness (of cables), zero and
    gain (of winches), routes (points of cables), friction, pins, gravity, rods, sheets, frame (of the measurement),
    scale (of the board), force (scale of measured forces). Writes the fitted robot, parameters.csv with 95 %
    intervals and identified.png. With ten or more rows, every fifth row is also predicted by a fit that leaves it
    out. `hydrostat design` takes the interval of the fitted material as its uncertainty. correction.json holds a
    correction of the contractions, if it predicts those rows better. Intervals follow from a linearized model;
    --profile corrects them where the model is nonlinear or a value is at its limit. With friction or hysteresis,
    loading and unloading differ: measure both, and add --in-order. With --suggest, the command prints file names of
    photographs to take, most informative first.

    Example: hydrostat identify my_starfish measured.csv --out build/fitted
    """
    from hydrostat.identification import identify as identify_robot
    from hydrostat.identification import read_measurements

    names = None if fit is None else tuple(name.strip() for name in fit.split(",") if name.strip())
    if names == ():
        raise InputError('--fit "": name at least one parameter')
    if suggest is not None:
        given = {"TABLE.csv": measurements, "--out": out, "--save-material": save_material}
        given |= {"--in-order": in_order or None, "--profile": profile or None}
        if extra := [name for name, value in given.items() if value is not None]:
            raise InputError(f"--suggest: plans measurements and writes nothing. Remove {', '.join(extra)}.")
        _suggest(read_robot(robot), suggest, names, hang or [], tension)
        return
    if hang or tension is not None:
        raise InputError("--hang and --tension: need --suggest. Add it.")
    if measurements is None or out is None:
        raise InputError("give TABLE.csv and --out DIR to fit, or --suggest N to plan measurements")
    require_folder(out)
    if save_material is not None:
        _check_material(save_material, names)
    if out.resolve() == folder_of(robot).resolve():
        raise InputError(f"--out {out}: is the folder of the robot. Name another one.")
    loaded = read_robot(robot)
    table = replace(read_measurements(measurements, loaded), in_order=in_order)
    began = time.process_time()
    found = identify_robot(loaded, table, fit=names, profile=profile, progress=report_progress())
    _write(robot, table, found, out)
    _print_values(found)
    _print_errors(found, table, time.process_time() - began)
    usable = _warn(loaded, table, found)
    if save_material is not None:
        rows = plural(len(table.commands), "row")
        _save_material(save_material, found, f"hydrostat identify, {rows} of {measurements.name}")
    step = f"hydrostat check {out}" if usable else "correct the table and fit again. Do not use this robot"
    print(f"Wrote {out}. Next: {step}")


def _suggest(
    robot: "Robot", count: int, names: tuple[str, ...] | None, hang: Sequence[str], tension: str | None
) -> None:
    """Print measurements that tell most about the parameters, named as `hydrostat measure` reads them."""
    from hydrostat.design import Constraints
    from hydrostat.identification import suggest_measurements
    from hydrostat.units import FORCE, MASS

    most = parse_optional("--tension", tension, FORCE) or robot.max_tension or Constraints().tension
    found = suggest_measurements(
        robot,
        count,
        fit=names,
        masses=[positive("--hang", text, MASS) for text in hang],
        tension=most,
    )
    poses = f"{plural(found.candidates, 'pose')} with tensions up to {most:g} N"
    if found.in_order:
        print(f"Take these photographs in this order, chosen from {poses}. Fit them with --in-order.")
    else:
        print(f"Take these photographs, chosen from {poses}. The first show most.")
    for step, (command, masses) in enumerate(zip(found.commands, found.masses, strict=True), start=1):
        parts = [f"{w.name}={1e3 * pull:g}mm" for w, pull in zip(robot.winches, command, strict=True) if pull]
        parts += [f"{marker}={1e3 * mass:g}g" for marker, mass in zip(found.markers, masses, strict=True) if mass]
        print(f"  {f'{step:02d} ' if found.in_order else ''}{','.join(parts) or 'rest'}.jpg")
    hidden = [name for name, share in found.deviations.items() if share > UNIDENTIFIED_RATIO]
    if hidden:
        print(
            f"note: at assumed marker errors of {1e3 * found.noise:.1f} mm (1 % of the body: reading, model), these "
            f"photographs hardly determine {', '.join(hidden)}. Take more."
        )
    if not hang and any(name.endswith(".young") for name in hidden):
        print("note: a hung mass shows a modulus. Add --hang 50g, and gravity to robot.toml.")


UNIDENTIFIED_RATIO = 0.7
"""Uncertainty of a parameter over that of its guess from which on measurements do not show it."""


def _write(path: Path, table: "Measurements", found: "IdentifiedRobot", out: Path) -> None:
    from hydrostat.cli.options import load_matplotlib
    from hydrostat.files import csv_text, read_text, replace_file
    from hydrostat.identification import identified_tolerances
    from hydrostat.robot import merged_text, save_robot

    load_matplotlib()
    from hydrostat.plot import draw_identified, save_png

    figure = draw_identified(table, found)
    text = merged_text(read_text(folder_of(path) / "robot.toml"), found.robot)
    save_robot(found.robot, out, text=text)
    rows = [
        [name, parameter.unit, f"{parameter.start:.6g}", f"{value:.6g}", f"{low:.6g}", f"{high:.6g}", f"{share:.3f}"]
        for parameter, (name, value), (low, high), share in zip(
            found.fitted.model.parameters,
            found.fitted.values.items(),
            found.fitted.intervals.values(),
            found.fitted.information_gains.values(),
            strict=True,
        )
    ]
    head = ["parameter", "unit", "assumed", "fitted", "low_95", "high_95", "shown"]
    replace_file(out / "parameters.csv", csv_text(head, rows))
    save_png(figure, out / "identified.png")
    replace_file(out / "tolerances.toml", identified_tolerances(found))
    if found.correction is None:
        (out / "correction.json").unlink(missing_ok=True)
    else:
        replace_file(out / "correction.json", found.correction.text())


def _check_material(name: str, fit: tuple[str, ...] | None) -> None:
    """Check that a fit can make a material of this name (InputError: it cannot)."""
    from hydrostat.given import check_name
    from hydrostat.robot import MATERIALS, own_materials

    own_materials()  # a wrong file is named before the fit
    try:
        check_name(name)
    except InputError as error:
        raise InputError(f"--save-material: {error}") from None
    if name.lower() in MATERIALS:
        raise InputError(f'--save-material "{name}": is in the table of materials. Name another one.')
    if fit is not None and "young" not in fit:
        raise InputError("--save-material: the fit leaves Young's modulus out. Add young to --fit.")


def _save_material(name: str, found: "IdentifiedRobot", source: str) -> None:
    from hydrostat.robot import own_materials, save_own_material

    material = found.robot.body.material
    if material.young_interval is None:
        print(f'warning: these measurements do not show body.young. "{name}" was not saved.')
        return
    replaced = own_materials().get(name.lower())
    path = save_own_material(replace(material, name=name, source=source))
    low, high = material.young_interval
    print(f"Wrote {path}: {1e-3 * material.young:.3g} kPa (95 %: {1e-3 * low:.3g} to {1e-3 * high:.3g} kPa)")
    if replaced is not None:
        print(f'note: it replaces your earlier "{replaced.name}", {1e-3 * replaced.young:.3g} kPa')
    if high > _WIDE_RATIO * low:
        print("warning: the interval of Young's modulus is wide. Measure with forces or hung masses, then fit again.")
    print(f'Use it: material = "{name}" in robot.toml')


_WIDE_RATIO = 2.0
"""Upper over lower end of an interval that is hardly of use."""


def _print_values(found: "IdentifiedRobot") -> None:
    """Print what the measurements show, then what they do not."""
    fitted = found.fitted
    for parameter in fitted.model.parameters:
        if parameter.name not in found.unknown:
            low, high = fitted.intervals[parameter.name]
            unit = f" {parameter.unit}" if parameter.unit else ""
            value = fitted.values[parameter.name]
            print(
                f"  {parameter.name}: {value:.4g}{unit} (95 %: {low:.4g} to {high:.4g}; assumed {parameter.start:.4g})"
            )
    if found.unknown:
        print(f"note: these measurements do not show {', '.join(found.unknown)}; they stay near what was assumed.")
    if pairs := [f"{one} and {other}" for one, other in fitted.inseparable]:
        print(f"note: these measurements hardly tell apart {', '.join(pairs)}: each can make up for the other.")
    for winch, length in found.pretension.items():
        words = f"{1e3 * length:.2f}"
        if float(words) > 0:
            print(
                f"note: the cables of {winch} are tight at rest, which robot.toml cannot hold. "
                f"Add {words} mm to its contractions."
            )


def _warn(robot: "Robot", table: "Measurements", found: "IdentifiedRobot") -> bool:
    """Print the probable errors in the table; return whether the fit can be used."""
    import numpy as np

    from hydrostat.identification import find_slip, find_swaps, is_mirrored, rms

    swaps = find_swaps(found.fitted, found.assumed, table)
    for swap in swaps:
        rows = ", ".join(str(row + 1) for row in swap.rows[:8]) + (", ..." if len(swap.rows) > 8 else "")
        print(
            f"warning: {' and '.join(swap.markers)} seem to be swapped in {plural(len(swap.rows), 'row')} ({rows}). "
            "Exchange their cells."
        )
    mirrored = not swaps and is_mirrored(found.assumed, table)
    if mirrored:
        print(
            "warning: the positions are mirrored: one axis points the wrong way, as y does in pictures. Change the "
            "sign of its columns, and fit again."
        )
    slip = None if swaps or mirrored else find_slip(found.fitted, table)
    if slip is not None:
        print(
            f"warning: from row {slip.row + 1} on, {slip.winch} acts as if {1e3 * abs(slip.length):.1f} mm of cable "
            f"were {'lost' if slip.length > 0 else 'taken up'}: it slipped. Fit the rows before and after alone."
        )
    for column, winch in enumerate(robot.winches):
        pulls = table.commands[:, column]
        unknown = [key for key in ("zero", "gain") if f"{winch.name}.{key}" in found.fitted.values]
        if unknown and not pulls.any():
            keys = " and ".join(unknown)
            print(f"warning: {winch.name} never contracts in the table. Unknown: {keys}. Add its column.")
        beyond = np.flatnonzero((pulls > winch.travel) | (pulls < -winch.release))
        if len(beyond):
            print(
                f"warning: {winch.name} contracts by {1e3 * pulls[beyond[0]]:.0f} mm in row {beyond[0] + 1}, beyond "
                f"its travel of {1e3 * winch.travel:.0f} mm. Columns are in mm."
            )
    size, error = robot.body.mesh.size, rms(found.after)
    if swaps or mirrored or slip is not None:  # one fault, one line
        return not mirrored and error <= BAD * size
    if error > BAD * size:
        print(
            f"warning: the fit is {100 * error / size:.0f} % of the body off. Check units (mm), the frame's axes, and "
            "which marker and winch is which."
        )
        return False
    far = np.argwhere(found.after > max(OUTLIER * rms(found.after), 0.01 * size)).tolist()
    for row, marker in far[:5]:
        print(
            f"warning: row {row + 1}: {table.markers[marker]} is {1e3 * found.after[row, marker]:.1f} mm off, much "
            "more than others. Measure it again, or empty its cells."
        )
    return True


BAD = 0.05
"""RMS error of a fit, as a share of the body's size, from which on something else than its parameters is wrong."""

OUTLIER = 3.0
"""Distance of a marker, over the RMS of all, from which on its row is named."""


def _print_errors(found: "IdentifiedRobot", table: "Measurements", seconds: float) -> None:
    import numpy as np

    from hydrostat.identification import rms

    seen = plural(len(table.commands), "row")
    has_places = bool(np.isfinite(found.after).any())
    before, after = (found.before, found.after) if has_places else found.length_errors(table)
    error = "rms error" if has_places else "rms error of distances"
    missing = f", {plural(found.fitted.num_failed, 'row')} without equilibrium" if found.fitted.num_failed else ""
    print(
        f"{seen}: {error} {1e3 * rms(before):.2f} mm as assumed, {1e3 * rms(after):.2f} mm fitted "
        f"({seconds:.1f} s{missing})"
    )
    if len(found.held_out) and has_places:
        print(
            f"held out ({plural(len(found.held_out), 'row')}): {1e3 * rms(found.held_out_before):.2f} mm as assumed, "
            f"{1e3 * rms(found.held_out_after):.2f} mm by a fit that did not see them"
        )
    if found.correction is not None:
        print(
            f"correction of contractions: {1e3 * found.correction.before:.2f} mm without, "
            f"{1e3 * found.correction.after:.2f} mm with it, on rows that it did not see (correction.json)"
        )
