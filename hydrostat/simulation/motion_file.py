"""Files of poses (JSON) and of motions (NumPy), written and read."""

import json
import shutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import NotConvergedError
from hydrostat.files import csv_text, replace_file
from hydrostat.geometry import write_lines_vtu, write_vtu
from hydrostat.given import path_of
from hydrostat.robot import Robot, robot_hash
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.obstacle_frames import carried_frames
from hydrostat.simulation.sensor_reader import SensorReader
from hydrostat.simulation.simulation import Simulation
from hydrostat.simulation.time.motion import Motion


def pose_facts(robot: Robot, pose: Equilibrium) -> dict[str, Any]:
    """Return the contents of pose.json: SI units, contractions by winch, tensions in the order of the named cables.

    Each moving obstacle has its center and its axes.
    """
    obstacles = {
        name: {"place": place.tolist(), "axes": axes.tolist()}
        for name, (place, axes) in carried_frames(robot, pose.carried).items()
    }
    return {
        **({"obstacles": obstacles} if obstacles else {}),
        "robot": robot_hash(robot),
        "contractions": {
            winch.name: float(value) for winch, value in zip(robot.winches, pose.contractions, strict=True)
        },
        **({"drives": drives} if (drives := _drive_facts(pose)) else {}),
        "cables": [cable.name for cable in robot.cables],
        "tensions": [float(tension) for tension in pose.tensions],
        "energy": pose.energy,
        "residual": pose.result.residual,
        "converged": pose.result.converged,
        "status": str(pose.result.status),
        "stable": pose.result.stable,
        "buckled": pose.result.buckled,
        "iterations": pose.result.iterations,
        "markers": {name: [float(value) for value in place] for name, place in pose.markers.items()},
    }


def _drive_facts(pose: Equilibrium) -> dict[str, dict[str, float]]:
    """Angle, travel or share of each drive."""
    keys, facts = {"rad": "angle_deg", "m": "travel_mm", "share": "share"}, {}
    for drive, value in zip(pose.robot.drives, pose.drives, strict=True):
        facts[drive.name] = {keys[drive.unit]: drive.column[1] * float(value)}
    return facts


def _sensor_facts(simulation: Simulation, pose: Equilibrium) -> dict[str, Any]:
    """Reading of each sensor, without noise."""
    if not simulation.robot.sensors:
        return {}
    return {"sensors": {name: np.array(value).tolist() for name, value in SensorReader(simulation).read(pose).items()}}


def write_pose(
    simulation: Simulation,
    pose: Equilibrium,
    folder: str | Path,
    *,
    extra: Mapping[str, Any] | None = None,
    jacobian: bool = False,
) -> list[Path]:
    """Write pose.json, pose.vtu, cables.vtu and, if wanted, jacobian.npz into a folder; returns their paths.

    If the solver found no equilibrium, only pose.json is written, with `converged` false.
    pose.vtu has `rest`, `displacement` [m], `strain` and `stress` (von Mises, [Pa]) at each node, cables.vtu the
    `tension` [N], the `winch` (its number) and the `contraction` [m] of each cable.

    Args:
        simulation: the robot's physics.
        pose: the equilibrium.
        folder: output folder (created if missing).
        extra: more entries for pose.json, such as seconds.
        jacobian: also write d nodes / d contractions, (nodes, dim, winches), under the key `jacobian`.
    """
    folder = path_of(folder, "a pose is written into a folder, given by its path")
    folder.mkdir(parents=True, exist_ok=True)
    robot = simulation.robot
    facts = {**pose_facts(robot, pose), **_sensor_facts(simulation, pose), **(extra or {})}
    written = [replace_file(folder / "pose.json", (json.dumps(facts, indent=2) + "\n").encode())]
    if not pose.result.converged:
        return written
    rest = robot.body.mesh.nodes
    fields = {"rest": rest, "displacement": pose.nodes - rest, "strain": pose.strains, "stress": pose.stresses}
    written.append(replace_file(folder / "pose.vtu", write_vtu(robot.body.mesh, pose.nodes, fields)))
    if robot.cables:
        written.append(replace_file(folder / "cables.vtu", _cables_vtu(simulation, pose)))
    if jacobian:
        buffer = BytesIO()
        np.savez_compressed(buffer, jacobian=simulation.jacobian(pose))
        written.append(replace_file(folder / "jacobian.npz", buffer.getvalue()))
    return written


def _cables_vtu(simulation: Simulation, pose: Equilibrium) -> bytes:
    """Cables in a pose as lines."""
    robot, routes = simulation.robot, simulation.route_points
    places = routes.positions(pose.nodes)
    names = [winch.name for winch in robot.winches]
    winches = np.array([names.index(cable.winch) for cable in robot.cables], dtype=np.int64)
    data = {"tension": np.asarray(pose.tensions), "winch": winches, "contraction": pose.contractions[winches]}
    return write_lines_vtu(places, routes.counts, data)


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionTable:
    """Observable quantities of a motion, a row for each instant.

    Attributes:
        times: times [s].
        contractions: contractions of the winches [m].
        drives: values of the drives [rad or m].
        markers: marker positions [m].
        tensions: cable tensions [N].
        energies: kinetic and potential energy [J].
        obstacles: center of each moving obstacle [m], by name.
        sensors: readings without noise, in SI, in the order of `SensorReader.heads`.
    """

    times: Vector
    contractions: Float[np.ndarray, "rows winches"]
    markers: Float[np.ndarray, "rows markers dim"]
    tensions: Float[np.ndarray, "rows cables"]
    energies: Float[np.ndarray, "rows 2"]
    drives: Float[np.ndarray, "rows drives"] = field(default_factory=lambda: np.zeros((0, 0)))
    obstacles: Mapping[str, Float[np.ndarray, "rows dim"]] = field(default_factory=dict)
    sensors: Float[np.ndarray, "rows values"] = field(default_factory=lambda: np.zeros((0, 0)))


def write_motion(
    robot: Robot,
    motions: Iterable[Motion],
    folder: str | Path,
    *,
    frames_per_second: float = 30.0,
    reader: SensorReader | None = None,
) -> tuple[list[Path], MotionTable, Motion]:
    """Write a motion; one that stops early is written as far as it got. Nothing is replaced before it has ended.

    Args:
        robot: moving robot.
        motions: its instants, at least one.
        folder: output folder (created if missing); the meshes go to its subfolder `frames`.
        frames_per_second: frame rate of the meshes: each frame is the first instant at or after its time.
        reader: sensors that are read; none if left out.

    Returns:
        The paths of motion.csv and motion.pvd, the table, and the last instant.

    Raises:
        NotConvergedError: from the motion, after all has been written.
    """
    folder = path_of(folder, "a motion is written into a folder, given by its path")
    folder.mkdir(parents=True, exist_ok=True)
    frames: list[tuple[float, str]] = []
    seen: list[tuple] = []
    stopped, last = None, None
    with TemporaryDirectory(dir=folder, prefix=".frames.") as part:
        for motion in _until_stopped(motions):
            if isinstance(motion, NotConvergedError):
                stopped = motion
                break
            last = motion
            seen.append((*_row(robot, motion), np.zeros(0) if reader is None else reader.read_vector(motion)))
            if motion.time - seen[0][0] >= len(frames) / frames_per_second - 1e-9:
                frames.append((motion.time, _write_frame(robot, motion, Path(part), len(frames))))
        if last is None:
            raise ValueError("a motion has at least one instant")
        _replace_folder(folder / "frames", Path(part))
    table = _table(robot, seen)
    files = [
        replace_file(folder / "motion.csv", _csv(robot, table)),
        replace_file(folder / "motion.pvd", _pvd(frames).encode()),
    ]
    if stopped is not None:
        raise stopped
    return files, table, last


def _until_stopped(motions: Iterable[Motion]) -> Iterator[Motion | NotConvergedError]:
    """Motions, and the error that ended them in place of being raised."""
    try:
        yield from motions
    except NotConvergedError as error:
        yield error


def _row(robot: Robot, motion: Motion) -> tuple:
    markers = np.array(list(motion.markers.values())).reshape(-1, robot.body.mesh.dim)
    frames = carried_frames(robot, None if motion.carried is None else motion.carried[0])
    obstacles = {name: place for name, (place, _) in frames.items()}
    return (
        motion.time,
        motion.contractions,
        markers,
        motion.tensions,
        (motion.kinetic, motion.potential),
        obstacles,
        motion.drives,
    )


def _table(robot: Robot, rows: list[tuple]) -> MotionTable:
    times, contractions, markers, tensions, energies, obstacles, drives, sensors = zip(*rows, strict=True)
    return MotionTable(
        times=np.array(times),
        contractions=np.array(contractions).reshape(len(rows), len(robot.winches)),
        markers=np.array(markers),
        tensions=np.array(tensions).reshape(len(rows), len(robot.cables)),
        energies=np.array(energies),
        drives=np.array(drives).reshape(len(rows), len(robot.drives)),
        obstacles={name: np.array([row[name] for row in obstacles]) for name in obstacles[0]},
        sensors=np.array(sensors),
    )


def _write_frame(robot: Robot, motion: Motion, folder: Path, number: int) -> str:
    name = f"motion_{number:04d}.vtu"
    data = {"rest": robot.body.mesh.nodes, "velocity": motion.velocities}
    (folder / name).write_bytes(write_vtu(robot.body.mesh, motion.nodes, data))
    return f"frames/{name}"


def _replace_folder(folder: Path, part: Path) -> None:
    """Replace the former contents of a folder by the files of `part`."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for file in part.iterdir():
        file.replace(folder / file.name)


def _csv(robot: Robot, table: MotionTable) -> bytes:
    """Times in s, lengths in mm, tensions in N, energies in J."""
    axes = "xyz"[: robot.body.mesh.dim]
    head = ["time_s", *(f"{winch.name}_mm" for winch in robot.winches)]
    head += [drive.column[0] for drive in robot.drives]
    head += [f"{marker.name}_{axis}_mm" for marker in robot.markers for axis in axes]
    head += [f"cable_{index + 1}_N" for index in range(len(robot.cables))] + ["kinetic_J", "potential_J"]
    head += [f"{name}_{axis}_mm" for name in table.obstacles for axis in axes]
    places = table.markers.reshape(len(table.times), -1)
    driven = table.drives * [drive.column[1] for drive in robot.drives]
    columns = [table.times[:, None], 1e3 * table.contractions, driven, 1e3 * places, table.tensions, table.energies]
    columns += [1e3 * way for way in table.obstacles.values()]
    if table.sensors.shape[1]:
        dim = robot.body.mesh.dim
        head += [name for sensor in robot.sensors for name in sensor.columns(dim)]
        factors = [sensor.column[1] for sensor in robot.sensors for _ in sensor.heads(dim)]
        columns.append(table.sensors * factors)
    return csv_text(head, ([f"{value:.9g}" for value in row] for row in np.concatenate(columns, axis=1)))


def _pvd(frames: list[tuple[float, str]]) -> str:
    sets = "\n".join(f'    <DataSet timestep="{time:.9g}" part="0" file="{name}"/>' for time, name in frames)
    return (
        f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n{sets}\n'
        "  </Collection>\n</VTKFile>\n"
    )
