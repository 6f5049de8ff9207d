"""Networks on a plate whose distances and angles are known by hand."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from builders import box_mesh, mesh_body, strip_mesh

from hydrostat.design.buildable import violations
from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.robot import Body, Cable, Pin, Robot, Winch

UP = ((0.03, 0.03), (0.06, 0.03), (0.1, 0.03), (0.15, 0.03))
DOWN = ((0.03, -0.03), (0.06, -0.03), (0.1, -0.03), (0.15, -0.03))
HAIR = 1e-4
STRAIGHT_UP, STRAIGHT_DOWN = (UP[0], UP[3]), (DOWN[0], DOWN[3])
FAN = 2 * float(np.arcsin(0.01 / 0.024))  # between two cables that are 10 mm apart 12 mm from their winch

Points = tuple[tuple[float, ...], ...]


@cache
def plate(dim: int) -> Body:
    """200 x 100 mm from x = 0, evenly about y = 0; in space 60 mm high from z = 0."""
    if dim == 2:
        return mesh_body(strip_mesh(8, 4, size=(0.2, 0.1)))
    mesh = box_mesh((8, 4, 3), size=(0.2, 0.1, 0.06))
    return mesh_body(replace(mesh, nodes=mesh.nodes - np.array([0.0, 0.05, 0.0])))


def network(
    up: Points = UP,
    down: Points = DOWN,
    *,
    winch: dict[str, Any] | None = None,
    lower: Any = (),
    more: Any = (),
    **cable: Any,
) -> Robot:
    """Two winches with a cable each; values of the upper ones, and further cables by winch and points."""
    dim = len(up[0])
    return Robot(
        name="plate",
        body=plate(dim),
        pins=(Pin(box=((-0.001,) + (-1.0,) * (dim - 1), (0.001,) + (1.0,) * (dim - 1))),),
        winches=(Winch(name="up", at=up[0], **(winch or {})), Winch(name="down", at=down[0], **dict(lower))),
        cables=(
            Cable(winch="up", points=up, **cable),
            Cable(winch="down", points=down),
            *(Cable(winch=name, points=points) for name, points in more),
        ),
        poses={},
    )


def broken(robot: Robot, **limits: Any) -> list[str]:
    constraints = Constraints(**{"cable_gap": 0.0, "max_turn": 75.0, **limits})
    constraints.check(robot)
    return violations(robot, constraints, Region.of_body(robot.body, constraints.clearance))


def moved(points: Points, index: int, *at: float) -> Points:
    return (*points[:index], at, *points[index + 1 :])


def high(points: Points, z: float = 0.03) -> Points:
    """The same points in space."""
    return tuple((*point, z) for point in points)


def corner(angle: float, first: float = 0.03, last: float = 0.04) -> Points:
    """A cable that turns by an angle [degrees] at its point 1."""
    way = np.radians(angle)
    return (UP[0], (0.03 + first, 0.03), (0.03 + first + last * float(np.cos(way)), 0.03 - last * float(np.sin(way))))


def third(x: float, y: float) -> dict[str, Any]:
    """A further cable of the lower winch that ends in a place."""
    return {"more": [("down", (DOWN[0], (0.06, -0.012), (x, y)))]}
