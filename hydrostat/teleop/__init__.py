"""From a glove to a robot: sensors, poses that a person mimics, and what is learned of them (R68 to R70)."""

from hydrostat.teleop.cyber_glove import CyberGlove, EmulatedGlove
from hydrostat.teleop.hand_source import HandReading, HandSource
from hydrostat.teleop.mimicry import Mimicry
from hydrostat.teleop.ridge import Ridge, fit_ridge

__all__ = ["CyberGlove", "EmulatedGlove", "HandReading", "HandSource", "Mimicry", "Ridge", "fit_ridge"]
