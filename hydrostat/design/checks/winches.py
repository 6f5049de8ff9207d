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
    yield from _overfull_winches(parts)


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
            yield (
                f"{parts.winch_name(index)}: outside winch_zones (by {mm(away)}, at {place(at[0])}). "
                "Allowed: inside a zone. Move it there."
            )


def _near_the_edge(parts: Parts) -> Iterator[str]:
    inside = [index for index in parts.new_winches if parts.robot.winches[index].mount is Mount.BODY]
    if not inside:
        return
    least = parts.constraints.winch_clearance
    depths = parts.region.depths(np.array([parts.robot.winches[index].at for index in inside], dtype=float))
    for index, depth in zip(inside, depths, strict=True):
        if depth < least - LENGTH:
            yield (
                f"{parts.winch_name(index)}: low clearance ({parts.within(depth)}). "
                f"Minimum winch_clearance: {mm(least)}. Move it inward."
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
                f"{parts.winch_name(other)}: too close to {parts.winch_name(one)} ({mm(gap)}). "
                f"Minimum winch_gap: {mm(least)}. Move them apart."
            )


def _of_other_makes(parts: Parts) -> Iterator[str]:
    limits = parts.constraints
    for index in parts.new_winches:
        winch, name = parts.robot.winches[index], parts.winch_name(index)
        if limits.mount is not None and winch.mount is not limits.mount:
            yield f'{name}: wrong mount ("{winch.mount}"). Allowed: "{limits.mount}". Change it.'
        if winch.travel > limits.travel + LENGTH:
            yield f"{name}: travel too large ({mm(winch.travel)}). Maximum: {mm(limits.travel)}. Reduce it."
        back = any(cable.reverse for cable in parts.robot.cables if cable.winch == winch.name)
        most = limits.reverse_release if back and limits.two_way else limits.release
        if winch.release > most + LENGTH:
            yield f"{name}: release too large ({mm(winch.release)}). Maximum: {mm(most)}. Reduce it."
        if abs(winch.spool_radius - limits.spool_radius) > LENGTH:
            allowed = mm(limits.spool_radius)
            yield f"{name}: wrong spool_radius ({mm(winch.spool_radius)}). Allowed: {allowed}. Change it."


def _overfull_winches(parts: Parts) -> Iterator[str]:
    most = parts.constraints.cables_per_winch
    changed = {parts.robot.cables[index].winch for index in parts.new_cables}
    for index, winch in enumerate(parts.robot.winches):
        count = sum(cable.winch == winch.name for cable in parts.robot.cables)
        if winch.name in changed and count > most:
            name = parts.winch_name(index)
            yield f"{name}: too many cables ({count}). Maximum cables_per_winch: {most}. Add a winch."


MIRROR_TOLERANCE = 1e-4  # a mirror image may be so far from where it should be [m]


def mirror_violations(parts: Parts) -> Iterator[str]:
    """Parts that have no equal on the other side; what stands in the mirror is its own."""
    if parts.constraints.mirror is None:
        return
    flip = parts.constraints.flip(parts.robot.body.mesh.dim)
    images = [_image_of(parts, winch, flip) for winch in parts.robot.winches]
    for index in parts.new_winches:
        if images[index] is None:
            image_at = place(flip * parts.robot.winches[index].at)
            yield f"{parts.winch_name(index)}: no mirror image (expected at {image_at}). Add it or clear mirror."
    for index in parts.new_cables:
        cable = parts.robot.cables[index]
        image = images[parts.numbers[cable.winch]]
        if image is None or not any(
            other.winch == parts.robot.winches[image].name and _mirrors(parts, index, number, flip)
            for number, other in enumerate(parts.robot.cables)
        ):
            end = place(flip * cable.points[-1])
            yield f"cable[{index}]: no mirror image (expected to end at {end}). Add it or clear mirror."


def _image_of(parts: Parts, winch: Winch, flip: np.ndarray) -> int | None:
    """Number of the winch that is the image of one."""
    wanted = np.array([*(flip * winch.at), winch.spool_radius, winch.travel, winch.release])
    for index, other in enumerate(parts.robot.winches):
        own = np.array([*other.at, other.spool_radius, other.travel, other.release])
        if other.mount is winch.mount and np.abs(own - wanted).max() <= MIRROR_TOLERANCE:
            return index
    return None


def _mirrors(parts: Parts, one: int, other: int, flip: np.ndarray) -> bool:
    """True if two cables are images of each other, their winches aside."""
    cables, ratios = parts.robot.cables, parts.robot.spool_ratios
    first, second = parts.points[one], parts.points[other]
    return (
        first.shape == second.shape
        and bool(np.abs(flip * first - second).max() <= MIRROR_TOLERANCE)
        and abs(cables[one].slack - cables[other].slack) <= MIRROR_TOLERANCE
        and bool(np.isclose(ratios[one], ratios[other], rtol=1e-3))
        and _make(cables[one]) == _make(cables[other])
    )


def _make(cable: Cable) -> tuple[object, ...]:
    """Return the properties in which two images agree exactly."""
    return cable.bare.tolist(), cable.stiffness, cable.smoothing, cable.friction
