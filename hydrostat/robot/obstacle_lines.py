"""`obstacle_lines`: the rims of obstacles, as lines to be drawn."""

from collections.abc import Callable

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.robot.contact import Obstacle, ObstacleShape
from hydrostat.robot.robot import Robot

ROUND = np.linspace(0.0, 2.0 * np.pi, 49)  # around a circle


def obstacle_lines(robot: Robot) -> list[Points]:
    """Lines along the rims of all obstacles of a robot [m]; a plane is drawn as far as the body is large, about it."""
    return [line for each in robot.obstacles for line in rims(each, robot)]


def rims(obstacle: Obstacle, robot: Robot) -> list[Points]:
    """Lines along the rims of one obstacle, which need not be among those of the robot [m]."""
    mesh = robot.body.mesh
    middle = 0.5 * (mesh.nodes.min(axis=0) + mesh.nodes.max(axis=0))
    return _LINES[ObstacleShape(obstacle.shape)](obstacle, middle, mesh.size)


def _plane(plane: Obstacle, middle: Vector, size: float) -> list[Points]:
    """Line, or a square in space, about the point under the middle of the body."""
    unit = np.array(plane.normal or ()) / np.linalg.norm(plane.normal or ())
    foot, across = middle - ((middle - np.array(plane.at)) @ unit) * unit, _across(unit)
    if len(across) == 1:
        return [foot + 0.75 * size * np.array([[-1.0], [1.0]]) * across[0]]
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    return [foot + 0.75 * size * corners @ across]


def _sphere(sphere: Obstacle, _: Vector, __: float) -> list[Points]:
    at, radius = np.array(sphere.at), sphere.radius or 0.0
    axes = np.eye(len(at))
    planes = [(0, 1)] if len(at) == 2 else [(0, 1), (1, 2), (2, 0)]
    return [at + radius * (np.outer(np.cos(ROUND), axes[a]) + np.outer(np.sin(ROUND), axes[b])) for a, b in planes]


def _rod(rod: Obstacle, _: Vector, __: float) -> list[Points]:
    """Capsule in the plane, its ends included; in space the rings at both ends of a rod and lines between them."""
    at, to, radius = np.array(rod.at), np.array(rod.to), rod.radius or 0.0
    axis = (to - at) / np.linalg.norm(to - at)
    across = _across(axis)
    if len(at) == 2:
        half = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 25)
        cap = np.outer(np.cos(half), axis) + np.outer(np.sin(half), across[0])
        rim = np.concatenate([to + radius * cap, at - radius * cap])
        return [np.concatenate([rim, rim[:1]])]
    ring = radius * (np.outer(np.cos(ROUND), across[0]) + np.outer(np.sin(ROUND), across[1]))
    sides = [np.array([at, to]) + ring[place] for place in range(0, 48, 12)]
    if rod.shape == ObstacleShape.CYLINDER:
        return [at + ring, to + ring, *sides]
    half = np.linspace(0.0, np.pi, 25)
    caps = [
        end + radius * (np.outer(np.cos(half), one) + np.outer(np.sin(half), way))
        for end, way in ((at, -axis), (to, axis))
        for one in across
    ]
    return [at + ring, to + ring, *sides, *caps]


def _box(box: Obstacle, _: Vector, __: float) -> list[Points]:
    at, to = np.array(box.at), np.array(box.to)
    corners = np.array(list(np.ndindex(*[2] * len(at))))
    if len(at) == 2:
        return [at + corners[[0, 1, 3, 2, 0]] * (to - at)]
    pairs = [(i, j) for i in range(8) for j in range(i) if np.abs(corners[i] - corners[j]).sum() == 1]
    return [at + corners[list(pair)] * (to - at) for pair in pairs]


def _mesh(obstacle: Obstacle, _: Vector, __: float) -> list[Points]:
    """Cuts by three planes through its middle."""
    assert obstacle.mesh is not None
    corners = (obstacle.mesh.surface.vertices + np.array(obstacle.at))[obstacle.mesh.surface.triangles]
    middle, lines = obstacle.frame()[0], []
    for axis in range(3):
        heights = corners[:, :, axis] - middle[axis]
        cut = (heights.min(axis=1) < 0) & (heights.max(axis=1) >= 0)
        for triangle, height in zip(corners[cut], heights[cut], strict=True):
            ends = []
            for a, b in ((0, 1), (1, 2), (2, 0)):
                if (height[a] < 0) != (height[b] < 0):
                    ends.append(triangle[a] + height[a] / (height[a] - height[b]) * (triangle[b] - triangle[a]))
            lines.append(np.array(ends))
    return lines


def _across(normal: Vector) -> Points:
    """Unit vectors across a direction, (dim - 1, dim)."""
    unit = normal / np.linalg.norm(normal)
    if len(unit) == 2:
        return np.array([[-unit[1], unit[0]]])
    first = np.cross(unit, np.eye(3)[int(np.argmin(np.abs(unit)))])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(unit, first)])


_LINES: dict[ObstacleShape, Callable[[Obstacle, Vector, float], list[Points]]] = {
    ObstacleShape.PLANE: _plane,
    ObstacleShape.SPHERE: _sphere,
    ObstacleShape.CAPSULE: _rod,
    ObstacleShape.CYLINDER: _rod,
    ObstacleShape.BOX: _box,
    ObstacleShape.MESH: _mesh,
}
