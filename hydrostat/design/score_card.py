"""`score_card`: what a network achieves, as plain values for score.json."""

from dataclasses import asdict
from typing import Any

import numpy as np

from hydrostat.design.network import Network, RouteTrace, TreeTrace
from hydrostat.ik import ReachedPose
from hydrostat.robot import Robot, robot_hash


def score_card(network: Network, *, version: str) -> dict[str, Any]:
    """Errors per pose and marker, tensions, contractions, lengths and time; SI units throughout.

    Args:
        network: what was designed.
        version: of hydrostat.
    """
    robot = network.robot
    return {
        "rms_error": network.rms_error,
        "rms_error_at_rest": rest_error(network),
        "poses": {pose.wanted.name: _reached(robot, pose) for pose in network.reached},
        "winches": [{"name": winch.name, "at": list(winch.at)} for winch in robot.winches],
        "cables": [
            {"winch": cable.winch, "length": cable.length, "sheathed": cable.length - bare}
            for cable in robot.cables
            for bare in [float(cable.segments[cable.bare].sum())]
        ],
        **_trace(network.trace),
        "alternatives": [
            {"winches": len(other.robot.winches), "cables": len(other.robot.cables), "rms_error": other.rms_error}
            for other in network.alternatives
        ],
        "networks_tried": network.tried,
        "cpu_seconds": network.seconds,
        "complete": network.complete,
        "method": network.method,
        "constraints": asdict(network.constraints),
        "options": asdict(network.options),
        "version": version,
        "source_robot": robot_hash(network.source),
        "robot": robot_hash(robot),
    }


def _trace(trace: TreeTrace | RouteTrace) -> dict[str, Any]:
    """What the method says of itself."""
    if isinstance(trace, TreeTrace):
        fibres = float(np.sqrt(np.mean([activation.rms_error**2 for activation in trace.activations])))
        return {"tree_score": trace.score, "rms_error_with_all_fibres": fibres}
    return {
        "stages": [{"what": stage.words, "rms_error": stage.error} for stage in trace.stages],
        "certificate": None if trace.certificate is None else asdict(trace.certificate),
    }


def rest_error(network: Network) -> float:
    """Root of the mean squared marker error over all poses if nothing moved [m]."""
    places = {marker.name: np.array(marker.at) for marker in network.robot.markers}
    squares = [
        np.mean([np.sum((places[name] - goal) ** 2) for name, goal in pose.wanted.targets.items()])
        for pose in network.reached
    ]
    return float(np.sqrt(np.mean(squares)))


def _reached(robot: Robot, reached: ReachedPose) -> dict[str, Any]:
    pose = reached.pose
    return {
        "rms_error": reached.rms_error,
        "errors": dict(reached.errors),
        "contractions": {
            winch.name: float(value) for winch, value in zip(robot.winches, pose.contractions, strict=True)
        },
        "tensions": [float(tension) for tension in pose.tensions],
        "reason": str(reached.reason),
        "residual": pose.result.residual,
    }
