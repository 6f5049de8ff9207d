"""Motor control: buses and links to motors, calibration, limits and guards, and playback of contractions (R58)."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.control.arm_motors import arm_motors
    from hydrostat.control.bus import Bus, Port, steady
    from hydrostat.control.bus_link import BusLink, LinkLimits, LinkState
    from hydrostat.control.calibration import CALIBRATION, EMULATED_CALIBRATION, Calibration, WinchMotor
    from hydrostat.control.corrected_link import correct_table
    from hydrostat.control.driven_pins import list_moved_loads, motor_stand, stand_table, stand_tensions
    from hydrostat.control.dynamixel_bus import GOAL, TICK, DynamixelBus
    from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedLine, EmulatedScs, EmulatedSts
    from hydrostat.control.emulated_servos import EmulatedChain, EmulatedServo, LiveChain
    from hydrostat.control.feetech_bus import FeetechBus
    from hydrostat.control.firmware_build import (
        build_images,
        check_ports,
        firmware_settings,
        flash,
        flash_command,
        on_boards,
        robot_word,
    )
    from hydrostat.control.firmware_moves import bake_moves
    from hydrostat.control.firmware_servos import SERVO_STEPS, find_zero_loss
    from hydrostat.control.guard import TensionGuard, not_judged
    from hydrostat.control.link import Link, SimulatedLink
    from hydrostat.control.marker_feedback import LostAction, MarkerFeedback, MarkerSight
    from hydrostat.control.marker_path import MarkerPath
    from hydrostat.control.model_tensions import TensionLookup, WinchPull, tensions_along, winch_tensions
    from hydrostat.control.motors import DEFAULT_MAX_SPEED, Motors
    from hydrostat.control.open_bus import EMULATED, add_cable_layers, check_port, open_bus, open_line, servo_ratings
    from hydrostat.control.player import Player
    from hydrostat.control.restart_motors import restart_motors
    from hydrostat.control.scs_bus import ScsBus
    from hydrostat.control.spool_curve import SpoolCurve
    from hydrostat.control.take_up import SlackCalibration, find_cable_zeros
    from hydrostat.control.timeline import MAX_DURATION, Key, Timeline

__all__ = [
    "CALIBRATION",
    "DEFAULT_MAX_SPEED",
    "EMULATED",
    "EMULATED_CALIBRATION",
    "GOAL",
    "MAX_DURATION",
    "SERVO_STEPS",
    "TICK",
    "Bus",
    "BusLink",
    "Calibration",
    "DynamixelBus",
    "EmulatedChain",
    "EmulatedFeetechChain",
    "EmulatedLine",
    "EmulatedScs",
    "EmulatedServo",
    "EmulatedSts",
    "FeetechBus",
    "Key",
    "Link",
    "LinkLimits",
    "LinkState",
    "LiveChain",
    "LostAction",
    "MarkerFeedback",
    "MarkerPath",
    "MarkerSight",
    "Motors",
    "Player",
    "Port",
    "ScsBus",
    "SimulatedLink",
    "SlackCalibration",
    "SpoolCurve",
    "TensionGuard",
    "TensionLookup",
    "Timeline",
    "WinchMotor",
    "WinchPull",
    "add_cable_layers",
    "arm_motors",
    "bake_moves",
    "build_images",
    "check_port",
    "check_ports",
    "correct_table",
    "find_cable_zeros",
    "find_zero_loss",
    "firmware_settings",
    "flash",
    "flash_command",
    "list_moved_loads",
    "motor_stand",
    "not_judged",
    "on_boards",
    "open_bus",
    "open_line",
    "restart_motors",
    "robot_word",
    "servo_ratings",
    "stand_table",
    "stand_tensions",
    "steady",
    "tensions_along",
    "winch_tensions",
]

open_package(__name__)
