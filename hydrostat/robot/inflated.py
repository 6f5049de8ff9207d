"""`inflated_robot`: a flat robot as the plush body that it becomes once it is filled, its cables on a face."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import InputError
from hydrostat.given import MAX_NAME, Point
from hydrostat.robot.body import Body
from hydrostat.robot.body_cache import Arrays, keep_body
from hydrostat.robot.cable import Cable
from hydrostat.robot.cable_side import CableSide
from hydrostat.robot.load import Load
from hydrostat.robot.pin import Pin
from hydrostat.robot.pin_drive import PinDrive
from hydrostat.robot.robot import Robot
from hydrostat.robot.sheet import SheetSide


def sewn_robot(robot: Robot) -> Robot:
    """Return the flat robot with each cable as often as it is sewn: in pairs, all front cables, then all back ones.

    Both of a pair are as stiff as the one that is drawn. A robot whose cables are no pairs is given back as it is.
    """
    if robot.face is not CableSide.PAIRS:
        return robot
    sewn = tuple(
        replace(cable, name=side_name(cable, side)) for side in CableSide.PAIRS.sides for cable in robot.cables
    )
    return replace(robot, cables=sewn, face=None)


def sewn_sides(robot: Robot) -> tuple[str, ...]:
    """Panels on which the cables of a flat plush robot are sewn: the front where it does not say, or cannot be."""
    return (robot.face.sides if robot.face else ()) or CableSide.FRONT.sides


def side_name(cable: Cable, side: str) -> str:
    """Such as "left 1 back"; nothing, so that a robot gives it one, where that is longer than a name may be."""
    name = f"{cable.name} {side}"
    return name if len(name) <= MAX_NAME else ""


def describe_cable_side(robot: Robot) -> str:
    """Describe the side of a flat robot's cables, such as "on the front"; empty in space or without cables."""
    if robot.body.mesh.dim != 2 or not robot.cables:
        return ""
    return _UNSAID if robot.face is None else robot.face.words


_UNSAID = 'side not set: a plush kit uses the front panel. Set face = "pairs" above [body] to use both panels'


def inflated_robot(robot: Robot, face: CableSide | str | None = None, *, element_size: float | None = None) -> Robot:
    """Return the 3D robot of a flat one: its outline inflated to its thickness, its cables on one side.

    Winches and markers stay in the plane z = 0; so a cable leaves its winch inside the body and comes to the skin at
    its first via point. A pair is two cables of one winch, each as stiff as the one that is drawn. Poses get z = 0.

    Args:
        robot: flat, with an outline.
        face: side on which its cables run; None: the robot's own, or else the front.
        element_size: size of the tetrahedra [m]; None: that of the flat mesh.

    Raises:
        InputError: a robot in space, one without a drawing, or a body too thick for its outline.
    """
    face = CableSide(face or robot.face or CableSide.FRONT)
    body = _blown_up(robot.body, element_size)
    flat = robot.gravity
    loads = tuple(_lift_load(load) for load in robot.loads if load.pressure is None)  # its holes are open now
    scaled = {load.drive for load in loads}
    return replace(
        robot,
        body=body,
        pins=tuple(_pin(pin, float(robot.body.thickness or 0.0)) for pin in robot.pins),
        winches=tuple(replace(winch, at=_raise_place(winch.at)) for winch in robot.winches),
        cables=tuple(lifted for cable in robot.cables for lifted in _lift_cable(cable, face, body)),
        markers=tuple(replace(marker, at=_raise_place(marker.at)) for marker in robot.markers),
        poses={
            name: replace(pose, targets={marker: _raise_place(place) for marker, place in pose.targets.items()})
            for name, pose in robot.poses.items()
        },
        gravity=None if flat is None else (*flat, 0.0),
        face=None,
        obstacles=(),
        loads=loads,
        drives=tuple(drive for drive in robot.drives if isinstance(drive, PinDrive) or drive.name in scaled),
        sensors=(),  # their faces and the sides to which they bend are those of a flat body
        sheets=tuple(
            replace(sheet, on=SheetSide.SKIN) for sheet in robot.sheets if sheet.on is not SheetSide.OUTLINE
        ),  # its outline is a seam now
        rods=tuple(replace(rod, points=tuple(map(_raise_place, rod.points))) for rod in robot.rods),
    )


def _blown_up(body: Body, element_size: float | None) -> Body:
    from hydrostat.geometry import Surface, inflate, write_ply

    outline, thickness = body.outline, body.thickness
    if outline is None or thickness is None:
        raise InputError("only a flat robot with a drawing can be inflated")
    spacing = outline.size / 80

    def make() -> Arrays:
        surface = inflate(outline, thickness, spacing=spacing)
        return {"vertices": surface.vertices, "triangles": surface.triangles}

    counts = [len(ring) for ring in outline.rings]
    content = b"".join(ring.tobytes() for ring in outline.rings)
    kept = keep_body(("inflated", counts, thickness, spacing), content, make)
    inflated = Body.from_surface(
        write_ply(Surface(kept["vertices"], kept["triangles"])),
        file="inflated.ply",
        unit=1e-3,
        material=body.material,
        element_size=element_size or body.element_size or body.mesh.size / 25,
        volume=body.volume,
    )
    return replace(inflated, grading=body.grading).with_parts(body.parts).with_elements(body.elements)


def _skin(body: Body, places: Points, side: float) -> Vector:
    """Height of the skin over points of the plane, on the side of +z or -z, a little inside [m]."""
    low, high = np.zeros(len(places)), np.full(len(places), float(np.abs(body.mesh.nodes[:, 2]).max()))
    halvings = 14  # of the height, so that it is within a hundredth of a millimeter
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        outside = body.distances(np.column_stack([places, side * middle])) > 0
        high, low = np.where(outside, middle, high), np.where(outside, low, middle)
    return side * low


def _lift_cable(cable: Cable, face: CableSide, body: Body) -> Iterator[Cable]:
    """Cable on its face, all but its first point, which is its winch's; twice for pairs."""
    points = np.array(cable.points)
    for name, side in _HEIGHTS[face]:
        lift = _skin(body, points, side)
        lift[0] = 0.0
        lifted = tuple(map(tuple, np.column_stack([points, lift]).tolist()))
        yield replace(cable, points=lifted, name=side_name(cable, name) if name else cable.name)


_HEIGHTS = {
    CableSide.FRONT: (("", 1.0),),
    CableSide.BACK: (("", -1.0),),
    CableSide.PAIRS: (("front", 1.0), ("back", -1.0)),
    CableSide.MIDDLE: (("", 0.0),),
}


def _lift_load(load: Load) -> Load:
    at = None if load.at is None else _raise_place(load.at)
    moment = None if load.moment is None else (0.0, 0.0, *load.moment)
    return replace(load, at=at, force=None if load.force is None else (*load.force, 0.0), moment=moment)


def _raise_place(place: Point) -> Point:
    return (*place, 0.0)


def _pin(pin: Pin, thickness: float) -> Pin:
    """Box in space that holds all of the body above and below a pin in the plane."""
    if pin.box is not None:
        low, high = np.min(pin.box, axis=0), np.max(pin.box, axis=0)
    else:
        low, high = np.array(pin.at) - pin.radius, np.array(pin.at) + pin.radius
    if pin.at is not None and pin.radius == 0.0:
        return replace(pin, at=_raise_place(pin.at))
    return replace(pin, at=None, radius=0.0, box=((*map(float, low), -thickness), (*map(float, high), thickness)))
