"""`sketch_robot`: a first robot from nothing but a drawing, to be edited from there."""

from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np
import shapely

from hydrostat.arrays import Int, Nodes, Points, Vector
from hydrostat.errors import InputError
from hydrostat.geometry import Inner, Outline, read_drawing, size_for, triangulate
from hydrostat.robot.body import Body
from hydrostat.robot.element_kind import ElementKind, Plane
from hydrostat.robot.limb_tips import find_limb_tips, measure_geodesics, name_tips
from hydrostat.robot.marker import Marker, PoseTarget
from hydrostat.robot.materials import get_material
from hydrostat.robot.mirror import find_mirror, mirror_points
from hydrostat.robot.pin import Pin
from hydrostat.robot.risks.body_risks import LOCKING_POISSON, MIN_ELEMENTS_ACROSS, MIN_QUADRATIC
from hydrostat.robot.robot import Robot

MIN_LINEAR_ELEMENTS = 6
"""A limb with fewer linear elements across bends 5 % too little or worse, whatever its Poisson's ratio."""


def is_slender(body: Body) -> bool:
    """Return True if linear elements bend a limb too little: it has few across, or they lock."""
    return body.material.poisson >= LOCKING_POISSON or bool(body.measured_thickness.thin_parts(MIN_LINEAR_ELEMENTS))


PLANE_STRAIN_RATIO = 2.0
"""Thickness over width from which plane strain is chosen: a bar of that pulls 20 % harder in plane stress than in space
at Poisson's ratio 0.45, and 48 % harder in plane strain, so that much thicker ones alone would be nearer to it."""


def choose_plane(body: Body) -> Plane:
    """Plane stress for a flat body that is at most twice as thick as it is wide (median), else plane strain."""
    width, _ = body.measured_thickness.part(0.5)
    return Plane.STRESS if body.thickness is not None and body.thickness <= PLANE_STRAIN_RATIO * width else Plane.STRAIN


def finer_size(body: Body, most: int) -> float | None:
    """Element size [m] with which limbs should have enough elements across.

    None where they have, where the body is a ready mesh, or where it would have more nodes than `most`.
    """
    dim = body.mesh.dim
    least = MIN_ELEMENTS_ACROSS[dim] if body.mesh.quadratic is None else 2 * MIN_QUADRATIC
    parts = body.measured_thickness.thin_parts(least) if body.element_size else []
    if not parts or body.element_size is None:
        return None
    few = min(part.across for part in parts)
    spare = 1.15  # as meshes differ, so much more than is needed is aimed at
    size = body.element_size * max(few / (spare * least), 0.5)
    nodes = len(body.mesh.nodes) * (body.element_size / size) ** dim
    return size if nodes <= most else None


def sketch_robot(
    content: bytes,
    *,
    file: str,
    name: str,
    size: float | None = None,
    element_size: float | None = None,
    thickness: float | None = None,
    nodes: int | None = None,
    material: str = "polyester fibre",
    inner: Inner = Inner.HOLES,
    drawing_part: int | None = None,
) -> Robot:
    """Robot from the bytes of a drawing (SVG, DXF, PNG, JPG), with sensible numbers where none are given.

    A body with slender limbs gets quadratic elements. One at most twice as thick as wide is in plane stress.
    It is held round its deepest point. The tip of each limb is a marker, named by its place ("upper left"), or "tip" if
    there is one. A pose bends the longest limb sideways; the other tips stay. In a drawing that is its own mirror image
    markers stand on the mirror line or in pairs, and limbs in pairs bend together. Everything is meant to be changed.

    Args:
        content: the drawing.
        file: name of the drawing in the robot's folder; its ending says of what kind it is.
        name: name of the robot.
        size: longest side of the bounding box [m]; None: as the drawing says, if it does.
        element_size: [m]; None: so that there are about as many nodes as asked for.
        thickness: [m]; None: a seventh of the size.
        nodes: wanted; None: about 250, 500 in quadratic elements, or as many as give each limb enough elements across;
            not used with an element size.
        material: a name from the table.
        inner: meaning of shapes in the body: holes, or lines drawn on it.
        drawing_part: number of the closed shape that is the body, the largest area is 1; None: chosen.

    Raises:
        InputError: the drawing is no body.
    """
    from shapely import Point as ShapelyPoint
    from shapely import maximum_inscribed_circle

    drawing = read_drawing(content, name=file, size=size, inner=inner, part=drawing_part)
    outline, drawing_part = drawing.outline, drawing.part if drawing.part > 1 else None
    asked, reading = bool(element_size or nodes), {"size": size, "inner": inner, "drawing_part": drawing_part}
    make = partial(Body.from_outline, content, file=file, material=get_material(material), **reading)
    length = element_size or _element_size(outline, nodes)
    body = make(element_size=length, thickness=thickness or _round(outline.size / 7))
    kind = ElementKind.QUADRATIC if is_slender(body) else ElementKind.LINEAR

    def refine(length: float) -> Body:
        return make(element_size=length, thickness=body.thickness or 0.0).with_elements(kind)

    if kind is ElementKind.QUADRATIC:
        body = refine(element_size or _quadratic_size(outline, nodes))
    most_nodes = 2000  # A sketch gets no more nodes than this for the sake of its thin limbs
    while not asked and (finer := finer_size(body, most_nodes)) is not None:
        if _round(finer) >= (body.element_size or 0.0):
            break
        body = refine(_round(finer))
    body = replace(body, plane=choose_plane(body))
    as_fine = 2**-0.5 if kind is ElementKind.QUADRATIC else 1.0
    spacing = as_fine * (body.element_size or 0.0)  # of linear elements in place of these
    center = np.array(maximum_inscribed_circle(outline.polygon).coords[0])
    axis = find_mirror(body)
    center = center if axis is None else _on_mirror(axis, outline, center)
    depth = outline.polygon.boundary.distance(ShapelyPoint(center))
    pin = Pin(at=_point(center), radius=_round(max(0.4 * depth, 1.3 * spacing)))
    pin = move_off_drawings(pin, body, outline.polygon, axis)
    tips, twins = _find_tips(body, pin, center, 2.5 * spacing, axis)
    names = name_tips(body.mesh, tips)
    return Robot(
        name=name,
        body=body,
        pins=(pin,),
        markers=tuple(Marker(name=tip, at=_point(at)) for tip, at in zip(names, tips, strict=True)),
        poses={"bend": PoseTarget(name="bend", targets=_bend_limb(names, tips, twins, center))},
    )


def _on_mirror(axis: int, outline: Outline, center: Vector) -> Vector:
    """A deepest place of a drawing [m], on its mirror line, where an axis is 0, if that is nearly as deep."""
    from shapely import Point as ShapelyPoint

    moved = center.copy()
    moved[axis] = 0.0
    here, there = (outline.polygon.boundary.distance(ShapelyPoint(place)) for place in (center, moved))
    return moved if outline.polygon.contains(ShapelyPoint(moved)) and there >= _AS_DEEP * here else center


def _find_tips(
    body: Body, pin: Pin, center: Vector, near: float, axis: int | None
) -> tuple[Points, Int[np.ndarray, " tips"]]:
    """Tips of limbs, the longest first [m], on the mirror line or in pairs if there is one; number of each one's twin.

    Tips are nodes within a distance of the ends of limbs.
    """
    corners = body.mesh.elements if body.mesh.quadratic is None else body.mesh.quadratic[:, :3]
    within = np.setdiff1d(corners, body.mesh.boundary_nodes)
    insides = body.mesh.nodes[within], body.mesh.nodes[corners].mean(axis=1)
    ends = find_limb_tips(body.mesh, measure_geodesics(body.mesh, pin.holds(body.mesh))[0])
    tips = np.array([_inner_tip(insides, body.mesh.nodes[end], center, near) for end in ends])
    if axis is None:
        return tips, np.arange(len(tips))
    return mirror_points(
        tips, axis, near=_TWIN_DISTANCE * body.mesh.size, holds=lambda place: body.distances(place[None])[0] <= 0
    )


def _inner_tip(insides: tuple[Nodes, Nodes], end: Vector, center: Vector, near: float) -> Vector:
    """Inner node about the end of a limb that is farthest from the center; a middle of an element if none is near."""
    for within in insides:
        chosen = within[np.linalg.norm(within - end, axis=1) <= near]
        if len(chosen):
            break
    else:
        chosen = insides[1]
    return chosen[np.argmax(np.linalg.norm(chosen - center, axis=1))]


def _bend_limb(
    names: list[str], tips: Points, twins: Int[np.ndarray, " tips"], center: Vector
) -> dict[str, tuple[float, ...]]:
    """Targets that bend the longest limb, or a pair that is nearly as long away from the mirror line; other tips stay.

    The limbs of a pair stand well apart, seen from a center on the mirror line: lobes of one fin do not bend apart.

    Args:
        names: a name for each tip.
        tips: ends of the limbs, the longest first [m].
        twins: number of the mirror image of each tip.
        center: place about which limbs turn [m].
    """
    arms, around = (tips - center) @ [1, 1j], complex(*center)
    apart = np.abs(np.angle(arms / arms[twins]))  # of a pair, seen from the center: 0 on the mirror line
    level = np.isclose(np.abs(arms), np.abs(arms[twins]), rtol=0.05)  # the center is on the line
    paired = np.round(np.abs(arms) * ((apart > 2 * _BESIDE) & level), 4)
    has_pair, first = paired.max() >= _PAIR_LENGTH * abs(arms[0]), int(np.argmax(paired))
    bent = [first, int(twins[first])] if has_pair else [0, 0]
    first = bent[0]
    across = tips[first] - tips[bent[1]]
    outward = -1 if (np.conj(across @ [1, 1j]) * 1j * arms[first]).real < 0 else 1
    turned = around + 0.96 * arms[first] * np.exp(1j * _BEND * outward)
    place = np.array([turned.real, turned.imag])
    targets = {names[bent[1]]: place * np.where(across == 0, 1.0, -1.0), names[first]: place}
    beside = np.abs(np.angle(arms[:, None] / arms[bent])).min(axis=1) <= _BESIDE
    targets |= {name: place for name, place, moves in zip(names, tips, beside, strict=True) if not moves}
    return {name: _point(place) for name, place in targets.items()}


_TWIN_DISTANCE = 0.1  # of one tip from the image of its twin, as a share of the body's size
_AS_DEEP = 0.95  # share of the largest depth from which on a pin stands on the mirror line
_PAIR_LENGTH = 2 / 3  # share of the longest limb's length from which on a pair of limbs is bent instead
_BESIDE = 0.7  # angle from a bent limb up to which a tip moves as well, as lobes of a fin do [rad]
_BEND = 0.3  # turn of the first pose about the pin [rad]: at 0.5 a fish with a narrow tail passes through itself


def _element_size(outline: Outline, nodes: int | None) -> float:
    if nodes is None:
        return _round(float(np.sqrt(outline.area / 215)))
    rim = outline.polygon.length
    return size_for(nodes, lambda trial: triangulate(outline, trial), content=outline.area, rim=rim, dim=2)


def _quadratic_size(outline: Outline, nodes: int | None) -> float:
    """Return the size of quadratic elements [m]: they follow a curved outline less well, so twice the nodes."""
    if nodes is None:
        return _round(2**0.5 * _element_size(outline, None))
    with suppress(InputError):  # a body so thin needs more elements
        return _element_size(outline, max(nodes // 3, 10))
    return _element_size(outline, nodes)


def _round(length: float) -> float:
    """Length rounded to half a millimeter, at least that."""
    return max(round(length * 2000), 1) / 2000


def _point(place: np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(value), 4) for value in place)


_COVERABLE_SIZE = 0.3
"""Size of a drawn shape, as a share of the body's, from which on a pin may cover it, such as a belly."""


def move_off_drawings(pin: Pin, body: Body, outline: shapely.Polygon, axis: int | None = None) -> Pin:
    """Return a pin at the nearest place in the body where it covers no small drawn shape; itself if there is none.

    A pin on the mirror line, where an axis is 0, stays on it if there is room.
    """
    hulls = [shapely.LineString(line).convex_hull for line in body.marks]
    sizes = [max(hull.bounds[2] - hull.bounds[0], hull.bounds[3] - hull.bounds[1]) for hull in hulls]
    limit = _COVERABLE_SIZE * body.mesh.size
    small = shapely.union_all([hull for hull, size in zip(hulls, sizes, strict=True) if size < limit])
    if pin.at is None or small.is_empty or shapely.Point(pin.at).distance(small) >= pin.radius:
        return pin
    reach = pin.radius * np.arange(0.25, 8.1, 0.25)
    turns = np.linspace(0.0, 2 * np.pi, 48, endpoint=False)
    away = (reach[:, None, None] * np.stack([np.cos(turns), np.sin(turns)], axis=-1)).reshape(-1, 2)
    places = np.round(np.array(pin.at) + away, 3)  # whole millimeters
    points = shapely.points(places)
    shapely.prepare(outline)
    room = np.where(shapely.contains(outline, points), shapely.distance(outline.boundary, points), 0.0)
    fits = (room >= pin.radius) & (shapely.distance(small, points) >= pin.radius)
    if not fits.any():
        return pin
    on_line = fits & (places[:, axis or 0] == 0)
    if axis is not None and pin.at[axis] == 0 and on_line.any():
        fits = on_line
    x, y = places[np.argmax(fits)].tolist()
    return replace(pin, at=(x, y))
