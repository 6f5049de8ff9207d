"""`Now`: a robot with what is wished of it and where it is, as one value that is replaced whole."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.robot import Robot
from hydrostat.studio.posing.held import Held, Mode, Wish
from hydrostat.studio.posing.mover import Anchored
from hydrostat.studio.view.shape import Shape
from hydrostat.studio.view.things import Ghost


@dataclass(frozen=True, kw_only=True)
class Now:
    """What belongs together, so that no thread sees an old wish with a new body.

    Attributes:
        robot: that is posed.
        wish: what a person wants of it.
        anchored: where held points are stuck to its mesh.
        shape: where its body is.
        ghost: a shape to compare with, if any.
    """

    robot: Robot
    wish: Wish
    anchored: Anchored
    shape: Shape
    ghost: Ghost | None = None

    def known(self, name: str) -> str:
        """The name, if a point that is held or a marker has it, else ""."""
        found = name in self.wish.held or any(marker.name == name for marker in self.robot.markers)
        return name if found else ""

    def adapted(self, robot: Robot) -> "Now":
        """The same for a robot of the same nodes, whose markers, cables and winches may be others.

        Markers that are gone are held no more, but what was held as a plain point stays held.
        """
        names, places = renamed(self.robot, robot), {marker.name: marker.at for marker in robot.markers}
        held: dict[str, Held] = {}
        for old, point in self.wish.held.items():
            name = names.get(old, old)
            if name in places or not point.marker:
                held[name] = replace(point, at=places.get(name, point.at))
        mode = self.wish.mode if robot.cables else Mode.MUSCLES
        return replace(
            self, robot=robot, wish=replace(self.wish, held=held, mode=mode), shape=fitted(robot, self.shape)
        )


def renamed(before: Robot, after: Robot) -> Mapping[str, str]:
    """New names of markers by their old ones: those that are new where one is gone."""
    old, new = {marker.name for marker in before.markers}, {marker.name for marker in after.markers}
    fresh = {marker.at: marker.name for marker in after.markers if marker.name not in old}
    gone = [marker for marker in before.markers if marker.name not in new]
    return {marker.name: fresh[marker.at] for marker in gone if marker.at in fresh}


def fitted(robot: Robot, shape: Shape) -> Shape:
    """A shape for a robot whose winches and cables may be others."""
    if len(shape.tensions) == len(robot.cables) and len(shape.contractions) == len(robot.winches):
        return shape
    return replace(shape, tensions=np.zeros(len(robot.cables)), contractions=np.zeros(len(robot.winches)))
