"""`inside`, `below_skin`, `tidy`: places in the body for what a pointer asks."""

import numpy as np

from hydrostat.geometry.anchors import locate, nearest_shares
from hydrostat.robot import Point
from hydrostat.robot.body import Body

DIGITS = 4
"""Places are whole tenths of a millimetre: decimals of a metre."""


def inside(body: Body, at: Point) -> Point:
    """A place, or the nearest one in the body [m]."""
    place = tidy(at)
    if _is_in(body, place):
        return place
    asked = np.array([at], dtype=float)
    if _is_in(body, at):
        return at
    held = locate(body.mesh, asked).positions(body.mesh.nodes)[0]
    return tuple(held.tolist())


def below_skin(body: Body, at: Point, depth: float) -> Point:
    """A place at least so deep in a body in space [m], straight below; half as deep and so on where it is too thin."""
    if body.mesh.dim == 2 or depth <= 0:
        return inside(body, at)
    mesh, point = body.mesh, np.array(inside(body, at))
    corners = mesh.nodes[mesh.boundary]
    feet = np.einsum("fc,fcd->fd", nearest_shares(corners, point[None]), corners)
    gaps = np.linalg.norm(feet - point, axis=1)
    facet = int(np.argmin(gaps))
    if gaps[facet] >= depth:
        return inside(body, at)
    away = np.cross(corners[facet, 1] - corners[facet, 0], corners[facet, 2] - corners[facet, 0])
    away /= np.linalg.norm(away)
    inner = mesh.nodes[mesh.elements[mesh.boundary_elements[facet]]].mean(axis=0) - corners[facet, 0]
    away *= np.sign(inner @ away)
    for _ in range(4):
        place = tidy(tuple((feet[facet] + depth * away).tolist()))
        if _is_in(body, place):
            return place
        depth /= 2
    return inside(body, at)


def tidy(at: Point) -> Point:
    """A place in whole tenths of a millimetre."""
    return tuple(round(float(value), DIGITS) + 0.0 for value in at)


def _is_in(body: Body, at: Point) -> bool:
    return not body.distances(np.array([at], dtype=float)).any()
