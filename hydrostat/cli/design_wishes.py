"""What `hydrostat design` was asked for, from its options and its file of constraints."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hydrostat.cli.options import positive
from hydrostat.closed_set import member
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.design import Constraints, DesignRequest, RouteOptions, TreeOptions
    from hydrostat.robot import Robot


@dataclass(frozen=True, kw_only=True)
class TypedLimits:
    """Limits from the command line, as text; None where the file or the default counts."""

    file: Path | None = None
    cables_per_winch: int | None = None
    clearance: str | None = None
    tension: str | None = None
    slack: str | None = None
    stepped: bool = False
    symmetric: str | None = None
    lock_winch: tuple[str, ...] = ()
    lock_cable: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class TypedRequest:
    """What a design is asked on the command line, as text; None where the default counts."""

    poses: tuple[str, ...] = ()
    winches: str | None = None
    cables: int | None = None
    method: str | None = None
    improve: bool = False
    tolerance: str | None = None
    fibres: str | None = None
    limits: TypedLimits = TypedLimits()


def asked_of(robot: "Robot", typed: TypedRequest) -> "DesignRequest":
    """The request that was typed, for a robot (InputError: what cannot be asked, of anyone or of this robot)."""
    from hydrostat.design import DesignMethod, DesignRequest

    winches = _winch_count(typed.winches)
    method = None if typed.method is None else member(DesignMethod, typed.method, what="method")
    given = {"winches": winches, "cables": typed.cables, "method": method}
    given = {name: value for name, value in given.items() if value is not None}
    poses = [robot.pose(name) for name in typed.poses] or list(robot.poses.values())
    trees = method is DesignMethod.TREES
    request = DesignRequest(
        poses=tuple(poses),
        constraints=_constraints(robot, typed.limits),
        options=_options(typed, trees=trees, open_winches=isinstance(winches, str)),
        improve=typed.improve,
        **given,
    )
    request.fitted(robot)  # what does not fit is told before anything begins
    return request


def _winch_count(text: str | None) -> int | str | None:
    """A number of winches, or what else was typed."""
    return int(text) if text is not None and text.isascii() and text.isdigit() and len(text) < 4 else text


def _constraints(robot: "Robot", limits: TypedLimits) -> "Constraints":
    """The constraints of a file, with those of the command line before them."""
    from hydrostat.design import Constraints
    from hydrostat.design.constraints_file import read_constraints

    constraints = Constraints() if limits.file is None else read_constraints(limits.file, robot)
    return replace(constraints, **_given(limits, robot))


def _options(typed: TypedRequest, *, trees: bool, open_winches: bool) -> "RouteOptions | TreeOptions | None":
    """Options of the method; None for its usual ones."""
    from hydrostat.design import FibreKind, RouteOptions, TreeOptions
    from hydrostat.units import LENGTH

    if typed.tolerance is not None and not open_winches:
        raise InputError("--tolerance is for --winches auto, which finds the fewest winches that keep it")
    if typed.fibres is not None:
        kind = member(FibreKind, typed.fibres, what="--fibres")
        if not trees:
            raise InputError("--fibres is for --method trees; routes need no muscle fibres")
        return TreeOptions(fibres=kind)
    if typed.tolerance is not None and not trees:
        return RouteOptions(tolerance=positive("--tolerance", typed.tolerance, LENGTH))
    return None


def _given(limits: TypedLimits, robot: "Robot") -> dict[str, Any]:
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
        given["locked_cables"] = tuple(dict.fromkeys(_cable(name, robot) for name in limits.lock_cable))
    return given


def _winch(name: str, robot: "Robot") -> str:
    try:
        return robot.winch(name).name
    except InputError as error:
        raise InputError(f"--lock-winch {name}: {error}") from None


def _cable(name: str, robot: "Robot") -> str:
    from hydrostat.design.constraints_file import cable_name

    try:
        return cable_name(name, robot)
    except InputError as error:
        raise InputError(f"--lock-cable {name}: {error}") from None
