"""`Tool`: what the pointer does in the stage "edit"."""

from enum import StrEnum


class Tool(StrEnum):
    """The tools."""

    MOVE = "move"
    PIN = "pin"
    MARKER = "marker"
    WINCH = "winch"
    CABLE = "cable"


KEYS = {"v": Tool.MOVE, "p": Tool.PIN, "m": Tool.MARKER, "w": Tool.WINCH, "c": Tool.CABLE}
"""The key of each tool."""
