"""Design request of `hydrostat design`, from its options and its constraints file."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, get_type_hints

from hydrostat.cli.options import positive
from hydrostat.closed_set import parse_choice
from hydrostat.errors import HydrostatWarning, InputError

if TYPE_CHECKING:
    from hydrostat.design import BuildTolerances, Constraints, DesignMethod, DesignRequest, RouteOptions, TreeOptions
    from hydrostat.robot import Robot

_Read = TypeVar("_Read")


@dataclass(frozen=True, kw_only=True)
class DesignArguments:
    """Command-line arguments of a design, as text; None where the file or the default counts."""

    poses: Sequence[str] = ()
    winches: str | None = None
    cables: int | None = None
    method: str | None = None
    warm_start: bool = False
    tolerance: str | None = None
    simplicity: float | None = None
    workspace_weight: float | None = None
    ideal: bool = False
    stuffed: bool = False
    time: str | None = None
    fibres: str | None = None
    tree_options: Sequence[str] = ()
    measured: Path | None = None  # file of tolerances that a measurement wrote, if there is one
    file: Path | None = None  # of constraints; what follows comes before it
    limits: Mapping[str, str | int | None] = field(default_factory=dict)  # by the fields of `Constraints`
    motor: str | None = None
    stepped: bool = False
    two_way: bool = False
    front: bool = False
    symmetric: str | None = None
    lock_winch: Sequence[str] = ()
    lock_cable: Sequence[str] = ()


def parse_request(robot: "Robot", typed: DesignArguments) -> "DesignRequest":
    """The request that was typed, for a robot (InputError: what cannot be asked, of anyone or of this robot)."""
    from hydrostat.design import DesignMethod, DesignRequest
    from hydrostat.units import TIME

    winches = _winch_count(typed.winches)
    method = None if typed.method is None else parse_choice(DesignMethod, typed.method, what="method")
    given = {"winches": winches, "cables": typed.cables, "method": method}
    given = {name: value for name, value in given.items() if value is not None}
    poses = [robot.pose(name) for name in typed.poses] or list(robot.poses.values())
    request = DesignRequest(
        poses=tuple(poses),
        constraints=_constraints(robot, typed),
        options=_options(typed, method=method or DesignMethod.ROUTES, open_winches=isinstance(winches, str)),
        warm_start=typed.warm_start,
        stuffed=typed.stuffed,
        front=typed.front,
        seconds=None if typed.time is None else positive("--time", typed.time, TIME),
        uncertainty=_uncertainty(robot, typed),
        **given,
    )
    request.fit_robot(robot)  # raises before anything begins
    return request


def _winch_count(text: str | None) -> int | str | None:
    """A number of winches, or what else was typed."""
    return int(text) if text is not None and text.isascii() and text.isdigit() and len(text) < 4 else text


def _uncertainty(robot: "Robot", typed: DesignArguments) -> "BuildTolerances | None":
    """The tolerances that are asked for; None for the usual ones."""
    from hydrostat.design import BuildTolerances, read_uncertainty

    if typed.ideal:
        return BuildTolerances.none()
    if typed.file is not None:
        return read_uncertainty(typed.file, robot)
    if typed.measured is None or not typed.measured.exists():
        return None
    print(f"note: build tolerances are those of {typed.measured}.")
    return _read_noting(read_uncertainty, typed.measured, robot)


def _read_noting(read: Callable[[Path, "Robot"], _Read], file: Path, robot: "Robot") -> _Read:
    """Record of a file; keys of older files are printed as notes."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", HydrostatWarning)
        try:
            return read(file, robot)
        finally:
            for warning in caught:
                print(f"note: {warning.message}.")


def _constraints(robot: "Robot", typed: DesignArguments) -> "Constraints":
    """The constraints of a file, with those of the command line before them."""
    from hydrostat.design import Constraints, read_constraints
    from hydrostat.fabrication import Motor

    constraints = Constraints() if typed.file is None else _read_noting(read_constraints, typed.file, robot)
    if typed.symmetric not in (None, "x", "y", "z"):
        raise InputError(f"--symmetric {typed.symmetric}: unknown axis. Allowed: x, y, z.")
    if typed.motor not in (None, "auto"):
        Motor.choose(typed.motor)
    given: dict[str, Any] = {
        **{name: _limit(name, value) for name, value in typed.limits.items()},
        "motor": typed.motor,
        "spool_ratio": Constraints.STEPPED if typed.stepped else None,
        "two_way": typed.two_way or None,
        "mirror": typed.symmetric,
        "locked_winches": tuple(dict.fromkeys(_winch(name, robot) for name in typed.lock_winch)) or None,
        "locked_cables": tuple(dict.fromkeys(_cable(name, robot) for name in typed.lock_cable)) or None,
    }
    return replace(constraints, **{name: value for name, value in given.items() if value is not None})


def _limit(name: str, value: str | int | None) -> float | int | None:
    """The value of a number of `Constraints`, typed with its unit if it has one."""
    from hydrostat.design import Constraints
    from hydrostat.units import ANGLE, FORCE, LENGTH, TORQUE

    if not isinstance(value, str):
        return value
    allowed = Constraints.ranges()[name]
    dimension = {"m": LENGTH, "N": FORCE, "N m": TORQUE, "degrees": ANGLE}[allowed.unit]
    return positive(f"--{name.replace('_', '-')}", value, dimension, zero=allowed.holds(0.0))


def _options(
    typed: DesignArguments, *, method: "DesignMethod", open_winches: bool
) -> "RouteOptions | TreeOptions | None":
    """Options of the method; None for its usual ones."""
    from hydrostat.design import DesignMethod, FibreKind, RouteOptions, TreeOptions
    from hydrostat.units import LENGTH

    trees = method.grows_trees

    if typed.tolerance is not None and not open_winches:
        raise InputError("--tolerance: needs --winches auto. Add it.")
    fibres = None if typed.fibres is None else parse_choice(FibreKind, typed.fibres, what="--fibres")
    for name, given in (("fibres", typed.fibres), ("tree-option", typed.tree_options)):
        if given and not trees:
            raise InputError(f"--{name}: needs --method trees or chang2018. Add it.")
    for name, given in (("simplicity", typed.simplicity), ("workspace-weight", typed.workspace_weight)):
        if given is not None and trees:
            raise InputError(f"--{name}: not available with --method {method}. Use --method routes.")
    if trees:
        one = typed.tree_options or method is DesignMethod.CHANG2018
        options = TreeOptions.single(**dict(map(_tree_option, typed.tree_options))) if one else TreeOptions()
        return replace(options, fibres=fibres or options.fibres)
    tolerance = None if typed.tolerance is None else positive("--tolerance", typed.tolerance, LENGTH)
    simplicity = RouteOptions.simplicity if typed.simplicity is None else typed.simplicity
    reach = RouteOptions.workspace_weight if typed.workspace_weight is None else typed.workspace_weight
    return RouteOptions(tolerance=tolerance, simplicity=simplicity, workspace_weight=reach)


def _tree_option(text: str) -> tuple[str, Any]:
    """Return a setting of trees and its value."""
    from hydrostat.design import TreeSettings

    name, _, value = text.partition("=")
    kinds = get_type_hints(TreeSettings)
    kind = kinds.get(name)
    if kind is None:
        *names, last = kinds
        raise InputError(
            f"--tree-option {text}: unknown setting. Write {', '.join(names)} or {last} with a value, e.g. phi=0.5."
        )
    try:
        return name, kind(value)
    except ValueError:
        raise InputError(f"--tree-option {text}: must be {'a whole number' if kind is int else 'a number'}") from None


def _winch(name: str, robot: "Robot") -> str:
    try:
        return robot.winch(name).name
    except InputError as error:
        raise InputError(f"--lock-winch {name}: {error}") from None


def _cable(name: str, robot: "Robot") -> str:
    from hydrostat.design import cable_name

    try:
        return cable_name(name, robot)
    except InputError as error:
        raise InputError(f"--lock-cable {name}: {error}") from None
