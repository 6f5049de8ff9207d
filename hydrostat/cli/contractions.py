"""What a winch is told on the command line, and whether it can do so."""

from typing import TYPE_CHECKING

from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.robot import Robot


def contraction(text: str) -> tuple[str, float]:
    """Name and length [m] from "left=12mm".

    Raises:
        InputError: no such text.
    """
    from hydrostat.units import LENGTH, parse_quantity

    name, equals, length = text.partition("=")
    if not equals:
        raise InputError(f'--contract {text}: write WINCH=LENGTH, for example "left=12mm"')
    sign = -1.0 if length.strip().startswith("-") else 1.0
    try:
        return name.strip(), sign * parse_quantity(length.strip().removeprefix("-"), LENGTH)
    except InputError as error:
        raise InputError(f"--contract {text}: {error}") from None


def check_contraction(robot: "Robot", name: str, value: float, *, option: str = "--contract") -> None:
    """Print a note if a winch cannot take in so much [m].

    Raises:
        InputError: there is no such winch, or it would take in all of a cable.
    """
    winch = robot.winch(name)
    if not -winch.release <= value <= winch.travel:
        print(
            f"note: winch {name} can take in from {0.0 - 1e3 * winch.release:g} to {1e3 * winch.travel:g} mm, "
            f"{1e3 * value:g} mm is beyond it"
        )
    for cable, ratio in zip(robot.cables, robot.spool_ratios, strict=True):
        if cable.winch == name and ratio * value >= cable.length:
            step = "" if ratio == 1 else f", by a spool {ratio:.3g} times that of the winch"
            long = f"all of a cable that is {1e3 * cable.length:.3g} mm long"
            raise InputError(f"{option} {name}: {1e3 * value:g} mm is {long}{step}")
