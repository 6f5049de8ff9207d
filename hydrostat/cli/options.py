"""Parsing of options given as text: quantities with units, limits, contractions."""

import math
import re
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from string import ascii_letters
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrostat.errors import InputError
from hydrostat.given import list_choices
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.arrays import Vector
    from hydrostat.ik import Limits
    from hydrostat.robot import Robot
    from hydrostat.units import Dimension


def load_matplotlib() -> None:
    """Load matplotlib without writing the texts of its setters, which takes a third of the time.

    Classes describe the keywords of their `set`, and functions those of their artists, for `help()` as they are made;
    no command shows that.
    """
    if "matplotlib.artist" in sys.modules:
        return
    from matplotlib import artist

    name = "_update_set_signature_and_docstring"
    describe, kwdoc = vars(artist.Artist).get(name), artist.kwdoc
    if describe is None:  # another version, which does otherwise
        return
    setattr(artist.Artist, name, classmethod(lambda _: None))
    artist.kwdoc = lambda _: ""
    try:
        with suppress(ImportError):
            import matplotlib.figure  # noqa: F401
    finally:
        setattr(artist.Artist, name, describe)
        artist.kwdoc = kwdoc


Contract = Annotated[
    list[str] | None,
    typer.Option(metavar="WINCH=LENGTH", help="Length of cable to reel in on one winch, e.g. left=12mm. Repeatable."),
]
Moves = Annotated[
    list[str] | None,
    typer.Option(metavar="DRIVE=VALUE", help="Angle or travel of one drive, e.g. leg=30deg or base=5mm. Repeatable."),
]
AddedLoads = Annotated[
    list[str] | None,
    typer.Option(
        "--load",
        metavar="MARKER=FORCE",
        help='Force along each axis at a marker, e.g. "tip=0,0,-1N", or hung mass, e.g. tip=100g. '
        'Moment, in 3D one about each axis: "tip=moment 0.01Nm". Repeatable.',
    ),
]
Pulls = Annotated[
    list[str] | None,
    typer.Option(
        "--pull", metavar="WINCH=FORCE", help="Tension of a winch instead of its contraction, e.g. left=5N. Repeatable."
    ),
]
MostTension = Annotated[
    str | None,
    typer.Option(metavar="FORCE", help="Maximum cable tension, e.g. 20N.", show_default="max_tension of robot.toml"),
]
MostTorque = Annotated[
    str | None,
    typer.Option(
        metavar="TORQUE", help='Maximum winch torque, e.g. "50 N mm".', show_default="max_torque of robot.toml"
    ),
]
EqualWinches = Annotated[
    list[str] | None,
    typer.Option(
        metavar="WINCH,WINCH", help="Couple winches so they share one contraction, e.g. left,right. Repeatable."
    ),
]


class MotorText(str):
    """Text of the default of --motor, with the names of all motors, which are read as help is printed."""

    __slots__ = ()

    def __format__(self, spec: str) -> str:
        """The default and the names."""
        from hydrostat.fabrication import ALL_MOTORS

        return format(f"{self!s}. Motors: {', '.join(motor.key for motor in ALL_MOTORS)}", spec)


class DefaultText(str):
    """Text of an option's default: "Record.field" of `hydrostat.design`, read from there when help is printed.

    Records take a second to import, which commands should not spend before they are called.
    """

    __slots__ = ()

    def __format__(self, spec: str) -> str:
        """The default with its unit."""
        from hydrostat import design

        record, _, field = self.partition(".")
        value = getattr(getattr(design, record), field)
        if not isinstance(value, float):
            return format(str(value), spec)
        allowed = design.Constraints.ranges().get(field) if record == "Constraints" else None
        scale, unit = (allowed or design.Range()).display_unit
        return format(f"{scale * value:g} {unit}".rstrip(), spec)


MotorPort = Annotated[
    str | None,
    typer.Option(
        "--motors",
        metavar="KIND:PORT",
        help="Motor connection, e.g. dynamixel:/dev/ttyUSB0, or emulated.",
        show_default="simulated motors",
    ),
]
MotorOption = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Motor model, or auto: the cheapest that fits, is strong enough and not slow.",
        show_default=MotorText("that of robot.toml, else auto"),
    ),
]
Budget = Annotated[
    str | None,
    typer.Option(
        metavar="AMOUNT",
        help="Maximum price of everything to buy, in whole packs, e.g. 250USD.",
        show_default="no limit",
    ),
]
PictureWidth = Annotated[int, typer.Option(metavar="PIXELS", help="Width of the animation [pixels].")]


def positive(option: str, text: str, dimension: "Dimension", *, zero: bool = False) -> float:
    """Value of an option in SI, above 0, or 0 where allowed (InputError: it is neither, or no such quantity)."""
    from hydrostat.units import parse_quantity

    try:
        value = parse_quantity(text, dimension)
    except InputError as error:
        raise InputError(f"{option} {text}: {error}") from None
    if value < 0 or (value == 0 and not zero):
        raise InputError(f"{option} {text}: must be {'0 or more' if zero else 'above 0'}, e.g. {dimension.example}")
    return value


def parse_optional(option: str, text: str | None, dimension: "Dimension", *, zero: bool = False) -> float | None:
    """Parse an option like `positive`; return None for an option that is not given."""
    return None if text is None else positive(option, text, dimension, zero=zero)


def parse_budget(text: str | None) -> float | None:
    """Amount of --budget, such as 120USD [USD]; None if not given (InputError: another currency, no amount)."""
    if text is None:
        return None
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*(?:USD|usd|\$)\s*", text)
    if match is None or not float(match[1]) > 0:
        raise InputError(f"--budget {text}: not an amount. Prices are in USD: write one above 0, e.g. 120USD.")
    return float(match[1])


def middle(text: str, dim: int) -> "Vector":
    """Parse the position of an object's center from --at [m] (InputError: not one number in mm for each axis)."""
    import numpy as np

    try:
        place = 1e-3 * np.array([float(part) for part in text.split(",")])
    except ValueError:
        raise InputError(f"--at {text}: not a position. Write the object center in mm, e.g. 0,0,90.") from None
    if len(place) != dim:
        got = plural(len(place), "coordinate")
        raise InputError(f"--at {text}: {got} for a body with {dim} axes. Give one per axis.")
    return place


def pose_limits(robot: "Robot", tension: str | None, torque: str | None, equal: Sequence[str] | None) -> "Limits":
    """Limits from --tension and --torque, else the robot's, and --equal (InputError: no such unit, a group of one)."""
    from hydrostat.ik import Limits
    from hydrostat.units import FORCE, TORQUE

    groups = [[name.strip() for name in text.split(",") if name.strip()] for text in equal or []]
    for text, names in zip(equal or [], groups, strict=True):
        if len(names) < 2:
            raise InputError(f'--equal {text}: too few winches. Name at least two, e.g. "left,right".')
    return Limits(
        tension=parse_optional("--tension", tension, FORCE) or robot.max_tension,
        torque=parse_optional("--torque", torque, TORQUE) or robot.max_torque,
        equal=groups,
    )


def check_width(width: int) -> None:
    """Refuse pictures of an animation that are too narrow or too wide (InputError: they are)."""
    from hydrostat.plot import WIDTHS

    if not WIDTHS[0] <= width <= WIDTHS[1]:
        raise InputError(f"--width {width}: must be {WIDTHS[0]} to {WIDTHS[1]}")


def contractions(robot: "Robot", texts: Sequence[str] | None) -> dict[str, float]:
    """Contractions [m] by winch, from texts such as "left=12mm"; notes are printed of what a winch cannot take in.

    A text or winch that is none, or a winch that would take in all of a cable, is an InputError.
    """
    given = _unique("--contract", (_contraction(text) for text in texts or []))
    for name, value in given.items():
        check_contraction(robot, name, value)
    return given


def _unique(option: str, pairs: Iterable[tuple[str, float]]) -> dict[str, float]:
    """Values by name (InputError: a name that is given twice)."""
    found: dict[str, float] = {}
    for name, value in pairs:
        if name in found:
            raise InputError(f'{option}: "{name}" is given twice. Give each name once.')
        found[name] = value
    return found


def _contraction(text: str) -> tuple[str, float]:
    """Name and length [m] from "left=12mm"."""
    from hydrostat.units import LENGTH, parse_quantity

    name, length = split_value("--contract", text, "WINCH=LENGTH, e.g. left=12mm")
    sign = -1.0 if length.startswith("-") else 1.0
    try:
        return name, sign * parse_quantity(length.removeprefix("-"), LENGTH)
    except InputError as error:
        raise InputError(f"--contract {text}: {error}") from None


def moves(robot: "Robot", texts: Sequence[str] | None) -> dict[str, float]:
    """Angles [rad], travels [m] and shares of loads by drive, from texts such as "leg=30deg".

    Raises InputError: a text or drive that is none. A warning is printed for a drive beyond its limits.
    """
    from hydrostat.robot import PinDrive

    drives = {drive.name: drive for drive in robot.drives}
    found = {}
    for text in texts or []:
        name, value = split_value("--move", text, "DRIVE=VALUE, e.g. leg=30deg")
        if name not in drives:
            raise InputError(f'--move {text}: unknown drive "{name}". {list_choices("drives", list(drives), name)}')
        if name in found:
            raise InputError(f'--move: "{name}" is given twice. Give each name once.')
        try:
            found[name] = drives[name].parse(value)
        except InputError as error:
            raise InputError(f"--move {text}: {error}") from None
        if drives[name].turns and abs(found[name]) > 2 * math.pi:
            shown = drives[name].format_value(found[name])
            raise InputError(f"--move {text}: {shown} is more than a turn. Allowed: -360 to 360 deg.")
        for line in PinDrive.check_values([drives[name]], [found[name]]):
            print(f"warning: {line}")
    return found


def loads(robot: "Robot", texts: Sequence[str] | None) -> "Robot":
    """Robot with more loads at its markers, from texts such as "tip=0,0,-1N", "tip=100g" or "tip=moment 0.01Nm".

    Raises InputError: no marker, force, mass or moment.
    """
    from hydrostat.robot import Load

    for number, text in enumerate(texts or [], start=1):
        right = f"{','.join('0' * (robot.body.mesh.dim - 1))},-1N"
        marker, value = split_value("--load", text, f"MARKER=FORCE or MARKER=MASS, e.g. tip={right} or tip=100g")
        form = f"Write one force for each axis, e.g. {marker}={right}, or a mass, e.g. {marker}=100g"
        numbers = [each.strip() for each in value.split(",")]
        try:
            robot.marker(marker)
            given = _given_load(numbers, robot.body.mesh.dim, marker, form)
            load = Load(name=f"given load {number}", marker=marker, **given)
            robot = replace(robot, loads=(*robot.loads, load))
        except InputError as error:
            raise InputError(f"--load {text}: {str(error).removeprefix(f'load[{len(robot.loads)}].')}") from None
    return robot


def _given_load(numbers: Sequence[str], dim: int, marker: str, form: str) -> dict[str, Any]:
    """Force, mass or moment of a load, by its name in `Load`."""
    from hydrostat.units import FORCE, TORQUE

    if numbers[0].split()[:1] == [_MOMENT]:
        axes = 1 if dim == 2 else 3
        example = f'Write "{marker}={_MOMENT} {",".join("0" * (axes - 1))}{"," * (axes > 1)}0.01Nm"'
        values = [numbers[0].removeprefix(_MOMENT).strip(), *numbers[1:]]
        return {"moment": axis_values(values, axes, TORQUE, f"a moment with {plural(axes, 'component')}. {example}")}
    if len(numbers) == 1:
        return {"mass": _hung_mass(numbers[0], form)}
    return {"force": axis_values(numbers, dim, FORCE, f"a body with {dim} axes. {form}")}


_MOMENT = "moment"


def axis_values(numbers: Sequence[str], count: int, kind: "Dimension", form: str) -> tuple[float, ...]:
    """Quantity along each axis; the unit of the last number counts for those without one."""
    from hydrostat.units import parse_quantity

    form = form.partition(". ")[2] if len(numbers) == count else form
    if len(numbers) != count:
        raise InputError(f"{plural(len(numbers), 'value')} for {form}.")
    unit = numbers[-1][len(numbers[-1].rstrip(ascii_letters)) :]
    if not unit:
        raise InputError(f"missing unit. {form}.")
    bare = [each if each[-1:].isalpha() else f"{each} {unit}" for each in numbers]
    try:
        return tuple(parse_quantity(each, kind) for each in bare)
    except InputError as error:
        raise InputError(f"{str(error).partition(';')[0]}. {form}.") from None


def _hung_mass(value: str, form: str) -> float:
    """Mass [kg] (InputError: a single force, or no mass)."""
    from hydrostat.units import FORCE, MASS, parse_quantity

    try:
        mass = parse_quantity(value, MASS)
    except InputError as error:
        try:
            parse_quantity(value, FORCE)
        except InputError:
            raise InputError(f"{str(error).partition(';')[0]}. {form}.") from None
        raise InputError(f"a single force has no direction. {form}.") from None
    if mass <= 0:
        raise InputError(f"a mass must be above 0. {form}.")
    return mass


def pulls(robot: "Robot", texts: Sequence[str] | None) -> dict[str, float]:
    """Pulls [N] by winch, from texts such as "left=5N" (InputError: a text or winch that is none)."""
    from hydrostat.units import FORCE, parse_quantity

    def read(text: str) -> tuple[str, float]:
        name, force = split_value("--pull", text, "WINCH=FORCE, e.g. left=5N")
        try:
            robot.winch(name)
            value = parse_quantity(force, FORCE)
        except InputError as error:
            raise InputError(f"--pull {text}: {error}") from None
        if value < 0:
            raise InputError(f"--pull {text}: a cable only pulls. Write 0 N or more.")
        return name, value

    return _unique("--pull", map(read, texts or []))


def split_value(option: str, text: str, form: str) -> tuple[str, str]:
    """Name and value of "NAME=VALUE" (InputError: no "=")."""
    name, equals, value = (part.strip() for part in text.partition("="))
    if not equals:
        raise InputError(f'{option} {text}: missing "=". Write {form}.')
    if "," in value and "=" in value:
        raise InputError(f"{option} {text}: more than one value. Repeat {option} for each.")
    return name, value


def check_contraction(robot: "Robot", name: str, value: float, *, option: str = "--contract") -> None:
    """Print a note if a contraction [m] exceeds a winch's travel (InputError: unknown winch, or a cable's length)."""
    winches = [each.name for each in robot.winches]
    if name not in winches and name in {each.name for each in robot.markers}:
        raise InputError(f'{option} {name}: "{name}" is a marker. {list_choices("winches", winches)}')
    if name not in winches and name in {each.name for each in robot.drives}:
        raise InputError(f'{option} {name}: "{name}" is a drive. Move it by --move. {list_choices("winches", winches)}')
    try:
        winch = robot.winch(name)
    except InputError as error:
        raise InputError(f"{option} {name}: {error}") from None
    for cable, ratio in zip(robot.cables, robot.spool_ratios, strict=True):
        if cable.winch == name and ratio * value >= cable.length:
            spool = "" if ratio == 1 else f" at spool ratio {ratio:.3g}"
            raise InputError(
                f"{option} {name}: {1e3 * value:g} mm{spool} takes in the whole cable ({1e3 * cable.length:.3g} mm). "
                f"Winch travel is {1e3 * winch.travel:g} mm."
            )
    if not -winch.release <= value <= winch.travel:
        print(
            f"warning: winch {name}: contraction {1e3 * value:g} mm is outside its range "
            f"({0.0 - 1e3 * winch.release:g} to {1e3 * winch.travel:g} mm)"
        )
