"""`Show`: what all screens show, as bytes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hydrostat.arrays import Vector
from hydrostat.robot import Robot
from hydrostat.studio.view.picture import Picture
from hydrostat.studio.view.shape import Shape
from hydrostat.studio.view.things import Thing


@dataclass(frozen=True, eq=False)
class Shown:
    """One moment.

    Attributes:
        serial: of its scene.
        scene: all that stays the same.
        frame: all that changes.
    """

    serial: int
    scene: bytes
    frame: bytes


class Show:
    """Makes a new scene only when the old one does not fit."""

    def __init__(self) -> None:
        self._picture: Picture | None = None
        self._scene = b""
        self._serial = 0

    def moment(
        self, robot: Robot, shape: Shape, things: Sequence[Thing], head: dict[str, Any], values: Vector | None = None
    ) -> Shown:
        """A robot in a shape, with things.

        Args:
            robot: whose body it is.
            shape: where the body is.
            things: beside it.
            head: words that go along with the frame.
            values: of the nodes, to be coloured by.
        """
        if self._picture is None or not self._picture.fits(robot, things):
            self._serial += 1
            self._picture = Picture(robot, things, self._serial)
            self._scene = self._picture.scene()
        frame = self._picture.frame(shape.nodes, things, head, values=values)
        return Shown(self._serial, self._scene, frame)
