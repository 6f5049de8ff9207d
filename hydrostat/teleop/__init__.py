"""Teleoperation: keyboards, knobs, data gloves and cameras as inputs, and hand maps fitted to them (R68 to R70)."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.control import EMULATED
    from hydrostat.teleop.cyber_glove import BAUD, SENSORS, CyberGlove, EmulatedPerson
    from hydrostat.teleop.drive import DriveLoop, drive
    from hydrostat.teleop.hand_map import HandMap
    from hydrostat.teleop.lesson_poses import HeldStill, LessonPoses, go_there
    from hydrostat.teleop.mapped_hand import MappedHand, Smoothing
    from hydrostat.teleop.mimicry import Mimicry
    from hydrostat.teleop.open_source import EmulatedHand, open_hand, open_source
    from hydrostat.teleop.source import DriveSource, HandSource
    from hydrostat.teleop.ways import CommandMapper, MarkerMapper, WinchMapper

__all__ = [
    "BAUD",
    "EMULATED",
    "SENSORS",
    "CommandMapper",
    "CyberGlove",
    "DriveLoop",
    "DriveSource",
    "EmulatedHand",
    "EmulatedPerson",
    "HandMap",
    "HandSource",
    "HeldStill",
    "LessonPoses",
    "MappedHand",
    "MarkerMapper",
    "Mimicry",
    "Smoothing",
    "WinchMapper",
    "drive",
    "go_there",
    "open_hand",
    "open_source",
]

open_package(__name__)
