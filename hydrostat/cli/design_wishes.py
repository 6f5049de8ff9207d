"""What `hydrostat design` was asked for, from its options and its file of constraints."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hydrostat.cli.options import positive
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.design import Constraints, RouteOptions, TreeOptions
    from hydrostat.robot import Robot

AUTO = "auto"
"""As many winches as a tolerance needs."""

MOST_WINCHES = 20

_ROUTES_ONLY = (
    *("winch_zones", "keep_out", "still", "mount", "bend_radius", "longest", "torque", "slack", "spool_ratio"),
    *("mirror", "locked_winches", "locked_cables"),
)
"""Constraints that winch trees do not look at."""


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits from the command line, as text; None where the file or the default counts."""

    cables_per_winch: int | None = None
    clearance: str | None = None
    tension: str | None = None
    slack: str | None = None
    stepped: bool = False
    symmetric: str | None = None
    lock_winch: tuple[str, ...] = ()
    lock_cable: tuple[int, ...] = ()


def winch_count(text: str) -> int | str:
    """A number of winches, or "auto".

    Raises:
        InputError: neither.
    """
    if text == AUTO:
        return AUTO
    if not (text.isascii() and text.isdigit() and len(text) < 4 and 1 <= int(text) <= MOST_WINCHES):
        raise InputError(f"--winches {text}: must be a whole number from 1 to {MOST_WINCHES}, or auto")
    return int(text)


def wanted_constraints(robot: "Robot", file: Path | None, limits: Limits, *, method: str) -> "Constraints":
    """The constraints of a file, with those of the command line before them.

    Raises:
        InputError: a limit that does not fit the robot.
    """
    from hydrostat.design import Constraints
    from hydrostat.design.constraints_file import read_constraints

    constraints = Constraints() if file is None else read_constraints(file, robot)
    constraints = replace(constraints, **_given(limits, robot))
    constraints.check(robot)
    if method == "trees":
        _check_trees(constraints)
    return constraints


def _check_trees(constraints: "Constraints") -> None:
    """Refuse what winch trees do not look at."""
    usual = type(constraints)()
    for name in _ROUTES_ONLY:
        if getattr(constraints, name) != getattr(usual, name):
            raise InputError(f"{name} is kept by --method routes only; leave it out, or the trees")


def wanted_options(
    method: str,
    *,
    winches: int | str,
    improve: bool,
    tolerance: str | None,
    seed: int | None,
    fibres: str | None,
) -> "RouteOptions | TreeOptions":
    """Options of the method.

    Raises:
        InputError: no such method, or options of the other one.
    """
    from hydrostat.design import FibreKind, RouteOptions, TreeOptions
    from hydrostat.design.design_cables import METHODS
    from hydrostat.units import LENGTH

    if method not in METHODS:
        raise InputError(f"--method {method}: must be one of {', '.join(METHODS)}")
    if fibres is not None and fibres not in list(FibreKind):
        raise InputError(f"--fibres {fibres}: must be one of {', '.join(FibreKind)}")
    if tolerance is not None and winches != AUTO:
        raise InputError("--tolerance is for --winches auto, which finds the fewest winches that keep it")
    if method == "trees":
        for option, used in (("--seed", seed is not None), ("--winches auto", winches == AUTO), ("--improve", improve)):
            if used:
                raise InputError(f"{option} is for --method routes; leave it out, or the trees")
        return TreeOptions() if fibres is None else TreeOptions(fibres=FibreKind(fibres))
    if fibres is not None:
        raise InputError("--fibres is for --method trees; routes need no muscle fibres")
    given: dict[str, Any] = {} if seed is None else {"seed": seed}
    if tolerance is not None:
        given["tolerance"] = positive("--tolerance", tolerance, LENGTH)
    return RouteOptions(**given)


def _given(limits: Limits, robot: "Robot") -> dict[str, Any]:
    """Fields of `Constraints` that the command line sets."""
    from hydrostat.units import FORCE, LENGTH

    given: dict[str, Any] = {}
    if limits.cables_per_winch is not None:
        given["cables_per_winch"] = limits.cables_per_winch
    if limits.clearance is not None:
        given["clearance"] = positive("--clearance", limits.clearance, LENGTH)
    if limits.tension is not None:
        given["tension"] = positive("--tension", limits.tension, FORCE)
    if limits.slack is not None:
        given["slack"] = positive("--slack", limits.slack, LENGTH, zero=True)
    if limits.stepped:
        given["spool_ratio"] = 2.0
    if limits.symmetric is not None:
        if limits.symmetric not in ("x", "y", "z"):
            raise InputError(f"--symmetric {limits.symmetric}: must be the axis across the mirror: x, y or z")
        given["mirror"] = limits.symmetric
    if limits.lock_winch:
        given["locked_winches"] = tuple(dict.fromkeys(_winch(name, robot) for name in limits.lock_winch))
    if limits.lock_cable:
        given["locked_cables"] = tuple(dict.fromkeys(_cable(number, robot) for number in limits.lock_cable))
    return given


def _winch(name: str, robot: "Robot") -> str:
    try:
        return robot.winch(name).name
    except InputError as error:
        raise InputError(f"--lock-winch {name}: {error}") from None


def _cable(number: int, robot: "Robot") -> int:
    from hydrostat.design.constraints_file import cable_index

    try:
        return cable_index(number, robot)
    except InputError as error:
        raise InputError(f"--lock-cable {error}") from None
