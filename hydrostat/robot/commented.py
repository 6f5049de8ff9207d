"""`commented_text`: a new robot.toml with comments on the purpose of its tables, like those of the gallery."""

from hydrostat.robot.robot import Robot
from hydrostat.robot.write import robot_text
from hydrostat.units import printable


def commented_text(robot: Robot, source: str) -> str:
    """Text of robot.toml with a comment before the first table of each kind.

    Args:
        robot: newly created robot.
        source: name of the file that it was created from.
    """
    flat = robot.body.mesh.dim == 2
    origin = "the middle of the drawing, x to the right, y up" if flat else "where the file of the body has it"
    where = "[0, 0]" if flat else "[0, 0, 0]"
    head = (
        f"# {robot.name}, begun from {printable(source)}. All of it is meant to be changed.\n"
        f"# Lengths are in {robot.length_unit}; {where} is {origin}. rest.png shows them.\n"
        "# `hydrostat check` reports errors and warnings. docs/robot_toml.md of hydrostat lists all keys.\n"
    )
    notes = {
        "[body]": "# The body. A smaller element_size is finer but slower; `hydrostat materials` lists materials.",
        "[[pin]]": "# Where it is held: what is within `radius` of `at`, or in the `box`, stays put.",
        "[[winch]]": "# A winch takes in up to `travel` of its cables' length, and lets out up to `release`.",
        "[[cable]]": "# A cable runs from its winch, the first point, to its stopper, the last.",
        "[[marker]]": "# Markers are points whose way is followed. Add one wherever the robot should reach something.",
        "[[pose]]": (
            "# A pose says where markers should go. `hydrostat design` finds cables for it.\n"
            "# What it does not name may go anywhere: name markers that shall stay, too, where they are."
        ),
    }
    lines, told = [], set()
    for line in robot_text(robot).splitlines():
        if line in notes and line not in told:
            told.add(line)
            if line == "[[marker]]" and "[[winch]]" not in told:
                lines += _NO_WINCH.splitlines()
            lines += notes[line].splitlines()
        lines.append(line)
    return head + "\n".join(lines) + "\n"


_NO_WINCH = """\
# There are no winches yet: `hydrostat design` finds them, and their cables, for the poses below. By hand:
# [[winch]]
# name = "left"
# at = [0, 0]
# travel = "60 mm"
#
# [[cable]]
# winch = "left"
# points = [[0, 0], [-20, 5], [-40, 10]]

"""
