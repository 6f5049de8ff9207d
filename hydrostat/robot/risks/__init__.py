"""What may disappoint about a robot that is free of errors, found without simulating anything."""

from hydrostat.robot.risks.body_risks import body_risks
from hydrostat.robot.risks.network_risks import cable_risks, winch_risks
from hydrostat.robot.risks.pose_risks import marker_risks, pin_risks, pose_risks
from hydrostat.robot.robot import Robot

__all__ = ["find_risks"]


def find_risks(robot: Robot) -> list[str]:
    """Tell in one line for each kind of risk and part what may disappoint; none if all is well."""
    kinds = (body_risks, pin_risks, winch_risks, cable_risks, marker_risks, pose_risks)
    return [line for kind in kinds for line in kind(robot)]
