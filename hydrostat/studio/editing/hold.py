"""`Hold`: what the pointer has taken hold of; `inside`, `below_skin`: places in the body for what it asks."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from hydrostat.geometry import locate, nearest_shares
from hydrostat.given import Point
from hydrostat.robot import Body, Mount, Robot
from hydrostat.studio.editing.part import Kind, Mirror, find_part, place_of
from hydrostat.studio.editing.place import insert_via


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


def find_place(body: Body, at: Point, snap: float, depth: float | None) -> Point:
    """Place in the body [m] for a part that is asked for at a place, on a grid; `depth` as in `below_skin` or None."""
    asked = snap_to_grid(at, snap)
    return inside(body, asked) if depth is None else below_skin(body, asked, depth)


def tidy(at: Point) -> Point:
    """A place in whole tenths of a millimeter."""
    digits = 4  # places are whole tenths of a millimeter: decimals of a meter
    return tuple(round(float(value), digits) + 0.0 for value in at)


def snap_to_grid(at: Point, step: float) -> Point:
    """Return the nearest place whose coordinates are multiples of a step [m]; the place itself for a step of 0."""
    return at if step <= 0 else tuple((step * np.round(np.array(at) / step)).tolist())


def _is_in(body: Body, at: Point) -> bool:
    return not body.distances(np.array([at], dtype=float)).any()


@dataclass(frozen=True, kw_only=True)
class Hold:
    """A part and its twin in the hand, or a cable out of which a via point is about to be drawn."""

    key: str  # of the part
    twin: str = ""  # key of its twin; "": it has none
    mirror: Mirror | None = None  # plane between the two; None: no mirror
    flat: bool = False  # whether the part stays on that plane
    grip: Point = ()  # from the pointer to the middle of the part [m]
    start: Point = ()  # where the pointer took hold [m]

    def places(self, at: Point) -> dict[str, Point]:
        """Places of the parts [m], by key, when the held one goes to a place."""
        if self.mirror is not None and self.flat:
            return {self.key: self.mirror.on_plane(at)}
        if self.mirror is not None and self.twin:
            return {self.key: at, self.twin: self.mirror.point(at)}
        return {self.key: at}

    def goal_at(self, robot: Robot, world: Point, snap: float = 0.0) -> Point:
        """Position [m] that a pointer asks for, on a grid; inside the body, except pins and winches next to it."""
        at = snap_to_grid(tuple((np.array(world) + self.grip).tolist()) if self.grip else world, snap)
        part = find_part(robot, self.key)
        if part is not None and part.kind is Kind.WINCH and robot.winches[part.index].mount is Mount.WORLD:
            return tidy(at)
        return tidy(at) if part is not None and part.kind is Kind.PIN else inside(robot.body, at)

    def drawn_out(self, robot: Robot) -> tuple[Robot, Self]:
        """The robot with the via point drawn out of a held cable, and the hold on it (InputError: none can be)."""
        part = find_part(robot, self.key)
        if part is None or part.kind is not Kind.CABLE:
            return robot, self
        at = inside(robot.body, self.start)
        robot, place = insert_via(robot, part.index, at)
        twin = find_part(robot, self.twin)
        key, other = f"via:{part.index}:{place}", ""
        if twin is not None and self.mirror is not None:
            robot, place = insert_via(robot, twin.index, inside(robot.body, self.mirror.point(at)))
            other = f"via:{twin.index}:{place}"
        return robot, replace(self, key=key, twin=other, grip=())


def take_hold(robot: Robot, key: str, mirror: Mirror | None, world: Point = ()) -> Hold:
    """Hold a part, by a place near its middle or by the middle itself."""
    at = place_of(robot, key)
    twin = None if mirror is None else mirror.twin(robot, key)
    return Hold(
        key=key,
        twin=twin or "",
        mirror=mirror,
        flat=mirror is not None and mirror.holds(robot, key),
        grip=tuple(np.subtract(at, world).tolist()) if at is not None and world else (),
        start=world,
    )
