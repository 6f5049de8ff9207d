"""`MoldSetting`: body to be cast, with the directions of its mold."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from manifold3d import Manifold

from hydrostat.arrays import Float
from hydrostat.fabrication.moulds.pull import Pull, find_pull
from hydrostat.fabrication.moulds.stance import MoldOrientation, find_stance
from hydrostat.fabrication.solids.body_solid import body_solid
from hydrostat.robot import Body, Pin, Robot
from hydrostat.units import MILLIMETERS


@dataclass(frozen=True, eq=False, kw_only=True)
class MoldSetting:
    """Directions of a mold, which depend on the body and its pins, not on winches and cables."""

    solid: Manifold  # body in the coordinates of the robot [mm]
    pull: Pull  # directions in which the halves come off
    stance: MoldOrientation  # axes of the mold


def mold_setting(robot: Robot) -> MoldSetting:
    """Find the directions of the mold of a robot's body (InputError: the body is not closed)."""
    solid = body_solid(robot.body)
    pull = find_pull(solid)
    return MoldSetting(
        solid=solid, pull=pull, stance=_keep_stance(pull, _pinned_nodes(robot.body, robot.pins).tobytes())
    )


@lru_cache(maxsize=8)
def _keep_stance(pull: Pull, held: bytes) -> MoldOrientation:
    """The orientation of a mold by its pull, which is kept too, and the bytes of the nodes that are held."""
    return find_stance(pull, np.frombuffer(held).reshape(-1, 3))


def _pinned_nodes(body: Body, pins: tuple[Pin, ...]) -> Float[np.ndarray, "held 3"]:
    """Nodes at pins [mm], flat bodies at z = 0."""
    mesh = body.mesh
    held = np.zeros(len(mesh.nodes), dtype=bool)
    for pin in pins:
        held |= pin.holds(mesh)
    nodes = MILLIMETERS * mesh.nodes[held]
    return np.column_stack([nodes, np.zeros((len(nodes), 3 - mesh.dim))])
