"""`read_object`, `place_object`: a grasped object from a text, and its position."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import InputError
from hydrostat.files import read_stranger
from hydrostat.geometry import SURFACE_SUFFIXES, locate
from hydrostat.robot import Obstacle, Robot, closed_mesh, edge_points, rims
from hydrostat.units import LENGTH, parse_quantity, plural, quote

FORMS = ("sphere:65mm", "cylinder:40mm,120mm", "capsule:40mm,120mm", "box:40mm,40mm,60mm", "mug.stl")
"""Forms of an object: a diameter, a diameter and a length along the last axis, the sides, or a surface file in mm."""


def read_object(text: str, dim: int, *, mass: float, friction: float) -> Obstacle:
    """Create an object at the origin from a text, as in `FORMS`.

    Args:
        text: shape and sizes.
        dim: dimension of the body that grasps it; a sphere is a disc in the plane.
        mass: mass [kg].
        friction: Coulomb friction coefficient.

    Raises:
        InputError: an unknown shape, a wrong number of sizes, a size without a length unit, or a size that is not above
            0.
    """
    if text.lower().endswith(SURFACE_SUFFIXES):
        return _from_file(text, dim, mass=mass, friction=friction)
    shape, _, rest = text.partition(":")
    counts = {"sphere": 1, "cylinder": 2, "capsule": 2, "box": dim}
    if shape not in counts:
        raise InputError(f'unknown shape "{shape}". Write e.g. {", ".join(FORMS)}.')
    given = [part.strip() for part in rest.split(",") if part.strip()]
    if len(given) != counts[shape]:
        example = "box:40mm,40mm" if shape == "box" and dim == 2 else FORMS[list(counts).index(shape)]
        raise InputError(f"a {shape} has {plural(counts[shape], 'size')}, not {len(given)}. Write e.g. {example}.")
    sizes = [parse_quantity(part, LENGTH) for part in given]
    if min(sizes) <= 0:
        raise InputError(f"sizes must be above 0, not {quote(rest)}")
    known = {"name": "object", "shape": shape, "mass": mass, "friction": friction}
    if shape == "sphere":
        return Obstacle(**known, at=(0.0,) * dim, radius=0.5 * sizes[0])
    if shape == "box":
        return Obstacle(**known, at=tuple(-0.5 * size for size in sizes), to=tuple(0.5 * size for size in sizes))
    long = sizes[1] - (sizes[0] if shape == "capsule" else 0.0)
    if long <= 0:
        raise InputError("the length of a capsule, its ends included, must be more than its diameter")
    end = 0.5 * long * np.eye(dim)[-1]
    return Obstacle(**known, at=tuple(-end), to=tuple(end), radius=0.5 * sizes[0])


def _from_file(text: str, dim: int, *, mass: float, friction: float) -> Obstacle:
    """Read an object from a surface file in millimeters, with its center at the origin."""
    if dim == 2:
        raise InputError(f"{text}: a flat body meets no mesh; use a sphere, which is a disc in the plane, or a box")
    mesh = closed_mesh(read_stranger(text), Path(text).name)
    return Obstacle(name="object", shape="mesh", at=tuple(-mesh.masses()[1]), mesh=mesh, mass=mass, friction=friction)


def move_object(obstacle: Obstacle, place: Vector) -> Obstacle:
    """Return the same object with its center at a position [m]."""
    shift = np.asarray(place) - obstacle.frame()[0]
    ends = (None if end is None else tuple((np.array(end) + shift).tolist()) for end in (obstacle.at, obstacle.to))
    at, to = ends
    return replace(obstacle, at=at or (), to=to)


def find_overlaps(robot: Robot, obstacle: Obstacle) -> list[str]:
    """Return the names of the robot's obstacles that an object overlaps; a pull has no contact between them."""

    def samples(one: Obstacle) -> Points:
        return np.concatenate([*rims(one, robot), one.spine()])

    return [
        other.name
        for other in robot.obstacles
        if min(other.field()(samples(obstacle)).values.min(), obstacle.field()(samples(other)).values.min()) < 0
    ]


def place_object(robot: Robot, obstacle: Obstacle, closed: Points) -> Obstacle:
    """Place an object between the markers of the closed robot, moved out of the body at rest.

    Args:
        robot: robot; at rest it must not touch the object.
        obstacle: object at any position.
        closed: marker positions in the closed pose [m].

    Raises:
        InputError: no free position nearby.
    """
    mesh, room = robot.body.mesh, 2.0 * robot.contact_distance
    skin, place = mesh.nodes[np.unique(mesh.boundary)], closed.mean(axis=0)
    between = edge_points(mesh, 7)
    trials = 400
    some = 0.25  # Moves in search of a place, and how far each goes, as a share of what is needed
    for _ in range(trials):
        tried = move_object(obstacle, place)
        found = tried.field()(skin)
        lacks = np.maximum(room - found.values, 0.0)
        inside = locate(mesh, tried.spine()).inside.any()
        if not lacks.any() and not inside:
            found = tried.field()(between)  # a small object fits between the nodes of an edge that runs through it
            lacks = np.maximum(0.5 * room - found.values, 0.0) * (found.values <= 0)
            if not lacks.any():
                return tried
        way = -(lacks[:, None] * found.normals).sum(axis=0)
        if inside or not way.any():
            way = place - mesh.nodes.mean(axis=0)
        place = place + (lacks.max() * some + 0.1 * room) * way / max(float(np.linalg.norm(way)), 1e-12)
    raise InputError("no place for the object was found near the markers of the pose; say where by --at")
