"""`hydrostat simulate`."""

import sys
import time
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrostat.cli.folders import OutFolder, RobotFolder, require_folder, result_folder
from hydrostat.cli.limits import print_exceeded, print_overloads
from hydrostat.cli.options import (
    AddedLoads,
    Contract,
    Moves,
    Pulls,
    check_contraction,
    contractions,
    loads,
    moves,
    parse_optional,
    positive,
    pulls,
)
from hydrostat.cli.profiling import print_profile
from hydrostat.cli.waiting import prepare_physics, progress_bar, read_robot
from hydrostat.errors import InputError
from hydrostat.progress import Progress
from hydrostat.units import plural

if TYPE_CHECKING:
    from hydrostat.robot import Robot
    from hydrostat.simulation import ContractionProfile, Equilibrium, Motion, SensorReader, Simulation


_TIME_STEP, _RAMP = "5ms", "0.5s"


def simulate(
    robot: RobotFolder,
    out: OutFolder,
    contract: Contract = None,
    pull: Pulls = None,
    load: AddedLoads = None,
    move: Moves = None,
    jacobian: Annotated[bool, typer.Option(help="Also write jacobian.npz.")] = False,
    dynamic: Annotated[
        bool,
        typer.Option("--dynamic", help="Run a dynamic simulation from rest instead of solving for static equilibrium."),
    ] = False,
    duration: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="Simulated time.", show_default="length of --ramp or --play, at least 1 s"),
    ] = None,
    step: Annotated[
        str | None, typer.Option("--time-step", metavar="TIME", help="Maximum time step.", show_default=_TIME_STEP)
    ] = None,
    ramp: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="Time over which the winches reach their target.", show_default=_RAMP),
    ] = None,
    play: Annotated[
        Path | None,
        typer.Option(metavar="FILE.csv", help="Controls over time: columns time_s, WINCH ... [mm], DRIVE_deg."),
    ] = None,
    timeout: Annotated[
        str | None,
        typer.Option(
            metavar="TIME", help="Time limit for the solver. On timeout, print a diagnosis.", show_default="none"
        ),
    ] = None,
    profile: Annotated[bool, typer.Option("--profile", help="Print the CPU time of each solver stage.")] = False,
) -> None:
    """Solve for static equilibrium, or simulate a motion.

    Give contractions with --contract, forces with --pull or values of drives with --move. Add --dynamic to simulate
    the motion.

    Writes pose.json, pose.vtu and cables.vtu (for ParaView) and pose.png. With --dynamic, these show the final state,
    and the command also writes motion.csv, motion.pvd (for ParaView) and motion.png.

    Example: hydrostat simulate gallery:starfish --contract left=12mm --out build/pose
    """
    from hydrostat.cli.options import load_matplotlib
    from hydrostat.simulation import SensorReader, write_pose
    from hydrostat.units import TIME
    from hydrostat.version import __version__

    require_folder(out)
    with print_profile(profile, "reading"):
        loaded = loads(read_robot(robot), load)
    given, forces = contractions(loaded, contract), pulls(loaded, pull)
    if both := sorted(given.keys() & forces.keys()):
        raise InputError(f"--pull {both[0]}: --contract is given for this winch, too. Remove one of them.")
    if forces and (dynamic or timeout is not None):
        raise InputError(f"--pull: not available with {'--dynamic' if dynamic else '--timeout'}. Remove one of them.")
    driven = moves(loaded, move)
    static = {"--jacobian": jacobian or None, "--timeout": timeout}
    _check_mode(dynamic, static, {"--play": play, "--duration": duration, "--time-step": step, "--ramp": ramp})
    limit = parse_optional("--timeout", timeout, TIME)
    with print_profile(profile, "preparing"):
        simulation = prepare_physics(loaded)
    if dynamic:
        with print_profile(profile, "simulating"), result_folder(out) as folder:
            files = _move(
                simulation,
                {**given, **driven},
                folder,
                duration=duration,
                step=step or _TIME_STEP,
                ramp=ramp or _RAMP,
                play=play,
            )
        print("Wrote " + ", ".join(str(out / file.relative_to(folder)) for file in files))
        return
    began = time.process_time()
    with print_profile(profile, "solving"):
        pose = _solve(simulation, {**given, **driven}, forces, limit)
    seconds = time.process_time() - began
    _print_places(pose, loaded)
    _print_readings(SensorReader(simulation), pose)
    for name, contraction in zip(forces, _contractions_of(pose, forces), strict=True):
        print(f"winch {name}: {1e3 * contraction:.2f} mm at {forces[name]:g} N")
        check_contraction(loaded, name, contraction, option="--pull")
    print(f"{pose.result.status} after {plural(pose.result.iterations, 'iteration')}, {1e3 * seconds:.0f} ms")
    _print_notes(simulation, pose)
    sys.stdout.flush()  # the answer is there before the picture is drawn
    load_matplotlib()
    from hydrostat.plot import draw_pose, save_png

    facts = {"seconds": seconds, "version": __version__}
    with result_folder(out) as folder:
        files = write_pose(simulation, pose, folder, extra=facts, jacobian=jacobian)
        files.append(save_png(draw_pose(loaded, pose), folder / "pose.png"))
    for note in pose.notes:
        print(f"note: {note}")
    print("Wrote " + ", ".join(str(out / file.relative_to(folder)) for file in files))
    if not pose.result.converged:
        for name in ("pose.vtu", "cables.vtu", "jacobian.npz"):  # of an earlier pose
            (out / name).unlink(missing_ok=True)
        print("note: no equilibrium was found: pose.json and pose.png say so, pose.vtu is not written")
        raise typer.Exit(1)


def _check_mode(dynamic: bool, static: Mapping[str, object], timed: Mapping[str, object]) -> None:
    """Reject options of the other kind of simulation that are given, i.e. not None."""
    for name, value in (static if dynamic else timed).items():
        if value is not None:
            fix = "not available with --dynamic. Remove one of them." if dynamic else "needs --dynamic. Add it."
            raise InputError(f"{name}: {fix}")


def _solve(
    simulation: "Simulation", given: Mapping[str, float], pulls: Mapping[str, float], limit: float | None
) -> "Equilibrium":
    """Equilibrium at contractions [m], with pulls of some winches [N]."""
    if not pulls:
        return simulation.solve(given, strict=False, seconds=limit)
    from hydrostat.ik import solve_pulls

    return solve_pulls(simulation, pulls, given)


def _contractions_of(pose: "Equilibrium", names: Iterable[str]) -> list[float]:
    """Contraction of some winches [m]."""
    order = [winch.name for winch in pose.robot.winches]
    return [float(pose.contractions[order.index(name)]) for name in names]


def _print_places(found: "Equilibrium | Motion", robot: "Robot") -> None:
    """Print where each marker is [mm], and how hard each cable pulls [N], with its name."""
    for name, place in found.markers.items():
        print(f"{name:<16} {', '.join(f'{1e3 * value:z8.2f}' for value in place)} mm")
    for index, tension in enumerate(found.tensions):
        print(f"cable {index + 1:<10} {tension:8.3f} N  {robot.cables[index].name}")


def _print_readings(reader: "SensorReader", found: "Equilibrium | Motion") -> None:
    """Print the reading of each sensor, without noise."""
    readings = reader.read(found)
    for sensor in reader.simulation.robot.sensors:
        unit, factor = sensor.column
        value = readings[sensor.name]
        values = [value] if isinstance(value, int | float) else value.tolist()
        print(f"{sensor.name:<16} {', '.join(f'{factor * each:z8.2f}' for each in values)} {unit}".rstrip())


def _print_notes(simulation: "Simulation", pose: "Equilibrium") -> None:
    """Print what is in the way of a pose that was not found, and where else the body could have gone."""
    from hydrostat.geometry import find_crossings
    from hydrostat.ik import spool_arms

    if not pose.result.converged:
        for obstacle in simulation.diagnose(pose):
            print(f"not converged: {obstacle}")
    if words := str(find_crossings(simulation.robot.body.mesh, pose.nodes)):
        print(f"warning: {words}")
    print_exceeded(pose)
    print_overloads(pose.robot, pose.tensions, abs(spool_arms(pose.robot) @ pose.tensions))
    if pose.result.buckled:
        print("note: buckled: a mirror-image pose is equally likely")
    if pose.result.converged and not pose.result.stable:
        print("warning: unstable equilibrium (saddle point)")


def _move(
    simulation: "Simulation",
    contractions: Mapping[str, float],
    out: Path,
    *,
    duration: str | None,
    step: str,
    ramp: str,
    play: Path | None,
) -> list[Path]:
    """Move a robot from where it rests at first, print how it ended, and write all files; returns their paths."""
    from hydrostat.ik import spool_arms
    from hydrostat.plot import draw_motion, draw_pose, save_png
    from hydrostat.simulation import SensorReader, rests_at_first, write_motion, write_pose
    from hydrostat.units import TIME
    from hydrostat.version import __version__

    profile = _profile(simulation, contractions, ramp, play)
    seconds = parse_optional("--duration", duration, TIME) or max(float(profile.times[-1]), 1.0)
    dt = positive("--time-step", step, TIME)
    if dt > seconds:
        raise InputError(f"--time-step {step}: longer than the simulated time ({seconds:g} s). Choose a shorter one.")
    start = simulation.motion_at_rest(_first_pose(simulation, profile) if rests_at_first(simulation.robot) else None)
    began = time.process_time()
    with progress_bar() as progress:
        motions = _with_progress(simulation.play(profile, seconds, dt, start=start), seconds, progress)
        reader = SensorReader(simulation)
        files, table, last = write_motion(simulation.robot, motions, out, reader=reader)
    spent = time.process_time() - began
    extra = {"time": last.time, "kinetic": last.kinetic, "seconds": spent, "version": __version__}
    files += write_pose(simulation, last.pose, out, extra=extra)
    picture = draw_pose(simulation.robot, last.pose, note=f"after {last.time:g} s of motion")
    files.append(save_png(picture, out / "pose.png"))
    files.append(save_png(draw_motion(simulation.robot, table), out / "motion.png"))
    _print_places(last, simulation.robot)
    _print_readings(reader, last)
    torques = abs(spool_arms(simulation.robot) @ table.tensions.T).max(axis=1)
    print_overloads(simulation.robot, table.tensions.max(axis=0), torques)
    fastest = 1e3 * float((last.velocities**2).sum(axis=1).max() ** 0.5)
    steps = f"{plural(len(table.times) - 1, 'step')} to {last.time:g} s, computed in {spent:.1f} s"
    print(f"{steps}. Maximum speed at the end: {fastest:.2g} mm/s")
    return files


def _first_pose(simulation: "Simulation", profile: "ContractionProfile") -> "Equilibrium":
    """Equilibrium in which a motion begins: each load with the share that it has at 0 s."""
    from dataclasses import replace

    from hydrostat.simulation import Simulation

    if not any(load.path for load in simulation.robot.loads):
        return simulation.solve(profile.at(0.0))
    loads = tuple(load for load in (each.held_at(0.0) for each in simulation.robot.loads) if load is not None)
    return Simulation(replace(simulation.robot, loads=loads)).solve(profile.at(0.0))


def _profile(
    simulation: "Simulation", contractions: Mapping[str, float], ramp: str, play: Path | None
) -> "ContractionProfile":
    from hydrostat.robot import PinDrive
    from hydrostat.simulation import ContractionProfile
    from hydrostat.units import TIME

    if play is None:
        return ContractionProfile.ramp(simulation.as_contractions(contractions), positive("--ramp", ramp, TIME))
    if contractions:
        raise InputError("--play: not available with --contract or --move. Remove one of them.")
    profile, drives = ContractionProfile.read(play, simulation.robot), simulation.robot.drives
    for extreme in (profile.values.max(axis=0), profile.values.min(axis=0)):
        for winch, most in zip(simulation.robot.winches, extreme, strict=False):
            check_contraction(simulation.robot, winch.name, float(most), option=f"--play {play}:")
        for line in PinDrive.check_values(drives, extreme[len(simulation.robot.winches) :]):
            print(f"warning: --play {play}: {line}")
    return profile


def _with_progress(motions: "Iterable[Motion]", seconds: float, progress: Progress) -> "Iterator[Motion]":
    """The same motions, told to the progress bar in milliseconds."""
    for motion in motions:
        progress("simulating [ms]", round(1e3 * motion.time), round(1e3 * seconds))
        yield motion
