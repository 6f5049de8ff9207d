"""`find_mirror_axis`: poses that are their own mirror image, of which a symmetric network is a likely answer."""

from collections.abc import Iterable, Mapping

import numpy as np

from hydrostat.design.constraints import Constraints
from hydrostat.errors import InputError
from hydrostat.robot import PoseTarget, Robot

_MIRROR_TOLERANCE = 0.02  # share of the body's size by which a point may be off its mirror image


def find_mirror_axis(robot: Robot, poses: Iterable[PoseTarget]) -> str | None:
    """Axis across which the outline, the markers and all targets are their own mirror image; None without one."""
    nodes, near = robot.body.mesh.nodes, _MIRROR_TOLERANCE * robot.body.mesh.size
    skin = nodes[robot.body.mesh.boundary_nodes]
    rest = {marker.name: np.array(marker.at) for marker in robot.markers}
    for axis in "xyz"[: nodes.shape[1]]:
        limits = Constraints(mirror=axis)
        try:
            limits.check(robot)
        except InputError:  # the body is not centered on the plane
            continue
        flip = limits.flip(nodes.shape[1])
        twins = _twins(rest, flip, near)
        if twins is None or robot.body.distances(skin * flip).max() > near:
            continue
        if all(_is_mirrored(pose, twins, flip, near) for pose in poses):
            return axis
    return None


def _twins(rest: Mapping[str, np.ndarray], flip: np.ndarray, near: float) -> dict[str, str] | None:
    """The marker at the mirror image of each; None if one has none."""
    twins = {
        name: min(rest, key=lambda other, image=at * flip: float(np.linalg.norm(rest[other] - image)))
        for name, at in rest.items()
    }
    return twins if all(np.linalg.norm(rest[twins[name]] - at * flip) <= near for name, at in rest.items()) else None


def _is_mirrored(pose: PoseTarget, twins: Mapping[str, str], flip: np.ndarray, near: float) -> bool:
    """True if the twin of each target's marker has the mirror image as its target."""
    return all(
        twins[name] in pose.targets and np.linalg.norm(np.array(pose.targets[twins[name]]) - flip * to) <= near
        for name, to in pose.targets.items()
    )
