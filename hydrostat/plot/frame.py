"""`Frame`: a robot at one instant of an animation."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.robot import Obstacle, PoseTarget, Robot
from hydrostat.simulation import Equilibrium, Motion


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """Content of a motion picture at one instant."""

    nodes: Nodes  # positions of the nodes [m]
    tensions: Vector  # of each cable [N]
    contractions: Vector | None = None  # cable taken in by each winch [m]; without, no winch is seen to turn
    target: PoseTarget | None = None  # the pose that is approached, whose targets are shown
    words: str = ""  # what happens, in a line
    things: tuple[Obstacle, ...] = ()  # beside the robot, where they are

    @classmethod
    def of(
        cls,
        found: Equilibrium | Motion,
        *,
        target: PoseTarget | None = None,
        words: str = "",
        things: Sequence[Obstacle] = (),
    ) -> Self:
        """The frame that shows an equilibrium, or an instant of a motion, and things beside the robot."""
        told = {"nodes": found.nodes, "tensions": found.tensions, "contractions": found.contractions}
        return cls(**told, target=target, words=words, things=tuple(things))


def check_frames(robot: Robot, frames: Sequence[Frame]) -> None:
    """Refuse frames that do not fit the robot before work begins (InputError: none, or wrong or infinite numbers)."""
    if not frames:
        raise InputError("an animation needs at least one frame")
    for index, frame in enumerate(frames):
        wanted = {
            "nodes": (frame.nodes, robot.body.mesh.nodes.shape),
            "tensions": (frame.tensions, (len(robot.cables),)),
            "contractions": (frame.contractions, (len(robot.winches),)),
        }
        for name, (values, shape) in wanted.items():
            if values is not None and not (np.shape(values) == shape and np.isfinite(values).all()):
                raise InputError(f"frame {index}: its {name} must be finite, {shape}, not {np.shape(values)}")
