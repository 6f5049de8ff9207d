"""`add_pin` and its like, `insert_via`, `move`, `remove`: a robot with other parts, or with parts elsewhere."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

import numpy as np

from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.project import fresh_name
from hydrostat.robot import Cable, Marker, Pin, PoseTarget, Robot, Winch
from hydrostat.studio.editing.body_parts import move_body_part, own_parts, with_body_parts
from hydrostat.studio.editing.part import Kind, Part, find_part, place_of


def add_pin(robot: Robot, at: Point) -> Robot:
    """One more pin, as wide as the last one (InputError: it would hold nothing)."""
    radii = [pin.radius for pin in robot.pins if pin.at is not None]
    pin_share = 0.06  # radius of a robot's first pin as a share of the body
    radius = radii[-1] if radii else round(pin_share * robot.body.mesh.size, 3)
    return replace(robot, pins=(*robot.pins, Pin(at=at, radius=radius)))


def add_marker(robot: Robot, at: Point) -> Robot:
    """One more marker, with a name of its own (InputError: it would lie outside the body)."""
    name = fresh_name("marker", [marker.name for marker in robot.markers])
    return replace(robot, markers=(*robot.markers, Marker(name=name, at=at)))


def add_winch(robot: Robot, at: Point) -> Robot:
    """One more winch, like the last one, with a name of its own (InputError: it would lie outside the body)."""
    name = fresh_name("winch", [winch.name for winch in robot.winches])
    like = robot.winches[-1] if robot.winches else None
    if like is None:
        winch = Winch(name=name, at=at)
    else:
        winch = Winch(name=name, at=at, spool_radius=like.spool_radius, travel=like.travel, release=like.release)
    return replace(robot, winches=(*robot.winches, winch))


def add_cable(robot: Robot, winch: str, points: tuple[Point, ...]) -> Robot:
    """One more cable of a winch, as stiff as the last, through points [m] to its stopper (InputError: not inside)."""
    run = (robot.winch(winch).at, *points)
    cable = Cable(winch=winch, points=run)
    if robot.cables:
        cable = replace(cable, stiffness=robot.cables[-1].stiffness)
    return replace(robot, cables=(*robot.cables, cable))


def insert_via(robot: Robot, index: int, at: Point) -> tuple[Robot, int]:
    """One more via point, in the nearest segment of a cable; with its number (InputError: it is outside the body)."""
    cable = robot.cables[index]
    place = nearest_segment(cable.points, at) + 1
    points = (*cable.points[:place], at, *cable.points[place:])
    sheathed = tuple((start + (start >= place), end + (end >= place)) for start, end in cable.sheathed)
    changed = replace(cable, points=points, sheathed=sheathed)
    return replace(robot, cables=(*robot.cables[:index], changed, *robot.cables[index + 1 :])), place


def nearest_segment(points: tuple[Point, ...], at: Point) -> int:
    """Number of the segment of a line that is nearest to a place."""
    corners = np.stack([np.array(points[:-1]), np.array(points[1:])], axis=1)
    along = corners[:, 1] - corners[:, 0]
    share = np.einsum("sd,sd->s", np.array(at) - corners[:, 0], along) / np.einsum("sd,sd->s", along, along)
    feet = corners[:, 0] + np.clip(share, 0.0, 1.0)[:, None] * along
    return int(np.argmin(np.linalg.norm(feet - np.array(at), axis=1)))


def move(robot: Robot, places: Mapping[str, Point]) -> Robot:
    """The same robot with parts, by key, elsewhere [m]; cables stay at their winches (InputError: not there)."""
    pins, winches, markers = list(robot.pins), list(robot.winches), list(robot.markers)
    points, regions = [list(cable.points) for cable in robot.cables], list(own_parts(robot.body))
    for key, at in places.items():
        part, before = find_part(robot, key), place_of(robot, key)
        if part is None or before is None:
            raise InputError(f"{key} cannot be moved")
        if part.kind is Kind.PIN:
            pins[part.index] = _pin(robot.pins[part.index], before, at)
        elif part.kind is Kind.MARKER:
            markers[part.index] = replace(robot.markers[part.index], at=at)
        elif part.kind is Kind.VIA:
            points[part.index][part.place] = at
        elif part.kind is Kind.REGION:
            regions[part.index] = move_body_part(regions[part.index], before, at)
        else:
            winch = robot.winches[part.index]
            winches[part.index] = replace(winch, at=at)
            for own, cable in zip(points, robot.cables, strict=True):
                if cable.winch == winch.name:
                    own[0] = _along(cable.points[0], before, at)
    moved = replace(
        robot, pins=tuple(pins), winches=tuple(winches), cables=_rerun(robot.cables, points), markers=tuple(markers)
    )
    return moved if tuple(regions) == own_parts(robot.body) else with_body_parts(moved, regions)


def _pin(pin: Pin, before: Point, at: Point) -> Pin:
    if pin.box is None:
        return replace(pin, at=at)
    return replace(pin, box=tuple(_along(corner, before, at) for corner in pin.box))


def _along(point: Point, before: Point, at: Point) -> Point:
    """A point that goes along with what it is at."""
    return at if point == before else tuple((np.array(point) + np.subtract(at, before)).tolist())


def _rerun(cables: Iterable[Cable], points: Iterable[Iterable[Point]]) -> tuple[Cable, ...]:
    runs = [tuple(own) for own in points]
    return tuple(
        cable if cable.points == run else replace(cable, points=run) for cable, run in zip(cables, runs, strict=True)
    )


def remove(robot: Robot, keys: Collection[str]) -> Robot:
    """The same robot without parts, a winch's cables, a marker's targets and loads (InputError: no such part)."""
    gone: dict[Kind, set[int]] = {kind: set() for kind in Kind}
    vias: dict[int, set[int]] = {}
    for key in keys:
        part = _find(robot, key)
        if part.kind is Kind.VIA:
            vias.setdefault(part.index, set()).add(part.place)
        gone[part.kind].add(part.index)
    if len(gone[Kind.PIN]) == len(robot.pins):
        raise InputError("the last pin cannot be deleted: the body would be unconstrained. Place another pin first")
    winches = tuple(winch for index, winch in enumerate(robot.winches) if index not in gone[Kind.WINCH])
    names = {winch.name for winch in winches}
    markers = tuple(marker for index, marker in enumerate(robot.markers) if index not in gone[Kind.MARKER])
    if gone[Kind.REGION]:
        kept = [part for index, part in enumerate(own_parts(robot.body)) if index not in gone[Kind.REGION]]
        robot = with_body_parts(robot, kept)
    return replace(
        robot,
        pins=tuple(pin for index, pin in enumerate(robot.pins) if index not in gone[Kind.PIN]),
        winches=winches,
        cables=tuple(
            _without_points(index, cable, vias.get(index, set()))
            for index, cable in enumerate(robot.cables)
            if index not in gone[Kind.CABLE] and cable.winch in names
        ),
        markers=markers,
        poses=_poses(robot, {marker.name for marker in markers}),
        loads=tuple(load for load in robot.loads if load.marker in {None, *(marker.name for marker in markers)}),
    )


def _find(robot: Robot, key: str) -> Part:
    part = find_part(robot, key)
    if part is None:
        raise InputError(f"unknown part {key}")
    return part


def _without_points(index: int, cable: Cable, places: Collection[int]) -> Cable:
    """A cable without some of its points; the one before a lost stopper becomes the stopper."""
    if not places:
        return cable
    kept = [place for place in range(len(cable.points)) if place not in places]
    if len(kept) < 2:
        raise InputError(f"cable {index + 1} needs a winch and a stopper. Delete the whole cable instead")
    sheaths = []
    for start, end in cable.sheathed:
        inside = [new for new, old in enumerate(kept) if start <= old <= end]
        if len(inside) > 1:
            sheaths.append((inside[0], inside[-1]))
    return replace(cable, points=tuple(cable.points[place] for place in kept), sheathed=tuple(sheaths))


def _poses(robot: Robot, markers: Collection[str]) -> dict[str, PoseTarget]:
    """Poses with the targets of these markers; those without any are gone."""
    poses = {}
    for name, pose in robot.poses.items():
        targets = {marker: target for marker, target in pose.targets.items() if marker in markers}
        if targets:
            poses[name] = pose if len(targets) == len(pose.targets) else replace(pose, targets=targets)
    return poses
