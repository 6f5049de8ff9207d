"""`write_pose`: an equilibrium as pose.json and pose.vtu."""

import json
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.geometry import write_vtu
from hydrostat.robot import Robot, replace_file, robot_hash
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.obstacle_frames import carried_frames
from hydrostat.simulation.simulation import Simulation


def pose_facts(robot: Robot, pose: Equilibrium) -> dict[str, Any]:
    """Return the contents of pose.json: SI units, contractions by winch, tensions in the order of the named cables.

    Each moving obstacle has its center and its axes.
    """
    things = {
        name: {"place": place.tolist(), "axes": axes.tolist()}
        for name, (place, axes) in carried_frames(robot, pose.carried).items()
    }
    return {
        **({"obstacles": things} if things else {}),
        "robot": robot_hash(robot),
        "contractions": {
            winch.name: float(value) for winch, value in zip(robot.winches, pose.contractions, strict=True)
        },
        "cables": [cable.name for cable in robot.cables],
        "tensions": [float(tension) for tension in pose.tensions],
        "energy": pose.energy,
        "residual": pose.result.residual,
        "reason": str(pose.result.reason),
        "stable": pose.result.stable,
        "buckled": pose.result.buckled,
        "iterations": pose.result.iterations,
        "markers": {name: [float(value) for value in place] for name, place in pose.markers.items()},
    }


def write_pose(
    simulation: Simulation,
    pose: Equilibrium,
    folder: Path,
    *,
    extra: Mapping[str, Any] | None = None,
    jacobian: bool = False,
) -> list[Path]:
    """Write pose.json, pose.vtu and, if wanted, jacobian.npz into a folder; returns their paths.

    Args:
        simulation: the robot's physics.
        pose: the equilibrium.
        folder: made if need be.
        extra: more entries for pose.json, such as seconds.
        jacobian: also write d nodes / d contractions, (nodes, dim, winches), under the key `jacobian`.
    """
    folder.mkdir(parents=True, exist_ok=True)
    robot = simulation.robot
    facts = {**pose_facts(robot, pose), **(extra or {})}
    mesh = write_vtu(robot.body.mesh, pose.nodes, {"rest": robot.body.mesh.nodes})
    written = [
        replace_file(folder / "pose.json", (json.dumps(facts, indent=2) + "\n").encode()),
        replace_file(folder / "pose.vtu", mesh),
    ]
    if jacobian:
        buffer = BytesIO()
        np.savez_compressed(buffer, jacobian=simulation.jacobian(pose))
        written.append(replace_file(folder / "jacobian.npz", buffer.getvalue()))
    return written
