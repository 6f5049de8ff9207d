"""`winch_violations`, `mirror_violations`: where winches stand, what they are, and what has no mirror image."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from hydrostat.design.checks.parts import LENGTH, Parts, mm, place
from hydrostat.robot import Cable, Mount, Winch


def winch_violations(parts: Parts) -> Iterator[str]:
    """Winches outside their zones, near the edge or each other, of other sizes, or with too many cables."""
    yield from standing_violations(parts)
    yield from _of_other_makes(parts)
    yield from _crowded(parts)


def standing_violations(parts: Parts) -> Iterator[str]:
    """Winches outside their zones, near the edge, or near each other."""
    yield from _out_of_zones(parts)
    yield from _near_the_edge(parts)
    yield from _near_each_other(parts)


def _out_of_zones(parts: Parts) -> Iterator[str]:
    zones = parts.constraints.winch_zones
    if not zones:
        return
    for index in parts.new_winches:
        at = np.array([parts.robot.winches[index].at], dtype=float)
        away = min(float(zone.distances(at)[0]) for zone in zones)
        if away > LENGTH:
            yield f"{parts.winch_name(index)} stands at {place(at[0])}, {mm(away)} outside the nearest of winch_zones"


def _near_the_edge(parts: Parts) -> Iterator[str]:
    inside = [index for index in parts.new_winches if parts.robot.winches[index].mount is Mount.BODY]
    if not inside:
        return
    least = parts.constraints.winch_clearance
    depths = parts.region.depths(np.array([parts.robot.winches[index].at for index in inside], dtype=float))
    for index, depth in zip(inside, depths, strict=True):
        if depth < least - LENGTH:
            yield (
                f"{parts.winch_name(index)} stands {parts.within(depth)}, less than the winch_clearance of {mm(least)}"
            )


def _near_each_other(parts: Parts) -> Iterator[str]:
    least, winches = parts.constraints.winch_gap, parts.robot.winches
    for one, other in combinations(range(len(winches)), 2):
        both_given = winches[one].mount is Mount.WORLD and winches[other].mount is Mount.WORLD
        if both_given or not {one, other} & set(parts.new_winches):
            continue
        gap = float(np.linalg.norm(np.subtract(winches[one].at, winches[other].at)))
        if gap < least - LENGTH:
            yield (
                f"{parts.winch_name(other)} stands {mm(gap)} from {parts.winch_name(one)}, "
                f"less than the winch_gap of {mm(least)}"
            )


def _of_other_makes(parts: Parts) -> Iterator[str]:
    limits = parts.constraints
    for index in parts.new_winches:
        winch, name = parts.robot.winches[index], parts.winch_name(index)
        if limits.mount is not None and winch.mount is not limits.mount:
            yield f'{name} has mount = "{winch.mount}", not "{limits.mount}"'
        if winch.travel > limits.travel + LENGTH:
            yield f"{name} has a travel of {mm(winch.travel)}, more than {mm(limits.travel)}"
        if winch.release > limits.release + LENGTH:
            yield f"{name} has a release of {mm(winch.release)}, more than {mm(limits.release)}"
        if abs(winch.spool_radius - limits.spool_radius) > LENGTH:
            yield f"{name} has a spool_radius of {mm(winch.spool_radius)}, not {mm(limits.spool_radius)}"


def _crowded(parts: Parts) -> Iterator[str]:
    most = parts.constraints.cables_per_winch
    changed = {parts.robot.cables[index].winch for index in parts.new_cables}
    for index, winch in enumerate(parts.robot.winches):
        count = sum(cable.winch == winch.name for cable in parts.robot.cables)
        if winch.name in changed and count > most:
            yield f"{parts.winch_name(index)} pulls {count} cables, more than the cables_per_winch of {most}"


_NEAR = 1e-4  # a mirror image may be so far from where it should be [m]


def mirror_violations(parts: Parts) -> Iterator[str]:
    """Parts that have no equal on the other side; what stands in the mirror is its own."""
    if parts.constraints.mirror is None:
        return
    flip = parts.constraints.flip(parts.robot.body.mesh.dim)
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
    """True if two cables are images of each other, their winches aside."""
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
    """Return the properties in which two images agree exactly."""
    return cable.bare.tolist(), cable.stiffness, cable.smoothing, cable.friction
