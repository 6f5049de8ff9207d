"""`score_card`: what a network achieves, as plain values for score.json."""

from dataclasses import asdict
from typing import Any

import numpy as np

from hydrostat.design.corrected_error import expected_corrected_error
from hydrostat.design.network import Alternative, Network, RouteTrace, TreeTrace
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.design.winch_front import winch_front
from hydrostat.ik import IKResult
from hydrostat.robot import Robot, robot_hash
from hydrostat.simulation import Simulation


def score_card(network: Network, *, version: str) -> dict[str, Any]:
    """Errors per pose and marker, tensions, contractions, lengths and time; SI units throughout."""
    robot = network.robot
    request = network.request.as_values()
    return {
        "rms_error": network.rms_error,
        "rms_error_as_built": network.expected_error,
        "rms_error_corrected": corrected_error(network),
        "rms_error_at_rest": network.rest_error,
        "craft": network.cost.as_values,
        "tension_limit": network.constraints.tension_limit,
        "torque_limit": network.constraints.torque,
        "motor": robot.motor,
        "poses": {pose.pose_target.name: _pose_results(robot, pose) for pose in network.ik_results},
        "winches": _winches(robot),
        "cables": _cables(robot),
        **_trace(network.trace),
        **_stuffed_results(network),
        "by_winches": [row.as_values for row in winch_front(network)],
        "alternatives": [_alternative(other) for other in network.alternatives],
        "networks_tried": network.num_evaluated,
        "cpu_seconds": network.seconds,
        "complete": network.complete,
        "request": request,
        "version": version,
        "source_robot": robot_hash(network.source),
        "robot": robot_hash(robot),
    }


def corrected_error(network: Network) -> float:
    """Return the rms error expected of a built robot after one correction by measured markers [m]."""
    uncertainty = network.request.uncertainty or BuildTolerances.of(network.robot.body)
    return expected_corrected_error(Simulation(network.robot), network.ik_results, uncertainty)


def _winches(robot: Robot) -> list[dict[str, Any]]:
    return [
        {
            "name": winch.name,
            "at": list(winch.at),
            "spool_radius": winch.spool_radius,
            "travel": winch.travel,
            "release": winch.release,
            "mount": str(winch.mount),
        }
        for winch in robot.winches
    ]


def _cables(robot: Robot) -> list[dict[str, Any]]:
    return [
        {
            "name": cable.name,
            "winch": cable.winch,
            "length": cable.length,
            "sheathed": float(cable.segments[~cable.bare].sum()),
            "slack": cable.slack,
            "spool_ratio": ratio,
            "via_points": len(cable.points) - 2,
        }
        for cable, ratio in zip(robot.cables, map(float, robot.spool_ratios), strict=True)
    ]


def _trace(trace: TreeTrace | RouteTrace) -> dict[str, Any]:
    """Return the facts that the method reports."""
    if isinstance(trace, TreeTrace):
        fibres = float(np.sqrt(np.mean([activation.rms_error**2 for activation in trace.activations])))
        return {"tree_score": trace.score, "rms_error_with_all_fibres": fibres}
    return {
        "stages": [
            {
                "what": stage.words,
                "rms_error": stage.error,
                "winches": len(stage.robot.winches),
                "cables": len(stage.robot.cables),
            }
            for stage in trace.stages
        ],
        "certificate": None if trace.certificate is None else asdict(trace.certificate),
    }


def _stuffed_results(network: Network) -> dict[str, Any]:
    """Return the results on the filled body; empty if not requested."""
    filled = network.stuffed
    if filled is None:
        return {}
    poses = {
        pose.pose_target.name: {
            "rms_error": pose.rms_error,
            "contractions": dict(
                zip((winch.name for winch in network.robot.winches), map(float, pose.pose.contractions), strict=True)
            ),
            "out_of_plane": pose.pose.out_of_plane,
        }
        for pose in filled.reached
    }
    told = {"face": str(filled.face), "rms_error": filled.rms_error, "rms_error_with_flat_commands": filled.played}
    return {"filled": {**told, "out_of_plane": filled.out, "finalists": filled.finalists, "poses": poses}}


def _alternative(other: Alternative) -> dict[str, Any]:
    return {
        "winches": len(other.robot.winches),
        "cables": len(other.robot.cables),
        "rms_error": other.rms_error,
        "rms_error_as_built": other.expected_error,
        "craft": other.cost.as_values,
        "poses": {pose.pose_target.name: pose.rms_error for pose in other.ik_results},
        "robot": robot_hash(other.robot),
    }


def _pose_results(robot: Robot, reached: IKResult) -> dict[str, Any]:
    pose = reached.pose
    return {
        "rms_error": reached.rms_error,
        "errors": dict(reached.errors),
        "contractions": {
            winch.name: float(value) for winch, value in zip(robot.winches, pose.contractions, strict=True)
        },
        "tensions": [float(tension) for tension in pose.tensions],
        "status": str(reached.status),
        "held": list(reached.active_limits),
        "residual": pose.result.residual,
    }
