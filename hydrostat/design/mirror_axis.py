"""`find_mirror_axis`, `find_unmirrored_poses`: poses that are mirror images of each other, or not."""

from collections.abc import Iterable, Mapping

import numpy as np

from hydrostat.design.constraints import Constraints
from hydrostat.errors import InputError
from hydrostat.robot import MIRROR_TOLERANCE, PoseTarget, Robot, measure_asymmetry


def find_mirror_axis(robot: Robot, poses: Iterable[PoseTarget]) -> str | None:
    """Axis across which the outline, the markers and the set of poses are their own mirror image; None without one.

    A pose may be its own image, as when both arms wave, or that of another, as when one arm waves in each.
    """
    dim, near, poses = robot.body.mesh.dim, MIRROR_TOLERANCE * robot.body.mesh.size, tuple(poses)
    rest = {marker.name: np.array(marker.at) for marker in robot.markers}
    for number, axis in enumerate("xyz"[:dim]):
        limits = Constraints(mirror=axis)
        try:
            limits.check(robot)
        except InputError:  # the body is not centered on the plane
            continue
        flip = limits.flip(dim)
        twins = _twins(rest, flip, near)
        if len(twins) < len(rest) or measure_asymmetry(robot.body, number) > near:
            continue
        if all(any(_is_image(pose, other, twins, flip, near) for other in poses) for pose in poses):
            return axis
    return None


def find_unmirrored_poses(robot: Robot, poses: Iterable[PoseTarget], axis: str) -> tuple[str, ...]:
    """Names of the poses whose targets are neither their own mirror image across an axis nor that of another pose."""
    near, poses = MIRROR_TOLERANCE * robot.body.mesh.size, tuple(poses)
    flip = Constraints(mirror=axis).flip(robot.body.mesh.dim)
    twins = _twins({marker.name: np.array(marker.at) for marker in robot.markers}, flip, near)
    return tuple(pose.name for pose in poses if not any(_is_image(pose, other, twins, flip, near) for other in poses))


def _twins(rest: Mapping[str, np.ndarray], flip: np.ndarray, near: float) -> dict[str, str]:
    """The marker at the mirror image of each that has one."""
    twins = {
        name: min(rest, key=lambda other, image=at * flip: float(np.linalg.norm(rest[other] - image)))
        for name, at in rest.items()
    }
    return {name: twin for name, twin in twins.items() if np.linalg.norm(rest[twin] - rest[name] * flip) <= near}


def _is_image(pose: PoseTarget, other: PoseTarget, twins: Mapping[str, str], flip: np.ndarray, near: float) -> bool:
    """True if the targets of another pose are the mirror images of those of a pose, for the twins of its markers."""
    return len(pose.targets) == len(other.targets) and all(
        twins.get(name) in other.targets and np.linalg.norm(np.array(other.targets[twins[name]]) - flip * to) <= near
        for name, to in pose.targets.items()
    )
