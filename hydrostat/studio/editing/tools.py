"""`Tool`: what the pointer does in the stage "edit", and the keys."""

from enum import StrEnum


class Tool(StrEnum):
    """The tools."""

    MOVE = "move"
    PIN = "pin"
    MARKER = "marker"
    WINCH = "winch"
    CABLE = "cable"
    RULER = "ruler"


KEYS = {  # the key of each tool
    "v": Tool.MOVE, "p": Tool.PIN, "m": Tool.MARKER, "w": Tool.WINCH, "c": Tool.CABLE, "d": Tool.RULER,
}  # fmt: skip
ARROWS = {"arrowleft": (-1, 0), "arrowright": (1, 0), "arrowdown": (-1, 1), "arrowup": (1, 1)}
"""Axis and sign by which each arrow key moves the selection: the first axis, or the last, which is up."""

NUDGE, PUSH = 1e-3, 1e-2  # how far an arrow moves it, and with Shift [m]
