"""`with_body_parts`: a robot with other regions of another material; the fields of such a region."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from hydrostat import units
from hydrostat.given import Point
from hydrostat.robot import Body, BodyPart, Robot, Source, fit_winch_bodies, get_material

RIGID = "rigid"  # material of a part that does not deform, for people
PLA = 1240.0  # mass density of printed parts [kg/m^3]


def read_body_again(robot: Robot, *, element_size: float | None = None) -> Body:
    """The body of a robot without parts, meshed from its file, with other elements if so asked [m]; may take a while.

    A number out of range is an InputError.
    """
    body, factor = robot.body, float(units.unit_factor(robot.length_unit, units.LENGTH))
    given: dict[str, Any] = {"material": body.material, "size": body.size, "volume": body.volume}
    meshed: dict[str, Any] = given | {"file": body.file, "element_size": element_size or body.element_size}
    if not body.content:  # made by a program
        return body.with_parts(())
    if body.source is Source.MESH:
        with TemporaryDirectory() as folder:
            path = Path(folder) / body.file
            path.write_bytes(body.content)
            made = Body.from_mesh(path, unit=factor, thickness=body.thickness, **given)
    elif body.source is Source.SURFACE:
        made = Body.from_surface(body.content, unit=factor, **meshed)
    else:
        reading = {"inner": body.inner, "drawing_part": body.drawing_part}
        made = Body.from_outline(body.content, thickness=body.thickness or 0.0, **reading, **meshed)
    return replace(made, plane=body.plane, grading=body.grading)


def with_body_parts(robot: Robot, parts: Iterable[BodyPart]) -> Robot:
    """The same robot with these regions beside the units of its winches (InputError: one does not fit)."""
    body = read_body_again(robot).with_parts(parts).with_elements(robot.body.elements)
    return fit_winch_bodies(replace(robot, body=body))


def own_parts(body: Body) -> tuple[BodyPart, ...]:
    """Regions of a body that are not units of its winches; these come after them."""
    return tuple(part for part in body.parts if not part.winch)


def fill(filling: str) -> dict[str, Any]:
    """Fields of a part of a material of the table, or of a rigid one."""
    rigid = filling == RIGID
    return {"material": None if rigid else get_material(filling), "density": PLA if rigid else None}


def filling_of(part: BodyPart) -> str:
    """Name of its material, or that it is rigid."""
    return RIGID if part.material is None else part.material.name or "custom"


def middle_of(part: BodyPart, dim: int) -> Point | None:
    """Middle of a region [m] in a body; None for one that has none, or that goes through all of a body in space."""
    corners = [point for point in (part.at, part.to, *part.points) if point is not None]
    return tuple(np.mean(corners, axis=0).tolist()) if corners and part.dim == dim else None


def move_body_part(part: BodyPart, before: Point, after: Point) -> BodyPart:
    """Return a region whose middle goes from one place to another [m]."""
    way = np.subtract(after, before)
    return part.with_transform(lambda point: round_place(np.add(point, way).tolist()))


def round_place(point: Iterable[float]) -> Point:
    """A place in whole tenths of a millimeter."""
    return tuple(round(float(value), 4) + 0.0 for value in point)
