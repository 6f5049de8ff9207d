"""What is allowed but may disappoint, in plain words: one file for each part of a robot."""

from hydrostat.robot.risks.find_risks import find_risks

__all__ = ["find_risks"]
