"""`find_mirror_axis`: poses that are mirror images of each other, of which a symmetric network is a likely answer."""

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
        if twins is None or measure_asymmetry(robot.body, number) > near:
            continue
        if all(any(_is_image(pose, other, twins, flip, near) for other in poses) for pose in poses):
            return axis
    return None


def _twins(rest: Mapping[str, np.ndarray], flip: np.ndarray, near: float) -> dict[str, str] | None:
    """The marker at the mirror image of each; None if one has none."""
    twins = {
        name: min(rest, key=lambda other, image=at * flip: float(np.linalg.norm(rest[other] - image)))
        for name, at in rest.items()
    }
    return twins if all(np.linalg.norm(rest[twins[name]] - at * flip) <= near for name, at in rest.items()) else None


def _is_image(pose: PoseTarget, other: PoseTarget, twins: Mapping[str, str], flip: np.ndarray, near: float) -> bool:
    """True if the targets of another pose are the mirror images of those of a pose, for the twins of its markers."""
    return len(pose.targets) == len(other.targets) and all(
        twins[name] in other.targets and np.linalg.norm(np.array(other.targets[twins[name]]) - flip * to) <= near
        for name, to in pose.targets.items()
    )
