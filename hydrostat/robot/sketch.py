"""`sketch_robot`: a first robot from nothing but a drawing, to be edited from there."""

from functools import partial

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.geometry import Inner, Outline, read_drawing, size_for, triangulate
from hydrostat.robot.body import Body
from hydrostat.robot.limb_tips import find_limb_tips, measure_geodesics, name_tips
from hydrostat.robot.marker import Marker, PoseTarget
from hydrostat.robot.materials import get_material
from hydrostat.robot.pin import Pin
from hydrostat.robot.risks.body_risks import LEAST_ACROSS
from hydrostat.robot.robot import Robot


def finer_size(body: Body, most: int) -> float | None:
    """Element size [m] with which limbs should have enough elements across.

    None where they have, where the body is a ready mesh, or where it would have more nodes than `most`.
    """
    least, dim = LEAST_ACROSS[body.mesh.dim], body.mesh.dim
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

    It is held round its deepest point. The tip of each limb is a marker, named by its place ("upper left"), or "tip" if
    there is one. A pose bends the longest limb sideways; the other tips stay. Everything is meant to be changed.

    Args:
        content: the drawing.
        file: name of the drawing in the robot's folder; its ending says of what kind it is.
        name: name of the robot.
        size: longest side of the bounding box [m]; None: as the drawing says, if it does.
        element_size: [m]; None: so that there are about as many nodes as asked for.
        thickness: [m]; None: a seventh of the size.
        nodes: wanted; None: about 250, or as many as give each limb enough elements across; not used with an element
            size.
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
    length, asked = element_size or _element_size(outline, nodes), bool(element_size or nodes)
    reading = {"size": size, "inner": inner, "drawing_part": drawing_part}
    make = partial(Body.from_outline, content, file=file, material=get_material(material), **reading)
    body = make(element_size=length, thickness=thickness or _round(outline.size / 7))
    most_nodes = 2000  # A sketch gets no more nodes than this for the sake of its thin limbs
    while not asked and (finer := finer_size(body, most_nodes)) is not None:
        if _round(finer) >= length:
            break
        length = _round(finer)
        body = make(element_size=length, thickness=body.thickness or 0.0)
    center = np.array(maximum_inscribed_circle(outline.polygon).coords[0])
    depth = outline.polygon.boundary.distance(ShapelyPoint(center))
    pin = Pin(at=_point(center), radius=_round(max(0.4 * depth, 1.3 * (body.element_size or 0.0))))
    away, _ = measure_geodesics(body.mesh, pin.holds(body.mesh))
    within = body.mesh.nodes[np.setdiff1d(np.arange(len(body.mesh.nodes)), body.mesh.boundary_nodes)]
    ends = body.mesh.nodes[find_limb_tips(body.mesh, away)]
    tips = np.array([_inner_tip(within, end, center, 2.5 * (body.element_size or 0.0)) for end in ends])
    names = name_tips(body.mesh, tips)
    arms = tips - center
    turned = center + 0.96 * (np.cos(_BEND) * arms[0] + np.sin(_BEND) * np.array([-arms[0, 1], arms[0, 0]]))
    others = np.abs(np.angle(arms @ [1, 1j] / (arms[0] @ [1, 1j]))) > 0.7  # a tip beside moves as well: lobes of a fin
    targets = {names[0]: _point(turned)} | {names[other]: _point(tips[other]) for other in np.flatnonzero(others)}
    return Robot(
        name=name,
        body=body,
        pins=(pin,),
        markers=tuple(Marker(name=tip, at=_point(at)) for tip, at in zip(names, tips, strict=True)),
        poses={"bend": PoseTarget(name="bend", targets=targets)},
    )


def _inner_tip(within: Nodes, end: Vector, center: Vector, near: float) -> Vector:
    """Inner node about the end of a limb that is farthest from the center."""
    away = np.linalg.norm(within - end, axis=1)
    chosen = within[away <= max(near, float(away.min()))]
    return chosen[np.argmax(np.linalg.norm(chosen - center, axis=1))]


_BEND = 0.3  # turn of the first pose about the pin [rad]: at 0.5 a fish with a narrow tail passes through itself


def _element_size(outline: Outline, nodes: int | None) -> float:
    if nodes is None:
        return _round(float(np.sqrt(outline.area / 215)))
    rim = outline.polygon.length
    return size_for(nodes, lambda trial: triangulate(outline, trial), content=outline.area, rim=rim, dim=2)


def _round(length: float) -> float:
    """Length rounded to half a millimeter, at least that."""
    return max(round(length * 2000), 1) / 2000


def _point(place: np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(value), 4) for value in place)
