"""Risks of a robot that has no errors, found without a simulation."""

from collections.abc import Iterable
from dataclasses import replace

from hydrostat.robot.marker import PoseTarget
from hydrostat.robot.risks.body_risks import body_risks
from hydrostat.robot.risks.network_risks import SEWN_DEPTH, cable_risks, limit_travels, winch_risks
from hydrostat.robot.risks.part_risks import part_risks
from hydrostat.robot.risks.pose_risks import marker_risks, pin_risks, pose_risks
from hydrostat.robot.robot import Robot

__all__ = ["SEWN_DEPTH", "find_far_targets", "find_risks", "limit_travels"]


def find_far_targets(robot: Robot, poses: Iterable[PoseTarget]) -> list[str]:
    """Find targets that the body cannot reach: too far from their markers, or only by stretching it too much."""
    asked = {pose.name: pose for pose in poses}
    return list(pose_risks(replace(robot, poses=asked)))


def find_risks(robot: Robot) -> list[str]:
    """Find risks without a simulation: one line for each kind of risk and part; empty if there are none."""
    kinds = (body_risks, part_risks, pin_risks, winch_risks, cable_risks, marker_risks, pose_risks)
    return [line for kind in kinds for line in kind(robot)]
