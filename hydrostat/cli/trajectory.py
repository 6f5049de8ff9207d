"""`hydrostat trajectory`."""

import json
import math
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrostat.cli.design_results import choose_motor, read_motors
from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder, result_folder
from hydrostat.cli.option_errors import naming_option
from hydrostat.cli.options import (
    EqualWinches,
    MostTension,
    MostTorque,
    PictureWidth,
    check_width,
    parse_optional,
    pose_limits,
    positive,
)
from hydrostat.cli.waiting import prepare_physics, progress_bar, read_robot
from hydrostat.closed_set import parse_choice
from hydrostat.errors import InputError
from hydrostat.progress import Progress

if TYPE_CHECKING:
    from hydrostat.arrays import Vector
    from hydrostat.control import Calibration
    from hydrostat.ik import Keyframe, Limits, Trajectory
    from hydrostat.robot import Robot
    from hydrostat.simulation import Simulation


USUAL_SPEED = 0.05  # of winches whose motor is unknown or faster [m/s]
REST = "rest"  # name of the pose without contractions, unless the robot has a pose of this name


def trajectory(
    robot: RobotFolder,
    out: OutFolder,
    poses: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,NAME...",
            help="Poses in order. Use rest for the pose without contractions.",
            show_default="all",
        ),
    ] = None,
    path: Annotated[
        str,
        typer.Option(
            metavar="smooth|linear|straight",
            help="Path between poses: smooth or linear contractions, or straight marker paths.",
        ),
    ] = "smooth",
    speed: Annotated[
        str | None,
        typer.Option(
            "--max-speed",
            metavar="SPEED",
            help="Maximum winch speed.",
            show_default="50 mm/s, or the no-load speed of the robot's motor if that is less",
        ),
    ] = None,
    acceleration: Annotated[
        str | None,
        typer.Option(
            "--max-acceleration",
            metavar="ACCELERATION",
            help="Maximum winch acceleration.",
            show_default="200 mm/s^2; no limit if linear",
        ),
    ] = None,
    hold: Annotated[str, typer.Option(metavar="TIME", help="Time to hold each pose.")] = "0s",
    loop: Annotated[bool, typer.Option("--return", help="Return to rest at the end.")] = False,
    tension: MostTension = None,
    torque: MostTorque = None,
    equal: EqualWinches = None,
    width: PictureWidth = 640,
) -> None:
    """Plan a trajectory through poses within winch limits.

    The limits are winch speed and acceleration. Writes trajectory.csv (for simulate --dynamic --play, and for motors),
    trajectory.json, trajectory.png and trajectory.gif. Each pose is solved from the previous one, and the path between
    them is simulated. The report lists snap-throughs, and poses that a search from rest reaches better.

    Example: hydrostat trajectory gallery:starfish --poses wave,star_jump --return --out build/dance
    """
    from hydrostat.ik import IKStatus, PathKind, solve_ik_trajectory
    from hydrostat.units import ACCELERATION, SPEED, TIME

    require_folder(out)
    asked = None if speed is None else positive("--max-speed", speed, SPEED)
    hardest = parse_optional("--max-acceleration", acceleration, ACCELERATION)
    stay = positive("--hold", hold, TIME, zero=True)
    kind = parse_choice(PathKind, path, what="--path")
    check_width(width)
    loaded = read_robot(robot)
    limits = pose_limits(loaded, tension, torque, equal)
    known = read_fitting_motors(loaded, robot)
    key = choose_motor(loaded, robot, known)
    free = free_speeds(loaded, known, key)
    fastest = _usual_speed(free, key) if asked is None else asked
    names = _keyframe_names(loaded, poses)
    simulation = prepare_physics(loaded)
    began = time.process_time()
    with progress_bar() as progress:
        made = solve_ik_trajectory(
            simulation,
            _keyframes(simulation, names),
            speed=fastest,
            acceleration=hardest,
            limits=limits,
            path=kind,
            loop=loop,
            hold=stay,
            progress=progress,
        )
        facts = _facts(simulation, made, limits, time.process_time() - began)
        with result_folder(out) as folder:
            files = _write(simulation, made, facts, folder, width, progress)
    print(*made.lines(), sep="\n")
    if warning := warn_of_speed(loaded, free, key, made.peak_speeds):
        print(warning)
    print("Wrote " + ", ".join(str(out / file.relative_to(folder)) for file in files))
    stuck = (IKStatus.ITERATION_LIMIT, IKStatus.NO_EQUILIBRIUM)
    if any(key.found is not None and key.found.status in stuck for key in made.keyframes):
        raise typer.Exit(1)


def read_fitting_motors(robot: "Robot", folder: Path) -> "Calibration | None":
    """The motors.toml of a robot; None without it, or with a warning if it does not fit the robot."""
    try:
        return read_motors(robot, folder)
    except InputError as error:
        print(f"warning: {str(error).rstrip('.')}. This plan uses the spools of robot.toml")
        return None


def free_speeds(robot: "Robot", known: "Calibration | None", key: str) -> list[float]:
    """No-load speed of each winch by its motor [m/s], on the spools of known motors if given; empty: not known."""
    from hydrostat.fabrication import Motor

    if key == "auto":
        return []
    turns = Motor.choose(key).speed / 60
    radii = [winch.spool_radius for winch in robot.winches] if known is None else [one.radius for one in known.motors]
    return [2 * math.pi * turns * radius for radius in radii]


def _usual_speed(free: list[float], key: str) -> float:
    """The usual speed [m/s], or that of the slowest winch, which is printed."""
    least = min(free, default=math.inf)
    if least >= USUAL_SPEED:
        return USUAL_SPEED
    slower = math.floor(1e3 * least) / 1e3 or least
    words = f"{1e3 * slower:g} mm/s, the no-load speed of the {key}. A loaded motor is slower"
    print(f"note: at most {words}. Override with --max-speed")
    return slower


def warn_of_speed(robot: "Robot", free: list[float], key: str, peaks: "Vector") -> str:
    """Warning of peak speeds [m/s], winches first, that a motor does not reach; empty if it does or is unknown."""
    ratios = [peak / most for peak, most in zip(peaks.tolist(), free, strict=False)]
    if max(ratios, default=0.0) <= 1:
        return ""
    number = ratios.index(max(ratios))
    peak, most, slowest = 1e3 * peaks[number], 1e3 * free[number], math.floor(1e3 * min(free))
    return (
        f"warning: winch {robot.winches[number].name} takes in {peak:.3g} mm/s, its {key} at most {most:.3g} "
        f'mm/s without load. Plan with --max-speed "{slowest} mm/s" or less'
    )


def _keyframe_names(robot: Any, poses: str | None) -> list[str]:
    """Names of the keyframes (InputError: none, or one that the robot does not have)."""
    if poses is None:
        if not robot.poses:
            raise InputError(f"{robot.name}: no [[pose]] in robot.toml. Add one, or give --poses rest.")
        return list(robot.poses)
    names = [name.strip() for name in poses.split(",")]
    if not all(names):
        raise InputError('--poses: no pose named. Write e.g. "wave,rest".')
    for name in names:
        if name != REST:
            with naming_option(f"--poses {poses}"):
                robot.pose(name)
    return names


def _keyframes(simulation: "Simulation", names: list[str]) -> "list[Keyframe]":
    from hydrostat.ik import Keyframe

    known = simulation.robot.poses
    return [Keyframe(target=known.get(name, simulation.rest), name=name) for name in names]


def _write(
    simulation: "Simulation",
    made: "Trajectory",
    facts: dict[str, Any],
    out: Path,
    width: int,
    progress: Progress,
) -> list[Path]:
    from hydrostat.files import replace_file
    from hydrostat.plot import draw_trajectory, save_gif, save_png, trajectory_frames

    robot = simulation.robot
    frames, step = trajectory_frames(made)
    return [
        made.profile().write(out / "trajectory.csv", robot),
        replace_file(out / "trajectory.json", (json.dumps(facts, indent=1) + "\n").encode()),
        save_png(draw_trajectory(robot, made), out / "trajectory.png"),
        save_gif(robot, frames, out / "trajectory.gif", step=step, width=width, progress=progress),
    ]


def _facts(simulation: "Simulation", made: "Trajectory", limits: "Limits", seconds: float) -> dict[str, Any]:
    """Facts of trajectory.json, in SI units: markers and tensions at the samples of trajectory.csv."""
    from hydrostat.robot import robot_hash
    from hydrostat.version import __version__

    return {
        "version": __version__,
        "robot": robot_hash(simulation.robot),
        "path": str(made.path),
        "duration": made.seconds,
        "seconds": seconds,
        "speed_limit": _by_winch(made, made.limits.speed),
        "acceleration_limit": _by_winch(made, made.limits.acceleration),
        "tension_limit": limits.tension,
        "torque_limit": limits.torque,
        "equal": [list(group) for group in limits.equal],
        "report": made.lines(),
        "keyframes": [_key_facts(made, key) for key in made.keyframes],
        "snaps": [{"time": snap.time, "distance": snap.distance} for snap in made.branch_jumps],
        "times": made.times.tolist(),
        "markers": {name: places.tolist() for name, places in made.markers.items()},
        "tensions": made.tensions.tolist(),
    }


def _key_facts(made: "Trajectory", key: Any) -> dict[str, Any]:
    facts = {
        "name": key.name,
        "time": key.time,
        "contractions": _by_winch(made, key.pose.contractions),
        "drives": {
            drive.name: float(value) for drive, value in zip(key.pose.robot.drives, key.pose.drives, strict=True)
        },
        "errors": dict(key.errors),
        "stray": key.path_deviation,
        "rms_error_from_rest": key.free_error,
        "same_pose": key.same,
    }
    if key.found is not None:
        facts |= {
            "status": str(key.found.status),
            "optimality": key.found.optimality,
            "held": list(key.found.active_limits),
        }
    return facts


def _by_winch(made: "Trajectory", values: Any) -> dict[str, float | None]:
    """Numbers by winch, without drives; None where there is no limit."""
    finite = [float(value) if abs(value) < float("inf") else None for value in values]
    return dict(zip(made.winches, finite, strict=False))
