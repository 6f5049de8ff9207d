"""`scaled_robot`: a robot of another size, with all of its parts where they were on it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.robot.body import Body, Source
from hydrostat.robot.contact import Contact, Obstacle
from hydrostat.robot.marker import PoseTarget
from hydrostat.robot.part import BodyPart
from hydrostat.robot.pin import Pin
from hydrostat.robot.robot import Robot
from hydrostat.robot.winch import Winch
from hydrostat.robot.winch_bodies import fit_winch_bodies


def scaled_robot(robot: Robot, factor: float) -> Robot:
    """Scale every length of a robot: body, elements, thickness, pins, winches, cables, obstacles.

    Also markers, targets of poses, spools, travel, release, slack and the distance of contact. Materials, stiffnesses,
    friction, masses and motors stay: they are those of what is bought.

    Raises:
        InputError: a factor out of its range, an obstacle that is a mesh, or no body of that size.
    """
    least, most = 0.01, 100.0  # No robot is made smaller or larger at once than by these factors
    if isinstance(factor, bool) or not isinstance(factor, int | float) or not least <= factor <= most:
        raise InputError(f"the factor must be from {least:g} to {most:g}, not {factor!r}")
    for each in (*robot.obstacles, *robot.body.parts, *robot.sheets):
        if each.mesh is not None:
            kind = "obstacle" if isinstance(each, Obstacle) else "body.part" if isinstance(each, BodyPart) else "sheet"
            raise InputError(f'{kind} "{each.name}" has the size of its file; scale that in CAD')

    def length(value: float) -> float:
        return float(f"{factor * value:.12g}")

    def point(place: Point) -> Point:
        return tuple(length(value) for value in place)

    def maybe(value: float | None) -> float | None:
        return None if value is None else length(value)

    def scale_pin(pin: Pin) -> Pin:
        box = None if pin.box is None else (point(pin.box[0]), point(pin.box[1]))
        return replace(pin, box=box, at=None if pin.at is None else point(pin.at), radius=length(pin.radius))

    def scale_obstacle(each: Obstacle) -> Obstacle:
        return replace(
            each, at=point(each.at), to=None if each.to is None else point(each.to), radius=maybe(each.radius)
        )

    contact = robot.contact
    own = [part for part in robot.body.parts if not part.winch]
    scaled = replace(
        robot,
        body=_scaled_body(robot, factor, tuple(part.with_transform(point, factor) for part in own)),
        pins=tuple(map(scale_pin, robot.pins)),
        drives=tuple(drive.with_transform(point, length) for drive in robot.drives),
        winches=tuple(_scale_winch(winch, point(winch.at), length) for winch in robot.winches),
        cables=tuple(
            replace(
                cable,
                points=tuple(map(point, cable.points)),
                smoothing=length(cable.smoothing),
                slack=length(cable.slack),
                spool_radius=maybe(cable.spool_radius),
                name=name,
            )
            for cable, name in zip(robot.cables, robot.given_cable_names, strict=True)
        ),
        markers=tuple(replace(marker, at=point(marker.at)) for marker in robot.markers),
        poses={
            name: PoseTarget(name=name, targets={key: point(place) for key, place in pose.targets.items()})
            for name, pose in robot.poses.items()
        },
        obstacles=tuple(map(scale_obstacle, robot.obstacles)),
        rods=tuple(rod.with_transform(point, factor) for rod in robot.rods),
        sheets=tuple(sheet.with_transform(point, factor) for sheet in robot.sheets),
        sensors=tuple(sensor.with_transform(point, length) for sensor in robot.sensors),
        loads=tuple(replace(load, at=None if load.at is None else point(load.at)) for load in robot.loads),
        contact=None if contact is None else Contact(distance=maybe(contact.distance), friction=contact.friction),
    )
    return fit_winch_bodies(scaled)


def _scale_winch(winch: Winch, at: Point, length: Callable[[float], float]) -> Winch:
    lengths = {key: length(getattr(winch, key)) for key in ("spool_radius", "travel", "release")}
    return replace(winch, at=at, **lengths)


def _scaled_body(robot: Robot, factor: float, parts: tuple[BodyPart, ...]) -> Body:
    """Return the scaled body with its scaled parts and the same kind of elements."""
    grading = None if robot.body.grading is None else robot.body.grading.with_scale(factor)
    body = replace(_mesh_scaled(robot, factor), plane=robot.body.plane, grading=grading)
    return body.with_parts(parts).with_elements(robot.body.elements)


def _mesh_scaled(robot: Robot, factor: float) -> Body:
    """Mesh the scaled body without its parts; if its size came from its file alone, it is now stated explicitly."""
    body = robot.body
    size = float(f"{factor * (body.size or _drawn_size(body)):.12g}")
    given = {"material": body.material, "size": size, "volume": body.volume}
    element_size = float(f"{factor * (body.element_size or 0.0):.12g}")
    thickness = None if body.thickness is None else float(f"{factor * body.thickness:.12g}")
    if body.source is Source.OUTLINE:
        return Body.from_outline(
            body.content,
            file=body.file,
            element_size=element_size,
            thickness=thickness or 0.0,
            inner=body.inner,
            drawing_part=body.drawing_part,
            **given,
        )
    unit = float(units.unit_factor(robot.length_unit, units.LENGTH))
    if body.source is Source.SURFACE:
        return Body.from_surface(body.content, file=body.file, unit=unit, element_size=element_size, **given)
    with TemporaryDirectory() as folder:
        path = Path(folder) / body.file
        path.write_bytes(body.content)
        return Body.from_mesh(path, unit=unit, thickness=thickness, **given)


def _drawn_size(body: Body) -> float:
    """Longest side of the bounding box of the file's contents [m]."""
    if body.outline is not None:
        return body.outline.size
    if body.source is Source.SURFACE:
        from hydrostat.geometry import read_surface

        return read_surface(body.content, name=body.file).size
    return body.mesh.size
