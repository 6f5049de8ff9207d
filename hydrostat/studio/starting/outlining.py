"""`Outlining`: an outline while a person draws it."""

from typing import Any

import numpy as np

from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Robot
from hydrostat.studio.records.work import Work
from hydrostat.studio.starting.loops import Corner, Loop, fitted, loops_svg, outline_of, read_loops
from hydrostat.studio.starting.reshape import Reshaped, reshaped


class Outlining:
    """Loops that are drawn, checked as they change.

    Attributes:
        loops: the rim and holes, in any order.
        robot: whose outline is edited; None: a new one is drawn.
        fault: why they are no body yet; "" if they are.
        words: what they are, such as "280 x 240 mm, 21 corners"; "" if they are no body.
    """

    def __init__(self, loops: tuple[Loop, ...] = (), robot: Robot | None = None) -> None:
        """Begin with loops."""
        self.robot = robot
        self.loops: tuple[Loop, ...] = ()
        self.fault = self.words = ""
        self._set(loops)

    @classmethod
    def of(cls, robot: Robot) -> "Outlining":
        """Edit the outline of a robot, as few corners.

        Raises:
            InputError: it was not drawn.
        """
        if robot.body.outline is None:
            raise InputError(f"{robot.name} has no outline; only flat bodies that were drawn have one")
        return cls(fitted(robot.body.outline), robot)

    def take(self, raw: Any) -> None:
        """What a screen has sent.

        Raises:
            InputError: it is no loops.
        """
        self._set(read_loops(raw))

    def drawing(self) -> bytes:
        """The loops as SVG in millimetres.

        Raises:
            InputError: they are no body.
        """
        return loops_svg(self.loops)[0]

    def applied(self, work: Work) -> Reshaped:
        """The work with this outline.

        Raises:
            InputError: it is no body, or no pin lies in it.
        """
        drawing, corner = loops_svg(self.loops)
        return reshaped(work, drawing, corner)

    def _set(self, loops: tuple[Loop, ...]) -> None:
        self.loops = loops
        try:
            outline = outline_of(loops)
        except HydrostatError as error:
            self.fault, self.words = str(error), ""
            return
        wide, high = 1e3 * np.ptp(outline.exterior, axis=0)
        holes = f", {len(loops) - 1} hole{'s' if len(loops) > 2 else ''}" if len(loops) > 1 else ""
        self.fault = ""
        self.words = f"{wide:.0f} x {high:.0f} mm, {sum(map(len, loops))} corners{holes}"


def beginnings() -> dict[str, tuple[Loop, ...]]:
    """Simple shapes to begin with, by name."""
    disc = tuple(Corner(100 * _cos(k, 8), 70 * _sin(k, 8), True) for k in range(8))
    bar = (Corner(-120, -25), Corner(120, -25), Corner(120, 25), Corner(-120, 25))
    star = tuple(Corner((120 if k % 2 else 45) * _cos(k + 1.5, 10), (120 if k % 2 else 45) * _sin(k + 1.5, 10), True)
                 for k in range(10))  # fmt: skip
    return {"Disc": (disc,), "Bar": (bar,), "Star": (star,)}


def _cos(step: float, steps: int) -> float:
    return round(float(np.cos(2 * np.pi * step / steps)), 3)


def _sin(step: float, steps: int) -> float:
    return round(float(np.sin(2 * np.pi * step / steps)), 3)
