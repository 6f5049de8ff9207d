"""`thing_surface`: a rigid thing in space as a closed surface, drawn in one image with the body that holds it."""

import numpy as np
from jaxtyping import Int

from hydrostat.arrays import Points
from hydrostat.robot import Obstacle, ObstacleShape

Surface = tuple[Points, Int[np.ndarray, "triangles 3"]]  # places of its corners [m], and triangles seen from outside


def thing_surface(thing: Obstacle) -> Surface:
    """The surface of a thing that has an end, as a hull of points."""
    from scipy.spatial import ConvexHull

    points = _points(thing)
    triangles = ConvexHull(points).simplices
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = (normals * (corners[:, 0] - points.mean(axis=0))).sum(axis=1) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return points, triangles


def _points(thing: Obstacle) -> Points:
    """Points all over it [m]."""
    at, to, radius = np.array(thing.at), np.array(thing.to or thing.at), thing.radius or 0.0
    if thing.shape is ObstacleShape.BOX:
        return at + np.array(list(np.ndindex(2, 2, 2))) * (to - at)
    if thing.shape is ObstacleShape.CYLINDER:
        axes, turns = thing.frame()[1], np.linspace(0.0, 2 * np.pi, 48, endpoint=False)
        ring = radius * (np.outer(np.cos(turns), axes[1]) + np.outer(np.sin(turns), axes[2]))
        return np.concatenate([at + ring, to + ring])
    heights = np.linspace(-1.0, 1.0, _DOTS)
    turns = np.pi * (3 - np.sqrt(5)) * np.arange(_DOTS)  # a spiral by the golden angle covers a sphere evenly
    flat = np.sqrt(1 - heights**2)
    ball = radius * np.column_stack([flat * np.cos(turns), flat * np.sin(turns), heights])
    return at + ball if thing.to is None else np.concatenate([at + ball, to + ball])


_DOTS = 800
"""Points on a sphere."""
