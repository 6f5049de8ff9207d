"""Design request of `hydrostat design`, from its options and its constraints file."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_type_hints

import typer

from hydrostat.cli.option_errors import naming_fields, naming_option
from hydrostat.cli.options import Budget, DefaultText, MotorOption, positive
from hydrostat.closed_set import parse_choice
from hydrostat.errors import HydrostatWarning, InputError

if TYPE_CHECKING:
    from hydrostat.design import BuildTolerances, Constraints, DesignMethod, DesignRequest, RouteOptions, TreeOptions
    from hydrostat.robot import PoseTarget, Robot

_Read = TypeVar("_Read")
_LIMITS = ("cables_per_winch", "clearance", "depth", "tension", "slack")  # fields of `Constraints` that are options


def _option(metavar: str | None, words: str, default: str) -> Any:
    """An option with its help, and the field of a record that has its default."""
    return typer.Option(metavar=metavar, help=words, show_default=DefaultText(default))


@dataclass(frozen=True, kw_only=True)
class DesignArguments:
    """Options of a design as they are typed; None where the constraints file or the default counts."""

    winches: Annotated[
        str | None,
        _option(
            "N|auto", "Number of winches, or auto for the fewest that meet the tolerance.", "DesignRequest.winches"
        ),
    ] = None
    cables: Annotated[
        int | None,
        _option(
            "N", "Maximum number of cables in total. A pair, sewn on both faces, counts once.", "DesignRequest.cables"
        ),
    ] = None
    pose: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Pose to design for. Repeatable.", show_default="all")
    ] = None
    method: Annotated[
        str | None,
        _option(
            "routes|trees|chang2018",
            "Search method: routes (adjoint-based), trees (muscle fibers, many settings) or chang2018 (one setting).",
            "DesignRequest.method",
        ),
    ] = None
    constraints: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="Constraints file. Options below override it.")
    ] = None
    cables_per_winch: Annotated[
        int | None, _option("N", "Maximum number of cables per winch.", "Constraints.cables_per_winch")
    ] = None
    clearance: Annotated[
        str | None, _option("LENGTH", "Minimum distance from cable to edge.", "Constraints.clearance")
    ] = None
    depth: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Depth of cables under the skin of a 3D body, with winches outside. 0 mm = on the skin.",
            show_default="anywhere inside",
        ),
    ] = None
    tension: Annotated[str | None, _option("FORCE", "Maximum cable tension.", "Constraints.tension")] = None
    motor: MotorOption = None
    budget: Budget = None
    slack: Annotated[
        str | None,
        _option(
            "LENGTH", "Maximum slack of a cable, so that cables of a winch pull one after another.", "Constraints.slack"
        ),
    ] = None
    stepped_spools: Annotated[
        bool, typer.Option("--stepped-spools", help="Allow cable spools from half to twice the winch spool radius.")
    ] = False
    two_way: Annotated[
        bool, typer.Option("--two-way", help="Let winches pull both ways, with cables wound in opposite directions.")
    ] = False
    front: Annotated[
        bool,
        typer.Option(
            "--front",
            help="Also search with one winch fewer, one more, and pulling both ways. Takes 3 to 6 times as long.",
        ),
    ] = False
    symmetric: Annotated[
        str | None,
        typer.Option(metavar="x|y|z", help="Mirror the network across the plane where this coordinate is 0."),
    ] = None
    lock_winch: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Keep this winch of the robot. Repeatable.")
    ] = None
    lock_cable: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Keep this cable, by name or number from 1. Repeatable.")
    ] = None
    warm_start: Annotated[bool, typer.Option("--warm-start", help="Start from the robot's own cables.")] = False
    tolerance: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Maximum rms error of each pose, with --winches auto.",
            show_default="1 % of the body size",
        ),
    ] = None
    simplicity: Annotated[
        float | None,
        _option(
            None,
            "Weight of simplicity in the score: fewer winches, cables and holes. 0 = ignore; 10 = quick to sew.",
            "RouteOptions.simplicity",
        ),
    ] = None
    workspace_weight: Annotated[
        float | None,
        _option(
            None,
            "Weight of workspace size in the score. 0 = ignore; 1 = twice the workspace may cost twice the error.",
            "RouteOptions.workspace_weight",
        ),
    ] = None
    ideal: Annotated[
        bool,
        typer.Option("--ideal", help="Assume a perfect build: no position error of holes and no cable friction."),
    ] = False
    stuffed: Annotated[
        bool,
        typer.Option("--stuffed", help="Re-rank the best designs on the stuffed 3D body instead of the flat model."),
    ] = False
    time: Annotated[
        str | None,
        typer.Option(
            "--time",
            "--timeout",
            metavar="TIME",
            help="Maximum search time. Keeps the best network so far. The report and the kit take additional time.",
            show_default="none",
        ),
    ] = None
    fibres: Annotated[
        str | None, _option("edges|elements", "Location of muscles for --method trees.", "TreeOptions.fibres")
    ] = None
    tree_option: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="Setting for --method chang2018: threshold, distance, steps or phi (Chang 2018). Repeatable.",
        ),
    ] = None


def parse_request(robot: "Robot", typed: DesignArguments, *, measured: Path | None = None) -> "DesignRequest":
    """The request that was typed, for a robot; `measured` is a file of tolerances that counts if it exists.

    Raises InputError: what cannot be asked, of anyone or of this robot.
    """
    from hydrostat.design import DesignMethod, DesignRequest
    from hydrostat.units import TIME

    winches = _winch_count(typed.winches)
    method = None if typed.method is None else parse_choice(DesignMethod, typed.method, what="--method")
    given = {"winches": winches, "cables": typed.cables, "method": method}
    given = {name: value for name, value in given.items() if value is not None}
    poses = [_pose(name, robot) for name in typed.pose or ()] or list(robot.poses.values())
    with naming_fields(*(each.name for each in fields(typed) if getattr(typed, each.name) is not None)):
        request = DesignRequest(
            poses=tuple(poses),
            constraints=_constraints(robot, typed),
            options=_options(typed, method=method or DesignMethod.ROUTES, open_winches=isinstance(winches, str)),
            warm_start=typed.warm_start,
            stuffed=typed.stuffed,
            front=typed.front,
            seconds=None if typed.time is None else positive("--time", typed.time, TIME),
            uncertainty=_uncertainty(robot, typed, measured),
            **given,
        )
    request.fit_robot(robot)  # raises before anything begins
    return request


def _winch_count(text: str | None) -> int | str | None:
    """A number of winches, or what else was typed."""
    return int(text) if text is not None and text.isascii() and text.isdigit() and len(text) < 4 else text


def _uncertainty(robot: "Robot", typed: DesignArguments, measured: Path | None) -> "BuildTolerances | None":
    """The tolerances that are asked for; None for the usual ones."""
    from hydrostat.design import BuildTolerances, read_uncertainty

    if typed.ideal:
        return BuildTolerances.none()
    if typed.constraints is not None:
        return read_uncertainty(typed.constraints, robot)
    if measured is None or not measured.exists():
        return None
    print(f"note: build tolerances are those of {measured}.")
    return _read_noting(read_uncertainty, measured, robot)


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

    constraints = Constraints()
    if typed.constraints is not None:
        constraints = _read_noting(read_constraints, typed.constraints, robot)
    if typed.symmetric not in (None, "x", "y", "z"):
        raise InputError(f"--symmetric {typed.symmetric}: unknown axis. Allowed: x, y, z.")
    _check_symmetric(robot, typed.symmetric)
    if typed.motor not in (None, "auto"):
        Motor.choose(typed.motor)
    given: dict[str, Any] = {
        **{name: _limit(name, getattr(typed, name)) for name in _LIMITS},
        "motor": typed.motor,
        "spool_ratio": Constraints.STEPPED if typed.stepped_spools else None,
        "two_way": typed.two_way or None,
        "mirror": typed.symmetric,
        "locked_winches": tuple(dict.fromkeys(_winch(name, robot) for name in typed.lock_winch or ())) or None,
        "locked_cables": tuple(dict.fromkeys(_cable(name, robot) for name in typed.lock_cable or ())) or None,
    }
    limits = _limits_of(robot, constraints, typed)
    return replace(constraints, **limits, **{name: value for name, value in given.items() if value is not None})


def _check_symmetric(robot: "Robot", axis: str | None) -> None:
    """Reject an axis that a flat body does not have, or that the body is not centered on (InputError)."""
    from hydrostat.design import Constraints

    if axis is None:
        return
    try:
        Constraints(mirror=axis).check(robot)
    except InputError as error:
        words = str(error).replace(f' ("{axis}")', "").replace("set mirror to None", "remove --symmetric")
        raise InputError(words.replace("constraints: mirror", f"--symmetric {axis}")) from None


def _limits_of(robot: "Robot", constraints: "Constraints", typed: DesignArguments) -> dict[str, float]:
    """Limits of robot.toml where no file, option or other motor states another; printed as a note."""
    usual = type(constraints)()
    own = {
        name: value
        for name, value in (("tension", robot.max_tension), ("torque", robot.max_torque))
        if value is not None and getattr(constraints, name) == getattr(usual, name)
    }
    if typed.motor is not None or typed.tension is not None or not own:
        return {}
    words = [f"tension {own['tension']:g} N"] if "tension" in own else []
    words += [f"torque {1e3 * own['torque']:.4g} N mm"] if "torque" in own else []
    print(f"note: limits of robot.toml: {', '.join(words)}. --tension or --motor replaces them.")
    return own


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
    for name, given in (("fibres", typed.fibres), ("tree-option", typed.tree_option)):
        if given and not trees:
            raise InputError(f"--{name}: needs --method trees or chang2018. Add it.")
    for name, given in (("simplicity", typed.simplicity), ("workspace-weight", typed.workspace_weight)):
        if given is not None and trees:
            raise InputError(f"--{name}: not available with --method {method}. Use --method routes.")
    if trees:
        one = typed.tree_option or method is DesignMethod.CHANG2018
        options = TreeOptions.single(**dict(map(_tree_option, typed.tree_option or ()))) if one else TreeOptions()
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


def _pose(name: str, robot: "Robot") -> "PoseTarget":
    with naming_option(f"--pose {name}"):
        return robot.pose(name)


def _winch(name: str, robot: "Robot") -> str:
    with naming_option(f"--lock-winch {name}"):
        return robot.winch(name).name


def _cable(name: str, robot: "Robot") -> str:
    from hydrostat.design import cable_name

    with naming_option(f"--lock-cable {name}"):
        return cable_name(name, robot)
