"""`with_pose`, `same_as`, `renamed_pose`, `without_pose`, `wishes_after`, `held_of`: the poses of a robot, changed."""

import math
from collections.abc import Mapping
from dataclasses import replace

from hydrostat.errors import InputError
from hydrostat.project import Wishes
from hydrostat.robot import Marker, PoseTarget, Robot, check_name
from hydrostat.studio.posing.held import HeldPoint

SAME = 1e-4  # poses whose targets are nearer to each other are the same [m]


def with_pose(robot: Robot, name: str, held: Mapping[str, HeldPoint]) -> Robot:
    """A robot with one more pose, or another of its name; held points get markers (InputError: no name or point)."""
    name = checked_name(name)
    if not held:
        raise InputError("no targets yet. Drag a point of the body, then store the pose")
    known = {marker.name for marker in robot.markers}
    new = tuple(Marker(name=own, at=point.at) for own, point in held.items() if own not in known)
    pose = PoseTarget(name=name, targets={own: point.target for own, point in held.items()})
    return replace(robot, markers=(*robot.markers, *new), poses={**robot.poses, name: pose})


def same_as(robot: Robot, name: str) -> str:
    """The first other pose with the same targets as one, to a tenth of a millimetre; "" if there is none."""
    own = robot.pose(name).targets
    for pose in robot.poses.values():
        alike = pose.name != name and set(pose.targets) == set(own)
        if alike and all(math.dist(pose.targets[marker], goal) < SAME for marker, goal in own.items()):
            return pose.name
    return ""


def renamed_pose(robot: Robot, old: str, new: str) -> Robot:
    """A robot with another name for a pose, in its old place (InputError: no such pose, no name, or a taken one)."""
    pose, new = robot.pose(old), checked_name(new)
    if new != old and new in robot.poses:
        raise InputError(f'the pose name "{new}" is already in use. Choose another name')
    poses = {new if name == old else name: own for name, own in robot.poses.items()}
    return replace(robot, poses={**poses, new: replace(pose, name=new)})


def without_pose(robot: Robot, name: str) -> Robot:
    """A robot without a pose (InputError: no such pose)."""
    robot.pose(name)
    return replace(robot, poses={own: pose for own, pose in robot.poses.items() if own != name})


def wishes_after(wishes: Wishes, robot: Robot, renamed: Mapping[str, str] | None = None) -> Wishes:
    """Wishes that name only poses that the robot has now; `renamed` gives new names by their old ones."""
    names = [(renamed or {}).get(name, name) for name in wishes.poses]
    return replace(wishes, poses=tuple(name for name in names if name in robot.poses))


def held_of(robot: Robot, name: str) -> dict[str, HeldPoint]:
    """The targets of a pose, as points that are held (InputError: no such pose)."""
    places = {marker.name: marker.at for marker in robot.markers}
    targets = robot.pose(name).targets
    return {own: HeldPoint(at=places[own], target=target, marker=True) for own, target in targets.items()}


def checked_name(given: str) -> str:
    """A name without spaces at its ends, fit for a robot's file (InputError: empty, too long, wrong letters)."""
    name = given.strip()
    if not name:
        raise InputError("pose name missing. Type one, e.g. wave")
    return check_name(name)
