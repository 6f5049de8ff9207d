"""Upright robot: placed on the ground, held by nothing else; `tilt` measures how far it leans."""

from dataclasses import replace

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.robot import Contact, Obstacle, ObstacleShape, Robot

VISCOSITY = 400.0
"""Shear viscosity of a material that has none [Pa s], assumed: a tenth to a third of stiffness is lost at 1 to 3 Hz."""


def standing(robot: Robot, friction: float | None) -> Robot:
    """A robot without its pins, on the ground; what robot.toml says of weight, ground and viscosity stays.

    Args:
        robot: flat, upright in its plane (y is up), or in space (z is up).
        friction: Coulomb's coefficient of the ground; as robot.toml has it if None, or `FRICTION` if it has none.

    Raises:
        InputError: friction below 0, or a ground that does not lie below.
    """
    up = np.eye(robot.body.mesh.dim)[-1]
    own = [obstacle for obstacle in robot.obstacles if obstacle.shape is ObstacleShape.PLANE]
    for plane in own:
        if not np.allclose(np.array(plane.normal) / np.linalg.norm(plane.normal or ()), up):
            raise InputError(f'robot {robot.name!r} walks on level ground: obstacle "{plane.name}" is not level')
    low = float(robot.body.mesh.nodes[:, -1].min())
    gap = 1e-3  # Between the lowest node and ground that robot.toml does not have [m]
    planes = own or [
        Obstacle(name="ground", shape="plane", at=tuple(((low - gap) * up).tolist()), normal=tuple(up.tolist()))
    ]
    coefficient = friction if friction is not None else planes[0].friction
    coefficient = FRICTION if coefficient is None else coefficient
    if not 0 <= coefficient < np.inf:
        raise InputError(f"friction must be 0 or more, not {coefficient:g}")
    rest = [obstacle for obstacle in robot.obstacles if obstacle not in own]
    material = robot.body.material
    if not (material.viscosity or material.relaxation):
        material = replace(material, viscosity=VISCOSITY)
    return replace(
        robot,
        body=replace(robot.body, material=material),
        pins=(),
        poses={},
        gravity=robot.gravity or ("-y" if len(up) == 2 else "-z"),
        contact=robot.contact or Contact(),
        obstacles=(*(replace(plane, friction=coefficient) for plane in planes), *rest),
    )


def with_friction(robot: Robot, friction: float) -> Robot:
    """A robot on ground with another coefficient of friction."""
    obstacles = [
        replace(obstacle, friction=friction) if obstacle.shape is ObstacleShape.PLANE else obstacle
        for obstacle in robot.obstacles
    ]
    return replace(robot, obstacles=tuple(obstacles))


def tilt(masses: Vector, rest: Nodes, nodes: Nodes) -> float:
    """Return the rotation of the upright direction with the body as a whole [rad], from nodes at rest and now [m].

    The turn is the rotation that fits best, by masses (Kabsch).
    """
    weight = masses[:, None] / masses.sum()
    before, now = (places - (weight * places).sum(axis=0) for places in (rest, nodes))
    left, _, right = np.linalg.svd((weight * now).T @ before)
    signs = np.ones(len(left))
    signs[-1] = np.sign(np.linalg.det(left @ right))
    return float(np.arccos(np.clip((left * signs @ right)[-1, -1], -1.0, 1.0)))


FRICTION = 0.6
"""Coulomb's coefficient of ground of which nothing is said."""
