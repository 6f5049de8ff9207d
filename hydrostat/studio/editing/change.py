"""`rename`, `change`, `remesh`: other names and numbers of a robot's parts and of its body."""

from collections.abc import Collection
from dataclasses import replace
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.given import check_name
from hydrostat.robot import Body, Cable, Contact, Mount, Robot, Source, get_material, gravity_along
from hydrostat.studio.editing.body_parts import fill, own_parts, read_body_again, with_body_parts
from hydrostat.studio.editing.part import Kind, find_part

FIELDS = {  # what can be changed of a part
    Kind.REGION: ("filling",),
    Kind.PIN: ("radius", "stiffness"),
    Kind.WINCH: ("spool_radius", "travel", "release", "mount"),
    Kind.CABLE: ("winch", "stiffness", "slack", "friction", "sheathed", "spool_radius"),
}

RANGES = {"radius": (1e-4, 20.0), "spool_radius": (1e-4, 20.0), "travel": (0.0, 20.0), "slack": (0.0, 20.0)}
"""Least and most of each length that a person may ask for [m]."""


def rename(robot: Robot, key: str, name: str) -> Robot:
    """The same robot with another name of a winch, cable or marker, also where it is used (InputError: not allowed)."""
    part = find_part(robot, key)
    check_name(name)
    if part is not None and part.kind is Kind.WINCH:
        before = robot.winches[part.index].name
        winches = tuple(replace(winch, name=name) if winch.name == before else winch for winch in robot.winches)
        _free(name, [winch.name for winch in winches])
        cables = tuple(
            replace(cable, winch=name, name=given) if cable.winch == before else cable
            for cable, given in zip(robot.cables, robot.given_cable_names, strict=True)
        )
        return replace(robot, winches=winches, cables=cables)
    if part is not None and part.kind is Kind.REGION:
        regions = list(own_parts(robot.body))
        regions[part.index] = replace(regions[part.index], name=name)
        return with_body_parts(robot, regions)
    if part is not None and part.kind is Kind.CABLE:
        cables = list(robot.cables)
        cables[part.index] = replace(cables[part.index], name=name)
        _free(name, [cable.name for cable in cables])
        return replace(robot, cables=tuple(cables))
    if part is not None and part.kind is Kind.MARKER:
        before = robot.markers[part.index].name
        markers = tuple(replace(marker, name=name) if marker.name == before else marker for marker in robot.markers)
        _free(name, [marker.name for marker in markers])
        poses = {
            pose.name: replace(
                pose, targets={name if marker == before else marker: at for marker, at in pose.targets.items()}
            )
            for pose in robot.poses.values()
        }
        loads = tuple(replace(load, marker=name) if load.marker == before else load for load in robot.loads)
        return replace(robot, markers=markers, poses=poses, loads=loads)
    raise InputError(f"{key} has no name")


def change(robot: Robot, keys: Collection[str], **values: Any) -> Robot:
    """The same robot with other numbers of some parts, in SI; see `FIELDS` (InputError: no such part or number)."""
    for name, value in values.items():
        if name in RANGES and value is not None:
            check_range(name, value, *RANGES[name])
    pins, winches, cables = list(robot.pins), list(robot.winches), list(robot.cables)
    regions = list(own_parts(robot.body))
    for key in keys:
        part = find_part(robot, key)
        if part is None or not set(values) <= set(FIELDS.get(part.kind, ())):
            raise InputError(f"{key} has no {' or '.join(values)}")
        if part.kind is Kind.REGION:
            regions[part.index] = replace(regions[part.index], **fill(values["filling"]))
            continue
        changed: list[Any] = {Kind.PIN: pins, Kind.WINCH: winches, Kind.CABLE: cables}[part.kind]
        if "winch" in values:  # a name made up of that of the winch before goes with it
            changed[part.index] = replace(changed[part.index], name=robot.given_cable_names[part.index])
        changed[part.index] = replace(changed[part.index], **values)
    if values.get("mount") is Mount.WORLD:  # there its cables begin in the winch itself
        places = {winch.name: winch.at for winch in winches if winch.mount is Mount.WORLD}
        cables = [
            replace(cable, points=(places.get(cable.winch, cable.points[0]), *cable.points[1:])) for cable in cables
        ]
    robot = with_body_parts(robot, regions) if "filling" in values else robot
    return replace(robot, pins=tuple(pins), winches=tuple(winches), cables=tuple(cables))


def set_gravity(robot: Robot, direction: str) -> Robot:
    """The same robot with gravity in a direction such as "-y", "" for none (InputError: no direction of this body)."""
    return replace(robot, gravity=gravity_along(direction, robot.body.mesh.dim) if direction else None)


def set_contact(robot: Robot, *, on: bool) -> Robot:
    """The same robot whose parts pass through one another, or do not."""
    return replace(robot, contact=Contact() if on else None)


def check_range(name: str, value: float, least: float, most: float) -> None:
    """Check a length that a person asks for [m] (InputError: it is out of its range, or no number)."""
    if not least <= value <= most:
        words = name.replace("_", " ")
        raise InputError(f"{words}: must be from {1e3 * least:g} mm to {most:g} m, not {1e3 * value:g} mm")


def _free(name: str, names: list[str]) -> None:
    if names.count(name) > 1:
        raise InputError(f'the name "{name}" is already in use. Choose another name')


def sheathed_segments(cable: Cable) -> list[int]:
    """Numbers of the segments in a sheath, counted from 0 at the winch."""
    return np.flatnonzero(~cable.bare).tolist()


def sheaths(segments: Collection[int]) -> tuple[tuple[int, int], ...]:
    """Pairs of point indices for `Cable.sheathed`; segments in a row are one sheath."""
    pairs: list[tuple[int, int]] = []
    for segment in sorted(set(segments)):
        if pairs and pairs[-1][1] == segment:
            pairs[-1] = (pairs[-1][0], segment + 1)
        else:
            pairs.append((segment, segment + 1))
    return tuple(pairs)


def remesh(
    robot: Robot, *, element_size: float | None = None, thickness: float | None = None, material: str | None = None
) -> Body:
    """The body of a robot, made again; takes a while if the elements are others. What is left out stays.

    The element size is the length of a mesh edge [m], the thickness that of a flat body [m], the material one of the
    table. A number out of its range, an unknown material, or a body whose elements are given is an InputError.
    """
    body = robot.body
    body_range = (1e-4, 20.0)  # least and most thickness and element size that a person may ask for [m]
    for name, value in (("thickness", thickness), ("element_size", element_size)):
        if value is not None:
            check_range(name, value, *body_range)
    if material is not None:
        body = replace(body, material=get_material(material))
    if thickness is not None:
        body = replace(body, thickness=thickness)
    if element_size is None or element_size == body.element_size:
        return body
    if body.source is Source.MESH:
        raise InputError("this body is an imported mesh. Its element size cannot be changed")
    again = read_body_again(replace(robot, body=body), element_size=element_size)
    return again.with_parts(body.parts).with_elements(body.elements)
