"""`winch_marks`: the mark that each winch has on the sheet, the pattern and the lists."""

import re

from hydrostat.robot import Robot


def winch_marks_of(robot: Robot) -> dict[str, str]:
    """W1, W2, ... of each winch by its name, as single letters are notches of the pattern.

    Where all names end in numbers, as winch_1 and winch_2 do, these are the numbers; else they are counted in order.
    """
    names = [winch.name for winch in robot.winches]
    ends = [re.search(r"(\d+)$", name) for name in names]
    numbers = [int(end[1]) for end in ends if end]
    if len(set(numbers)) != len(names):
        numbers = list(range(1, len(names) + 1))
    return {name: f"W{number}" for name, number in zip(names, numbers, strict=True)}


def marked_name(robot: Robot, name: str) -> str:
    """The mark of a winch with its name: "W1 left"."""
    return f"{winch_marks_of(robot)[name]} {name}"
