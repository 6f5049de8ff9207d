"""Output files and printed results of `hydrostat design`."""

import json
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from hydrostat.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from hydrostat.control import Calibration
    from hydrostat.design import Alternative, BuildCost, Constraints, Network
    from hydrostat.fabrication import Kit, KitOptions
    from hydrostat.ik import IKResult
    from hydrostat.robot import Robot

_Value = TypeVar("_Value", float, str)
_Taken = TypeVar("_Taken")
STALE = r"alternatives/\d+_\d+_winches_\d+_cables"  # folders of alternatives of an earlier design


def write_results(network: "Network", folder: Path) -> None:
    """The robot, score.json, report.html and the alternatives."""
    from hydrostat.design import score_card
    from hydrostat.files import replace_file
    from hydrostat.plot import write_report
    from hydrostat.robot import save_robot
    from hydrostat.version import __version__

    save_robot(network.robot, folder / "robot")
    for number, other in enumerate(network.alternatives, start=1):
        save_robot(other.robot, alternative_folder(folder, number, other.robot))
    card = score_card(network, version=__version__)
    replace_file(folder / "score.json", (json.dumps(card, indent=2) + "\n").encode())
    write_report(network, folder / "report.html", facts=_facts(network))


def alternative_folder(out: Path, number: int, robot: "Robot") -> Path:
    """Folder of an alternative by its number, from 1."""
    return out / "alternatives" / f"{number:02d}_{len(robot.winches)}_winches_{len(robot.cables)}_cables"


def write_kit(network: "Network", folder: Path, *, budget: float | None) -> "Kit":
    """The fabrication kit, with problems listed. Its poses keep to the design's tension."""
    from hydrostat.camera import tag_files
    from hydrostat.fabrication import build_kit

    robot, options = network.robot, kit_options(network, budget)
    kit = build_kit(robot, options=options, added=tag_files(robot, options.paper))
    kit.write(folder)
    return kit


def kit_options(network: "Network", budget: float | None) -> "KitOptions":
    """Options of the kit of a design, which `fabricate` follows too; problems are listed."""
    from hydrostat.fabrication import KitOptions

    limits = network.constraints
    return KitOptions(force=True, tension=limits.tension_limit, torque=limits.torque, budget=budget)


def find_over_budget(network: "Network", budget: float | None) -> tuple[str, ...]:
    """The problem of `fabricate` if the kit of a network costs more than a budget [USD]; empty if not."""
    from hydrostat.fabrication import OVER_BUDGET, summarize_kit

    if budget is None:
        return ()
    rows = dict(summarize_kit(network.robot, options=kit_options(network, budget)))
    return tuple(problem for problem in rows.get("Problems", ()) if OVER_BUDGET in problem)


def find_refused_better(network: "Network") -> "tuple[Alternative, str] | None":
    """The alternative of the least error if its kit would be refused, with the first reason; None if none is better."""
    from hydrostat.design import kit_fits
    from hydrostat.fabrication import Demand, find_refusals

    better = [one for one in network.alternatives if one.expected_error < _BETTER_RATIO * network.expected_error]
    best = min((one for one in better if not kit_fits(one)), key=lambda one: one.expected_error, default=None)
    return best and (best, find_refusals(best.robot, Demand.of_results(best.robot, best.ik_results))[0])


_BETTER_RATIO = 0.9  # a network below this share of the error of the chosen one is clearly better


def designed_tension(robot: "Robot", folder: Path) -> float | None:
    """The tension that a design kept [N]: that of studio.json, else of the robot; of older designs from score.json.

    None for a robot of which none is. Raises InputError: studio.json is there, and cannot be read.
    """
    if robot.max_tension is not None:
        return _wished_tension(robot, folder) or robot.max_tension
    limit = _design_value(robot, folder, "tension_limit", float)
    return _wished_tension(robot, folder) if limit is None else limit


def designed_torque(robot: "Robot", folder: Path) -> float | None:
    """The torque that a design kept [N m]: that of the robot, of older designs from the score.json next to it."""
    return robot.max_torque or _design_value(robot, folder, "torque_limit", float)


def designed_motor(robot: "Robot", folder: Path) -> str:
    """Key of the motor that a robot without one was designed for, from the score.json next to its folder; or "auto"."""
    return _design_value(robot, folder, "motor", str) or "auto" if robot.motor == "auto" else "auto"


def kit_motor(robot: "Robot", folder: Path) -> str:
    """Key of the motor on a robot: that of robot.toml, of motors.toml, or of the kit of its design; or "auto"."""
    return robot.motor if robot.motor != "auto" else choose_motor(robot, folder, read_motors(robot, folder))


def choose_motor(robot: "Robot", folder: Path, known: "Calibration | None") -> str:
    """Key of the motor of a robot by robot.toml, by known motors, or by the kit of its design; or "auto"."""

    def take(card: "Any", network: "Any") -> str:
        return str(network["craft"]["motor"] if card["motor"] == "auto" else card["motor"])

    if robot.motor != "auto":
        return robot.motor
    return (known and known.model) or _of_design(robot, folder, take) or "auto"


def read_motors(robot: "Robot", folder: Path) -> "Calibration | None":
    """The motors.toml of a robot; None without it, or if the robot has drives."""
    from hydrostat.cli.folders import folder_of
    from hydrostat.control import CALIBRATION, Calibration

    if robot.drives or not (folder_of(folder) / CALIBRATION).exists():
        return None
    return Calibration.read(folder_of(folder), robot)


def designed_cost(robot: "Robot", folder: Path) -> "BuildCost | None":
    """The cost to build that a design computed for a robot, with the motors of its poses; None without a design."""
    from hydrostat.design import BuildCost

    return _of_design(robot, folder, lambda _, network: BuildCost.from_values(network["craft"]))


def _design_value(robot: "Robot", folder: Path, name: str, kind: "type[_Value]") -> "_Value | None":
    """A value of the design that made a robot; None where there is no such design or no such value."""
    return _of_design(robot, folder, lambda card, _: None if card[name] is None else kind(card[name]))


def _of_design(robot: "Robot", folder: Path, take: "Callable[[Any, Any], _Taken]") -> "_Taken | None":
    """Value taken from score.json and the network next to a robot; None where they are missing or wrong."""
    from hydrostat.robot import robot_hash

    own = robot_hash(robot)
    for place in (folder.resolve().parent, folder.resolve().parent.parent):
        with suppress(OSError, ValueError, KeyError, TypeError):
            card = json.loads((place / "score.json").read_text(encoding="utf-8"))
            for network in (card, *card["alternatives"]):
                if network["robot"] == own:
                    return take(card, network)
    return None


def _wished_tension(robot: "Robot", folder: Path) -> float | None:
    """Tension limit of the project file [N]; None where there is no such file (InputError: it cannot be read)."""
    from hydrostat.project import PROJECT_FILE, read_project_file

    home = folder.parent if folder.suffix == ".toml" else folder
    if not (home / PROJECT_FILE).is_file():
        return None

    try:
        return read_project_file(home)[1].to_constraints(robot).tension_limit
    except InputError as error:
        raise InputError(f"{error}. Fix the file, or set the limit with --tension") from None


def print_poses(network: "Network", seconds: float) -> tuple[str, ...]:
    """Print a table of the poses, and a line on all of them; return the errors and warnings that were printed."""
    from rich.console import Console
    from rich.table import Table

    from hydrostat.design import corrected_error
    from hydrostat.geometry import find_crossings
    from hydrostat.ik import unconstrained_motion
    from hydrostat.robot import describe_cable_side
    from hydrostat.units import plural

    robot = network.robot
    size = f"{plural(len(robot.winches), 'winch')}, {count_cables(robot)}"
    table = Table(title=f"{robot.name}: {size}", title_justify="left")
    for name, justify in (("pose", "left"), ("rms error", "right"), ("worst marker", "left"), ("contractions", "left")):
        table.add_column(name, justify=justify)  # type: ignore[arg-type]
    for reached in network.ik_results:
        table.add_row(*_pose_row(robot, reached))
    Console(markup=False).print(table)
    for reached in network.ik_results:
        if words := str(find_crossings(robot.body.mesh, reached.pose.nodes)):
            print(f"{reached.pose_target.name}: {words}")
        if words := reached.pose.squeezed_corners:
            print(f"warning: {reached.pose_target.name}: {words}")
        if words := unconstrained_motion(reached):
            print(f"{reached.pose_target.name}: {words}")
    corrected = corrected_error(network)
    after = (
        f", {1e3 * corrected:.2f} mm after one correction by measured markers"
        if corrected < network.expected_error
        else ""
    )
    print(
        f"model error {1e3 * network.rms_error:.2f} mm rms (at rest {1e3 * network.rest_error:.2f} mm), "
        f"expected as-built error {1e3 * network.expected_error:.2f} mm{after} "
        f"({plural(network.num_evaluated, 'candidate')}, {seconds:.1f} s)"
    )
    print(f"build: {network.cost}")
    if words := describe_cable_side(robot):
        print(f"cables: {words}")
    _print_stuffed(network)
    return _print_findings(network)


def count_cables(robot: "Robot") -> str:
    """Return the number of cables in words; of those in pairs also how many are sewn."""
    from hydrostat.fabrication import KitOptions, Method
    from hydrostat.robot import sewn_robot
    from hydrostat.units import plural

    count, sewn = len(robot.cables), len(sewn_robot(robot).cables)
    if sewn == count or KitOptions().method_for(robot.body) is not Method.PLUSH:
        return plural(count, "cable")
    return f"{plural(count, 'pair')} of cables, {sewn} to sew"


def _print_findings(network: "Network") -> tuple[str, ...]:
    """Print errors that would prevent a kit, and warnings, for the loads that the design found; return them.

    Few elements across a limb are a note where they move the markers less than the build tolerances do.
    """
    from hydrostat.design import review_robot
    from hydrostat.errors import in_words
    from hydrostat.fabrication import Demand
    from hydrostat.robot import FEW_ELEMENTS

    found = review_robot(network.robot, demand=Demand.of_results(network.robot, network.ik_results))
    for finding in found:
        moved = network.element_error if FEW_ELEMENTS in finding.text else float("inf")
        words = "" if moved == float("inf") else f"quadratic elements move the markers by {1e3 * moved:.2g} mm rms"
        if moved < network.expected_error:
            print(f"note: few elements across a limb: {words}")
        else:
            print(f"{finding.severity.word}: {in_words(finding.text)}{words and f': {words}'}")
    return tuple(finding.text for finding in found)


def _print_stuffed(network: "Network") -> None:
    """Print the errors on the stuffed 3D body, if these were requested."""
    from hydrostat.units import plural

    filled = network.stuffed
    if filled is None:
        if network.request.stuffed:
            print("stuffed 3D body: no equilibrium found for a pose")
        else:
            _print_uncounted(network)
        return
    print(
        f"stuffed 3D body: {1e3 * filled.rms_error:.2f} mm rms with its own contractions "
        f"({1e3 * filled.played:.2f} mm with those above), markers up to {1e3 * filled.out:.1f} mm out of plane "
        f"(best of {plural(filled.finalists, 'network')})"
    )
    for reached in filled.reached:
        taken = zip(network.robot.winches, reached.pose.contractions, strict=True)
        own = ", ".join(f"{winch.name} {1e3 * value:z.1f} mm" for winch, value in taken)
        print(f"  {reached.pose_target.name}: {1e3 * reached.rms_error:.2f} mm, {own}")


def _print_uncounted(network: "Network") -> None:
    """Print the motion of the stuffed 3D body by the same contractions, if it is larger than the as-built error."""
    from hydrostat.design import describe_uncounted_motion
    from hydrostat.errors import HydrostatError

    try:
        if words := describe_uncounted_motion(network):
            print(f"stuffed 3D body: {words}")
    except HydrostatError as error:
        print(f"stuffed 3D body: not computed ({error})")


def print_front(network: "Network") -> None:
    """Tables of the error: for each number of winches with its effort; where the search chose it, of cables too."""
    from rich.console import Console
    from rich.table import Table

    from hydrostat.design import BuildCost, on_front, size_of, winch_front

    console, rows = Console(), winch_front(network)
    if len(rows) > 1:
        motors = Table(title="best network for each number of winches", title_justify="left")
        work = BuildCost.cable_work(network.robot)
        for name in ("winches", "cables", "as-built error", "motors", work, "price"):
            motors.add_column(name, justify="right")
        motors.add_column("")
        for row in rows:
            cost, error = row.cost, f"{1e3 * row.expected_error:.2f} mm"
            values = (f"{cost.motors} × {cost.motor}", f"{cost.minutes:.0f} min", f"{cost.price:.0f} USD", row.note)
            motors.add_row(row.title, str(row.cables), error, *values)
        console.print(motors)
    if not network.request.is_open:
        return
    errors = network.best_errors(network.alternatives)
    table = Table(title="expected as-built error by number of winches and cables", title_justify="left")
    for name in ("winches", "cables", "rms error"):
        table.add_column(name, justify="right")
    table.add_column("")
    for size, error in errors.items():
        note = "chosen" if size == size_of(network) else "" if on_front(size, errors) else "no better than fewer"
        table.add_row(str(size[0]), str(size[1]), f"{1e3 * error:.2f} mm", note)
    console.print(table)


def _pose_row(robot: "Robot", reached: "IKResult") -> tuple[str, ...]:
    worst = max(reached.errors, key=lambda name: reached.errors[name])
    taken = zip(robot.winches, reached.pose.contractions, strict=True)
    return (
        reached.pose_target.name,
        f"{1e3 * reached.rms_error:.2f} mm",
        f"{worst} {1e3 * reached.errors[worst]:.1f} mm",
        ", ".join(f"{winch.name} {1e3 * value:z.1f} mm" for winch, value in taken),
    )


def _facts(network: "Network") -> dict[str, object]:
    """Options and constraints as a person reads them."""
    options = network.request.as_values()["options"]
    told = {name: ", ".join(map(str, value)) if isinstance(value, tuple) else value for name, value in options.items()}
    given = {name.replace("_", " "): value for name, value in told.items() if value is not None}
    return {**given, **_constraint_texts(network.constraints)}


def _constraint_texts(constraints: "Constraints") -> dict[str, str]:
    """Constraints as a person reads them; those that ask nothing are left out."""
    words = {
        field.name.replace("_", " "): _words(field.name, getattr(constraints, field.name))
        for field in fields(constraints)
    }
    return {name: told for name, told in words.items() if told}


def _words(name: str, value: Any) -> str:
    """The value of one constraint with its unit; nothing if it asks nothing."""
    from hydrostat.design import Constraints

    if isinstance(value, bool):
        return "allowed" if value else "not allowed"
    if isinstance(value, tuple):
        return ", ".join(value) if name.startswith("locked") else str(len(value) or "")
    if isinstance(value, float):
        factor, unit = Constraints.ranges()[name].display_unit
        return f"{factor * value:g}{'°' if unit == 'degrees' else f' {unit}'.rstrip()}"
    return "" if value is None else str(value)
