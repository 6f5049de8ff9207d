"""`mirror_violations`: winches and cables without a mirror image."""

from collections.abc import Iterator

import numpy as np

from hydrostat.design.checks.parts import Parts, place
from hydrostat.robot import Cable, Winch

_NEAR = 1e-4
"""A mirror image may be so far from where it should be [m]."""


def mirror_violations(parts: Parts) -> Iterator[str]:
    """Parts that have no equal on the other side; what stands in the mirror is its own."""
    axis = parts.constraints.mirror
    if axis is None:
        return
    flip = np.ones(parts.robot.body.mesh.dim)
    flip["xyz".index(axis)] = -1.0
    images = [_image_of(parts, winch, flip) for winch in parts.robot.winches]
    for index in parts.new_winches:
        if images[index] is None:
            yield f"{parts.winch_name(index)} has no mirror image at {place(flip * parts.robot.winches[index].at)}"
    for index in parts.new_cables:
        cable = parts.robot.cables[index]
        image = images[parts.numbers[cable.winch]]
        if image is None or not any(
            other.winch == parts.robot.winches[image].name and _mirrors(parts, index, number, flip)
            for number, other in enumerate(parts.robot.cables)
        ):
            yield f"cable[{index}] has no mirror image that ends at {place(flip * cable.points[-1])}"


def _image_of(parts: Parts, winch: Winch, flip: np.ndarray) -> int | None:
    """Number of the winch that is the image of one."""
    wanted = np.array([*(flip * winch.at), winch.spool_radius, winch.travel, winch.release])
    for index, other in enumerate(parts.robot.winches):
        own = np.array([*other.at, other.spool_radius, other.travel, other.release])
        if other.mount is winch.mount and np.abs(own - wanted).max() <= _NEAR:
            return index
    return None


def _mirrors(parts: Parts, one: int, other: int, flip: np.ndarray) -> bool:
    """Whether two cables are images of each other, their winches aside."""
    cables, ratios = parts.robot.cables, parts.robot.spool_ratios
    first, second = parts.points[one], parts.points[other]
    return (
        first.shape == second.shape
        and bool(np.abs(flip * first - second).max() <= _NEAR)
        and abs(cables[one].slack - cables[other].slack) <= _NEAR
        and bool(np.isclose(ratios[one], ratios[other], rtol=1e-3))
        and _make(cables[one]) == _make(cables[other])
    )


def _make(cable: Cable) -> tuple[object, ...]:
    """What two images have exactly in common."""
    return cable.bare.tolist(), cable.stiffness, cable.smoothing, cable.friction
