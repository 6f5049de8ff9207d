"""Cable-driven soft robots of hydrostat, and what drives them by hand, for LeRobot."""

from lerobot_robot_hydrostat.hydrostat_robot import HydrostatRobot, HydrostatRobotConfig
from lerobot_robot_hydrostat.hydrostat_teleop import HydrostatTeleop, HydrostatTeleopConfig

__all__ = ["HydrostatRobot", "HydrostatRobotConfig", "HydrostatTeleop", "HydrostatTeleopConfig"]
