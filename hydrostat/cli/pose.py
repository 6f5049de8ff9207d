"""`hydrostat pose`."""

import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder, result_folder
from hydrostat.cli.learned import learned_start, read_model
from hydrostat.cli.limits import print_exceeded, print_far_targets
from hydrostat.cli.option_errors import naming_option
from hydrostat.cli.options import EqualWinches, MostTension, MostTorque, parse_optional, pose_limits
from hydrostat.cli.pose_targets import (
    Muscles,
    Store,
    Targets,
    check_pose_options,
    given_targets,
    show_muscles,
    store_pose,
)
from hydrostat.cli.waiting import read_robot, show_search
from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.geometry import Outline
    from hydrostat.ik import IKResult, Limits
    from hydrostat.robot import PoseTarget, Robot
    from hydrostat.simulation import Equilibrium, Simulation


def pose(
    robot: RobotFolder,
    out: OutFolder,
    name: Annotated[
        str | None,
        typer.Option("--pose", metavar="NAME", help="Pose to reach.", show_default="all; none with --drawing"),
    ] = None,
    drawing: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Target shape, drawn over the body's own drawing.")
    ] = None,
    goals: Targets = None,
    store: Store = None,
    muscles: Muscles = False,
    tension: MostTension = None,
    torque: MostTorque = None,
    equal: EqualWinches = None,
    restarts: Annotated[
        int | None,
        typer.Option(metavar="N", help="Random restarts if a target is not reached.", show_default="3; 0 within 0.3 %"),
    ] = None,
    timeout: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="Time limit per search. Returns the best pose so far.", show_default="none"),
    ] = None,
    jacobian: Annotated[bool, typer.Option(help="Also write jacobian.npz.")] = False,
    model: Annotated[
        Path | None, typer.Option(metavar="MODEL", help="Warm-start from a model trained by `hydrostat learn`.")
    ] = None,
) -> None:
    """Solve inverse kinematics: find contractions for a pose.

    Writes contractions.json, pose.json, pose.vtu and cables.vtu (for ParaView) and pose.png. Several poses get one
    folder each.
    A pose sets marker targets; --drawing sets a whole target shape. Give both to combine them. --target sets a pose
    that robot.toml does not have yet; --muscles shows it before there are cables. With --model, the command prints the
    error that the model predicts and the simulated error, then starts the search from there.
    A pose counts as reached if the distance of each marker to its target is at most 0.3 % of the body size.

    Example: hydrostat pose gallery:starfish --pose wave --out build/wave
    """
    from hydrostat.ik import IKStatus, load_target_outline, solve_ik
    from hydrostat.simulation import Simulation

    require_folder(out)
    cables = {"--drawing": drawing, "--model": model, "--tension": tension, "--torque": torque, "--restarts": restarts}
    by_cables = cables | {"--timeout": timeout, "--equal": equal, "--jacobian": jacobian or None} if muscles else {}
    check_pose_options(robot, name=name, targets=goals, store=store, by_cables=by_cables)
    loaded = read_robot(robot)
    limits = pose_limits(loaded, tension, torque, equal)
    outline = None if drawing is None else load_target_outline(loaded, drawing)
    asked_for = _search_options(restarts, timeout, outline)
    targets = given_targets(loaded, goals, store) or _asked_targets(loaded, robot, name, drawing)
    if muscles:
        show_muscles(loaded, targets, out)
        store_pose(robot, loaded, store, targets)
        return
    learned, loaded = (None, loaded) if model is None else read_model(model, loaded)
    simulation, stuck = Simulation(loaded), False
    for title, target in targets:
        began = time.process_time()
        start = None if learned is None or target is None else learned_start(simulation, learned, target)
        with show_search(title) as tell:
            reached = solve_ik(simulation, target, start=start, progress=tell, limits=limits, **asked_for)
        seconds = time.process_time() - began
        folder: Path = out / title if len(targets) > 1 else out
        _write(simulation, reached, folder, title, limits, seconds, outline=outline, jacobian=jacobian)
        _print_all(simulation, reached, title, seconds, folder)
        stuck |= reached.status not in (IKStatus.REACHED, IKStatus.LOCAL_OPTIMUM)
    store_pose(robot, loaded, store, targets)
    if stuck:
        raise typer.Exit(1)


def _search_options(restarts: int | None, timeout: str | None, outline: "Outline | None") -> dict[str, Any]:
    """Options, time and outline of a search (InputError: a negative number of restarts, or a wrong time)."""
    from hydrostat.ik import IKOptions, ShapeTarget
    from hydrostat.units import TIME

    if restarts is not None and restarts < 0:
        raise InputError(f"--restarts {restarts}: must be 0 or more")
    return {
        "options": IKOptions() if restarts is None else IKOptions(restarts=restarts, restart_error=0.0),
        "seconds": parse_optional("--timeout", timeout, TIME),
        "objectives": [] if outline is None else [ShapeTarget(outline=outline)],
    }


def _print_all(simulation: "Simulation", reached: "IKResult", title: str, seconds: float, folder: Path) -> None:
    """Print a pose, warnings about it, and where its files are."""
    _print_reached(simulation.robot, reached, title, seconds)
    _note_other_pose(simulation, reached)
    _note_crossings(simulation.robot, reached.pose)
    print_exceeded(reached.pose, "  ")
    for note in reached.pose.notes:
        print(f"  note: {note}")
    print(f"  wrote {folder}")


def _asked_targets(
    loaded: "Robot", folder: Path, name: str | None, drawing: Path | None
) -> "Sequence[tuple[str, PoseTarget | None]]":
    """Poses with their names, as `_targets` has them; print a warning of those that the body cannot reach."""
    targets = _targets(loaded, folder, name, drawing)
    print_far_targets(loaded, [target for _, target in targets if target is not None])
    return targets


def _targets(
    loaded: "Robot", folder: Path, name: str | None, drawing: Path | None
) -> "Sequence[tuple[str, PoseTarget | None]]":
    """Poses with their names; None where only a drawing is given (InputError: there is nothing to reach)."""
    if name:
        with naming_option(f"--pose {name}"):
            return [(name, loaded.pose(name))]
    if drawing is not None:
        return [(drawing.stem, None)]
    if not loaded.poses:
        raise InputError(f"{folder}: no [[pose]] in robot.toml. Add one, or give a target shape with --drawing.")
    return list(loaded.poses.items())


def _write(
    simulation: "Simulation",
    reached: "IKResult",
    folder: Path,
    title: str,
    limits: "Limits",
    seconds: float,
    *,
    outline: "Outline | None",
    jacobian: bool,
) -> None:
    from hydrostat.cli.options import load_matplotlib
    from hydrostat.version import __version__

    load_matplotlib()
    from hydrostat.files import replace_file
    from hydrostat.plot import draw_reached, reached_title, save_png
    from hydrostat.simulation import write_pose

    extra: dict[str, Any] = {
        "seconds": seconds,
        "version": __version__,
        "pose": title,
        "errors": dict(reached.errors),
        "inverse": str(reached.status),
        "optimality": reached.optimality,
        "held": list(reached.active_limits),
        "tension_limit": limits.tension,
        "torque_limit": limits.torque,
        "equal": [list(group) for group in limits.equal],
    }
    taken = _contraction_facts(simulation.robot, reached)
    figure = draw_reached(simulation.robot, reached, title=reached_title(reached, title), outline=outline)
    with result_folder(folder) as made:
        write_pose(simulation, reached.pose, made, extra=extra, jacobian=jacobian)
        replace_file(made / "contractions.json", (json.dumps(taken, indent=2) + "\n").encode())
        save_png(figure, made / "pose.png")


def _print_reached(loaded: "Robot", reached: "IKResult", title: str, seconds: float) -> None:
    """Print what was reached, and what keeps it from more."""
    print(f"{title}: rms error {1e3 * reached.rms_error:.2f} mm; {reached.outcome} ({1e3 * seconds:.0f} ms)")
    if len(reached.errors) > 1:
        markers = ", ".join(f"{name} {1e3 * error:.2f} mm" for name, error in reached.errors.items())
        print(f"  marker errors: {markers}")
    text = ", ".join(f"{winch} {1e3 * value:z.1f} mm" for winch, value in _contraction_facts(loaded, reached).items())
    if text:
        print(f"  contractions: {text}")
    if turned := list(zip(loaded.drives, reached.pose.drives, strict=True)):
        print(f"  drives: {', '.join(f'{drive.name} {drive.format_value(value)}' for drive, value in turned)}")
    if reached.friction_hysteresis:
        band = ", ".join(f"{name} {1e3 * apart:.2f} mm" for name, apart in reached.friction_hysteresis.items())
        print(f"  friction: hysteresis after 10 % overshoot: {band}")
    for words in reached.active_limits:
        print(f"  limit: {words}")
    steep = 1e-3  # an optimality above this is told: there was more to gain
    if reached.active_limits or reached.optimality > steep:
        print(f"  optimality: {reached.optimality:.1g} (0 = optimum within these limits)")


def _note_other_pose(simulation: "Simulation", reached: "IKResult") -> None:
    """Say it if the contractions alone do not decide the pose (E20): at once from rest they may lead to another."""
    from hydrostat.simulation import largest_distance

    pose = simulation.solve(reached.pose.controls, strict=False)
    away = largest_distance(pose.nodes, reached.pose.nodes)
    apart = 1e-3  # poses that differ by more than this share of the body's size are different
    if pose.result.converged and away > apart * simulation.robot.body.mesh.size:
        print(
            f"  warning: in one step from rest, these contractions lead to another pose, up to {1e3 * away:.1f} mm away"
        )
        print("  Apply them in small steps, or run `hydrostat branches`.")


def _note_crossings(loaded: "Robot", pose: "Equilibrium") -> None:
    """Say it if the body passes through itself."""
    from hydrostat.geometry import find_crossings

    if words := str(find_crossings(loaded.body.mesh, pose.nodes)):
        print(f"  warning: {words}")


def _contraction_facts(loaded: "Robot", reached: "IKResult") -> dict[str, float]:
    return {winch.name: float(a) for winch, a in zip(loaded.winches, reached.pose.contractions, strict=True)}
