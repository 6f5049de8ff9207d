"""`remove`: a robot without some of its parts."""

from collections.abc import Collection
from dataclasses import replace

from hydrostat.errors import InputError
from hydrostat.robot import Cable, Pose, Robot
from hydrostat.studio.editing.part import Kind, Part, find_part


def remove(robot: Robot, keys: Collection[str]) -> Robot:
    """The same robot without parts; the cables of a winch go with it, a marker leaves its poses.

    Raises:
        InputError: no such part, or one that the robot cannot do without.
    """
    gone: dict[Kind, set[int]] = {kind: set() for kind in Kind}
    vias: dict[int, set[int]] = {}
    for key in keys:
        part = _found(robot, key)
        if part.kind is Kind.VIA:
            vias.setdefault(part.index, set()).add(part.place)
        gone[part.kind].add(part.index)
    if len(gone[Kind.PIN]) == len(robot.pins):
        raise InputError("the last pin stays: a robot must be held somewhere; place another one first")
    winches = tuple(winch for index, winch in enumerate(robot.winches) if index not in gone[Kind.WINCH])
    names = {winch.name for winch in winches}
    markers = tuple(marker for index, marker in enumerate(robot.markers) if index not in gone[Kind.MARKER])
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
    )


def _found(robot: Robot, key: str) -> Part:
    part = find_part(robot, key)
    if part is None:
        raise InputError(f"there is no {key} to be removed")
    return part


def _without_points(index: int, cable: Cable, places: Collection[int]) -> Cable:
    """A cable without some of its points; the one before a lost stopper becomes the stopper."""
    if not places:
        return cable
    kept = [place for place in range(len(cable.points)) if place not in places]
    if len(kept) < 2:
        raise InputError(f"cable {index + 1} needs its winch and a stopper; delete the cable itself")
    sheaths = []
    for start, end in cable.sheathed:
        inside = [new for new, old in enumerate(kept) if start <= old <= end]
        if len(inside) > 1:
            sheaths.append((inside[0], inside[-1]))
    return replace(cable, points=tuple(cable.points[place] for place in kept), sheathed=tuple(sheaths))


def _poses(robot: Robot, markers: Collection[str]) -> dict[str, Pose]:
    """Poses with the targets of these markers; those without any are gone."""
    poses = {}
    for name, pose in robot.poses.items():
        targets = {marker: target for marker, target in pose.targets.items() if marker in markers}
        if targets:
            poses[name] = pose if len(targets) == len(pose.targets) else replace(pose, targets=targets)
    return poses
