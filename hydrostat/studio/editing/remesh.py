"""`remesh`: the same body of other elements, thickness or material."""

from dataclasses import replace

from hydrostat import units
from hydrostat.errors import InputError
from hydrostat.robot import Robot, Source, find_material, outline_body
from hydrostat.robot.body import Body, surface_body
from hydrostat.studio.editing.change import check_range

RANGE = (1e-4, 20.0)
"""Least and most thickness and element size that a person may ask for [m]."""


def remesh(
    robot: Robot, *, element_size: float | None = None, thickness: float | None = None, material: str | None = None
) -> Body:
    """The body of a robot, made anew; takes a while if the elements are others.

    Args:
        robot: whose body it is.
        element_size: length of a mesh edge [m]; as it was if left out, as are the others.
        thickness: of a flat body [m].
        material: a name of the table.

    Raises:
        InputError: a number out of its range, an unknown material, or a body whose elements are given.
    """
    body = robot.body
    for name, value in (("thickness", thickness), ("element_size", element_size)):
        if value is not None:
            check_range(name, value, *RANGE)
    if material is not None:
        body = replace(body, material=find_material(material))
    if thickness is not None:
        body = replace(body, thickness=thickness)
    if element_size is None or element_size == body.element_size:
        return body
    if body.source is Source.MESH:
        raise InputError("a ready mesh has its own elements, their size cannot be chosen")
    given = {"file": body.file, "material": body.material, "element_size": element_size, "size": body.size}
    if body.source is Source.SURFACE:
        unit = float(units.unit_factor(robot.length_unit, units.LENGTH))
        return surface_body(body.content, unit=unit, volume=body.volume, **given)
    assert body.thickness is not None
    return outline_body(body.content, thickness=body.thickness, volume=body.volume, **given)
