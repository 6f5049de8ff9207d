"""`find_risks`: all that may disappoint, without simulating anything."""

from hydrostat.robot.risks.body_risks import body_risks
from hydrostat.robot.risks.cable_risks import cable_risks
from hydrostat.robot.risks.marker_risks import marker_risks
from hydrostat.robot.risks.pin_risks import pin_risks
from hydrostat.robot.risks.pose_risks import pose_risks
from hydrostat.robot.risks.winch_risks import winch_risks
from hydrostat.robot.robot import Robot


def find_risks(robot: Robot) -> list[str]:
    """One line for each kind of risk and part; none if all is well."""
    kinds = (body_risks, pin_risks, winch_risks, cable_risks, marker_risks, pose_risks)
    return [line for kind in kinds for line in kind(robot)]
