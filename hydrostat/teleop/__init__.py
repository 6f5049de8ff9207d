"""From a person to a robot: keys, knobs, gloves and cameras, and what is learned of a hand (R68 to R70)."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.control import EMULATED
    from hydrostat.teleop.camera_hand import CameraHand
    from hydrostat.teleop.cyber_glove import BAUD, SENSORS, CyberGlove, EmulatedGlove, EmulatedPerson
    from hydrostat.teleop.drive import DriveLoop, drive
    from hydrostat.teleop.gamepad import Gamepad
    from hydrostat.teleop.hand_map import HandMap
    from hydrostat.teleop.keys import HELP, Keys
    from hydrostat.teleop.landmarks import HandLandmarks
    from hydrostat.teleop.lesson_poses import HeldStill, LessonPoses, go_there, hold_still, pose_pool
    from hydrostat.teleop.mapped_hand import MappedHand, OneEuro, Smoothing
    from hydrostat.teleop.midi_osc import MidiKnobs, Osc
    from hydrostat.teleop.mimicry import Mimicry, write_mcap
    from hydrostat.teleop.open_source import EmulatedHand, open_hand, open_source
    from hydrostat.teleop.ridge import Ridge, fit_ridge
    from hydrostat.teleop.source import DriveChannels, DriveSource, DriveWish, HandReading, HandSource
    from hydrostat.teleop.ways import CommandMapper, MarkerMapper, WinchMapper, marker_channels, winch_channels

__all__ = [
    "BAUD",
    "EMULATED",
    "HELP",
    "SENSORS",
    "CameraHand",
    "CommandMapper",
    "CyberGlove",
    "DriveChannels",
    "DriveLoop",
    "DriveSource",
    "DriveWish",
    "EmulatedGlove",
    "EmulatedHand",
    "EmulatedPerson",
    "Gamepad",
    "HandLandmarks",
    "HandMap",
    "HandReading",
    "HandSource",
    "HeldStill",
    "Keys",
    "LessonPoses",
    "MappedHand",
    "MarkerMapper",
    "MidiKnobs",
    "Mimicry",
    "OneEuro",
    "Osc",
    "Ridge",
    "Smoothing",
    "WinchMapper",
    "drive",
    "fit_ridge",
    "go_there",
    "hold_still",
    "marker_channels",
    "open_hand",
    "open_source",
    "pose_pool",
    "winch_channels",
    "write_mcap",
]

open_package(__name__)
